/*
 * What a control law needs around it and is no law: the table's loader, the encoder, the look-up, the limits.
 * C99, written by hand; no memory but the caller's, no library, no allocation, no recursion. No licence is claimed on it.
 *
 * A table is one block of bytes, little-endian; workbench/firmware/image.py lists it field by field. wb_check() refuses one
 * that is damaged or was made for something else, and says why by a code of its own.
 */
#ifndef WB_RUNTIME_H
#define WB_RUNTIME_H

#include <stddef.h>
#include <stdint.h>

#if defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0
#error "float has to be computed as float: build for hardware floating point (on x86: -mfpmath=sse)"
#endif

enum wb_refusal {
    WB_ACCEPTED = 0,
    WB_TRUNCATED = 1,  /* fewer bytes than the table says, or than any table has */
    WB_MAGIC = 2,      /* not a table */
    WB_ENDIAN = 3,     /* written in another byte order */
    WB_VERSION = 4,    /* of a format that is not this one */
    WB_LENGTH = 5,     /* more bytes than the table says, or than its fields come to */
    WB_DAMAGED = 6,    /* the CRC-32 is wrong */
    WB_ARITHMETIC = 7, /* for the other arithmetic */
    WB_LAW = 8,        /* for another law, or for other scales of it */
    WB_PLANT = 9,      /* tuned on another plant */
    WB_SHAPE = 10,     /* more knots than there is memory for, or not as many numbers as the law has */
    WB_PERIOD = 11,    /* for another sample time */
    WB_KNOTS = 12,     /* the knots do not lie at 2^e (1 + j/m) */
    WB_NUMBER = 13,    /* a number is not finite */
    WB_FIELD = 14      /* a field of the head is out of its range */
};

enum { WB_FLOAT32 = 1, WB_FIXED = 2, WB_DIGEST = 32, WB_FINEST = 12 };

/* What a firmware takes. plant: the digest's 32 bytes, or NULL for any plant. period: s, or 0 for any. */
typedef struct {
    uint32_t arithmetic;
    uint32_t law;
    uint32_t numbers;
    uint32_t rows;
    uint32_t most_knots;
    float period;
    const uint8_t *plant;
} wb_wanted;

/* The head of a table that was accepted. */
typedef struct {
    float sample_time;  /* [s] */
    float count;        /* one encoder count [rad or m] */
    float limit;        /* largest command [N*m or N] */
    float first_knot;   /* [rad or m, or rad/s or m/s] */
    float last_knot;
    uint32_t knots;     /* how many; 0 for a law without a table of gains */
    uint32_t shift;     /* bits of a float below its segment */
    uint32_t first;     /* the first knot's bits >> shift */
    uint32_t encoder_mask; /* 2^bits - 1 */
    uint32_t jump;      /* largest plausible way between two samples [count] */
    uint32_t verdict;   /* 0: not judged, 1: requirements met, 2: not met */
    uint32_t numbers_at;/* where numbers, knots and rows begin [byte] */
    uint32_t knots_at;
    uint32_t rows_at;
} wb_head;

/* An encoder that may wrap. position: counts from an origin, which moves along. */
typedef struct {
    uint32_t raw;
    uint32_t origin;
    int32_t position;
    uint32_t fault; /* 1 after a jump: the command is zero until the next start */
} wb_encoder;

enum {
    WB_FAR = 4194304,   /* 2^22 counts from the origin it is moved, so that float32 holds every count (to 2^24) */
    WB_END = 1073741824 /* 2^30 counts from an origin that is not moved, the axis stops */
};

uint32_t wb_crc32(const uint8_t *bytes, size_t size);
enum wb_refusal wb_check(const uint8_t *bytes, size_t size, const wb_wanted *wanted, wb_head *head);
void wb_encoder_start(wb_encoder *encoder, uint32_t raw, uint32_t origin);
int wb_encoder_follow(wb_encoder *encoder, const wb_head *head, uint32_t raw);
int32_t wb_encoder_recentre(wb_encoder *encoder);
int32_t wb_signed(uint32_t word);

static inline uint32_t wb_u32(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] | ((uint32_t)bytes[1] << 8) | ((uint32_t)bytes[2] << 16) | ((uint32_t)bytes[3] << 24);
}

typedef union {
    uint32_t bits;
    float real;
} wb_word;

static inline float wb_real(uint32_t bits)
{
    wb_word word;
    word.bits = bits;
    return word.real;
}

static inline uint32_t wb_bits(float real)
{
    wb_word word;
    word.real = real;
    return word.bits;
}

/* A NaN operand is ignored, and of equal operands the first is returned. */
static inline float wb_minf(float a, float b)
{
    return ((a <= b) || (b != b)) ? a : b;
}

static inline float wb_maxf(float a, float b)
{
    return ((a >= b) || (b != b)) ? a : b;
}

static inline float wb_absf(float a)
{
    return wb_real(wb_bits(a) & 0x7FFFFFFFu);
}

/* What came from outside, within +-limit; a NaN is nothing. */
static inline float wb_boundedf(float a, float limit)
{
    return (a != a) ? 0.0f : wb_minf(wb_maxf(a, -limit), limit);
}

float wb_sqrtf(float a);

/*
 * The segment i of an amplitude on knots at 2^e (1 + j/m), and how far beyond knot i it lies. The leading bits of a
 * float count such knots. Below the first knot (and for a NaN) gains are those of the first, from the last on of the last.
 */
static inline uint32_t wb_segment(const wb_head *head, const float *knots, float amplitude, float *beyond)
{
    uint32_t i;
    *beyond = 0.0f;
    if (!(amplitude > head->first_knot)) {
        return 0u;
    }
    if (!(amplitude < head->last_knot)) {
        return head->knots - 1u;
    }
    i = (wb_bits(amplitude) >> head->shift) - head->first;
    *beyond = amplitude - knots[i];
    return i;
}

#endif
