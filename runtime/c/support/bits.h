#ifndef ICDGEN_SUPPORT_BITS_H
#define ICDGEN_SUPPORT_BITS_H

#include "base.h"
#include "words.h"

/* Return the two's complement number with these bits. */
ICDGEN_INLINE int8_t icdgen_i8(uint8_t bits)
{
    int8_t value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

ICDGEN_INLINE int16_t icdgen_i16(uint16_t bits)
{
    int16_t value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

ICDGEN_INLINE int32_t icdgen_i32(uint32_t bits)
{
    int32_t value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

ICDGEN_INLINE int64_t icdgen_i64(uint64_t bits)
{
    int64_t value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

/* Sign-extend a number that has fewer bits than its type. `sign` is the mask of its highest bit. */
ICDGEN_INLINE int32_t icdgen_extend32(uint32_t bits, uint32_t sign)
{
    return ICDGEN_I32(bits ^ sign) - ICDGEN_I32(sign);
}

ICDGEN_INLINE int64_t icdgen_extend64(uint64_t bits, uint64_t sign)
{
    return ICDGEN_I64(bits ^ sign) - ICDGEN_I64(sign);
}

/* Floating-point fields are copied as bits, so that every NaN keeps its payload. */
ICDGEN_INLINE void icdgen_set_f32(float *value, uint32_t bits)
{
    (void)memcpy(value, &bits, sizeof bits);
}

ICDGEN_INLINE void icdgen_set_f64(double *value, uint64_t bits)
{
    (void)memcpy(value, &bits, sizeof bits);
}

ICDGEN_INLINE uint32_t icdgen_bits_f32(const float *value)
{
    uint32_t bits;
    (void)memcpy(&bits, value, sizeof bits);
    return bits;
}

ICDGEN_INLINE uint64_t icdgen_bits_f64(const double *value)
{
    uint64_t bits;
    (void)memcpy(&bits, value, sizeof bits);
    return bits;
}

/**
 * Return the float with these bits. Special values such as NaN are defined this way because NAN and INFINITY are
 * optional in C.
 */
static inline float icd_f32_of(uint32_t bits)
{
    float value;
    icdgen_set_f32(&value, bits);
    return value;
}

/** Return the double with these bits. */
static inline double icd_f64_of(uint64_t bits)
{
    double value;
    icdgen_set_f64(&value, bits);
    return value;
}

/**
 * Return whether a float equals a special value. Unlike with `==`, any NaN equals any other NaN. Both zeros are equal.
 */
static inline bool icd_is_special_f32(float value, float special)
{
    const uint32_t infinity = UINT32_C(0x7F800000);
    const uint32_t one = icdgen_bits_f32(&value);
    const uint32_t other = icdgen_bits_f32(&special);
    const uint32_t most = one & UINT32_C(0x7FFFFFFF);
    const uint32_t others = other & UINT32_C(0x7FFFFFFF);
    return (one == other) || ((most | others) == 0u) || ((most > infinity) && (others > infinity));
}

/**
 * Return whether a double equals a special value. Unlike with `==`, any NaN equals any other NaN. Both zeros are equal.
 */
static inline bool icd_is_special_f64(double value, double special)
{
    const uint64_t infinity = UINT64_C(0x7FF0000000000000);
    const uint64_t one = icdgen_bits_f64(&value);
    const uint64_t other = icdgen_bits_f64(&special);
    const uint64_t most = one & UINT64_C(0x7FFFFFFFFFFFFFFF);
    const uint64_t others = other & UINT64_C(0x7FFFFFFFFFFFFFFF);
    return (one == other) || ((most | others) == 0u) || ((most > infinity) && (others > infinity));
}

/*
 * Copy four or eight adjacent bools of a struct from or to adjacent bits of a byte, from bit 0 up (FALLING: down to bit
 * 0). If a bool is one byte, a single multiplication copies all of them: it places a shifted copy of the bits over each
 * byte of a word, so that bit 0 of each byte is a different bit. The inverse uses the same trick in reverse.
 */
#if ICDGEN_WORDS
#define ICDGEN_FLAGS_ARE_BYTES(type, first, last, count)                                                               \
    (sizeof(bool) == 1u && offsetof(type, last) - offsetof(type, first) == (count) - 1u)
#else
#define ICDGEN_FLAGS_ARE_BYTES(type, first, last, count) false
#endif

ICDGEN_INLINE void icdgen_spread_4(void *message, size_t offset, unsigned bits, bool falling)
{
    uint8_t *const bytes = ICDGEN_CAST(uint8_t *, message);
    const bool reversed = falling == (ICDGEN_LITTLE != 0);
    const uint32_t word = reversed ? ((bits & 0x0Fu) * 0x08040201u) >> 3 : (bits & 0x0Fu) * 0x00204081u;
    const uint32_t flags = word & 0x01010101u;
    (void)memcpy(&bytes[offset], &flags, sizeof flags);
}

ICDGEN_INLINE int icdgen_join_4(const void *message, size_t offset, bool falling)
{
    const uint8_t *const bytes = ICDGEN_CAST(const uint8_t *, message);
    const bool reversed = falling == (ICDGEN_LITTLE != 0);
    uint32_t flags;
    (void)memcpy(&flags, &bytes[offset], sizeof flags);
    return ICDGEN_CAST(int, (flags * (reversed ? 0x08040201u : 0x01020408u)) >> 24);
}

ICDGEN_INLINE void icdgen_spread_8(void *message, size_t offset, unsigned bits, bool falling)
{
#if UINTPTR_MAX > 0xFFFFFFFFu && ICDGEN_WORDS
    uint8_t *const bytes = ICDGEN_CAST(uint8_t *, message);
    const bool reversed = falling == (ICDGEN_LITTLE != 0);
    const uint64_t word = (((bits & 0xFFu) * UINT64_C(0x8040201008040201)) >> 7) & UINT64_C(0x0101010101010101);
    const uint64_t flags = reversed ? word : __builtin_bswap64(word);
    (void)memcpy(&bytes[offset], &flags, sizeof flags);
#else
    icdgen_spread_4(message, offset, falling ? bits >> 4 : bits, falling);
    icdgen_spread_4(message, offset + 4u, falling ? bits : bits >> 4, falling);
#endif
}

ICDGEN_INLINE int icdgen_join_8(const void *message, size_t offset, bool falling)
{
#if UINTPTR_MAX > 0xFFFFFFFFu && ICDGEN_WORDS
    const uint8_t *const bytes = ICDGEN_CAST(const uint8_t *, message);
    const bool reversed = falling == (ICDGEN_LITTLE != 0);
    uint64_t flags;
    (void)memcpy(&flags, &bytes[offset], sizeof flags);
    flags *= reversed ? UINT64_C(0x8040201008040201) : UINT64_C(0x0102040810204080);
    return ICDGEN_CAST(int, flags >> 56);
#else
    const int first = icdgen_join_4(message, offset, falling);
    const int second = icdgen_join_4(message, offset + 4u, falling);
    return falling ? (first << 4) | second : first | (second << 4);
#endif
}

#define ICDGEN_READ_4_FLAGS(type, message, bits, a, b, c, d)                                                           \
    do {                                                                                                               \
        if (ICDGEN_FLAGS_ARE_BYTES(type, a, d, 4u)) {                                                                  \
            icdgen_spread_4(message, offsetof(type, a), bits, false);                                                  \
        } else {                                                                                                       \
            (message)->a = ((bits) & 0x01u) != 0u;                                                                     \
            (message)->b = ((bits) & 0x02u) != 0u;                                                                     \
            (message)->c = ((bits) & 0x04u) != 0u;                                                                     \
            (message)->d = ((bits) & 0x08u) != 0u;                                                                     \
        }                                                                                                              \
    } while (false)

#define ICDGEN_JOIN_4_FLAGS(type, message, a, b, c, d)                                                                 \
    (ICDGEN_FLAGS_ARE_BYTES(type, a, d, 4u)                                                                            \
         ? icdgen_join_4(message, offsetof(type, a), false)                                                            \
         : ((message)->a | ((message)->b << 1) | ((message)->c << 2) | ((message)->d << 3)))

#define ICDGEN_READ_4_FLAGS_FALLING(type, message, bits, a, b, c, d)                                                   \
    do {                                                                                                               \
        if (ICDGEN_FLAGS_ARE_BYTES(type, a, d, 4u)) {                                                                  \
            icdgen_spread_4(message, offsetof(type, a), bits, true);                                                   \
        } else {                                                                                                       \
            (message)->a = ((bits) & 0x08u) != 0u;                                                                     \
            (message)->b = ((bits) & 0x04u) != 0u;                                                                     \
            (message)->c = ((bits) & 0x02u) != 0u;                                                                     \
            (message)->d = ((bits) & 0x01u) != 0u;                                                                     \
        }                                                                                                              \
    } while (false)

#define ICDGEN_JOIN_4_FLAGS_FALLING(type, message, a, b, c, d)                                                         \
    (ICDGEN_FLAGS_ARE_BYTES(type, a, d, 4u)                                                                            \
         ? icdgen_join_4(message, offsetof(type, a), true)                                                             \
         : (((message)->a << 3) | ((message)->b << 2) | ((message)->c << 1) | (message)->d))

#define ICDGEN_READ_8_FLAGS(type, message, bits, a, b, c, d, e, f, g, h)                                               \
    do {                                                                                                               \
        if (ICDGEN_FLAGS_ARE_BYTES(type, a, h, 8u)) {                                                                  \
            icdgen_spread_8(message, offsetof(type, a), bits, false);                                                  \
        } else {                                                                                                       \
            (message)->a = ((bits) & 0x01u) != 0u;                                                                     \
            (message)->b = ((bits) & 0x02u) != 0u;                                                                     \
            (message)->c = ((bits) & 0x04u) != 0u;                                                                     \
            (message)->d = ((bits) & 0x08u) != 0u;                                                                     \
            (message)->e = ((bits) & 0x10u) != 0u;                                                                     \
            (message)->f = ((bits) & 0x20u) != 0u;                                                                     \
            (message)->g = ((bits) & 0x40u) != 0u;                                                                     \
            (message)->h = ((bits) & 0x80u) != 0u;                                                                     \
        }                                                                                                              \
    } while (false)

#define ICDGEN_JOIN_8_FLAGS(type, message, a, b, c, d, e, f, g, h)                                                     \
    ICDGEN_U8(                                                                                                         \
        ICDGEN_FLAGS_ARE_BYTES(type, a, h, 8u)                                                                         \
            ? icdgen_join_8(message, offsetof(type, a), false)                                                         \
            : ((message)->a | ((message)->b << 1) | ((message)->c << 2) | ((message)->d << 3) | ((message)->e << 4) |  \
               ((message)->f << 5) | ((message)->g << 6) | ((message)->h << 7)))

#define ICDGEN_READ_8_FLAGS_FALLING(type, message, bits, a, b, c, d, e, f, g, h)                                       \
    do {                                                                                                               \
        if (ICDGEN_FLAGS_ARE_BYTES(type, a, h, 8u)) {                                                                  \
            icdgen_spread_8(message, offsetof(type, a), bits, true);                                                   \
        } else {                                                                                                       \
            (message)->a = ((bits) & 0x80u) != 0u;                                                                     \
            (message)->b = ((bits) & 0x40u) != 0u;                                                                     \
            (message)->c = ((bits) & 0x20u) != 0u;                                                                     \
            (message)->d = ((bits) & 0x10u) != 0u;                                                                     \
            (message)->e = ((bits) & 0x08u) != 0u;                                                                     \
            (message)->f = ((bits) & 0x04u) != 0u;                                                                     \
            (message)->g = ((bits) & 0x02u) != 0u;                                                                     \
            (message)->h = ((bits) & 0x01u) != 0u;                                                                     \
        }                                                                                                              \
    } while (false)

#define ICDGEN_JOIN_8_FLAGS_FALLING(type, message, a, b, c, d, e, f, g, h)                                             \
    ICDGEN_U8(                                                                                                         \
        ICDGEN_FLAGS_ARE_BYTES(type, a, h, 8u)                                                                         \
            ? icdgen_join_8(message, offsetof(type, a), true)                                                          \
            : (((message)->a << 7) | ((message)->b << 6) | ((message)->c << 5) | ((message)->d << 4) |                 \
               ((message)->e << 3) | ((message)->f << 2) | ((message)->g << 1) | (message)->h))

#endif /* ICDGEN_SUPPORT_BITS_H */
