/*
 * What a firmware would do with an exported gain table, and nothing more.
 *
 *   consumer lookup     amplitude                  -> kp kd
 *   consumer drive      amplitude                  -> kp kd in the drive's units
 *   consumer schedule   target position            -> amplitude kp kd; the first line starts a move
 *   consumer stroke     position                   -> amplitude turn, of a table that follows; the first line starts from rest
 *   consumer check                                 -> CRC-32 of "123456789", whether the tables are whole
 *
 * Numbers are the bits of a float32 in hexadecimal, one line a sample, so that nothing is rounded on the way.
 */
#include "gains.h"

#include <stdio.h>
#include <string.h>

static float from_bits(unsigned int bits)
{
    const uint32_t word = (uint32_t)bits;
    float value;
    (void)memcpy(&value, &word, sizeof value);
    return value;
}

static unsigned int to_bits(float value)
{
    return (unsigned int)wb_table_bits(value);
}

static int gains(int drive)
{
    unsigned int a;
    while (scanf("%x", &a) == 1) {
        float kp = 0.0f;
        float kd = 0.0f;
        if (drive == 0) {
            wb_gains_lookup(from_bits(a), &kp, &kd);
        } else {
#ifdef WB_GAINS_HAS_DRIVE
            wb_gains_lookup_drive(from_bits(a), &kp, &kd);
#else
            return 3;
#endif
        }
        printf("%08x %08x\n", to_bits(kp), to_bits(kd));
    }
    return 0;
}

static int schedule(void)
{
    wb_gains_state state;
    unsigned int r;
    unsigned int y;
    int first = 1;
    while (scanf("%x %x", &r, &y) == 2) {
        float kp;
        float kd;
        const float amplitude = (first != 0) ? wb_gains_start(&state, from_bits(r), from_bits(y))
                                             : wb_gains_update(&state, from_bits(r), from_bits(y));
        first = 0;
        wb_gains_lookup(amplitude, &kp, &kd);
        printf("%08x %08x %08x\n", to_bits(amplitude), to_bits(kp), to_bits(kd));
    }
    return 0;
}

static int stroke(void)
{
#if WB_GAINS_FROZEN || WB_GAINS_ERROR || WB_GAINS_CLOSING
    return 3;
#else
    wb_gains_state state;
    unsigned int y;
    int first = 1;
    while (scanf("%x", &y) == 1) {
        const float amplitude = (first != 0) ? wb_gains_start(&state, 0.0f, from_bits(y))
                                             : wb_gains_update(&state, 0.0f, from_bits(y));
        first = 0;
        printf("%08x %08x\n", to_bits(amplitude), to_bits(state.turned));
    }
    return 0;
#endif
}

static int check(void)
{
    const char *const known = "123456789";
    uint32_t crc = 0xFFFFFFFFu;
    size_t i;
    for (i = 0u; known[i] != '\0'; ++i) {
        crc = wb_crc32_byte(crc, (uint32_t)(unsigned char)known[i]);
    }
    printf("%08x %d\n", (unsigned int)(crc ^ 0xFFFFFFFFu), (int)wb_gains_check());
    return 0;
}

int main(int argc, char **argv)
{
    const char what = (argc == 2) ? argv[1][0] : '?';
    const char next = (what != '?') ? argv[1][1] : '?';
    int result = 2;
    if (what == 'l') {
        result = gains(0);
    } else if (what == 'd') {
        result = gains(1);
    } else if (what == 'c') {
        result = check();
    } else if (what == 's') {
        result = (next == 't') ? stroke() : schedule();
    } else {
        (void)fprintf(stderr, "consumer: one of lookup, drive, schedule, stroke, check\n");
    }
    return result;
}
