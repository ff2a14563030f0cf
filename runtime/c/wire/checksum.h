#ifndef ICDGEN_WIRE_CHECKSUM_H
#define ICDGEN_WIRE_CHECKSUM_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "kinds.h"
#include "crc.h"

/* ---- checksums of all kinds -------------------------------------------------------------------------------------- */

/**
 * Compute a checksum. The function NODE_NAME_checksum() of a node returns the algorithm of its checksum NAME. `bytes`
 * end with the seed of the message if the checksum has `seeds`.
 */
ICDGEN_API uint32_t icd_checksum(const icd_checksum_algorithm_t *algorithm, const uint8_t *bytes, size_t length);

/*
 * Whether a value of an enumeration is this member. `kinds` are the members that the links have, as a mask: the
 * compiler knows the result for all others, and also if there is only one.
 */
#define ICDGEN_IS(value, member, kinds)                                                                                \
    (((kinds) & ICDGEN_BIT(member)) != 0u && ((kinds) == ICDGEN_BIT(member) || (value) == (member)))
#define ICDGEN_IS_CHECK(algorithm, member) ICDGEN_IS((algorithm)->kind, member, ICDGEN_CHECKS)

/* State of a checksum that is computed piece by piece. */
typedef struct {
    const icd_checksum_algorithm_t *algorithm;
    icd_crc_t crc;
    uint32_t first;
    uint32_t second;
} icdgen_check_t;

static inline bool icdgen_is_pair(const icd_checksum_algorithm_t *algorithm)
{
    return ICDGEN_IS_CHECK(algorithm, ICD_CHECK_FLETCHER) || ICDGEN_IS_CHECK(algorithm, ICD_CHECK_FLETCHER_255);
}

static inline void icdgen_check_begin(icdgen_check_t *check, const icd_checksum_algorithm_t *algorithm)
{
    check->algorithm = algorithm;
    if (ICDGEN_IS_CHECK(algorithm, ICD_CHECK_CRC)) {
        icd_crc_init(&check->crc, &algorithm->crc);
    } else {
        check->first = icdgen_is_pair(algorithm) ? algorithm->crc.init & 0xFFu : algorithm->crc.init;
        check->second = algorithm->crc.init >> 8;
    }
}

static inline void icdgen_check_feed(icdgen_check_t *check, const uint8_t *bytes, size_t length)
{
    const icd_checksum_algorithm_t *const algorithm = check->algorithm;
    const uint32_t modulus = ICDGEN_IS_CHECK(algorithm, ICD_CHECK_FLETCHER_255) ? 255u : 256u;
    if (ICDGEN_IS_CHECK(algorithm, ICD_CHECK_CRC)) {
        icd_crc_feed(&check->crc, bytes, length);
        return;
    }
    for (size_t i = 0; i < length; ++i) {
        if (ICDGEN_IS_CHECK(algorithm, ICD_CHECK_SUM)) {
            check->first += bytes[i];
        } else if (ICDGEN_IS_CHECK(algorithm, ICD_CHECK_XOR)) {
            check->first ^= bytes[i];
        } else {
            check->first = (check->first + bytes[i]) % modulus;
            check->second = (check->second + check->first) % modulus;
        }
    }
}

static inline uint32_t icdgen_check_result(const icdgen_check_t *check)
{
    const icd_crc_form_t *const form = &check->algorithm->crc;
    if (ICDGEN_IS_CHECK(check->algorithm, ICD_CHECK_CRC)) {
        return icd_crc_result(&check->crc);
    }
    const uint32_t value = icdgen_is_pair(check->algorithm)
        ? (check->second << 8) | check->first
        : check->first & (UINT32_C(0xFFFFFFFF) >> (32u - form->width));
    return value ^ form->xor_out;
}

#endif /* ICDGEN_WIRE_CHECKSUM_H */
