#ifndef ICDGEN_SUPPORT_BASE_H
#define ICDGEN_SUPPORT_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/** Result of a function. ICD_OK is 0; all other values are errors. */
typedef enum {
    ICD_OK = 0,
    /** Length mismatch: data of the wrong length, or an output buffer that is too small. */
    ICD_ERROR_LENGTH = 1,
    /** Value out of range of its field, or not finite. */
    ICD_ERROR_RANGE = 2,
    /** The ICD has no message with this id. */
    ICD_ERROR_UNKNOWN_ID = 3,
    /** Wire layer only: the ICD does not describe this part of the protocol. */
    ICD_ERROR_UNSUPPORTED = 4,
    /** Wire layer only: checksum mismatch. */
    ICD_ERROR_CHECKSUM = 5,
    /** Wire layer only: another request is in progress. */
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
