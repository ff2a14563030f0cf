#ifndef ICDGEN_WIRE_PACKET_FIELDS_H
#define ICDGEN_WIRE_PACKET_FIELDS_H

#include "stream.h"
#include "checksum.h"
#include "kinds.h"

#define ICDGEN_NO_SEQUENCE UINT32_C(0xFFFFFFFF) /* not a valid sequence number: these have at most 31 bits */

#define ICDGEN_IS_DELIMITED_BY(form, delimiter) ICDGEN_IS((form)->delimited_by, delimiter, ICDGEN_DELIMITERS)
#define ICDGEN_HAS_ROLE(field, member) ICDGEN_IS((field)->role, member, ICDGEN_ROLES)
#define ICDGEN_CONTAINS(packet, member) ICDGEN_IS((packet)->content, member, ICDGEN_CONTENTS)
#define ICDGEN_IS_VERDICT(verdict, member) ICDGEN_IS(verdict, member, ICDGEN_VERDICTS)
#define ICDGEN_HAS_FLAG(row, flag) (((row)->flags & (flag) & ICDGEN_STREAM_FLAGS) != 0u)
#define ICDGEN_RESPONSES_HAVE(part) ((ICDGEN_RESPONSES & (part)) != 0u)
#define ICDGEN_HAS_BUS(bus) ((ICDGEN_BUSES & ICDGEN_BIT(bus)) != 0u)

/* Whether the sender chooses the value of a field. */
#define ICDGEN_IS_OF_SENDER(field)                                                                                     \
    ((ICDGEN_ROLES & (ICDGEN_BIT(ICD_HEADER_VALUES) - 1u)) != 0u && (field)->role < ICD_FIELD_CONSTANT)

#define ICDGEN_LENGTH(value) ICDGEN_CAST(icdgen_length_t, value)

/* Access to the fields and the checksum of a frame, for encoder and decoder. */

static inline uint32_t icdgen_field_mask(const icd_packet_field_t *field)
{
    return UINT32_C(0xFFFFFFFF) >> (32u - field->bits);
}

/* Return the number of bytes of header and trailer. */
static inline size_t icdgen_packet_around(const icd_packet_form_t *packet)
{
    return ICDGEN_SIZE(packet->header_bytes) + packet->trailer_bytes;
}

/* Return the field with this role; NULL if there is none. */
static inline const icd_packet_field_t *icdgen_packet_field(const icd_packet_form_t *packet, icd_field_role_t role)
{
    for (size_t i = 0; i < packet->field_count; ++i) {
        if (packet->fields[i].role == role) {
            return &packet->fields[i];
        }
    }
    return NULL;
}

/* The field with this role. A compiler knows that there is none if no packet has one. */
#define ICDGEN_FIELD(packet, role) ((ICDGEN_ROLES & ICDGEN_BIT(role)) != 0u ? icdgen_packet_field(packet, role) : NULL)

/* Return the value of a field. `bytes` is the header or the trailer that contains the field. */
static inline uint32_t icdgen_field_get(const icd_packet_field_t *field, const uint8_t *bytes)
{
    uint32_t number = 0;
    for (size_t i = 0; i < field->size; ++i) {
        number = (number << 8) | bytes[field->at + (field->little ? field->size - 1u - i : i)];
    }
    return (number >> field->shift) & icdgen_field_mask(field);
}

/* Return the id of a packet whose id is in the header. */
static inline uint32_t icdgen_packet_id(
    const icd_packet_form_t *packet, icd_direction_t direction, const uint8_t *header)
{
    uint32_t id = packet->ids[direction];
    for (size_t i = 0; i < packet->field_count; ++i) {
        const icd_packet_field_t *const field = &packet->fields[i];
        if (ICDGEN_HAS_ROLE(field, ICD_FIELD_ID) && !field->in_trailer) {
            id |= icdgen_field_get(field, header) << field->values[0];
        }
    }
    return id;
}

/* Return the number of data bytes that a length field says. */
static inline icdgen_length_t icdgen_field_bytes(const icd_packet_field_t *field, uint32_t value)
{
    return (ICDGEN_LENGTH(value) * ICDGEN_LENGTH(field->values[1])) - ICDGEN_I32(field->values[0]);
}

/* Return the value of a length field for a number of data bytes. */
static inline uint32_t icdgen_field_counted(const icd_packet_field_t *field, size_t length)
{
    return (ICDGEN_U32(length) + field->values[0]) / field->values[1];
}

static inline void icdgen_field_put(const icd_packet_field_t *field, uint8_t *bytes, uint32_t value)
{
    uint32_t rest = value << field->shift;
    for (size_t i = 0; i < field->size; ++i) {
        uint8_t *const byte = &bytes[field->at + (field->little ? i : field->size - 1u - i)];
        *byte = ICDGEN_U8(*byte | (rest & 0xFFu));
        rest >>= 8;
    }
}

/* Return a number of a message. See icd_number_place_t. */
static inline uint32_t icdgen_stream_number(
    const icd_number_place_t *place, uint32_t id, const uint8_t *data, size_t length)
{
    uint32_t number = 0;
    for (size_t i = 0; i < place->size; ++i) {
        const size_t at = ICDGEN_SIZE(place->at) + (place->little ? place->size - 1u - i : i);
        uint32_t byte = 0;
        if (at < sizeof id) {
            const uint32_t shift = 8u * (3u - ICDGEN_U32(at));
            byte = (id >> shift) & 0xFFu;
        } else if (at - sizeof id < length) {
            byte = data[at - sizeof id];
        } else {
            /* the message has no such byte */
        }
        number = (number << 8) | byte;
    }
    return (number >> place->shift) & (UINT32_C(0xFFFFFFFF) >> (32u - place->bits));
}

/* Return the meaning of a status; NULL if the ICD does not list it. */
static inline const icd_meaning_t *icdgen_meaning(const icd_response_t *response, uint32_t status)
{
    for (size_t i = 0; i < response->meaning_count; ++i) {
        if (response->meanings[i].value == status) {
            return &response->meanings[i];
        }
    }
    return NULL;
}

/* Return what a response says. */
static inline icd_verdict_t icdgen_verdict_of(
    const icd_response_t *response, uint32_t id, const uint8_t *data, size_t length)
{
    const icd_meaning_t *meaning = NULL;
    if (ICDGEN_RESPONSES_HAVE(ICDGEN_RESPONSE_STATUS) && response->status != NULL) {
        meaning = icdgen_meaning(response, icdgen_stream_number(response->status, id, data, length));
    }
    return meaning != NULL ? meaning->verdict : response->verdict;
}

/*
 * Return the checksum of header, data and trailer. `row` is NULL if there is no message and so no seed; `data` is NULL
 * for zeros.
 */
static inline uint32_t icdgen_packet_checksum(
    const icd_packet_form_t *packet,
    const icd_stream_row_t *row,
    const uint8_t *header,
    const uint8_t *data,
    size_t length,
    const uint8_t *trailer)
{
    static const uint8_t zero = 0;
    const icd_check_form_t *const given = packet->check;
    icdgen_check_t check;
    icdgen_check_begin(&check, given->algorithm);
    icdgen_check_feed(&check, header + given->covered_from, ICDGEN_SIZE(packet->header_bytes) - given->covered_from);
    if (data != NULL) {
        icdgen_check_feed(&check, data, length);
    } else {
        for (size_t i = 0; i < length; ++i) {
            icdgen_check_feed(&check, &zero, 1);
        }
    }
    icdgen_check_feed(&check, trailer, given->covered_trailer);
    if (given->is_seeded && row != NULL) {
        icdgen_check_feed(&check, &row->seed, 1);
    }
    return icdgen_check_result(&check);
}

/* Return the message with this id; NULL if there is none. */
static inline const icd_stream_row_t *icdgen_stream_row(
    const icd_stream_form_t *form, icd_direction_t direction, uint32_t id)
{
    size_t low = 0;
    size_t high = form->row_counts[direction];
    while (low < high) {
        const size_t middle = low + ((high - low) / 2u);
        const icd_stream_row_t *const row = &form->rows[direction][middle];
        if (row->id == id) {
            return row;
        }
        if (row->id < id) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return NULL;
}

#endif /* ICDGEN_WIRE_PACKET_FIELDS_H */
