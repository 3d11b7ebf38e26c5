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

enum { WB_FLOAT32 = 1, WB_FIXED = 2, WB_DIGEST = 32, WB_FINEST = 11 };

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
    uint32_t knots;     /* how many; 0 for a law without a table of gains */
    uint32_t last;      /* the last one's number */
    uint32_t shift;     /* bits of a float below its segment */
    uint32_t first;     /* the first knot's bits >> shift */
    uint32_t encoder_shift; /* bits of a word that the encoder does not fill */
    uint32_t jump;      /* largest plausible way between two samples [count] */
    uint32_t verdict;   /* 0: not judged, 1: requirements met, 2: not met; of the trace 4: a cause, 8: nothing missing, 12: unknown */
    uint32_t numbers_at;/* where numbers, knots and rows begin [byte] */
    uint32_t knots_at;
    uint32_t rows_at;
} wb_head;

/* An encoder that may wrap. position: counts from an origin, which moves along; origin + position is the latest reading. */
typedef struct {
    uint32_t origin;
    int32_t position;
    uint32_t jump;   /* the way between two samples, lifted by so much, has to stay below */
    uint32_t below;  /* this; 0 after a jump, so that the command is zero until the next start */
} wb_encoder;

#define WB_FAR 4194304u    /* more than 2^22 counts away the origin is moved, so that float32 holds every count (to 2^24) */
#define WB_END 1073741824u /* more than 2^30 counts from an origin that is not moved, the axis stops */
#define WB_REACH 16777216u /* in fixed point more than 2^24, so that every position fits with fractions of a count */

uint32_t wb_crc32(const uint8_t *bytes, size_t size);
enum wb_refusal wb_check(const uint8_t *bytes, size_t size, const wb_wanted *wanted, wb_head *head);
/* Shifts of negative numbers to the right keep the sign; a compiler that does otherwise does not get past this line. */
typedef char wb_shifts_keep_the_sign[(((int32_t)-3 >> 1) == -2) ? 1 : -1];

static inline uint32_t wb_u32(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] | ((uint32_t)bytes[1] << 8) | ((uint32_t)bytes[2] << 16) | ((uint32_t)bytes[3] << 24);
}

/* What hangs on its arguments alone: called once where a law asks twice. */
#if defined(__GNUC__)
#define WB_CONST __attribute__((const))
#else
#define WB_CONST
#endif

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

/* How many zeros lead; word is not 0. */
static inline uint32_t wb_leading(uint32_t word)
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

/* The word as two's complement, without leaving it to the compiler: one move, or none. */
static inline int32_t wb_signed(uint32_t word)
{
    return (word <= 0x7FFFFFFFu) ? (int32_t)word : -(int32_t)(~word) - 1;
}

static inline void wb_encoder_start(wb_encoder *encoder, const wb_head *head, uint32_t raw, uint32_t origin)
{
    encoder->origin = origin;
    encoder->position = wb_signed(raw - origin);
    encoder->jump = head->jump;
    encoder->below = 2u * head->jump + 1u;
}

/* Take a new reading, the short way round where the encoder wraps. Return 0 after a jump, and until the next start. */
static inline int wb_encoder_follow(wb_encoder *encoder, const wb_head *head, uint32_t raw, int32_t *way)
{
    const uint32_t from = raw - encoder->origin - (uint32_t)encoder->position;
    *way = wb_signed(from << head->encoder_shift) >> head->encoder_shift;
    if ((uint32_t)*way + encoder->jump >= encoder->below) {
        encoder->below = 0u;
        return 0;
    }
    encoder->position += *way;
    return 1;
}

/* Stop further than `most` from an origin that is not moved. Return 0 then. */
static inline int wb_encoder_within(wb_encoder *encoder, uint32_t most)
{
    if ((uint32_t)encoder->position + most > 2u * most) {
        encoder->below = 0u;
        return 0;
    }
    return 1;
}

/* Move the origin to where the axis is, once that is far: return 1 then, and every position has to be lowered by this one. */
static inline int wb_encoder_recentre(wb_encoder *encoder)
{
    const int32_t by = encoder->position;
    if ((uint32_t)by + WB_FAR <= 2u * WB_FAR) {
        return 0;
    }
    encoder->origin += (uint32_t)by;
    encoder->position = 0;
    return 1;
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
#if defined(__GNUC__)
    return __builtin_fabsf(a); /* one instruction, or two; never a call */
#else
    return wb_real(wb_bits(a) & 0x7FFFFFFFu);
#endif
}

/* The same where the second operand is a number for certain: a literal, or one of the table, which was checked. */
static inline float wb_lowf(float a, float known)
{
    return (a <= known) ? a : known;
}

static inline float wb_highf(float a, float known)
{
    return (a >= known) ? a : known;
}

/* 1, 0 or -1; 0 for a NaN. */
static inline float wb_signf(float a)
{
    return (a > 0.0f) ? 1.0f : ((a < 0.0f) ? -1.0f : 0.0f);
}

/* What came from outside; a NaN is nothing. */
static inline float wb_givenf(float a)
{
    return (a == a) ? a : 0.0f;
}

/* The root of a word that is not 0, downwards. */
WB_CONST uint32_t wb_root64(uint64_t word);

WB_CONST float wb_sqrtf(float a);

/*
 * The segment i of an amplitude on knots at 2^e (1 + j/m), and whether it lies beyond knot i within the table. The leading bits of a
 * float count such knots. Below the first knot gains are those of the first, from the last on of the last. Amplitudes are not negative.
 */
static inline uint32_t wb_segment(const wb_head *head, float amplitude, int *within)
{
    const uint32_t i = (wb_bits(amplitude) >> head->shift) - head->first;
    *within = i < head->last;
    if (*within) {
        return i;
    }
    return (i > 0x7FFFFFFFu) ? 0u : head->last;
}

#endif
