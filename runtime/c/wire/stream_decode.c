#ifndef ICDGEN_WIRE_STREAM_DECODE_C
#define ICDGEN_WIRE_STREAM_DECODE_C

#include "envelope.h"
#include "stream_encode.c"

/* Result of checking a frame: accepted; certainly a frame, but not usable; possibly not a frame. */
typedef enum { ICDGEN_TAKEN, ICDGEN_PROVEN, ICDGEN_DOUBTFUL } icdgen_verdict_t;

/* The event callback. */
typedef struct {
    icd_stream_event_fn *on_event;
    void *context;
} icdgen_listener_t;

static inline icd_stream_event_t icdgen_stream_event(icd_stream_kind_t kind)
{
    icd_stream_event_t event;
    (void)memset(&event, 0, sizeof event);
    event.kind = kind;
    return event;
}

static inline void icdgen_stream_tell_of(
    const icdgen_listener_t *listener, icd_stream_kind_t kind, bool has_id, uint32_t id)
{
    icd_stream_event_t event = icdgen_stream_event(kind);
    event.has_id = has_id;
    event.id = id;
    listener->on_event(listener->context, &event);
}

static inline void icdgen_stream_tell(const icdgen_listener_t *listener, icd_stream_kind_t kind)
{
    icdgen_stream_tell_of(listener, kind, false, 0);
}

static inline void icdgen_stream_clear(icd_stream_decoder_t *decoder)
{
    decoder->length = 0;
    decoder->escaped = false;
    decoder->zero = false;
    decoder->left = 0;
    decoder->faulty = false;
}

ICDGEN_API icd_status_t icd_stream_decoder_init(
    icd_stream_decoder_t *decoder,
    const icd_link_t *link,
    icd_direction_t direction,
    uint8_t *buffer,
    size_t capacity,
    uint32_t *sequences,
    size_t sequence_count)
{
    (void)memset(decoder, 0, sizeof *decoder);
    if (link->stream == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (capacity < ICDGEN_SIZE(link->stream->header_bytes) + link->stream->trailer_bytes) {
        return ICD_ERROR_LENGTH;
    }
    decoder->link = link;
    decoder->form = link->stream;
    decoder->direction = direction;
    decoder->buffer = buffer;
    decoder->capacity = capacity < link->longest ? capacity : ICDGEN_SIZE(link->longest);
    decoder->sequences = sequences;
    decoder->sequence_count = sequence_count;
    for (size_t i = 0; i < sequence_count; ++i) {
        sequences[i] = ICDGEN_NO_SEQUENCE;
    }
    return ICD_OK;
}

/* Report missing sequence numbers. */
static inline void icdgen_stream_count(
    icd_stream_decoder_t *decoder, const icd_stream_row_t *row, uint32_t number, const icdgen_listener_t *listener)
{
    const icd_stream_form_t *const form = decoder->form;
    const icd_envelope_field_t *const field = icdgen_envelope_field(form, ICD_ENVELOPE_SEQUENCE);
    const size_t key = form->per_id ? ICDGEN_SIZE(row - form->rows[decoder->direction]) : 0u;
    if (field == NULL || key >= decoder->sequence_count) {
        return;
    }
    const uint32_t last = decoder->sequences[key];
    const uint32_t missing = (number - last - 1u) & icdgen_envelope_mask(field);
    decoder->sequences[key] = number;
    if (last != ICDGEN_NO_SEQUENCE && missing != 0u) {
        icd_stream_event_t event = icdgen_stream_event(ICD_STREAM_GAP);
        event.has_id = true;
        event.id = row->id;
        event.missing = number == last ? 0u : missing;
        listener->on_event(listener->context, &event);
    }
}

static inline void icdgen_stream_message(
    icd_stream_decoder_t *decoder,
    const icd_stream_row_t *row,
    const uint8_t *frame,
    size_t length,
    const icdgen_listener_t *listener)
{
    const icd_stream_form_t *const form = decoder->form;
    icd_stream_event_t event = icdgen_stream_event(ICD_STREAM_MESSAGE);
    event.has_id = true;
    event.id = row->id;
    event.data = frame + form->header_bytes;
    event.length = length;
    for (size_t i = 0; i < form->field_count; ++i) {
        const icd_envelope_field_t *const field = &form->fields[i];
        if (field->role < ICD_ENVELOPE_CONSTANT) {
            event.values.of[field->role] = icdgen_envelope_get(field, field->in_trailer ? event.data + length : frame);
        }
    }
    icdgen_stream_count(decoder, row, event.values.of[ICD_ENVELOPE_SEQUENCE], listener);
    listener->on_event(listener->context, &event);
}

/* Return whether the constants are correct in the received part of the header and, unless NULL, in the trailer. */
static inline bool icdgen_stream_constants(
    const icd_stream_decoder_t *decoder, const uint8_t *frame, size_t count, const uint8_t *trailer)
{
    const icd_stream_form_t *const form = decoder->form;
    for (size_t i = 0; i < form->field_count; ++i) {
        const icd_envelope_field_t *const field = &form->fields[i];
        const uint8_t *const bytes = field->in_trailer ? trailer : frame;
        const bool came = field->in_trailer ? trailer != NULL : ICDGEN_SIZE(field->at) + field->size <= count;
        if (field->role == ICD_ENVELOPE_CONSTANT && came &&
            icdgen_envelope_get(field, bytes) != field->values[decoder->direction]) {
            return false;
        }
    }
    return true;
}

/* Return the number of header bytes needed for the next check after `left` bytes: up to the next constant, or all. */
static inline size_t icdgen_stream_next(const icd_stream_form_t *form, size_t left)
{
    size_t next = form->header_bytes;
    for (size_t i = 0; i < form->field_count; ++i) {
        const icd_envelope_field_t *const field = &form->fields[i];
        const size_t end = ICDGEN_SIZE(field->at) + field->size;
        if (field->role == ICD_ENVELOPE_CONSTANT && !field->in_trailer && end > left && end < next) {
            next = end;
        }
    }
    return next;
}

/* Return the data length according to the length field; negative if it is invalid. */
static inline int64_t icdgen_stream_length(
    const icd_stream_form_t *form, const icd_envelope_field_t *field, const uint8_t *frame, const uint8_t *trailer)
{
    return ICDGEN_I64(icdgen_envelope_get(field, field->in_trailer ? trailer : frame)) - form->length_plus;
}

/* Report a frame. */
static inline icdgen_verdict_t icdgen_stream_judge(
    icd_stream_decoder_t *decoder, const uint8_t *frame, size_t count, const icdgen_listener_t *listener)
{
    const icd_stream_form_t *const form = decoder->form;
    const size_t around = ICDGEN_SIZE(form->header_bytes) + form->trailer_bytes;
    if (count < around) {
        icdgen_stream_tell(listener, ICD_STREAM_LENGTH);
        return ICDGEN_DOUBTFUL;
    }
    const size_t length = count - around;
    const uint8_t *const trailer = frame + form->header_bytes + length;
    if (!icdgen_stream_constants(decoder, frame, count, trailer)) {
        icdgen_stream_tell(listener, ICD_STREAM_FRAMING);
        return ICDGEN_DOUBTFUL;
    }
    const icd_envelope_field_t *field = icdgen_envelope_field(form, ICD_ENVELOPE_LENGTH);
    if (field != NULL && icdgen_stream_length(form, field, frame, trailer) != ICDGEN_I64(length)) {
        icdgen_stream_tell(listener, ICD_STREAM_LENGTH);
        return ICDGEN_DOUBTFUL;
    }
    field = icdgen_envelope_field(form, ICD_ENVELOPE_ID);
    uint32_t id = 0;
    if (field != NULL) {
        id = icdgen_envelope_get(field, field->in_trailer ? trailer : frame);
    } else if (form->row_counts[decoder->direction] != 0u) {
        id = form->rows[decoder->direction][0].id;
    } else {
        /* there is no message in this direction */
    }
    const icd_stream_row_t *const row = icdgen_stream_row(form, decoder->direction, id);
    field = icdgen_envelope_field(form, ICD_ENVELOPE_CHECKSUM);
    if (field != NULL && form->check != NULL) {
        if (form->check->is_seeded && row == NULL) {
            icdgen_stream_tell_of(listener, ICD_STREAM_UNKNOWN_ID, true, id);
            return ICDGEN_DOUBTFUL;
        }
        const uint32_t sum = icdgen_envelope_check(form, row, frame, frame + form->header_bytes, length, trailer);
        if (icdgen_envelope_get(field, field->in_trailer ? trailer : frame) != sum) {
            icdgen_stream_tell_of(listener, ICD_STREAM_CHECKSUM, true, id);
            return ICDGEN_DOUBTFUL;
        }
    }
    if (row == NULL) {
        icdgen_stream_tell_of(listener, ICD_STREAM_UNKNOWN_ID, true, id);
        return ICDGEN_PROVEN;
    }
    if (length < row->least || length > row->most) {
        icdgen_stream_tell_of(listener, ICD_STREAM_LENGTH, true, id);
        return ICDGEN_PROVEN;
    }
    icdgen_stream_message(decoder, row, frame, length, listener);
    return ICDGEN_TAKEN;
}

/* Check the buffer from `at` on. Return the number of bytes to advance; 0 if more bytes are needed. */
static inline size_t icdgen_stream_front(icd_stream_decoder_t *decoder, size_t at, const icdgen_listener_t *listener)
{
    const icd_stream_form_t *const form = decoder->form;
    const size_t left = decoder->length - at;
    const uint8_t *const frame = decoder->buffer + at;
    const icd_envelope_field_t *const field = icdgen_envelope_field(form, ICD_ENVELOPE_LENGTH);
    if (left != 0u && !icdgen_stream_constants(decoder, frame, left, NULL)) {
        decoder->discarded++;
        return 1;
    }
    if (left < form->header_bytes || field == NULL) {
        decoder->needed = icdgen_stream_next(form, left);
        return 0;
    }
    const int64_t length = icdgen_stream_length(form, field, frame, frame);
    const int64_t size = length + form->header_bytes + form->trailer_bytes;
    if (length < 0 || size > ICDGEN_I64(decoder->capacity)) {
        const bool fits = length >= 0 && size <= ICDGEN_I64(decoder->link->longest);
        icdgen_stream_tell(listener, fits ? ICD_STREAM_OVERRUN : ICD_STREAM_LENGTH);
        decoder->discarded++;
        return 1;
    }
    const size_t whole = ICDGEN_SIZE(size);
    if (left < whole) {
        decoder->needed = whole;
        return 0;
    }
    const icdgen_verdict_t verdict = icdgen_stream_judge(decoder, frame, whole, listener);
    const size_t taken = verdict == ICDGEN_DOUBTFUL ? 1u : whole;
    decoder->discarded += verdict == ICDGEN_TAKEN ? 0u : taken;
    return taken;
}

/* Process bytes of a stream with a length field. There is always room: a full buffer can always be decided. */
static inline void icdgen_stream_append(
    icd_stream_decoder_t *decoder, const uint8_t *bytes, size_t count, const icdgen_listener_t *listener)
{
    size_t taken = 0;
    while (taken < count) {
        const size_t wanted = decoder->needed > decoder->length ? decoder->needed - decoder->length : 1u;
        const size_t piece = wanted < (count - taken) ? wanted : (count - taken);
        (void)memcpy(decoder->buffer + decoder->length, bytes + taken, piece);
        decoder->length += piece;
        taken += piece;
        if (decoder->length >= decoder->needed) {
            size_t at = 0;
            size_t over;
            do {
                decoder->needed = 0;
                over = icdgen_stream_front(decoder, at, listener);
                at += over;
            } while (over != 0u);
            if (at != 0u) {
                decoder->length -= at;
                (void)memmove(decoder->buffer, decoder->buffer + at, decoder->length);
            }
        }
        decoder->pending = decoder->length;
    }
}

static inline void icdgen_stream_fail(icd_stream_decoder_t *decoder, icd_stream_kind_t fault)
{
    if (!decoder->faulty) {
        decoder->faulty = true;
        decoder->fault = fault;
    }
}

static inline void icdgen_stream_put(icd_stream_decoder_t *decoder, uint32_t byte)
{
    if (decoder->length < decoder->capacity) {
        decoder->buffer[decoder->length] = ICDGEN_U8(byte);
        decoder->length++;
    } else {
        icdgen_stream_fail(decoder, ICD_STREAM_OVERRUN);
    }
}

/* Process a byte of a frame between delimiters. */
static inline void icdgen_stream_inside(icd_stream_decoder_t *decoder, uint8_t byte)
{
    const icd_delimiter_t delimiter = decoder->form->delimited_by;
    const uint32_t escape = delimiter == ICD_DELIMITED_BY_SLIP ? ICDGEN_SLIP_ESCAPE : ICDGEN_HDLC_ESCAPE;
    if (delimiter == ICD_DELIMITED_BY_COBS && decoder->left != 0u) {
        decoder->left--;
        icdgen_stream_put(decoder, byte);
    } else if (delimiter == ICD_DELIMITED_BY_COBS) {
        if (decoder->zero) {
            icdgen_stream_put(decoder, 0);
        }
        decoder->left = ICDGEN_U8(byte - 1u);
        decoder->zero = byte != ICDGEN_COBS_WHOLE;
    } else if (decoder->escaped && delimiter == ICD_DELIMITED_BY_HDLC) {
        decoder->escaped = false;
        icdgen_stream_put(decoder, byte ^ ICDGEN_HDLC_FLIP);
    } else if (decoder->escaped) {
        decoder->escaped = false;
        if (byte == ICDGEN_SLIP_ESCAPED_END) {
            icdgen_stream_put(decoder, ICDGEN_SLIP_END);
        } else if (byte == ICDGEN_SLIP_ESCAPED_ESCAPE) {
            icdgen_stream_put(decoder, ICDGEN_SLIP_ESCAPE);
        } else {
            icdgen_stream_fail(decoder, ICD_STREAM_FRAMING);
        }
    } else if (byte == escape) {
        decoder->escaped = true;
    } else {
        icdgen_stream_put(decoder, byte);
    }
}

/* Process a delimiter. */
static inline void icdgen_stream_end(icd_stream_decoder_t *decoder, const icdgen_listener_t *listener)
{
    bool taken = false;
    if (decoder->escaped || decoder->left != 0u) {
        icdgen_stream_fail(decoder, ICD_STREAM_FRAMING);
    }
    if (decoder->faulty) {
        icdgen_stream_tell(listener, decoder->fault);
    } else if (decoder->length != 0u) {
        taken = icdgen_stream_judge(decoder, decoder->buffer, decoder->length, listener) == ICDGEN_TAKEN;
    } else {
        taken = true; /* empty frame between two delimiters */
    }
    decoder->discarded += taken ? 0u : decoder->pending;
    decoder->pending = 0;
    icdgen_stream_clear(decoder);
}

ICDGEN_API void icd_stream_feed(
    icd_stream_decoder_t *decoder, const uint8_t *bytes, size_t count, icd_stream_event_fn *on_event, void *context)
{
    const icd_delimiter_t delimiter = decoder->form->delimited_by;
    const icdgen_listener_t listener = {on_event, context};
    if (delimiter == ICD_DELIMITED_BY_PACKET) {
        if (count > decoder->capacity) {
            icdgen_stream_tell(&listener, ICD_STREAM_OVERRUN);
            decoder->discarded += count;
        } else if (icdgen_stream_judge(decoder, bytes, count, &listener) != ICDGEN_TAKEN) {
            decoder->discarded += count;
        } else {
            /* the frame was a message */
        }
        return;
    }
    const uint32_t end = delimiter == ICD_DELIMITED_BY_SLIP ? ICDGEN_SLIP_END
        : delimiter == ICD_DELIMITED_BY_HDLC                ? ICDGEN_HDLC_FLAG
                                                            : 0u;
    if (delimiter == ICD_DELIMITED_BY_LENGTH) {
        icdgen_stream_append(decoder, bytes, count, &listener);
        return;
    }
    for (size_t i = 0; i < count; ++i) {
        decoder->pending++;
        if (bytes[i] == end) {
            icdgen_stream_end(decoder, &listener);
        } else if (!decoder->faulty) {
            icdgen_stream_inside(decoder, bytes[i]);
        } else {
            /* all bytes up to the next delimiter are dropped */
        }
    }
}

#endif /* ICDGEN_WIRE_STREAM_DECODE_C */
