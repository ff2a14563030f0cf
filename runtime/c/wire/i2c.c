#ifndef ICDGEN_WIRE_I2C_C
#define ICDGEN_WIRE_I2C_C

#include "i2c.h"
#include "link.c"

ICDGEN_API uint32_t icd_message_checksum(const icd_link_t *link, uint8_t id, const uint8_t *data, size_t length)
{
    icdgen_check_t check;
    icdgen_check_begin(&check, link->checksum->algorithm);
    if (link->checksum->covers_id) {
        icdgen_check_feed(&check, &id, 1);
    }
    icdgen_check_feed(&check, data, length);
    return icdgen_check_result(&check);
}

/* Write id, data and checksum of a message. Return ICD_ERROR_RANGE if the checksum does not fit. */
static inline icd_status_t icdgen_put_message(
    const icd_link_t *link, uint8_t id, const uint8_t *data, size_t length, bool checked, uint8_t *buffer)
{
    uint8_t *const rest = buffer + 1;
    buffer[0] = id;
    if (length != 0u) {
        (void)memcpy(rest, data, length);
    }
    if (!checked) {
        return ICD_OK;
    }
    return icdgen_put_number(link, rest + length, link->checksum->bytes, icd_message_checksum(link, id, rest, length));
}

ICDGEN_API icd_status_t icd_i2c_write(
    const icd_link_t *link,
    uint8_t id,
    const uint8_t *data,
    size_t length,
    bool checked,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    size_t extra = 0;
    if (checked) {
        if (link->checksum == NULL) {
            return ICD_ERROR_UNSUPPORTED;
        }
        extra = link->checksum->bytes;
    }
    if (capacity < extra + 1u || capacity - extra - 1u < length) {
        return ICD_ERROR_LENGTH;
    }
    *written = 1u + length + extra;
    return icdgen_put_message(link, id, data, length, checked, buffer);
}

ICDGEN_API icd_status_t icd_i2c_read_length(const icd_link_t *link, uint8_t id, bool checked, size_t *length)
{
    const icd_message_t *const message = icd_find_message(link, ICD_TELEMETRY, id);
    if (message == NULL) {
        return ICD_ERROR_UNKNOWN_ID;
    }
    if (checked && link->checksum == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    *length = ICDGEN_SIZE(message->length) + (checked ? link->checksum->bytes : 0u);
    return ICD_OK;
}

/* Return whether the checksum after the data of a message is right. */
static inline bool icdgen_is_intact(const icd_link_t *link, uint8_t id, const uint8_t *data, size_t length)
{
    return icdgen_number(link, data + length, link->checksum->bytes) == icd_message_checksum(link, id, data, length);
}

ICDGEN_API icd_status_t icd_i2c_reply(
    const icd_link_t *link, uint8_t id, const uint8_t *bytes, size_t length, bool checked, size_t *frame_length)
{
    size_t expected = 0;
    const icd_status_t status = icd_i2c_read_length(link, id, checked, &expected);
    if (status != ICD_OK) {
        return status;
    }
    if (length != expected) {
        return ICD_ERROR_LENGTH;
    }
    *frame_length = expected - (checked ? link->checksum->bytes : 0u);
    return !checked || icdgen_is_intact(link, id, bytes, *frame_length) ? ICD_OK : ICD_ERROR_CHECKSUM;
}

#endif /* ICDGEN_WIRE_I2C_C */
