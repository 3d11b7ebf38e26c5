/*
 * Arithmetic in 32-bit integers: n stands for n 2^-bits, and |n| <= 2^30. Written by hand; no licence is claimed on it.
 * Nothing here overflows: ranges are proven when the law's source is written, and what is not proven is cut off.
 */
#ifndef WB_FIXED_H
#define WB_FIXED_H

#include "wb_runtime.h"

/* Fewer fractional bits, rounded down, as in every product: what is lost is less than the unit of the result. */
static inline int32_t wb_right(int32_t a, int by)
{
    return a >> by;
}

static inline int32_t wb_left(int32_t a, int by)
{
    return a * ((int32_t)1 << by);
}

static inline int32_t wb_times(int32_t a, int32_t b, int by)
{
    return (int32_t)(((int64_t)a * b) >> by);
}

/* As wb_times, and no more than 2^30: by is 2 to 32, so that the upper word alone says whether it would be. */
static inline int32_t wb_times_most(int32_t a, int32_t b, int by)
{
    const int64_t found = (int64_t)a * b;
    return ((int32_t)(found >> 32) >= ((int32_t)1 << (by - 2))) ? 1073741824 : (int32_t)(found >> by);
}

/* a 2^up / b, towards zero and no more than 2^30 in size; by the least unit where b is zero. */
WB_CONST int32_t wb_over(int32_t a, int32_t b, int up);

/* The square root of a 2^up, downwards; 0 of what is negative. */
WB_CONST int32_t wb_root(int32_t a, int up);

static inline int32_t wb_min(int32_t a, int32_t b)
{
    return (a <= b) ? a : b;
}

static inline int32_t wb_max(int32_t a, int32_t b)
{
    return (a >= b) ? a : b;
}

static inline int32_t wb_size(int32_t a)
{
    return (a < 0) ? -a : a;
}

static inline int32_t wb_within(int32_t a, int32_t most)
{
    return wb_min(wb_max(a, -most), most);
}

static inline int32_t wb_choose(int condition, int32_t a, int32_t b)
{
    return (condition != 0) ? a : b;
}

static inline int32_t wb_truth(int condition)
{
    return (int32_t)condition;
}

static inline int wb_not(int a)
{
    return a == 0;
}

static inline int wb_and(int a, int b)
{
    return (a != 0) && (b != 0);
}

static inline int wb_or(int a, int b)
{
    return (a != 0) || (b != 0);
}

/*
 * Where an amplitude lies on knots at 2^e (1 + j/m): the segment i, and how far into it, 0 to 2^12 - 1. `amplitude` is in
 * units of 2^-bits and not negative; its bits are put where a float has them, for the leading bits of a float count the
 * knots. Its last bit is taken as set, so that nothing is a number too.
 */
static inline uint32_t wb_segment_fixed(const wb_head *head, int32_t amplitude, int bits, int32_t *into)
{
    const uint32_t whole = (uint32_t)amplitude | 1u;
    const uint32_t zeros = wb_leading(whole);
    /* a float's exponent is biased by 127, this integer's by `bits`; the leading one adds the last one to 158 */
    const uint32_t real = ((157u - (uint32_t)bits - zeros) << 23) + ((whole << zeros) >> 8);
    const uint32_t i = (real >> head->shift) - head->first;
    if (i < head->last) {
        *into = (int32_t)((real >> (head->shift - 12u)) & 0xFFFu);
        return i;
    }
    *into = 0;
    return (i > 0x7FFFFFFFu) ? 0u : head->last;
}

/* Of a row of 19-bit gains: between two knots along a line. The last one stands there twice. */
static inline int32_t wb_between(const int32_t *row, uint32_t i, int32_t into)
{
    return row[i] + wb_right((row[i + 1u] - row[i]) * into, 12);
}

#endif
