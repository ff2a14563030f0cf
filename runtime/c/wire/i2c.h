#ifndef ICDGEN_WIRE_I2C_H
#define ICDGEN_WIRE_I2C_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "checksum.h"

/* ---- I2C --------------------------------------------------------------------------------------------------------- */

/** Compute the checksum of the data of a message. The link must describe checksums. */
ICDGEN_API uint32_t icd_message_checksum(const icd_link_t *link, uint8_t id, const uint8_t *data, size_t length);

/** Encode a telecommand: id, data and, if `checked`, the checksum. I2C writes these bytes; the UART frames them. */
ICDGEN_API icd_status_t icd_i2c_write(
    const icd_link_t *link,
    uint8_t id,
    const uint8_t *data,
    size_t length,
    bool checked,
    uint8_t *buffer,
    size_t capacity,
    size_t *written);

/** Get the number of bytes to read for a frame. */
ICDGEN_API icd_status_t icd_i2c_read_length(const icd_link_t *link, uint8_t id, bool checked, size_t *length);

/**
 * Check the bytes that were read and get the length of the frame at their beginning. Return ICD_ERROR_LENGTH or
 * ICD_ERROR_CHECKSUM if the reply is not valid.
 */
ICDGEN_API icd_status_t icd_i2c_reply(
    const icd_link_t *link, uint8_t id, const uint8_t *bytes, size_t length, bool checked, size_t *frame_length);

#endif /* ICDGEN_WIRE_I2C_H */
