/* Square roots, of words and of floats: see wb_runtime.h. Written by hand; no licence is claimed on it. */
#include "wb_runtime.h"

/*
 * The root of a word in which one of the two top bits is set: 8 of its 16 bits digit by digit, the others by one division
 * (Zimmermann, Karatsuba Square Root, 1999). *rest: what the square leaves.
 */
static uint32_t root_of(uint32_t word, uint32_t *rest)
{
    uint32_t high = word >> 16;
    uint32_t half = 0u;
    uint32_t bit;
    uint32_t quotient;
    uint32_t left;
    uint32_t root;
    for (bit = (uint32_t)1u << 14; bit != 0u; bit >>= 2) {
        const uint32_t tried = half + bit;
        half >>= 1;
        if (high >= tried) {
            high -= tried;
            half += bit;
        }
    }
    left = (high << 8) + ((word >> 8) & 0xFFu);
    quotient = left / (2u * half);
    left = ((left - quotient * 2u * half) << 8) + (word & 0xFFu);
    root = (half << 8) + quotient;
    if (left < quotient * quotient) {
        --root;
        left += 2u * root + 1u;
    }
    *rest = left - quotient * quotient;
    return root;
}

/* Of the upper half, and the lower half by one division, once more. */
uint32_t wb_root64(uint64_t word)
{
    const uint32_t high = (uint32_t)(word >> 32);
    const uint32_t zeros = ((high != 0u) ? wb_leading(high) : 32u + wb_leading((uint32_t)word)) & ~(uint32_t)1u;
    const uint64_t full = word << zeros;
    uint32_t rest;
    const uint32_t half = root_of((uint32_t)(full >> 32), &rest);
    const uint32_t quotient = ((rest << 15) + ((uint32_t)full >> 17)) / half;
    const uint64_t left = (((uint64_t)rest << 16) + ((uint32_t)full >> 16)) - (uint64_t)quotient * 2u * half;
    uint64_t root = ((uint64_t)half << 16) + quotient;
    if (((left << 16) + (full & 0xFFFFu)) < (uint64_t)quotient * quotient) {
        --root;
    }
    return (uint32_t)(root >> (zeros >> 1));
}

/*
 * The square root, rounded to nearest: the instruction where the target has one, else digit by digit (24 bits and one
 * to round by). Both give the same bits. A negative number gives 0, zeros and a NaN
 * themselves: the laws take roots of what is not negative.
 */
float wb_sqrtf(float a)
{
#if defined(__ARM_FP) && (__ARM_FP & 4)
    float root;
    if (!(a > 0.0f)) {
        return (a < 0.0f) ? 0.0f : a;
    }
    __asm__("vsqrt.f32 %0, %1" : "=t"(root) : "t"(a));
    return root;
#else
    uint32_t bits = wb_bits(a);
    int32_t exponent;
    uint64_t rest;
    uint32_t root;
    if (!(a > 0.0f)) {
        return (a < 0.0f) ? 0.0f : a;
    }
    if ((bits & 0x7F800000u) == 0x7F800000u) {
        return a;
    }
    exponent = (int32_t)(bits >> 23);
    bits &= 0x007FFFFFu;
    if (exponent == 0) {
        exponent = 1;
        while ((bits & 0x00800000u) == 0u) { /* a denormal */
            bits <<= 1;
            --exponent;
        }
    }
    bits |= 0x00800000u;
    exponent -= 127;
    rest = (uint64_t)bits << (((exponent & 1) != 0) ? 26 : 25); /* 48 or 49 bits: the root has 25 */
    root = wb_root64(rest);
    root = (root + 1u) >> 1; /* the 25th bit rounds; a tie cannot be, for its square would have too many bits */
    exponent = (exponent - (((exponent & 1) != 0) ? 1 : 0)) / 2;
    return wb_real((((uint32_t)(exponent + 127)) << 23) + (root - 0x00800000u));
#endif
}
