#ifndef ICDGEN_SUPPORT_BASE_H
#define ICDGEN_SUPPORT_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/** What became of a call. */
typedef enum {
    ICD_OK = 0,
    /** The buffer does not have the length of the message; for encoding: it is smaller. */
    ICD_ERROR_LENGTH = 1,
    /** A value does not fit its field, or is not finite. */
    ICD_ERROR_RANGE = 2,
    /** The node has no message of that id. */
    ICD_ERROR_UNKNOWN_ID = 3,
    /** On the wire: the ICD does not describe this part of the protocol. */
    ICD_ERROR_UNSUPPORTED = 4,
    /** On the wire: the checksum is not that of the data. */
    ICD_ERROR_CHECKSUM = 5,
    /** On the wire: a request is going on, another one would overrun the node. */
    ICD_ERROR_BUSY = 6
} icd_status_t;

#if defined(__GNUC__) || defined(__clang__) || defined(_MSC_VER)
#define ICDGEN_RESTRICT __restrict
#elif !defined(__cplusplus)
#define ICDGEN_RESTRICT restrict
#else
#define ICDGEN_RESTRICT
#endif

#if defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__)
#define ICDGEN_INLINE static inline __attribute__((always_inline))
#else
#define ICDGEN_INLINE static inline
#endif

#ifdef __cplusplus
#define ICDGEN_CAST(type, value) static_cast<type>(value)
#else
#define ICDGEN_CAST(type, value) ((type)(value))
#endif
#define ICDGEN_U8(value) ICDGEN_CAST(uint8_t, value)
#define ICDGEN_U16(value) ICDGEN_CAST(uint16_t, value)
#define ICDGEN_U32(value) ICDGEN_CAST(uint32_t, value)
#define ICDGEN_U64(value) ICDGEN_CAST(uint64_t, value)
#define ICDGEN_SIZE(value) ICDGEN_CAST(size_t, value)
#define ICDGEN_I8(value) ICDGEN_CAST(int8_t, value)
#define ICDGEN_I16(value) ICDGEN_CAST(int16_t, value)
#define ICDGEN_I32(value) ICDGEN_CAST(int32_t, value)
#define ICDGEN_I64(value) ICDGEN_CAST(int64_t, value)

#endif /* ICDGEN_SUPPORT_BASE_H */
