/* See wb_fixed.h. Written by hand; no licence is claimed on it. */
#include "wb_fixed.h"

/* By hand, digit by digit: a target without a division of 64 bits would call a library for it. */
int32_t wb_over(int32_t a, int32_t b, int up)
{
    const int negative = (a < 0) != (b < 0);
    const uint64_t above = (uint64_t)(uint32_t)wb_size(a) << up;
    const uint64_t below = (b == 0) ? 1u : (uint64_t)(uint32_t)wb_size(b);
    uint64_t rest = above;
    uint32_t found = 0u;
    int bit;
    if ((above >> 30) >= below) {
        found = (uint32_t)1u << 30;
    } else {
        for (bit = 29; bit >= 0; --bit) {
            if (rest >= (below << bit)) {
                rest -= below << bit;
                found |= (uint32_t)1u << bit;
            }
        }
    }
    return negative ? -(int32_t)found : (int32_t)found;
}

int32_t wb_root(int32_t a, int up)
{
    uint64_t rest = (a > 0) ? (uint64_t)a << up : 0u;
    uint64_t root = 0u;
    uint64_t bit = (uint64_t)1u << 60;
    while (bit != 0u) {
        if (rest >= root + bit) {
            rest -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
        bit >>= 2;
    }
    return (int32_t)root;
}

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
