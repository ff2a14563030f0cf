#ifndef ICDGEN_WIRE_CRC_H
#define ICDGEN_WIRE_CRC_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"

/* ---- CRCs -------------------------------------------------------------------------------------------------------- */

/** State of a CRC that is computed piece by piece. */
typedef struct {
    const icd_crc_form_t *form;
    uint32_t value;
    bool fed;
} icd_crc_t;

ICDGEN_API void icd_crc_init(icd_crc_t *crc, const icd_crc_form_t *form);

ICDGEN_API void icd_crc_feed(icd_crc_t *crc, const uint8_t *bytes, size_t length);

/** Return the CRC of all bytes fed so far. */
ICDGEN_API uint32_t icd_crc_result(const icd_crc_t *crc);

ICDGEN_API uint32_t icd_crc(const icd_crc_form_t *form, const uint8_t *bytes, size_t length);

#endif /* ICDGEN_WIRE_CRC_H */
