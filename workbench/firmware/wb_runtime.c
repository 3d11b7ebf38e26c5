/* See wb_runtime.h. Written by hand; no licence is claimed on it. */
#include "wb_runtime.h"

enum {
    AT_ORDER = 8,
    AT_VERSION = 12,
    AT_LENGTH = 16,
    AT_ARITHMETIC = 20,
    AT_LAW = 24,
    AT_NUMBERS = 28,
    AT_ROWS = 32,
    AT_KNOTS = 36,
    AT_PER_OCTAVE = 40,
    AT_PERIOD = 44,
    AT_COUNT = 48,
    AT_LIMIT = 52,
    AT_BITS = 56,
    AT_JUMP = 60,
    AT_VERDICT = 64,
    AT_PLANT = 72,
    HEAD = 104,
    SMALLEST = 108,
    VERSION = 1
};

#define ORDER 0x01020304u

static const uint8_t magic[8] = {'W', 'B', 'T', 'A', 'B', 'L', 'E', 0};

/* CRC-32 of IEEE 802.3: reflected, polynomial 0xEDB88320; "123456789" gives 0xCBF43926. */
uint32_t wb_crc32(const uint8_t *bytes, size_t size)
{
    uint32_t crc = 0xFFFFFFFFu;
    size_t i;
    for (i = 0u; i < size; ++i) {
        int bit;
        crc ^= bytes[i];
        for (bit = 0; bit < 8; ++bit) {
            crc = (crc >> 1) ^ (0xEDB88320u & (0u - (crc & 1u)));
        }
    }
    return ~crc;
}

static int same(const uint8_t *a, const uint8_t *b, size_t size)
{
    uint32_t differs = 0u;
    size_t i;
    for (i = 0u; i < size; ++i) {
        differs |= (uint32_t)a[i] ^ (uint32_t)b[i];
    }
    return differs == 0u;
}

static int finite(uint32_t bits)
{
    return (bits & 0x7F800000u) != 0x7F800000u;
}

static int positive(float x) /* and finite */
{
    return (x > 0.0f) && finite(wb_bits(x));
}

/* What says that the bytes are a whole table, of whatever law. */
static enum wb_refusal whole(const uint8_t *bytes, size_t size)
{
    uint32_t length;
    if (size < (size_t)SMALLEST) {
        return WB_TRUNCATED;
    }
    if (!same(bytes, magic, sizeof magic)) {
        return WB_MAGIC;
    }
    if (wb_u32(bytes + AT_ORDER) != ORDER) {
        return WB_ENDIAN;
    }
    if (wb_u32(bytes + AT_VERSION) != (uint32_t)VERSION) {
        return WB_VERSION;
    }
    length = wb_u32(bytes + AT_LENGTH);
    if (length > size) {
        return WB_TRUNCATED;
    }
    if (length < size) {
        return WB_LENGTH;
    }
    return (wb_crc32(bytes, size - 4u) == wb_u32(bytes + size - 4u)) ? WB_ACCEPTED : WB_DAMAGED;
}

/* What says that a whole table was made for this firmware, and has the size that its fields come to. */
static enum wb_refusal meant(const uint8_t *bytes, size_t size, const wb_wanted *wanted)
{
    const uint32_t numbers = wb_u32(bytes + AT_NUMBERS);
    const uint32_t rows = wb_u32(bytes + AT_ROWS);
    const uint32_t knots = wb_u32(bytes + AT_KNOTS);
    if (wb_u32(bytes + AT_ARITHMETIC) != wanted->arithmetic) {
        return WB_ARITHMETIC;
    }
    if (wb_u32(bytes + AT_LAW) != wanted->law) {
        return WB_LAW;
    }
    if ((wanted->plant != NULL) && !same(bytes + AT_PLANT, wanted->plant, (size_t)WB_DIGEST)) {
        return WB_PLANT;
    }
    if ((numbers != wanted->numbers) || (rows != wanted->rows) || (knots > wanted->most_knots)
        || ((knots == 0u) != (rows == 0u))) {
        return WB_SHAPE;
    }
    return (size == (size_t)SMALLEST + 4u * ((size_t)numbers + (size_t)knots * (1u + (size_t)rows))) ? WB_ACCEPTED
                                                                                                    : WB_LENGTH;
}

/* Read the fields of the head. */
static enum wb_refusal fields(const uint8_t *bytes, const wb_wanted *wanted, wb_head *head)
{
    const uint32_t bits = wb_u32(bytes + AT_BITS);
    head->sample_time = wb_real(wb_u32(bytes + AT_PERIOD));
    head->count = wb_real(wb_u32(bytes + AT_COUNT));
    head->limit = wb_real(wb_u32(bytes + AT_LIMIT));
    head->jump = wb_u32(bytes + AT_JUMP);
    head->verdict = wb_u32(bytes + AT_VERDICT);
    head->knots = wb_u32(bytes + AT_KNOTS);
    head->numbers_at = (uint32_t)HEAD;
    head->knots_at = head->numbers_at + 4u * wb_u32(bytes + AT_NUMBERS);
    head->rows_at = head->knots_at + 4u * head->knots;
    if ((bits < 2u) || (bits > 32u) || (head->jump > WB_FAR) || (head->verdict > 15u) || ((head->verdict & 3u) == 3u)) {
        return WB_FIELD;
    }
    if (!positive(head->sample_time) || !positive(head->count) || !positive(head->limit)) {
        return WB_FIELD;
    }
    head->encoder_shift = 32u - bits;
    return ((wanted->period > 0.0f) && (head->sample_time != wanted->period)) ? WB_PERIOD : WB_ACCEPTED;
}

/* Check that the knots lie at 2^e (1 + j/m), one after the other, and keep what the look-up needs of them. */
static enum wb_refusal grid(const uint8_t *bytes, wb_head *head)
{
    const uint32_t per_octave = wb_u32(bytes + AT_PER_OCTAVE);
    uint32_t step = 0u;
    uint32_t i;
    head->shift = 0u;
    head->first = 0u;
    head->last = 0u;
    if (head->knots == 0u) {
        return WB_ACCEPTED;
    }
    while ((step <= (uint32_t)WB_FINEST) && (per_octave != ((uint32_t)1u << step))) {
        ++step;
    }
    if (step > (uint32_t)WB_FINEST) {
        return WB_KNOTS;
    }
    head->shift = 23u - step;
    head->first = wb_u32(bytes + head->knots_at) >> head->shift;
    for (i = 0u; i < head->knots; ++i) {
        const uint32_t knot = wb_u32(bytes + head->knots_at + 4u * i);
        if ((knot != ((head->first + i) << head->shift)) || !positive(wb_real(knot))) {
            return WB_KNOTS;
        }
    }
    head->last = head->knots - 1u;
    return WB_ACCEPTED;
}

static enum wb_refusal numbers(const uint8_t *bytes, const wb_head *head, uint32_t end)
{
    uint32_t at;
    for (at = head->numbers_at; at < end; at += 4u) {
        if (!finite(wb_u32(bytes + at))) {
            return WB_NUMBER;
        }
    }
    return WB_ACCEPTED;
}

/* Say whether `bytes` may be used; fill in `head` where it may. Every byte is checked before one is used. */
enum wb_refusal wb_check(const uint8_t *bytes, size_t size, const wb_wanted *wanted, wb_head *head)
{
    enum wb_refusal refused = whole(bytes, size);
    if (refused == WB_ACCEPTED) {
        refused = meant(bytes, size, wanted);
    }
    if (refused == WB_ACCEPTED) {
        refused = fields(bytes, wanted, head);
    }
    if (refused == WB_ACCEPTED) {
        refused = grid(bytes, head);
    }
    if ((refused == WB_ACCEPTED) && (wanted->arithmetic == (uint32_t)WB_FLOAT32)) {
        refused = numbers(bytes, head, (uint32_t)size - 4u);
    }
    return refused;
}
