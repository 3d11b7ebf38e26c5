/* See wb_fixed.h. Written by hand; no licence is claimed on it. */
#include "wb_fixed.h"

static uint32_t leading(uint32_t word) /* how many zeros lead; word is not 0 */
{
#if defined(__GNUC__)
    return (uint32_t)__builtin_clz(word);
#else
    uint32_t zeros = 0u;
    while ((word & 0x80000000u) == 0u) {
        word <<= 1;
        ++zeros;
    }
    return zeros;
#endif
}

/*
 * above / below for above < 2^30 below, below normalised (its top bit set): two digits of 16 bits, each from the division of 32 bits
 * that a target has (Knuth, The Art of Computer Programming 2, 4.3.1 D). A digit is at most two too large at first.
 */
static uint32_t ratio(uint64_t above, uint32_t below)
{
    const uint32_t high = below >> 16;
    const uint32_t low = below & 0xFFFFu;
    uint32_t rest = (uint32_t)(above >> 32);
    uint32_t found = 0u;
    int shift;
    for (shift = 16; shift >= 0; shift -= 16) {
        const uint32_t next = ((uint32_t)above >> shift) & 0xFFFFu;
        uint32_t digit = rest / high;
        uint32_t over = rest - digit * high;
        while ((over <= 0xFFFFu) && ((uint64_t)digit * low > (((uint64_t)over << 16) | next))) {
            --digit;
            over += high;
        }
        rest = (rest << 16) + next - digit * below;
        found = (found << 16) + digit;
    }
    return found;
}

int32_t wb_over(int32_t a, int32_t b, int up)
{
    const int negative = (a < 0) != (b < 0);
    const uint64_t above = (uint64_t)(uint32_t)wb_size(a) << up;
    const uint32_t below = (b == 0) ? 1u : (uint32_t)wb_size(b);
    uint32_t found = (uint32_t)1u << 30;
    if ((above >> 30) < below) {
        const uint32_t zeros = leading(below);
        found = ratio(above << zeros, below << zeros);
    }
    return negative ? -(int32_t)found : (int32_t)found;
}

/*
 * The root of a word in which one of the two top bits is set: 16 bits, digit by digit. *rest: what the square leaves.
 */
static uint32_t root_of(uint32_t word, uint32_t *rest)
{
    uint32_t root = 0u;
    uint32_t bit = (uint32_t)1u << 30;
    while (bit != 0u) {
        if (word >= root + bit) {
            word -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
        bit >>= 2;
    }
    *rest = word;
    return root;
}

/* Of the upper half digit by digit, and the lower half by one division (Zimmermann, Karatsuba Square Root, 1999). */
int32_t wb_root(int32_t a, int up)
{
    uint64_t word;
    uint32_t zeros;
    uint32_t half;
    uint32_t rest;
    uint32_t quotient;
    uint64_t left;
    uint64_t root;
    if (a <= 0) {
        return 0;
    }
    word = (uint64_t)(uint32_t)a << up;
    zeros = (word >> 32 != 0u) ? leading((uint32_t)(word >> 32)) : 32u + leading((uint32_t)word);
    zeros &= ~(uint32_t)1u;
    word <<= zeros;
    half = root_of((uint32_t)(word >> 32), &rest);
    quotient = ((rest << 15) + ((uint32_t)word >> 17)) / half;
    left = (((uint64_t)rest << 16) + ((uint32_t)word >> 16)) - (uint64_t)quotient * 2u * half;
    root = ((uint64_t)half << 16) + quotient;
    if (((left << 16) + (word & 0xFFFFu)) < (uint64_t)quotient * quotient) {
        --root;
    }
    return (int32_t)(root >> (zeros >> 1));
}

uint32_t wb_segment_fixed(const wb_head *head, int32_t amplitude, int bits, int32_t *into)
{
    const uint32_t step = 23u - head->shift; /* log2 of the knots an octave */
    uint32_t zeros;
    uint32_t word;
    uint32_t i;
    *into = 0;
    if (amplitude <= 0) {
        return 0u;
    }
    zeros = leading((uint32_t)amplitude);
    word = (uint32_t)amplitude << zeros;
    /* the float's exponent is biased by 127, this integer's by `bits` */
    i = ((31u - zeros + 127u - (uint32_t)bits) << step) + ((word >> (31u - step)) & ((1u << step) - 1u));
    i -= head->first;
    if (i >= head->last) {
        return (i > 0x7FFFFFFFu) ? 0u : head->last;
    }
    *into = (int32_t)((word >> (19u - step)) & 0xFFFu);
    return i;
}
