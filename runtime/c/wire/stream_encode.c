#ifndef ICDGEN_WIRE_STREAM_ENCODE_C
#define ICDGEN_WIRE_STREAM_ENCODE_C

#include "packet_fields.h"

#define ICDGEN_HEADER_BYTES 64u /* largest header or trailer */

#define ICDGEN_SLIP_END 0xC0u
#define ICDGEN_SLIP_ESCAPE 0xDBu
#define ICDGEN_SLIP_ESCAPED_END 0xDCu
#define ICDGEN_SLIP_ESCAPED_ESCAPE 0xDDu
#define ICDGEN_HDLC_FLAG 0x7Eu
#define ICDGEN_HDLC_ESCAPE 0x7Du
#define ICDGEN_HDLC_FLIP 0x20u
#define ICDGEN_COBS_WHOLE 0xFFu /* length byte of a full block, which no zero follows */

/* Output buffer for a message with its delimiters. */
typedef struct {
    const icd_stream_form_t *form;
    uint8_t *buffer;
    size_t capacity;
    size_t count;
    size_t block; /* COBS: position of the length byte of the block */
    bool ended;   /* COBS: the last block was a full one */
    bool full;
} icdgen_line_t;

static inline void icdgen_line_byte(icdgen_line_t *line, uint32_t byte)
{
    if (line->count < line->capacity) {
        line->buffer[line->count] = ICDGEN_U8(byte);
        line->count++;
    } else {
        line->full = true;
    }
}

/* COBS: write the length byte in front of the block and start the next block. */
static inline void icdgen_line_block(icdgen_line_t *line)
{
    if (!line->full) {
        line->buffer[line->block] = ICDGEN_U8(line->count - line->block);
    }
    line->block = line->count;
}

static inline void icdgen_line_put(icdgen_line_t *line, uint8_t byte)
{
    if (ICDGEN_IS_DELIMITED_BY(line->form, ICD_DELIMITED_BY_COBS)) {
        if (line->ended) {
            icdgen_line_byte(line, 0);
            line->ended = false;
        }
        if (byte != 0u) {
            icdgen_line_byte(line, byte);
        }
        if (byte == 0u || line->count - line->block == ICDGEN_COBS_WHOLE) {
            icdgen_line_block(line);
            line->ended = byte != 0u;
            if (byte == 0u) {
                icdgen_line_byte(line, 0);
            }
        }
    } else if (ICDGEN_IS_DELIMITED_BY(line->form, ICD_DELIMITED_BY_SLIP) && byte == ICDGEN_SLIP_END) {
        icdgen_line_byte(line, ICDGEN_SLIP_ESCAPE);
        icdgen_line_byte(line, ICDGEN_SLIP_ESCAPED_END);
    } else if (ICDGEN_IS_DELIMITED_BY(line->form, ICD_DELIMITED_BY_SLIP) && byte == ICDGEN_SLIP_ESCAPE) {
        icdgen_line_byte(line, ICDGEN_SLIP_ESCAPE);
        icdgen_line_byte(line, ICDGEN_SLIP_ESCAPED_ESCAPE);
    } else if (
        ICDGEN_IS_DELIMITED_BY(line->form, ICD_DELIMITED_BY_HDLC) &&
        (byte == ICDGEN_HDLC_FLAG || byte == ICDGEN_HDLC_ESCAPE)) {
        icdgen_line_byte(line, ICDGEN_HDLC_ESCAPE);
        icdgen_line_byte(line, byte ^ ICDGEN_HDLC_FLIP);
    } else if (ICDGEN_IS_DELIMITED_BY(line->form, ICD_DELIMITED_BY_ESCAPE) && byte == line->form->escaping->escape) {
        icdgen_line_byte(line, byte);
        icdgen_line_byte(line, line->form->escaping->data);
    } else {
        icdgen_line_byte(line, byte);
    }
}

static inline void icdgen_line_delimiter(icdgen_line_t *line, bool begins)
{
    if (ICDGEN_IS_DELIMITED_BY(line->form, ICD_DELIMITED_BY_SLIP)) {
        icdgen_line_byte(line, ICDGEN_SLIP_END);
    } else if (ICDGEN_IS_DELIMITED_BY(line->form, ICD_DELIMITED_BY_HDLC)) {
        icdgen_line_byte(line, ICDGEN_HDLC_FLAG);
    } else if (ICDGEN_IS_DELIMITED_BY(line->form, ICD_DELIMITED_BY_COBS) && begins) {
        icdgen_line_byte(line, 0); /* placeholder for the length of the first block */
    } else if (ICDGEN_IS_DELIMITED_BY(line->form, ICD_DELIMITED_BY_COBS)) {
        if (!line->ended) {
            icdgen_line_block(line);
        }
        icdgen_line_byte(line, 0);
    } else if (ICDGEN_IS_DELIMITED_BY(line->form, ICD_DELIMITED_BY_ESCAPE)) {
        icdgen_line_byte(line, line->form->escaping->escape);
        if (!begins) {
            icdgen_line_byte(line, line->form->escaping->end);
        } else if (line->form->escaping->has_start) {
            icdgen_line_byte(line, line->form->escaping->start);
        } else {
            /* the first byte of the packet follows */
        }
    } else {
        /* delimited by its length only */
    }
}

/* Write bytes; zeros if `bytes` is NULL. */
static inline void icdgen_line_write(icdgen_line_t *line, const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; ++i) {
        icdgen_line_put(line, bytes != NULL ? bytes[i] : 0u);
    }
}

ICDGEN_API icd_header_values_t icd_header_values(const icd_link_t *link, icd_direction_t direction)
{
    const icd_stream_form_t *const form = link->stream;
    icd_header_values_t values;
    uint32_t seen = 0; /* roles, as a mask */
    (void)memset(&values, 0, sizeof values);
    for (size_t i = 0; form != NULL && i < form->packet_count; ++i) {
        const icd_packet_form_t *const packet = &form->packets[i];
        for (size_t j = 0; packet->is_sent[direction] && j < packet->field_count; ++j) {
            const icd_packet_field_t *const field = &packet->fields[j];
            if (ICDGEN_IS_OF_SENDER(field)) {
                const uint32_t role = UINT32_C(1) << ICDGEN_U32(field->role);
                uint32_t *const value = &values.of[field->role];
                if ((seen & role) == 0u) {
                    *value = field->values[direction];
                } else if (*value != field->values[direction] && field->bits < 32u) {
                    *value = ICD_HEADER_DEFAULT;
                } else {
                    /* the packets have the same default */
                }
                seen |= role;
            }
        }
    }
    return values;
}

/* Return whether the sender chose the value of a field. Otherwise, the field has the default of its packet. */
static inline bool icdgen_field_is_chosen(const icd_packet_field_t *field, const icd_header_values_t *values)
{
    return values != NULL && (values->of[field->role] != ICD_HEADER_DEFAULT || field->bits == 32u);
}

/* A packet that is to be encoded. */
typedef struct {
    const icd_stream_form_t *form;
    icd_direction_t direction;
    const icd_packet_form_t *packet;
    uint32_t id;
    const icd_stream_row_t *row; /* the message, or the telemetry that the packet requests; NULL without either */
    bool is_message;
    const uint8_t *data; /* NULL: zeros */
    size_t length;
    const icd_exchange_t *exchange; /* its responses; NULL if they do not matter */
    uint32_t *sources;              /* of `exchange`: the numbers in the header are written here */
} icdgen_outgoing_t;

/* Return the part of an id that belongs into a field. If the id is too large, its topmost part does not fit. */
static inline uint32_t icdgen_id_part(const icd_packet_form_t *packet, const icd_packet_field_t *field, uint32_t id)
{
    const uint32_t shift = field->values[0];
    uint32_t bits = 0;
    for (size_t i = 0; i < packet->field_count; ++i) {
        bits += ICDGEN_HAS_ROLE(&packet->fields[i], ICD_FIELD_ID) ? packet->fields[i].bits : 0u;
    }
    const uint32_t part = id >> shift;
    return shift + field->bits < bits ? part & icdgen_field_mask(field) : part;
}

/* Write all fields except the checksum. Return false if a value does not fit. */
static inline bool icdgen_packet_fill(
    const icdgen_outgoing_t *outgoing,
    size_t length,
    const icd_header_values_t *values,
    uint8_t *header,
    uint8_t *trailer)
{
    const icd_packet_form_t *const packet = outgoing->packet;
    for (size_t i = 0; i < packet->field_count; ++i) {
        const icd_packet_field_t *const field = &packet->fields[i];
        uint32_t value = field->values[outgoing->direction];
        if (ICDGEN_HAS_ROLE(field, ICD_FIELD_CHECKSUM)) {
            continue;
        }
        if (ICDGEN_HAS_ROLE(field, ICD_FIELD_ID)) {
            value = icdgen_id_part(packet, field, outgoing->id);
        } else if (ICDGEN_HAS_ROLE(field, ICD_FIELD_LENGTH)) {
            value = icdgen_field_counted(field, length);
        } else if (ICDGEN_HAS_ROLE(field, ICD_FIELD_RESPONSE_LENGTH) && outgoing->row != NULL) {
            value = icdgen_field_counted(field, outgoing->row->most);
        } else if (ICDGEN_IS_OF_SENDER(field) && icdgen_field_is_chosen(field, values)) {
            value = values->of[field->role];
        } else {
            /* the value of the ICD */
        }
        if (value > icdgen_field_mask(field)) {
            return false;
        }
        icdgen_field_put(field, field->in_trailer ? trailer : header, value);
    }
    return true;
}

/* Return the data length without trailing zeros, at least 1. */
static inline size_t icdgen_without_zeros(const uint8_t *data, size_t length)
{
    size_t left = length;
    while (left > 1u && data[left - 1u] == 0u) {
        left--;
    }
    return left;
}

/* Prepare a message; as a telecommand also the packet that requests telemetry, with the row of the telemetry. */
static inline icdgen_outgoing_t icdgen_outgoing_row(
    const icd_stream_form_t *form,
    icd_direction_t direction,
    const icd_stream_row_t *row,
    const uint8_t *data,
    size_t length)
{
    const bool requests = direction == ICD_TELECOMMAND && ICDGEN_HAS_FLAG(row, ICD_STREAM_REQUESTED);
    const icd_packet_form_t *const packet = &form->packets[requests ? form->request->packet : row->packet];
    const icdgen_outgoing_t outgoing = {form, direction, packet, row->id, row, !requests, data, length, NULL, NULL};
    return outgoing;
}

/* Prepare the message with this id. */
static inline icd_status_t icdgen_outgoing_message(
    icdgen_outgoing_t *outgoing,
    const icd_link_t *link,
    icd_direction_t direction,
    uint32_t id,
    const uint8_t *data,
    size_t length)
{
    const icd_stream_form_t *const form = link->stream;
    if (form == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    const icd_stream_row_t *const row = icdgen_stream_row(form, direction, id);
    if (row == NULL) {
        return ICD_ERROR_UNKNOWN_ID;
    }
    if (length < row->least || length > row->most) {
        return ICD_ERROR_LENGTH;
    }
    *outgoing = icdgen_outgoing_row(form, direction, row, data, length);
    return ICD_OK;
}

/* Prepare the packet that requests the telemetry with this id. */
static inline icd_status_t icdgen_outgoing_request(icdgen_outgoing_t *outgoing, const icd_link_t *link, uint32_t id)
{
    const icd_stream_form_t *const form = link->stream;
    if (form == NULL || form->request == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    const icd_stream_row_t *const row = icdgen_stream_row(form, ICD_TELEMETRY, id);
    if (row == NULL || (row->flags & ICD_STREAM_REQUESTED) == 0u) {
        return ICD_ERROR_UNKNOWN_ID;
    }
    *outgoing = icdgen_outgoing_row(form, ICD_TELECOMMAND, row, NULL, form->packets[form->request->packet].reserved);
    return ICD_OK;
}

/* Prepare a packet without a message, with its reserved bytes. */
static inline icd_status_t icdgen_outgoing_packet(
    icdgen_outgoing_t *outgoing, const icd_link_t *link, icd_direction_t direction, size_t packet, uint32_t id)
{
    const icd_stream_form_t *const form = link->stream;
    if (form == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (packet >= form->packet_count || !ICDGEN_CONTAINS(&form->packets[packet], ICD_PACKET_NOTHING) ||
        !form->packets[packet].is_sent[direction]) {
        return ICD_ERROR_RANGE;
    }
    const icdgen_outgoing_t prepared = {
        form, direction, &form->packets[packet], id, NULL, false, NULL, form->packets[packet].reserved, NULL, NULL};
    *outgoing = prepared;
    return ICD_OK;
}

static inline icd_status_t icdgen_outgoing_encode(
    const icdgen_outgoing_t *outgoing,
    const icd_header_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    const icd_packet_form_t *const packet = outgoing->packet;
    const uint8_t *const data = outgoing->data;
    const bool cuts_zeros = outgoing->is_message && ICDGEN_HAS_FLAG(outgoing->row, ICD_STREAM_CUTS_ZEROS);
    const size_t length = cuts_zeros ? icdgen_without_zeros(data, outgoing->length) : outgoing->length;
    uint8_t header[ICDGEN_HEADER_BYTES] = {0};
    uint8_t trailer[ICDGEN_HEADER_BYTES] = {0};
    if (!icdgen_packet_fill(outgoing, length, values, header, trailer)) {
        return ICD_ERROR_RANGE;
    }
    const icd_packet_field_t *const check = ICDGEN_FIELD(packet, ICD_FIELD_CHECKSUM);
    if (check != NULL && packet->check != NULL) {
        const uint32_t sum = icdgen_packet_checksum(packet, outgoing->row, header, data, length, trailer);
        icdgen_field_put(check, check->in_trailer ? trailer : header, sum);
    }
    if (ICDGEN_RESPONSES_HAVE(ICDGEN_RESPONSE_HEADER_ECHO) && outgoing->exchange != NULL) {
        const icd_exchange_t *const exchange = outgoing->exchange;
        const size_t first = ICDGEN_SIZE(exchange->source_count) - exchange->header_count;
        for (size_t i = first; i < exchange->source_count; ++i) {
            outgoing->sources[i] = icdgen_stream_number(&exchange->sources[i], 0, header, packet->header_bytes);
        }
    }
    icdgen_line_t line = {outgoing->form, buffer, capacity, 0, 0, false, false};
    icdgen_line_delimiter(&line, true);
    icdgen_line_write(&line, header, packet->header_bytes);
    icdgen_line_write(&line, data, length);
    icdgen_line_write(&line, trailer, packet->trailer_bytes);
    icdgen_line_delimiter(&line, false);
    *written = line.count;
    return line.full ? ICD_ERROR_LENGTH : ICD_OK;
}

ICDGEN_API icd_status_t icd_stream_encode(
    const icd_link_t *link,
    icd_direction_t direction,
    uint32_t id,
    const uint8_t *data,
    size_t length,
    const icd_header_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    icdgen_outgoing_t outgoing;
    const icd_status_t status = icdgen_outgoing_message(&outgoing, link, direction, id, data, length);
    return status != ICD_OK ? status : icdgen_outgoing_encode(&outgoing, values, buffer, capacity, written);
}

ICDGEN_API icd_status_t icd_stream_encode_request(
    const icd_link_t *link,
    uint32_t telemetry,
    const icd_header_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    icdgen_outgoing_t outgoing;
    const icd_status_t status = icdgen_outgoing_request(&outgoing, link, telemetry);
    return status != ICD_OK ? status : icdgen_outgoing_encode(&outgoing, values, buffer, capacity, written);
}

ICDGEN_API icd_status_t icd_stream_encode_packet(
    const icd_link_t *link,
    icd_direction_t direction,
    size_t packet,
    uint32_t id,
    const icd_header_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    icdgen_outgoing_t outgoing;
    const icd_status_t status = icdgen_outgoing_packet(&outgoing, link, direction, packet, id);
    return status != ICD_OK ? status : icdgen_outgoing_encode(&outgoing, values, buffer, capacity, written);
}

ICDGEN_API icd_status_t icd_stream_sender_init(
    icd_stream_sender_t *sender,
    const icd_link_t *link,
    icd_direction_t direction,
    uint32_t *sequences,
    size_t sequence_count)
{
    (void)memset(sender, 0, sizeof *sender);
    sender->link = link;
    sender->direction = direction;
    sender->values = icd_header_values(link, direction);
    sender->sequences = sequences;
    sender->sequence_count = sequence_count;
    for (size_t i = 0; i < sequence_count; ++i) {
        sequences[i] = ICDGEN_NO_SEQUENCE;
    }
    return link->stream != NULL ? ICD_OK : ICD_ERROR_UNSUPPORTED;
}

/* Encode a packet with these values and the next sequence number. */
static inline icd_status_t icdgen_outgoing_send(
    const icdgen_outgoing_t *outgoing,
    icd_stream_sender_t *sender,
    const icd_header_values_t *chosen,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    const bool per_id = outgoing->form->per_id;
    const icd_packet_field_t *const field = ICDGEN_FIELD(outgoing->packet, ICD_FIELD_SEQUENCE);
    size_t counter = 0;
    if (per_id && outgoing->is_message) {
        counter = ICDGEN_SIZE(outgoing->row - outgoing->form->rows[outgoing->direction]);
    }
    /* With a sequence for each id, only messages have a counter. */
    const bool is_counted = field != NULL && counter < sender->sequence_count && (outgoing->is_message || !per_id);
    icd_header_values_t values = *chosen;
    if (is_counted) {
        uint32_t number = sender->values.of[ICD_FIELD_SEQUENCE];
        if (sender->sequences[counter] != ICDGEN_NO_SEQUENCE) {
            number = (sender->sequences[counter] + 1u) & icdgen_field_mask(field);
        } else if (number == ICD_HEADER_DEFAULT) {
            number = field->values[sender->direction];
        } else {
            /* the first number of the sender */
        }
        values.of[ICD_FIELD_SEQUENCE] = number;
    }
    const icd_status_t status = icdgen_outgoing_encode(outgoing, &values, buffer, capacity, written);
    if (status == ICD_OK && is_counted) {
        sender->sequences[counter] = values.of[ICD_FIELD_SEQUENCE];
    }
    return status;
}

ICDGEN_API icd_status_t icd_stream_send(
    icd_stream_sender_t *sender,
    uint32_t id,
    const uint8_t *data,
    size_t length,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    icdgen_outgoing_t outgoing;
    const icd_status_t status = icdgen_outgoing_message(&outgoing, sender->link, sender->direction, id, data, length);
    return status != ICD_OK ? status
                            : icdgen_outgoing_send(&outgoing, sender, &sender->values, buffer, capacity, written);
}

ICDGEN_API icd_status_t icd_stream_send_request(
    icd_stream_sender_t *sender, uint32_t telemetry, uint8_t *buffer, size_t capacity, size_t *written)
{
    icdgen_outgoing_t outgoing;
    const icd_status_t status = icdgen_outgoing_request(&outgoing, sender->link, telemetry);
    return status != ICD_OK ? status
                            : icdgen_outgoing_send(&outgoing, sender, &sender->values, buffer, capacity, written);
}

ICDGEN_API icd_status_t icd_stream_send_packet(
    icd_stream_sender_t *sender,
    size_t packet,
    uint32_t id,
    const icd_header_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    icdgen_outgoing_t outgoing;
    const icd_header_values_t *const chosen = values != NULL ? values : &sender->values;
    const icd_status_t status = icdgen_outgoing_packet(&outgoing, sender->link, sender->direction, packet, id);
    return status != ICD_OK ? status : icdgen_outgoing_send(&outgoing, sender, chosen, buffer, capacity, written);
}

#endif /* ICDGEN_WIRE_STREAM_ENCODE_C */
