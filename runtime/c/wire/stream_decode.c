#ifndef ICDGEN_WIRE_STREAM_DECODE_C
#define ICDGEN_WIRE_STREAM_DECODE_C

#include "packet_fields.h"
#include "events.c"
#include "stream_encode.c"

/* Result of checking a frame: accepted; certainly a frame, but not usable; possibly not a frame. */
typedef enum { ICDGEN_TAKEN, ICDGEN_PROVEN, ICDGEN_DOUBTFUL } icdgen_verdict_t;

static inline void icdgen_stream_tell_of(
    const icdgen_listener_t *listener, icd_event_kind_t kind, bool has_id, uint32_t id)
{
    icd_event_t event;
    icdgen_event_init(&event, kind);
    event.has_id = has_id;
    event.id = id;
    icdgen_tell(listener, &event);
}

static inline void icdgen_stream_tell(const icdgen_listener_t *listener, icd_event_kind_t kind)
{
    icdgen_stream_tell_of(listener, kind, false, 0);
}

static inline void icdgen_stream_clear(icd_stream_decoder_t *decoder)
{
    decoder->length = 0;
    decoder->escaped = false;
    decoder->inside = false;
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
    const icd_stream_form_t *const form = link->stream;
    if (form == NULL || form->around[direction] < 0) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (capacity < ICDGEN_SIZE(form->around[direction])) {
        return ICD_ERROR_LENGTH;
    }
    decoder->link = link;
    decoder->form = form;
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

/* What a packet contains. */
typedef struct {
    icd_event_kind_t kind;       /* of its event; ICD_EVENT_UNKNOWN_ID if there is no message with its id */
    const icd_stream_row_t *row; /* the message, or the requested telemetry; otherwise NULL */
    size_t least;                /* bounds of the number of data bytes */
    size_t most;
} icdgen_incoming_t;

/* Set the bounds of a packet that contains telemetry without its id: those of all such telemetry. */
static inline void icdgen_incoming_bounds(const icd_stream_form_t *form, size_t packet, icdgen_incoming_t *incoming)
{
    incoming->least = SIZE_MAX;
    incoming->most = 0;
    for (size_t i = 0; i < form->row_counts[ICD_TELEMETRY]; ++i) {
        const icd_stream_row_t *const row = &form->rows[ICD_TELEMETRY][i];
        if (row->packet == packet) {
            incoming->least = row->least < incoming->least ? row->least : incoming->least;
            incoming->most = row->most > incoming->most ? row->most : incoming->most;
        }
    }
}

/* Return what a packet with this id contains. */
static inline icdgen_incoming_t icdgen_incoming(
    const icd_stream_decoder_t *decoder, const icd_packet_form_t *packet, uint32_t id)
{
    const icd_stream_form_t *const form = decoder->form;
    const size_t index = ICDGEN_SIZE(packet - form->packets);
    icdgen_incoming_t incoming = {ICD_EVENT_PACKET, NULL, packet->reserved, packet->reserved};
    if (ICDGEN_CONTAINS(packet, ICD_PACKET_NOTHING)) {
        return incoming;
    }
    if (ICDGEN_CONTAINS(packet, ICD_PACKET_REQUESTED)) {
        icdgen_incoming_bounds(form, index, &incoming);
        return incoming;
    }
    const icd_stream_row_t *row = icdgen_stream_row(form, decoder->direction, id);
    if (row != NULL && row->packet == index) {
        incoming.kind = ICD_EVENT_MESSAGE;
        incoming.row = row;
        incoming.least = row->least;
        incoming.most = row->most;
        return incoming;
    }
    incoming.kind = ICD_EVENT_UNKNOWN_ID;
    if (decoder->direction == ICD_TELECOMMAND && form->request != NULL && form->request->packet == index) {
        row = icdgen_stream_row(form, ICD_TELEMETRY, id);
        if (row != NULL && ICDGEN_HAS_FLAG(row, ICD_STREAM_REQUESTED)) {
            incoming.kind = ICD_EVENT_REQUEST;
            incoming.row = row;
        }
    }
    return incoming;
}

/* Report missing sequence numbers. `field`: field of the sequence number; NULL if the packet has none. */
static inline void icdgen_stream_count(
    icd_stream_decoder_t *decoder,
    const icdgen_incoming_t *incoming,
    const icd_packet_field_t *field,
    const icd_event_t *message,
    const icdgen_listener_t *listener)
{
    const icd_stream_form_t *const form = decoder->form;
    /* With a sequence for each id, other packets than messages have no counter. */
    if (field == NULL || (form->per_id && incoming->kind != ICD_EVENT_MESSAGE)) {
        return;
    }
    const size_t key = form->per_id ? ICDGEN_SIZE(incoming->row - form->rows[decoder->direction]) : 0u;
    if (key >= decoder->sequence_count) {
        return;
    }
    const uint32_t number = message->values.of[ICD_FIELD_SEQUENCE];
    const uint32_t last = decoder->sequences[key];
    const uint32_t missing = (number - last - 1u) & icdgen_field_mask(field);
    decoder->sequences[key] = number;
    if (last != ICDGEN_NO_SEQUENCE && missing != 0u) {
        icd_event_t event;
        icdgen_event_init(&event, ICD_EVENT_GAP);
        event.has_id = true;
        event.id = message->id;
        event.missing = number == last ? 0u : missing;
        icdgen_tell(listener, &event);
    }
}

/* Return whether the constants are correct in the received part of the header and, unless NULL, in the trailer. */
static inline bool icdgen_stream_constants(
    const icd_packet_form_t *packet,
    icd_direction_t direction,
    const uint8_t *frame,
    size_t count,
    const uint8_t *trailer)
{
    for (size_t i = 0; i < packet->field_count; ++i) {
        const icd_packet_field_t *const field = &packet->fields[i];
        const uint8_t *const bytes = field->in_trailer ? trailer : frame;
        const bool came = field->in_trailer ? trailer != NULL : ICDGEN_SIZE(field->at) + field->size <= count;
        if (ICDGEN_HAS_ROLE(field, ICD_FIELD_CONSTANT) && came &&
            icdgen_field_get(field, bytes) != field->values[direction]) {
            return false;
        }
    }
    return true;
}

/*
 * Return the first packet format that fits. `is_whole`: whether the bytes are a whole frame; if no format fits it,
 * return the first one, which tells the fault. Otherwise, constants that have not arrived may still be correct; return
 * NULL if no format fits.
 */
static inline const icd_packet_form_t *icdgen_stream_format(
    const icd_stream_decoder_t *decoder, const uint8_t *frame, size_t count, bool is_whole)
{
    const icd_packet_form_t *first = NULL;
    for (size_t i = 0; i < decoder->form->packet_count; ++i) {
        const icd_packet_form_t *const packet = &decoder->form->packets[i];
        if (packet->is_sent[decoder->direction]) {
            const bool fits = !is_whole || count >= icdgen_packet_around(packet);
            const uint8_t *const trailer = is_whole && fits ? frame + count - packet->trailer_bytes : NULL;
            if (fits && icdgen_stream_constants(packet, decoder->direction, frame, count, trailer)) {
                return packet;
            }
            first = is_whole && first == NULL ? packet : first;
        }
    }
    return first;
}

/* Return the number of header bytes needed for the next check after `left` bytes: up to the next constant, or all. */
static inline size_t icdgen_stream_next(const icd_packet_form_t *packet, size_t left)
{
    size_t next = packet->header_bytes;
    for (size_t i = 0; i < packet->field_count; ++i) {
        const icd_packet_field_t *const field = &packet->fields[i];
        const size_t end = ICDGEN_SIZE(field->at) + field->size;
        if (ICDGEN_HAS_ROLE(field, ICD_FIELD_CONSTANT) && !field->in_trailer && end > left && end < next) {
            next = end;
        }
    }
    return next;
}

/* Report a frame, which has at least the bytes of header and trailer. */
static inline icdgen_verdict_t icdgen_stream_judge(
    icd_stream_decoder_t *decoder,
    const icd_packet_form_t *packet,
    const uint8_t *frame,
    size_t count,
    const icdgen_listener_t *listener)
{
    const size_t length = count - icdgen_packet_around(packet);
    const uint8_t *const data = frame + packet->header_bytes;
    const uint8_t *const trailer = data + length;
    const icd_packet_field_t *sequence = NULL;
    icdgen_length_t wanted = -1; /* number of bytes of the requested telemetry, if the request says it */
    uint32_t sum = 0;
    bool is_framed = true;
    bool is_long = true; /* whether each length is right */
    icd_event_t event;
    icdgen_event_init(&event, ICD_EVENT_MESSAGE);
    event.id = packet->ids[decoder->direction];
    for (size_t i = 0; i < packet->field_count; ++i) {
        const icd_packet_field_t *const field = &packet->fields[i];
        const uint32_t value = icdgen_field_get(field, field->in_trailer ? trailer : frame);
        if (ICDGEN_HAS_ROLE(field, ICD_FIELD_CONSTANT)) {
            is_framed = is_framed && value == field->values[decoder->direction];
        } else if (ICDGEN_HAS_ROLE(field, ICD_FIELD_ID)) {
            event.id |= value << field->values[0];
        } else if (ICDGEN_HAS_ROLE(field, ICD_FIELD_LENGTH)) {
            is_long = is_long && icdgen_field_bytes(field, value) == ICDGEN_LENGTH(length);
        } else if (ICDGEN_HAS_ROLE(field, ICD_FIELD_RESPONSE_LENGTH)) {
            wanted = icdgen_field_bytes(field, value);
        } else if (ICDGEN_HAS_ROLE(field, ICD_FIELD_CHECKSUM)) {
            sum = value;
        } else if (ICDGEN_IS_OF_SENDER(field)) {
            sequence = ICDGEN_HAS_ROLE(field, ICD_FIELD_SEQUENCE) ? field : sequence;
            event.values.of[field->role] = value;
        } else {
            /* there are no other roles */
        }
    }
    if (!is_framed || !is_long) {
        icdgen_event_init(&event, is_framed ? ICD_EVENT_LENGTH : ICD_EVENT_FRAMING);
        icdgen_tell(listener, &event);
        return ICDGEN_DOUBTFUL;
    }
    const icdgen_incoming_t incoming = icdgen_incoming(decoder, packet, event.id);
    icdgen_verdict_t verdict = ICDGEN_PROVEN;
    event.kind = incoming.kind;
    if (packet->check != NULL) {
        if (packet->check->is_seeded && incoming.kind == ICD_EVENT_UNKNOWN_ID) {
            verdict = ICDGEN_DOUBTFUL;
        } else if (icdgen_packet_checksum(packet, incoming.row, frame, data, length, trailer) != sum) {
            event.kind = ICD_EVENT_CHECKSUM;
            verdict = ICDGEN_DOUBTFUL;
        } else {
            /* the checksum is correct */
        }
    }
    if (verdict == ICDGEN_PROVEN && event.kind != ICD_EVENT_UNKNOWN_ID &&
        (length < incoming.least || length > incoming.most ||
         (incoming.kind == ICD_EVENT_REQUEST && wanted >= 0 && wanted != ICDGEN_LENGTH(incoming.row->most)))) {
        event.kind = ICD_EVENT_LENGTH;
    }
    event.has_id = true;
    event.packet = ICDGEN_U8(packet - decoder->form->packets);
    event.header = frame;
    event.is_request = event.kind == ICD_EVENT_REQUEST || ICDGEN_CONTAINS(packet, ICD_PACKET_REQUEST);
    if (event.kind != incoming.kind || event.kind == ICD_EVENT_UNKNOWN_ID) {
        icdgen_tell(listener, &event);
        return verdict;
    }
    event.is_packet = incoming.kind == ICD_EVENT_PACKET;
    event.data = event.is_packet ? frame : data;
    event.length = event.is_packet ? count : length;
    icdgen_stream_count(decoder, &incoming, sequence, &event, listener);
    icdgen_tell(listener, &event);
    return ICDGEN_TAKEN;
}

/* Report a frame that is delimited on both sides. Return whether it is correct. */
static inline bool icdgen_stream_frame(
    icd_stream_decoder_t *decoder, const uint8_t *frame, size_t count, const icdgen_listener_t *listener)
{
    const icd_packet_form_t *const packet = icdgen_stream_format(decoder, frame, count, true);
    if (count < icdgen_packet_around(packet)) {
        icdgen_stream_tell(listener, ICD_EVENT_LENGTH);
        return false;
    }
    return icdgen_stream_judge(decoder, packet, frame, count, listener) == ICDGEN_TAKEN;
}

/* Drop the first byte. Return the number of bytes to advance. */
static inline size_t icdgen_stream_skip(icd_stream_decoder_t *decoder)
{
    decoder->discarded++;
    return 1;
}

/* Check the next `left` bytes. Return the number of bytes to advance; 0 if `decoder->needed` bytes are needed. */
static inline size_t icdgen_stream_front(
    icd_stream_decoder_t *decoder, const uint8_t *frame, size_t left, const icdgen_listener_t *listener)
{
    const icd_packet_form_t *const packet = icdgen_stream_format(decoder, frame, left, false);
    if (packet == NULL) {
        return icdgen_stream_skip(decoder);
    }
    if (left < packet->header_bytes) {
        decoder->needed = icdgen_stream_next(packet, left);
        return 0;
    }
    const icd_packet_field_t *const field = ICDGEN_FIELD(packet, ICD_FIELD_LENGTH);
    icd_event_kind_t fault = ICD_EVENT_MESSAGE; /* none */
    uint32_t id = 0;
    icdgen_length_t length;
    if (field != NULL) {
        length = icdgen_field_bytes(field, icdgen_field_get(field, frame));
    } else {
        id = icdgen_packet_id(packet, decoder->direction, frame);
        const icdgen_incoming_t incoming = icdgen_incoming(decoder, packet, id);
        if (incoming.kind == ICD_EVENT_UNKNOWN_ID && ICDGEN_CONTAINS(packet, ICD_PACKET_MESSAGE)) {
            fault = ICD_EVENT_UNKNOWN_ID;
        }
        length = ICDGEN_LENGTH(incoming.most);
    }
    const icdgen_length_t size = length + ICDGEN_LENGTH(icdgen_packet_around(packet));
    if (fault == ICD_EVENT_MESSAGE && (length < 0 || size > ICDGEN_LENGTH(decoder->capacity))) {
        const bool fits = length >= 0 && size <= ICDGEN_LENGTH(decoder->link->longest);
        fault = fits ? ICD_EVENT_OVERRUN : ICD_EVENT_LENGTH;
    }
    if (fault != ICD_EVENT_MESSAGE) {
        icdgen_stream_tell_of(listener, fault, fault == ICD_EVENT_UNKNOWN_ID, id);
        return icdgen_stream_skip(decoder);
    }
    const size_t whole = ICDGEN_SIZE(size);
    if (left < whole) {
        decoder->needed = whole;
        return 0;
    }
    const icdgen_verdict_t verdict = icdgen_stream_judge(decoder, packet, frame, whole, listener);
    const size_t taken = verdict == ICDGEN_DOUBTFUL ? 1u : whole;
    decoder->discarded += ICDGEN_U32(verdict == ICDGEN_TAKEN ? 0u : taken);
    return taken;
}

/* Check bytes from the first one on. Return the number of decided ones; the others may become part of a message. */
static inline size_t icdgen_stream_decide(
    icd_stream_decoder_t *decoder, const uint8_t *bytes, size_t count, const icdgen_listener_t *listener)
{
    size_t decided = 0;
    size_t over;
    do {
        decoder->needed = 0;
        over = icdgen_stream_front(decoder, bytes + decided, count - decided, listener);
        decided += over;
    } while (over != 0u);
    return decided;
}

/* Process bytes of a stream without delimiters. There is always room: a full buffer can always be decided. */
static inline void icdgen_stream_append(
    icd_stream_decoder_t *decoder, const uint8_t *bytes, size_t count, const icdgen_listener_t *listener)
{
    size_t taken = 0;
    while (taken < count) {
        if (decoder->length == 0u) { /* whole messages need not be copied */
            taken += icdgen_stream_decide(decoder, bytes + taken, count - taken, listener);
        }
        while (taken < count && decoder->length < decoder->needed) {
            decoder->buffer[decoder->length] = bytes[taken];
            decoder->length++;
            taken++;
        }
        if (decoder->length >= decoder->needed) {
            const size_t decided = icdgen_stream_decide(decoder, decoder->buffer, decoder->length, listener);
            decoder->length -= decided;
            (void)memmove(decoder->buffer, decoder->buffer + decided, decoder->length);
        }
        decoder->pending = decoder->length;
    }
}

static inline void icdgen_stream_fail(icd_stream_decoder_t *decoder, icd_event_kind_t fault)
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
        icdgen_stream_fail(decoder, ICD_EVENT_OVERRUN);
    }
}

/* Process a byte of a frame between delimiters. */
static inline void icdgen_stream_inside(icd_stream_decoder_t *decoder, uint8_t byte)
{
    const icd_stream_form_t *const form = decoder->form;
    const uint32_t escape =
        ICDGEN_IS_DELIMITED_BY(form, ICD_DELIMITED_BY_SLIP) ? ICDGEN_SLIP_ESCAPE : ICDGEN_HDLC_ESCAPE;
    if (ICDGEN_IS_DELIMITED_BY(form, ICD_DELIMITED_BY_COBS) && decoder->left != 0u) {
        decoder->left--;
        icdgen_stream_put(decoder, byte);
    } else if (ICDGEN_IS_DELIMITED_BY(form, ICD_DELIMITED_BY_COBS)) {
        if (decoder->zero) {
            icdgen_stream_put(decoder, 0);
        }
        decoder->left = ICDGEN_U8(byte - 1u);
        decoder->zero = byte != ICDGEN_COBS_WHOLE;
    } else if (decoder->escaped && ICDGEN_IS_DELIMITED_BY(form, ICD_DELIMITED_BY_HDLC)) {
        decoder->escaped = false;
        icdgen_stream_put(decoder, byte ^ ICDGEN_HDLC_FLIP);
    } else if (decoder->escaped) {
        decoder->escaped = false;
        if (byte == ICDGEN_SLIP_ESCAPED_END) {
            icdgen_stream_put(decoder, ICDGEN_SLIP_END);
        } else if (byte == ICDGEN_SLIP_ESCAPED_ESCAPE) {
            icdgen_stream_put(decoder, ICDGEN_SLIP_ESCAPE);
        } else {
            icdgen_stream_fail(decoder, ICD_EVENT_FRAMING);
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
        icdgen_stream_fail(decoder, ICD_EVENT_FRAMING);
    }
    if (decoder->faulty) {
        icdgen_stream_tell(listener, decoder->fault);
    } else if (decoder->length != 0u || decoder->inside) {
        taken = icdgen_stream_frame(decoder, decoder->buffer, decoder->length, listener);
    } else {
        taken = true; /* empty frame between two delimiters */
    }
    decoder->discarded += ICDGEN_U32(taken ? 0u : decoder->pending);
    decoder->pending = 0;
    icdgen_stream_clear(decoder);
}

/* Process bytes between two escape bytes. */
static inline void icdgen_stream_plain(icd_stream_decoder_t *decoder, const uint8_t *bytes, size_t count)
{
    if (!decoder->inside) {
        decoder->discarded += ICDGEN_U32(count);
        return;
    }
    decoder->pending += count;
    if (!decoder->faulty) {
        const size_t room = decoder->capacity - decoder->length;
        const size_t piece = count < room ? count : room;
        (void)memcpy(decoder->buffer + decoder->length, bytes, piece);
        decoder->length += piece;
        if (piece < count) {
            icdgen_stream_fail(decoder, ICD_EVENT_OVERRUN);
        }
    }
}

/* Return whether a byte that follows the escape byte begins a packet. */
static inline bool icdgen_stream_begins(const icd_escaping_t *escaping, uint8_t byte)
{
    if (escaping->has_start) {
        return byte == escaping->start;
    }
    return byte != escaping->escape && byte != escaping->end && byte != escaping->data;
}

/* Process the byte after an escape byte. */
static inline void icdgen_stream_escaped(icd_stream_decoder_t *decoder, uint8_t byte, const icdgen_listener_t *listener)
{
    const icd_escaping_t *const escaping = decoder->form->escaping;
    decoder->escaped = false;
    decoder->pending++;
    if (icdgen_stream_begins(escaping, byte)) {
        if (decoder->inside) { /* the end of the packet before was lost */
            decoder->pending -= 2u;
            icdgen_stream_fail(decoder, ICD_EVENT_FRAMING);
            icdgen_stream_end(decoder, listener);
        }
        decoder->inside = true;
        decoder->pending = 2;
        if (!escaping->has_start) {
            icdgen_stream_put(decoder, byte);
        }
    } else if (!decoder->inside) {
        /* The last one of several escape bytes can begin a packet. */
        decoder->escaped = byte == escaping->escape;
        decoder->pending = decoder->escaped ? 1u : 0u;
        decoder->discarded += ICDGEN_U32(2u - decoder->pending);
    } else if (byte == escaping->end) {
        icdgen_stream_end(decoder, listener);
    } else if (byte == escaping->data) {
        if (!decoder->faulty) {
            icdgen_stream_put(decoder, escaping->escape);
        }
    } else if (!escaping->ignores_other) {
        icdgen_stream_fail(decoder, ICD_EVENT_FRAMING);
        decoder->escaped = byte == escaping->escape;
    } else {
        /* both bytes are ignored */
    }
}

/* Process bytes of a stream with escape characters. */
static inline void icdgen_stream_unescape(
    icd_stream_decoder_t *decoder, const uint8_t *bytes, size_t count, const icdgen_listener_t *listener)
{
    const uint8_t escape = decoder->form->escaping->escape;
    size_t at = 0;
    while (at < count) {
        if (decoder->escaped) {
            icdgen_stream_escaped(decoder, bytes[at], listener);
            at++;
        } else {
            size_t end = at;
            while (end < count && bytes[end] != escape) {
                end++;
            }
            icdgen_stream_plain(decoder, bytes + at, end - at);
            at = end;
            if (end < count) {
                decoder->escaped = true;
                decoder->pending++;
                at++;
            }
        }
    }
}

static inline void icdgen_stream_feed(
    icd_stream_decoder_t *decoder, const uint8_t *bytes, size_t count, const icdgen_listener_t *listener)
{
    const icd_stream_form_t *const form = decoder->form;
    if (ICDGEN_IS_DELIMITED_BY(form, ICD_DELIMITED_BY_DATAGRAM)) {
        if (count > decoder->capacity) {
            icdgen_stream_tell(listener, ICD_EVENT_OVERRUN);
            decoder->discarded += ICDGEN_U32(count);
        } else if (!icdgen_stream_frame(decoder, bytes, count, listener)) {
            decoder->discarded += ICDGEN_U32(count);
        } else {
            /* the frame was a message */
        }
        return;
    }
    const uint32_t end = ICDGEN_IS_DELIMITED_BY(form, ICD_DELIMITED_BY_SLIP) ? ICDGEN_SLIP_END
        : ICDGEN_IS_DELIMITED_BY(form, ICD_DELIMITED_BY_HDLC)                ? ICDGEN_HDLC_FLAG
                                                                             : 0u;
    if (ICDGEN_IS_DELIMITED_BY(form, ICD_DELIMITED_BY_LENGTH)) {
        icdgen_stream_append(decoder, bytes, count, listener);
        return;
    }
    if (ICDGEN_IS_DELIMITED_BY(form, ICD_DELIMITED_BY_ESCAPE)) {
        icdgen_stream_unescape(decoder, bytes, count, listener);
        return;
    }
    for (size_t i = 0; i < count; ++i) {
        decoder->pending++;
        if (bytes[i] == end) {
            icdgen_stream_end(decoder, listener);
        } else if (!decoder->faulty) {
            icdgen_stream_inside(decoder, bytes[i]);
        } else {
            /* all bytes up to the next delimiter are dropped */
        }
    }
}

ICDGEN_API void icd_stream_feed(
    icd_stream_decoder_t *decoder, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context)
{
    const icdgen_caller_t caller = {on_event, context};
    const icdgen_listener_t listener = {icdgen_tell_caller, &caller};
    icdgen_stream_feed(decoder, bytes, count, &listener);
}

#endif /* ICDGEN_WIRE_STREAM_DECODE_C */
