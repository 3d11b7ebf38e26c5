/* Square roots, of words and of floats: see wb_runtime.h. Written by hand; no licence is claimed on it. */
#include "wb_runtime.h"

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
