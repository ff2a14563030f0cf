#ifndef ICDGEN_WIRE_UART_C
#define ICDGEN_WIRE_UART_C

#include "uart.h"
#include "events.c"

ICDGEN_API icd_status_t
icd_uart_encode_begin(icd_uart_encoder_t *encoder, const icd_link_t *link, const uint8_t *message, size_t length)
{
    (void)memset(encoder, 0, sizeof *encoder);
    encoder->ended = true;
    if (link->framing == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (length == 0u) {
        return ICD_ERROR_LENGTH;
    }
    encoder->framing = link->framing;
    encoder->message = message;
    encoder->length = length;
    encoder->next[0] = link->framing->start;
    encoder->next[1] = link->framing->escape;
    encoder->pending = 2;
    encoder->ended = false;
    return ICD_OK;
}

ICDGEN_API size_t icd_uart_encode_some(icd_uart_encoder_t *encoder, uint8_t *buffer, size_t capacity)
{
    const icd_framing_t *const framing = encoder->framing;
    size_t count = 0;
    while (count < capacity) {
        if (encoder->pending != 0u) {
            encoder->pending--;
            buffer[count] = encoder->next[encoder->pending];
            count++;
        } else if (encoder->at < encoder->length) {
            const uint8_t byte = encoder->message[encoder->at];
            if (byte == framing->escape && (encoder->at != 0u || framing->escapes_id)) {
                encoder->next[0] = framing->escaped;
                encoder->pending = 1;
            }
            buffer[count] = byte;
            count++;
            encoder->at++;
        } else if (!encoder->ended) {
            encoder->next[0] = framing->end;
            encoder->next[1] = framing->escape;
            encoder->pending = 2;
            encoder->ended = true;
        } else {
            break;
        }
    }
    return count;
}

ICDGEN_API icd_status_t icd_uart_encode(
    const icd_link_t *link, const uint8_t *message, size_t length, uint8_t *buffer, size_t capacity, size_t *written)
{
    icd_uart_encoder_t encoder;
    uint8_t more;
    const icd_status_t status = icd_uart_encode_begin(&encoder, link, message, length);
    if (status != ICD_OK) {
        return status;
    }
    *written = icd_uart_encode_some(&encoder, buffer, capacity);
    return icd_uart_encode_some(&encoder, &more, 1) == 0u ? ICD_OK : ICD_ERROR_LENGTH;
}

ICDGEN_API icd_status_t
icd_uart_decoder_init(icd_uart_decoder_t *decoder, const icd_link_t *link, uint8_t *buffer, size_t capacity)
{
    (void)memset(decoder, 0, sizeof *decoder);
    if (link->framing == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    decoder->framing = link->framing;
    decoder->buffer = buffer;
    decoder->capacity = capacity;
    return ICD_OK;
}

#define ICDGEN_UART_KEEPS_ALL 3u

/*
 * Drop all bytes except the last `kept` ones: the two bytes of a start sequence, after which a message begins, or a
 * single escape byte, which may start one.
 */
static inline void icdgen_uart_drop(icd_uart_decoder_t *decoder, size_t kept)
{
    decoder->discarded += ICDGEN_U32(decoder->pending - kept);
    decoder->pending = kept;
    decoder->inside = kept == 2u;
    decoder->escaped = kept == 1u;
    decoder->length = 0;
}

/* Process a byte outside a message. Return the number of bytes to keep. */
static inline size_t icdgen_uart_outside(const icd_uart_decoder_t *decoder, uint8_t byte)
{
    if (decoder->escaped && byte == decoder->framing->start) {
        return 2;
    }
    return byte == decoder->framing->escape ? 1u : 0u;
}

/* Process a control byte: the byte after an escape byte. See icdgen_uart_inside(). */
static inline size_t icdgen_uart_control(const icd_uart_decoder_t *decoder, uint8_t byte, icd_event_kind_t *kind)
{
    const icd_framing_t *const framing = decoder->framing;
    if (byte == framing->end) {
        *kind = decoder->length != 0u ? ICD_EVENT_MESSAGE : ICD_EVENT_EMPTY;
        return 0;
    }
    if (byte == framing->start) {
        *kind = ICD_EVENT_UNEXPECTED_START;
        return 2;
    }
    if (framing->ignores_other) {
        return ICDGEN_UART_KEEPS_ALL;
    }
    *kind = ICD_EVENT_PROTOCOL_ERROR;
    return byte == framing->escape ? 1u : 0u;
}

/* Process a byte within a message. Return the number of bytes to keep. If not all, there is an event of this kind. */
static inline size_t icdgen_uart_inside(icd_uart_decoder_t *decoder, uint8_t byte, icd_event_kind_t *kind)
{
    const icd_framing_t *const framing = decoder->framing;
    const bool escaped = decoder->escaped;
    decoder->escaped = !escaped && byte == framing->escape && (decoder->length != 0u || framing->escapes_id);
    if (decoder->escaped) {
        return ICDGEN_UART_KEEPS_ALL;
    }
    if (escaped && byte != framing->escaped) {
        return icdgen_uart_control(decoder, byte, kind);
    }
    if (decoder->length < decoder->capacity) {
        decoder->buffer[decoder->length] = escaped ? framing->escape : byte;
        decoder->length++;
        return ICDGEN_UART_KEEPS_ALL;
    }
    *kind = ICD_EVENT_OVERRUN;
    return 0;
}

static inline void icdgen_uart_feed(
    icd_uart_decoder_t *decoder, const uint8_t *bytes, size_t count, const icdgen_listener_t *listener)
{
    for (size_t i = 0; i < count; ++i) {
        const bool inside = decoder->inside;
        icd_event_kind_t kind = ICD_EVENT_MESSAGE;
        decoder->pending++;
        const size_t kept =
            inside ? icdgen_uart_inside(decoder, bytes[i], &kind) : icdgen_uart_outside(decoder, bytes[i]);
        if (kept != ICDGEN_UART_KEEPS_ALL) {
            const size_t length = decoder->length;
            const bool is_message = inside && kind == ICD_EVENT_MESSAGE;
            decoder->pending = is_message ? 0u : decoder->pending;
            icdgen_uart_drop(decoder, kept);
            if (inside) {
                icd_event_t event;
                icdgen_event_init(&event, kind);
                if (is_message) {
                    event.has_id = true;
                    event.id = decoder->buffer[0];
                    event.data = decoder->buffer;
                    event.length = length;
                }
                icdgen_tell(listener, &event);
            }
        }
    }
}

ICDGEN_API void icd_uart_feed(
    icd_uart_decoder_t *decoder, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context)
{
    const icdgen_caller_t caller = {on_event, context};
    const icdgen_listener_t listener = {icdgen_tell_caller, &caller};
    icdgen_uart_feed(decoder, bytes, count, &listener);
}

/* Return the number of slots that a mask selects. */
static inline size_t icdgen_log_slots(const uint8_t *mask, size_t size)
{
    size_t count = 0;
    for (size_t i = 0; i < size; ++i) {
        for (unsigned bits = mask[i]; bits != 0u; bits &= bits - 1u) {
            count++;
        }
    }
    return count;
}

/* Return what an unsolicited message contains; NULL if it is none. */
static inline const icd_unsolicited_t *icdgen_unsolicited(const icd_link_t *link, const uint8_t *message, size_t length)
{
    for (size_t i = 0; i < link->unsolicited_count; ++i) {
        const icd_unsolicited_t *const row = &link->unsolicited[i];
        if (row->id == message[0] && length == 1u + ICDGEN_SIZE(row->length)) {
            return row;
        }
    }
    return NULL;
}

/* Return the kind of a message, and what it contains if it is ICD_UART_ARRIVED. */
static inline icd_uart_kind_t icdgen_uart_kind(
    const icd_link_t *link, const uint8_t *message, size_t length, const icd_unsolicited_t **contained)
{
    const uint8_t id = message[0];
    const icd_log_message_form_t *const log = ICDGEN_OF_LOGS(link->log_message);
    if (log != NULL && id == log->id) {
        const bool has_mask = length >= ICDGEN_SIZE(log->mask_at) + log->mask_bytes;
        const size_t slots = has_mask ? icdgen_log_slots(message + log->mask_at, log->mask_bytes) : 0u;
        return has_mask && length == log->frames_at + (slots * log->slot_bytes) ? ICD_UART_LOG : ICD_UART_OTHER;
    }
    if (id >= link->telemetry_first && id <= link->telemetry_last) {
        return ICD_UART_REPLY;
    }
    if (length > 0u && length == link->acknowledge_bytes) {
        return ICD_UART_ACKNOWLEDGE;
    }
    *contained = icdgen_unsolicited(link, message, length);
    return *contained != NULL ? ICD_UART_ARRIVED : ICD_UART_OTHER;
}

ICDGEN_API icd_uart_kind_t icd_uart_kind(const icd_link_t *link, const uint8_t *message, size_t length)
{
    const icd_unsolicited_t *contained;
    return icdgen_uart_kind(link, message, length, &contained);
}

#endif /* ICDGEN_WIRE_UART_C */
