#ifndef ICDGEN_WIRE_STREAM_ENCODE_C
#define ICDGEN_WIRE_STREAM_ENCODE_C

#include "envelope.h"

#define ICDGEN_ENVELOPE_BYTES 64u /* largest header or trailer */

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
    icd_delimiter_t delimiter;
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
    if (line->delimiter == ICD_DELIMITED_BY_COBS) {
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
    } else if (line->delimiter == ICD_DELIMITED_BY_SLIP && byte == ICDGEN_SLIP_END) {
        icdgen_line_byte(line, ICDGEN_SLIP_ESCAPE);
        icdgen_line_byte(line, ICDGEN_SLIP_ESCAPED_END);
    } else if (line->delimiter == ICD_DELIMITED_BY_SLIP && byte == ICDGEN_SLIP_ESCAPE) {
        icdgen_line_byte(line, ICDGEN_SLIP_ESCAPE);
        icdgen_line_byte(line, ICDGEN_SLIP_ESCAPED_ESCAPE);
    } else if (line->delimiter == ICD_DELIMITED_BY_HDLC && (byte == ICDGEN_HDLC_FLAG || byte == ICDGEN_HDLC_ESCAPE)) {
        icdgen_line_byte(line, ICDGEN_HDLC_ESCAPE);
        icdgen_line_byte(line, byte ^ ICDGEN_HDLC_FLIP);
    } else {
        icdgen_line_byte(line, byte);
    }
}

static inline void icdgen_line_delimiter(icdgen_line_t *line, bool begins)
{
    if (line->delimiter == ICD_DELIMITED_BY_SLIP) {
        icdgen_line_byte(line, ICDGEN_SLIP_END);
    } else if (line->delimiter == ICD_DELIMITED_BY_HDLC) {
        icdgen_line_byte(line, ICDGEN_HDLC_FLAG);
    } else if (line->delimiter == ICD_DELIMITED_BY_COBS && begins) {
        icdgen_line_byte(line, 0); /* placeholder for the length of the first block */
    } else if (line->delimiter == ICD_DELIMITED_BY_COBS) {
        if (!line->ended) {
            icdgen_line_block(line);
        }
        icdgen_line_byte(line, 0);
    } else {
        /* delimited by its length only */
    }
}

static inline void icdgen_line_write(icdgen_line_t *line, const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; ++i) {
        icdgen_line_put(line, bytes[i]);
    }
}

ICDGEN_API icd_envelope_values_t icd_envelope_values(const icd_link_t *link, icd_direction_t direction)
{
    const icd_stream_form_t *const form = link->stream;
    icd_envelope_values_t values;
    uint32_t seen = 0; /* roles, as a mask */
    (void)memset(&values, 0, sizeof values);
    for (size_t i = 0; form != NULL && i < form->packet_count; ++i) {
        const icd_packet_form_t *const packet = &form->packets[i];
        for (size_t j = 0; packet->is_sent[direction] && j < packet->field_count; ++j) {
            const icd_envelope_field_t *const field = &packet->fields[j];
            if (field->role < ICD_ENVELOPE_CONSTANT) {
                const uint32_t role = UINT32_C(1) << ICDGEN_U32(field->role);
                uint32_t *const value = &values.of[field->role];
                if ((seen & role) == 0u) {
                    *value = field->values[direction];
                } else if (*value != field->values[direction] && field->bits < 32u) {
                    *value = ICD_ENVELOPE_DEFAULT;
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
static inline bool icdgen_envelope_is_chosen(const icd_envelope_field_t *field, const icd_envelope_values_t *values)
{
    return values != NULL && (values->of[field->role] != ICD_ENVELOPE_DEFAULT || field->bits == 32u);
}

/* Write all fields except the checksum. Return false if a value does not fit. */
static inline bool icdgen_envelope_fill(
    const icd_packet_form_t *packet,
    icd_direction_t direction,
    const icd_stream_row_t *row,
    size_t length,
    const icd_envelope_values_t *values,
    uint8_t *header,
    uint8_t *trailer)
{
    for (size_t i = 0; i < packet->field_count; ++i) {
        const icd_envelope_field_t *const field = &packet->fields[i];
        uint32_t value = field->values[direction];
        if (field->role == ICD_ENVELOPE_CHECKSUM) {
            continue;
        }
        if (field->role == ICD_ENVELOPE_ID) {
            value = (row->id >> value) & icdgen_envelope_mask(field);
        } else if (field->role == ICD_ENVELOPE_LENGTH) {
            value = icdgen_envelope_counted(field, length);
        } else if (field->role == ICD_ENVELOPE_RESPONSE_LENGTH) {
            value = icdgen_envelope_counted(field, row->most);
        } else if (field->role < ICD_ENVELOPE_CONSTANT && icdgen_envelope_is_chosen(field, values)) {
            value = values->of[field->role];
        } else {
            /* the value of the ICD */
        }
        if (value > icdgen_envelope_mask(field)) {
            return false;
        }
        icdgen_envelope_put(field, field->in_trailer ? trailer : header, value);
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

/* A packet that is to be encoded. */
typedef struct {
    const icd_stream_form_t *form;
    icd_direction_t direction;
    const icd_stream_row_t *row; /* the message; as a telecommand also telemetry, for the packet that requests it */
    const uint8_t *data;
    size_t length;
    const icd_exchange_t *exchange; /* its responses; NULL if they do not matter */
    uint32_t *sources;              /* of `exchange`: the numbers in the header are written here */
} icdgen_outgoing_t;

static inline bool icdgen_outgoing_requests(const icdgen_outgoing_t *outgoing)
{
    return outgoing->direction == ICD_TELECOMMAND && (outgoing->row->flags & ICD_STREAM_REQUESTED) != 0u;
}

static inline const icd_packet_form_t *icdgen_outgoing_packet(const icdgen_outgoing_t *outgoing)
{
    const icd_stream_form_t *const form = outgoing->form;
    return &form->packets[icdgen_outgoing_requests(outgoing) ? form->request->packet : outgoing->row->packet];
}

/* Find the message with this id. */
static inline icd_status_t icdgen_outgoing_message(icdgen_outgoing_t *outgoing, const icd_link_t *link, uint32_t id)
{
    outgoing->form = link->stream;
    if (outgoing->form == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    outgoing->row = icdgen_stream_row(outgoing->form, outgoing->direction, id);
    if (outgoing->row == NULL) {
        return ICD_ERROR_UNKNOWN_ID;
    }
    const bool fits = outgoing->length >= outgoing->row->least && outgoing->length <= outgoing->row->most;
    return fits ? ICD_OK : ICD_ERROR_LENGTH;
}

/* Find the telemetry with this id that a packet requests. */
static inline icd_status_t icdgen_outgoing_request(icdgen_outgoing_t *outgoing, const icd_link_t *link, uint32_t id)
{
    const icd_stream_form_t *const form = link->stream;
    if (form == NULL || form->request == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    outgoing->form = form;
    outgoing->row = icdgen_stream_row(form, ICD_TELEMETRY, id);
    outgoing->data = form->request->data;
    outgoing->length = form->packets[form->request->packet].reserved;
    return outgoing->row != NULL && icdgen_outgoing_requests(outgoing) ? ICD_OK : ICD_ERROR_UNKNOWN_ID;
}

static inline icd_status_t icdgen_outgoing_encode(
    const icdgen_outgoing_t *outgoing,
    const icd_envelope_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    const icd_packet_form_t *const packet = icdgen_outgoing_packet(outgoing);
    const icd_stream_row_t *const row = outgoing->row;
    const uint8_t *const data = outgoing->data;
    const bool cuts_zeros = (row->flags & ICD_STREAM_CUTS_ZEROS) != 0u && !icdgen_outgoing_requests(outgoing);
    const size_t length = cuts_zeros ? icdgen_without_zeros(data, outgoing->length) : outgoing->length;
    uint8_t header[ICDGEN_ENVELOPE_BYTES] = {0};
    uint8_t trailer[ICDGEN_ENVELOPE_BYTES] = {0};
    if (!icdgen_envelope_fill(packet, outgoing->direction, row, length, values, header, trailer)) {
        return ICD_ERROR_RANGE;
    }
    const icd_envelope_field_t *const check = icdgen_envelope_field(packet, ICD_ENVELOPE_CHECKSUM);
    if (check != NULL && packet->check != NULL) {
        const uint32_t sum = icdgen_envelope_check(packet, row, header, data, length, trailer);
        icdgen_envelope_put(check, check->in_trailer ? trailer : header, sum);
    }
    if (outgoing->exchange != NULL) {
        const icd_exchange_t *const exchange = outgoing->exchange;
        const size_t first = ICDGEN_SIZE(exchange->source_count) - exchange->header_count;
        for (size_t i = first; i < exchange->source_count; ++i) {
            outgoing->sources[i] = icdgen_stream_number(&exchange->sources[i], 0, header, packet->header_bytes);
        }
    }
    icdgen_line_t line = {outgoing->form->delimited_by, buffer, capacity, 0, 0, false, false};
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
    const icd_envelope_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    icdgen_outgoing_t outgoing = {NULL, direction, NULL, data, length, NULL, NULL};
    const icd_status_t status = icdgen_outgoing_message(&outgoing, link, id);
    return status != ICD_OK ? status : icdgen_outgoing_encode(&outgoing, values, buffer, capacity, written);
}

ICDGEN_API icd_status_t icd_stream_encode_request(
    const icd_link_t *link,
    uint32_t telemetry,
    const icd_envelope_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    icdgen_outgoing_t outgoing = {NULL, ICD_TELECOMMAND, NULL, NULL, 0u, NULL, NULL};
    const icd_status_t status = icdgen_outgoing_request(&outgoing, link, telemetry);
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
    sender->values = icd_envelope_values(link, direction);
    sender->sequences = sequences;
    sender->sequence_count = sequence_count;
    for (size_t i = 0; i < sequence_count; ++i) {
        sequences[i] = ICDGEN_NO_SEQUENCE;
    }
    return link->stream != NULL ? ICD_OK : ICD_ERROR_UNSUPPORTED;
}

/* Encode a packet with the next sequence number. */
static inline icd_status_t icdgen_outgoing_send(
    const icdgen_outgoing_t *outgoing, icd_stream_sender_t *sender, uint8_t *buffer, size_t capacity, size_t *written)
{
    const icd_stream_form_t *const form = outgoing->form;
    const icd_envelope_field_t *const field =
        icdgen_envelope_field(icdgen_outgoing_packet(outgoing), ICD_ENVELOPE_SEQUENCE);
    const size_t counter = form->per_id ? ICDGEN_SIZE(outgoing->row - form->rows[outgoing->direction]) : 0u;
    /* With a sequence for each id, packets that request telemetry have no counter. */
    const bool is_counted =
        field != NULL && counter < sender->sequence_count && !(form->per_id && icdgen_outgoing_requests(outgoing));
    icd_envelope_values_t values = sender->values;
    if (is_counted && sender->sequences[counter] != ICDGEN_NO_SEQUENCE) {
        values.of[ICD_ENVELOPE_SEQUENCE] = (sender->sequences[counter] + 1u) & icdgen_envelope_mask(field);
    } else if (is_counted && values.of[ICD_ENVELOPE_SEQUENCE] == ICD_ENVELOPE_DEFAULT) {
        values.of[ICD_ENVELOPE_SEQUENCE] = field->values[sender->direction];
    } else {
        /* the value that the sender chose */
    }
    const icd_status_t status = icdgen_outgoing_encode(outgoing, &values, buffer, capacity, written);
    if (status == ICD_OK && is_counted) {
        sender->sequences[counter] = values.of[ICD_ENVELOPE_SEQUENCE];
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
    icdgen_outgoing_t outgoing = {NULL, sender->direction, NULL, data, length, NULL, NULL};
    const icd_status_t status = icdgen_outgoing_message(&outgoing, sender->link, id);
    return status != ICD_OK ? status : icdgen_outgoing_send(&outgoing, sender, buffer, capacity, written);
}

ICDGEN_API icd_status_t icd_stream_send_request(
    icd_stream_sender_t *sender, uint32_t telemetry, uint8_t *buffer, size_t capacity, size_t *written)
{
    icdgen_outgoing_t outgoing = {NULL, ICD_TELECOMMAND, NULL, NULL, 0u, NULL, NULL};
    const icd_status_t status = icdgen_outgoing_request(&outgoing, sender->link, telemetry);
    return status != ICD_OK ? status : icdgen_outgoing_send(&outgoing, sender, buffer, capacity, written);
}

#endif /* ICDGEN_WIRE_STREAM_ENCODE_C */
