#ifndef ICDGEN_WIRE_I2C_H
#define ICDGEN_WIRE_I2C_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "crc.h"

/* ---- I2C --------------------------------------------------------------------------------------------------------- */

/** The checksum of a message's data. The node has checksums. */
ICDGEN_API uint32_t icd_checksum(const icd_link_t *link, uint8_t id, const uint8_t *data, size_t length);

/** Id, data and, if asked for, the checksum of a telecommand: what is written on I2C, and framed on the UART. */
ICDGEN_API icd_status_t icd_i2c_write(
    const icd_link_t *link,
    uint8_t id,
    const uint8_t *data,
    size_t length,
    bool checked,
    uint8_t *buffer,
    size_t capacity,
    size_t *written);

/** Bytes to read for a frame. */
ICDGEN_API icd_status_t icd_i2c_read_length(const icd_link_t *link, uint8_t id, bool checked, size_t *length);

/** The bytes of the frame in what was read; ICD_ERROR_LENGTH or ICD_ERROR_CHECKSUM if it is not as it must be. */
ICDGEN_API icd_status_t icd_i2c_reply(
    const icd_link_t *link, uint8_t id, const uint8_t *bytes, size_t length, bool checked, size_t *frame_length);

#endif /* ICDGEN_WIRE_I2C_H */
