#ifndef ICDGEN_SUPPORT_WORDS_H
#define ICDGEN_SUPPORT_WORDS_H

#include "base.h"

/*
 * Words are loaded and stored directly if the processor supports unaligned access, and swapped if its byte order
 * differs. On other processors they are assembled byte by byte.
 */
#if !defined(ICDGEN_PORTABLE) && defined(__GNUC__) && defined(__BYTE_ORDER__) &&                                       \
    (defined(__x86_64__) || defined(__i386__) || defined(__aarch64__) || defined(__ARM_FEATURE_UNALIGNED) ||           \
     defined(__powerpc64__) || defined(__s390x__) || defined(__wasm__))
#define ICDGEN_WORDS 1
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
#define ICDGEN_LITTLE 1
#else
#define ICDGEN_LITTLE 0
#endif
#else
#define ICDGEN_WORDS 0
#define ICDGEN_LITTLE 0
#endif

#if ICDGEN_WORDS
#if ICDGEN_LITTLE
#define ICDGEN_FOR_LE(bits, value) (value)
#define ICDGEN_FOR_BE(bits, value) __builtin_bswap##bits(value)
#else
#define ICDGEN_FOR_LE(bits, value) __builtin_bswap##bits(value)
#define ICDGEN_FOR_BE(bits, value) (value)
#endif
#endif

ICDGEN_INLINE uint16_t icdgen_load_u16le(const uint8_t *bytes)
{
#if ICDGEN_WORDS
    uint16_t word;
    (void)memcpy(&word, bytes, sizeof word);
    return ICDGEN_FOR_LE(16, word);
#else
    return ICDGEN_U16(bytes[0] | (ICDGEN_U32(bytes[1]) << 8));
#endif
}

ICDGEN_INLINE void icdgen_store_u16le(uint8_t *bytes, uint16_t value)
{
#if ICDGEN_WORDS
    const uint16_t word = ICDGEN_FOR_LE(16, value);
    (void)memcpy(bytes, &word, sizeof word);
#else
    bytes[0] = ICDGEN_U8(value);
    bytes[1] = ICDGEN_U8(value >> 8);
#endif
}

ICDGEN_INLINE uint32_t icdgen_load_u32le(const uint8_t *bytes)
{
#if ICDGEN_WORDS
    uint32_t word;
    (void)memcpy(&word, bytes, sizeof word);
    return ICDGEN_FOR_LE(32, word);
#else
    const uint32_t low = icdgen_load_u16le(&bytes[0]);
    const uint32_t high = icdgen_load_u16le(&bytes[2]);
    return low | (high << 16);
#endif
}

ICDGEN_INLINE void icdgen_store_u32le(uint8_t *bytes, uint32_t value)
{
#if ICDGEN_WORDS
    const uint32_t word = ICDGEN_FOR_LE(32, value);
    (void)memcpy(bytes, &word, sizeof word);
#else
    icdgen_store_u16le(&bytes[0], ICDGEN_U16(value));
    icdgen_store_u16le(&bytes[2], ICDGEN_U16(value >> 16));
#endif
}

ICDGEN_INLINE uint64_t icdgen_load_u64le(const uint8_t *bytes)
{
#if ICDGEN_WORDS
    uint64_t word;
    (void)memcpy(&word, bytes, sizeof word);
    return ICDGEN_FOR_LE(64, word);
#else
    const uint64_t low = icdgen_load_u32le(&bytes[0]);
    const uint64_t high = icdgen_load_u32le(&bytes[4]);
    return low | (high << 32);
#endif
}

ICDGEN_INLINE void icdgen_store_u64le(uint8_t *bytes, uint64_t value)
{
#if ICDGEN_WORDS
    const uint64_t word = ICDGEN_FOR_LE(64, value);
    (void)memcpy(bytes, &word, sizeof word);
#else
    icdgen_store_u32le(&bytes[0], ICDGEN_U32(value));
    icdgen_store_u32le(&bytes[4], ICDGEN_U32(value >> 32));
#endif
}

ICDGEN_INLINE uint16_t icdgen_load_u16be(const uint8_t *bytes)
{
#if ICDGEN_WORDS
    uint16_t word;
    (void)memcpy(&word, bytes, sizeof word);
    return ICDGEN_FOR_BE(16, word);
#else
    return ICDGEN_U16(bytes[1] | (ICDGEN_U32(bytes[0]) << 8));
#endif
}

ICDGEN_INLINE void icdgen_store_u16be(uint8_t *bytes, uint16_t value)
{
#if ICDGEN_WORDS
    const uint16_t word = ICDGEN_FOR_BE(16, value);
    (void)memcpy(bytes, &word, sizeof word);
#else
    bytes[1] = ICDGEN_U8(value);
    bytes[0] = ICDGEN_U8(value >> 8);
#endif
}

ICDGEN_INLINE uint32_t icdgen_load_u32be(const uint8_t *bytes)
{
#if ICDGEN_WORDS
    uint32_t word;
    (void)memcpy(&word, bytes, sizeof word);
    return ICDGEN_FOR_BE(32, word);
#else
    const uint32_t low = icdgen_load_u16be(&bytes[2]);
    const uint32_t high = icdgen_load_u16be(&bytes[0]);
    return low | (high << 16);
#endif
}

ICDGEN_INLINE void icdgen_store_u32be(uint8_t *bytes, uint32_t value)
{
#if ICDGEN_WORDS
    const uint32_t word = ICDGEN_FOR_BE(32, value);
    (void)memcpy(bytes, &word, sizeof word);
#else
    icdgen_store_u16be(&bytes[2], ICDGEN_U16(value));
    icdgen_store_u16be(&bytes[0], ICDGEN_U16(value >> 16));
#endif
}

ICDGEN_INLINE uint64_t icdgen_load_u64be(const uint8_t *bytes)
{
#if ICDGEN_WORDS
    uint64_t word;
    (void)memcpy(&word, bytes, sizeof word);
    return ICDGEN_FOR_BE(64, word);
#else
    const uint64_t low = icdgen_load_u32be(&bytes[4]);
    const uint64_t high = icdgen_load_u32be(&bytes[0]);
    return low | (high << 32);
#endif
}

ICDGEN_INLINE void icdgen_store_u64be(uint8_t *bytes, uint64_t value)
{
#if ICDGEN_WORDS
    const uint64_t word = ICDGEN_FOR_BE(64, value);
    (void)memcpy(bytes, &word, sizeof word);
#else
    icdgen_store_u32be(&bytes[4], ICDGEN_U32(value));
    icdgen_store_u32be(&bytes[0], ICDGEN_U32(value >> 32));
#endif
}

#endif /* ICDGEN_SUPPORT_WORDS_H */
