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
    icd_envelope_values_t values;
    (void)memset(&values, 0, sizeof values);
    if (link->stream != NULL) {
        for (size_t i = 0; i < link->stream->field_count; ++i) {
            const icd_envelope_field_t *const field = &link->stream->fields[i];
            if (field->role < ICD_ENVELOPE_CONSTANT) {
                values.of[field->role] = field->values[direction];
            }
        }
    }
    return values;
}

/* Write all fields except the checksum. Return false if a value does not fit. */
static inline bool icdgen_envelope_fill(
    const icd_stream_form_t *form,
    icd_direction_t direction,
    uint32_t id,
    size_t length,
    const icd_envelope_values_t *values,
    uint8_t *header,
    uint8_t *trailer)
{
    for (size_t i = 0; i < form->field_count; ++i) {
        const icd_envelope_field_t *const field = &form->fields[i];
        uint32_t value = field->values[direction];
        if (field->role == ICD_ENVELOPE_CHECKSUM) {
            continue;
        }
        if (field->role == ICD_ENVELOPE_ID) {
            value = id;
        } else if (field->role == ICD_ENVELOPE_LENGTH) {
            value = ICDGEN_U32(ICDGEN_I64(length) + form->length_plus);
        } else if (field->role < ICD_ENVELOPE_CONSTANT) {
            value = values->of[field->role];
        } else {
            /* a constant */
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
    const icd_stream_form_t *const form = link->stream;
    uint8_t header[ICDGEN_ENVELOPE_BYTES] = {0};
    uint8_t trailer[ICDGEN_ENVELOPE_BYTES] = {0};
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
    const size_t sent = row->cuts_zeros ? icdgen_without_zeros(data, length) : length;
    const icd_envelope_values_t chosen = values != NULL ? *values : icd_envelope_values(link, direction);
    if (!icdgen_envelope_fill(form, direction, id, sent, &chosen, header, trailer)) {
        return ICD_ERROR_RANGE;
    }
    const icd_envelope_field_t *const check = icdgen_envelope_field(form, ICD_ENVELOPE_CHECKSUM);
    if (check != NULL && form->check != NULL) {
        const uint32_t sum = icdgen_envelope_check(form, row, header, data, sent, trailer);
        icdgen_envelope_put(check, check->in_trailer ? trailer : header, sum);
    }
    icdgen_line_t line = {form->delimited_by, buffer, capacity, 0, 0, false, false};
    icdgen_line_delimiter(&line, true);
    icdgen_line_write(&line, header, form->header_bytes);
    icdgen_line_write(&line, data, sent);
    icdgen_line_write(&line, trailer, form->trailer_bytes);
    icdgen_line_delimiter(&line, false);
    *written = line.count;
    return line.full ? ICD_ERROR_LENGTH : ICD_OK;
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

ICDGEN_API icd_status_t icd_stream_send(
    icd_stream_sender_t *sender,
    uint32_t id,
    const uint8_t *data,
    size_t length,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    const icd_stream_form_t *const form = sender->link->stream;
    icd_envelope_values_t values = sender->values;
    size_t place = 0;
    icd_status_t status;
    if (form == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    const icd_stream_row_t *const row = icdgen_stream_row(form, sender->direction, id);
    const icd_envelope_field_t *const field = icdgen_envelope_field(form, ICD_ENVELOPE_SEQUENCE);
    if (row != NULL && form->per_id) {
        place = ICDGEN_SIZE(row - form->rows[sender->direction]);
    }
    if (field != NULL && place < sender->sequence_count && sender->sequences[place] != ICDGEN_NO_SEQUENCE) {
        values.of[ICD_ENVELOPE_SEQUENCE] = (sender->sequences[place] + 1u) & icdgen_envelope_mask(field);
    }
    status = icd_stream_encode(sender->link, sender->direction, id, data, length, &values, buffer, capacity, written);
    if (status == ICD_OK && place < sender->sequence_count) {
        sender->sequences[place] = values.of[ICD_ENVELOPE_SEQUENCE];
    }
    return status;
}

#endif /* ICDGEN_WIRE_STREAM_ENCODE_C */
