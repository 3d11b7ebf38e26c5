/* See wb_fixed.h. Written by hand; no licence is claimed on it. */
#include "wb_fixed.h"

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
        const uint32_t zeros = wb_leading(below);
        found = ratio(above << zeros, below << zeros);
    }
    return negative ? -(int32_t)found : (int32_t)found;
}

int32_t wb_root(int32_t a, int up)
{
    return (a > 0) ? (int32_t)wb_root64((uint64_t)(uint32_t)a << up) : 0;
}
