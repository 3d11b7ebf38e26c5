/*
 * Calls a firmware with whatever there is, and holds it to what it promises: every table that was touched is refused, no
 * command is beyond the limit, nothing is undefined (the sanitizers see to that).
 *
 *   fuzz TABLES CALLS SEED
 *
 * TABLES: blocks of a 32-bit length and so many bytes; of each the loader's answer is printed. The first has to be whole.
 */
#include "axis.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef FIXED
#include "wb_fixed.h"
typedef int32_t number;
#else
typedef float number;
#endif

enum { MOST = 1 << 16 };

static uint8_t bytes[MOST];
static uint8_t touched[MOST];
static uint8_t plant[32];
static wb_axis_table table;
static wb_axis_table other;
static wb_axis_state state;
static uint64_t seed;

static uint32_t draw(void) /* xorshift64* */
{
    seed ^= seed >> 12;
    seed ^= seed << 25;
    seed ^= seed >> 27;
    return (uint32_t)((seed * 2685821657736338717u) >> 32);
}

static void insist(int good, const char *what)
{
    if (!good) {
        (void)fprintf(stderr, "fuzz: %s\n", what);
        exit(1);
    }
}

static size_t block(FILE *file, uint8_t *into)
{
    uint8_t head[4];
    size_t size;
    if (fread(head, 1u, 4u, file) != 4u) {
        return 0u;
    }
    size = wb_u32(head);
    insist((size <= MOST) && (fread(into, 1u, size, file) == size), "the tables cannot be read");
    return size;
}

static number number_of(uint32_t word)
{
#ifdef FIXED
    return wb_signed(word);
#else
    return wb_real(word);
#endif
}

static wb_axis_inputs inputs(uint32_t from)
{
    wb_axis_inputs now;
    const uint32_t kind = draw();
    const uint32_t most = table.head.jump - 1u;
    (void)memset(&now, 0, sizeof now);
    now.position = (kind & 0x1FFFu) ? from + draw() % most - ((kind & 0x30000u) ? 0u : most) : draw();
    now.reference = wb_signed((kind & 0x40000u) ? draw() : now.position + (draw() & 0xFFFFu) - 0x8000u);
    now.reference = ((kind & 0x3F00000u) != 0u) ? now.reference : wb_signed(now.position);
    now.added = number_of((kind >> 28) ? 0u : draw());
    return now;
}

static void one_step(number limit)
{
    const uint32_t from = state.encoder.origin + (uint32_t)state.encoder.position;
    const wb_axis_inputs now = inputs(from);
    const number u = ((state.encoder.below == 0u) || ((draw() & 0xFFFu) == 0u))
                         ? (wb_axis_start(&state, &table, &now), wb_axis_step(&state, &table, &now))
                         : wb_axis_step(&state, &table, &now);
    insist((u <= limit) && (u >= -limit), "a command is beyond the limit");
}

static void one_load(size_t size)
{
    const uint32_t flips = 1u + (draw() & 3u);
    uint32_t i;
    size_t length = size;
    enum wb_refusal refused;
    (void)memcpy(touched, bytes, size);
    for (i = 0u; i < flips; ++i) {
        touched[draw() % size] ^= (uint8_t)(1u + draw() % 255u);
    }
    if ((draw() & 7u) == 0u) {
        length = draw() % size;
    }
    refused = wb_axis_load(&other, touched, length, plant);
    insist((refused != WB_ACCEPTED) || (memcmp(touched, bytes, size) == 0), "a table that was touched is accepted");
}

/* The loader's own: a firmware may insist on its sample time, and need not on its plant. */
static void wanted(size_t size)
{
    wb_wanted what;
    wb_head head;
    what.arithmetic = wb_u32(bytes + 20);
    what.law = WB_AXIS_LAW;
    what.numbers = WB_AXIS_NUMBERS;
    what.rows = WB_AXIS_ROWS;
    what.most_knots = WB_AXIS_KNOTS;
    what.plant = NULL;
    what.period = table.head.sample_time;
    insist(wb_check(bytes, size, &what, &head) == WB_ACCEPTED, "its own sample time is refused");
    what.period *= 2.0f;
    insist(wb_check(bytes, size, &what, &head) == WB_PERIOD, "another sample time is accepted");
    what.period = 0.0f;
    { /* the same bytes as a table of the other arithmetic, for a firmware of that */
        static uint8_t copy[8192];
        uint32_t crc;
        int byte;
        insist(size <= sizeof copy, "a table is too long for this test");
        (void)memcpy(copy, bytes, size);
        what.arithmetic = 3u - what.arithmetic;
        copy[20] = (uint8_t)what.arithmetic;
        crc = wb_crc32(copy, size - 4u);
        for (byte = 0; byte < 4; ++byte) {
            copy[size - 4u + (size_t)byte] = (uint8_t)(crc >> (8 * byte));
        }
        (void)wb_check(copy, size, &what, &head);
        what.arithmetic = 3u - what.arithmetic;
    }
#if WB_AXIS_KNOTS > 0
    what.most_knots = 1u;
    insist(wb_check(bytes, size, &what, &head) == WB_SHAPE, "more knots than there is memory for are accepted");
    {
        int within;
        insist(wb_segment(&table.head, 0.5f * table.knot[0], &within) == 0u && !within, "below the first knot");
        insist(wb_segment(&table.head, 1e30f, &within) == table.head.last && !within, "beyond the last knot");
    }
#ifdef FIXED
    {
        int32_t into;
        insist(wb_segment_fixed(&table.head, 0, 20, &into) == 0u, "an amplitude of nothing");
        insist(wb_segment_fixed(&table.head, 1, 60, &into) == 0u, "below the first knot");
        insist(wb_segment_fixed(&table.head, 1 << 30, 0, &into) == table.head.last, "beyond the last knot");
        insist(wb_times_most(1 << 30, 1 << 30, 20) == 1 << 30, "a product is not cut off");
    }
#endif
#endif
}

#ifdef FIXED
/* Quotients and roots of numbers of every size, held to what they are defined as. */
static void arithmetic(void)
{
    uint64_t state = 88172645463325252u;
    long k;
    for (k = 0; k < 200000; ++k) {
        int32_t a;
        int32_t b;
        int up;
        uint64_t whole;
        uint64_t found;
        state = state * 6364136223846793005u + 1442695040888963407u;
        a = (int32_t)((uint32_t)(state >> 34) >> ((state >> 5) % 31u));
        b = (int32_t)(((uint32_t)(state >> 20) & 0x3FFFFFFFu) >> ((state >> 10) % 31u)) + 1;
        b = (k % 50 == 0) ? 0x3FFFFFFF : b;
        up = (int)(state >> 16) & 31;
        whole = ((uint64_t)(uint32_t)a << up) / (uint64_t)(uint32_t)b;
        insist((uint64_t)(uint32_t)wb_over(a, b, up) == ((whole < 1073741824u) ? whole : 1073741824u), "a quotient is wrong");
        whole = (uint64_t)(uint32_t)a << (29 + k % 2);
        found = (uint64_t)(uint32_t)wb_root(a, 29 + (int)(k % 2));
        insist(found * found <= whole && (found + 1u) * (found + 1u) > whole, "a root is wrong");
    }
}
#endif

/* What the laws of these tests do not reach by themselves. */
static void corners(void)
{
    static const char *const known = "123456789";
    static const float values[] = {0.0f, -1.0f, 1e-45f, 1e-39f, 1e-30f, 0.5f, 1.0f, 2.0f, 3.4e38f};
    size_t i;
    volatile float zero = 0.0f;
    insist(wb_crc32((const uint8_t *)known, 9u) == 0xCBF43926u, "CRC-32 is wrong");
    for (i = 0u; i < sizeof values / sizeof values[0]; ++i) {
        const float root = wb_sqrtf(values[i]);
        insist(root >= 0.0f, "a root is negative");
        (void)printf("%08x ", (unsigned int)wb_bits(root));
    }
    (void)printf("%08x %d\n", (unsigned int)wb_bits(wb_sqrtf(1.0f / zero)), wb_sqrtf(zero / zero) >= 0.0f);
#ifdef FIXED
    insist(wb_over(7, 2, 0) == 3 && wb_over(-7, 2, 0) == -3 && wb_over(7, -2, 0) == -3, "a quotient is wrong");
    insist(wb_over(5, 0, 4) == 80 && wb_over(1 << 30, 1, 20) == 1 << 30, "a quotient is not cut off");
    insist(wb_root(-1, 4) == 0 && wb_root(16, 4) == 16, "a root is wrong");
    arithmetic();
#endif
}

int main(int argc, char **argv)
{
    FILE *const file = (argc == 4) ? fopen(argv[1], "rb") : NULL;
    unsigned long calls;
    unsigned long i;
    size_t size;
    size_t next;
    wb_axis_inputs now;
    insist(file != NULL, "fuzz TABLES CALLS SEED");
    calls = strtoul(argv[2], NULL, 10);
    seed = strtoul(argv[3], NULL, 10) + 1u;
    corners();
    size = block(file, bytes);
    (void)memcpy(plant, bytes + 72, sizeof plant);
    insist(wb_axis_load(&table, bytes, size, plant) == WB_ACCEPTED, "the first table is refused");
    wanted(size);
    (void)printf("0\n");
    while ((next = block(file, touched)) != 0u) {
        (void)printf("%d\n", (int)wb_axis_load(&other, touched, next, plant));
    }
    (void)fclose(file);
    (void)memset(&now, 0, sizeof now);
    wb_axis_start(&state, &table, &now);
    for (i = 0u; i < calls; ++i) {
        if (i % 128u == 0u) {
            one_load(size);
        } else {
            one_step(table.number[LIMIT_AT]);
        }
    }
    (void)printf("%lu calls\n", calls);
    return 0;
}
