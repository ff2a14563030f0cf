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

static inline void icdgen_uart_start(icd_uart_decoder_t *decoder)
{
    decoder->discarded += ICDGEN_U32(decoder->pending - 2u); /* all except the two bytes of the start sequence */
    decoder->pending = 2;
    decoder->inside = true;
    decoder->escaped = false;
    decoder->length = 0;
}

/* Drop bytes that are not part of a message. A final escape byte is kept because it may start one. */
static inline void icdgen_uart_outside(icd_uart_decoder_t *decoder, bool escaped)
{
    decoder->discarded += ICDGEN_U32(decoder->pending - (escaped ? 1u : 0u));
    decoder->pending = escaped ? 1u : 0u;
    decoder->inside = false;
    decoder->escaped = escaped;
    decoder->length = 0;
}

/* Process a byte of a message. Return whether there is an event, and set its kind. */
static inline bool icdgen_uart_data(icd_uart_decoder_t *decoder, uint8_t byte, icd_event_kind_t *kind)
{
    if (decoder->length < decoder->capacity) {
        decoder->buffer[decoder->length] = byte;
        decoder->length++;
        return false;
    }
    *kind = ICD_EVENT_OVERRUN;
    icdgen_uart_outside(decoder, false);
    return true;
}

/* Process the byte after an escape byte within a message. Return whether there is an event, and set its kind. */
static inline bool icdgen_uart_escaped(icd_uart_decoder_t *decoder, uint8_t byte, icd_event_kind_t *kind)
{
    const icd_framing_t *const framing = decoder->framing;
    decoder->escaped = false;
    if (byte == framing->escaped) {
        return icdgen_uart_data(decoder, framing->escape, kind);
    }
    if (byte == framing->start) {
        *kind = ICD_EVENT_UNEXPECTED_START;
        icdgen_uart_start(decoder);
    } else if (byte == framing->end) {
        *kind = decoder->length != 0u ? ICD_EVENT_MESSAGE : ICD_EVENT_EMPTY;
        decoder->pending = decoder->length != 0u ? 0u : decoder->pending;
        icdgen_uart_outside(decoder, false);
    } else if (!framing->ignores_other) {
        *kind = ICD_EVENT_PROTOCOL_ERROR;
        icdgen_uart_outside(decoder, byte == framing->escape);
    } else {
        return false; /* both bytes are skipped */
    }
    return true;
}

/* Process a byte. Return whether there is an event, and set its kind. */
static inline bool icdgen_uart_byte(icd_uart_decoder_t *decoder, uint8_t byte, icd_event_kind_t *kind)
{
    const icd_framing_t *const framing = decoder->framing;
    decoder->pending++;
    if (!decoder->inside) {
        if (decoder->escaped && byte == framing->start) {
            icdgen_uart_start(decoder);
        } else {
            icdgen_uart_outside(decoder, byte == framing->escape);
        }
    } else if (decoder->escaped) {
        return icdgen_uart_escaped(decoder, byte, kind);
    } else if (byte == framing->escape && (decoder->length != 0u || framing->escapes_id)) {
        decoder->escaped = true;
    } else {
        return icdgen_uart_data(decoder, byte, kind);
    }
    return false;
}

static inline void icdgen_uart_feed(
    icd_uart_decoder_t *decoder, const uint8_t *bytes, size_t count, const icdgen_listener_t *listener)
{
    for (size_t i = 0; i < count; ++i) {
        const size_t length = decoder->length;
        icd_event_kind_t kind = ICD_EVENT_MESSAGE;
        if (icdgen_uart_byte(decoder, bytes[i], &kind)) {
            icd_event_t event;
            icdgen_event_init(&event, kind);
            if (kind == ICD_EVENT_MESSAGE) {
                event.has_id = true;
                event.id = decoder->buffer[0];
                event.data = decoder->buffer;
                event.length = length;
            }
            icdgen_tell(listener, &event);
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

ICDGEN_API icd_uart_kind_t icd_uart_kind(const icd_link_t *link, const uint8_t *message, size_t length)
{
    const uint8_t id = message[0];
    const icd_log_message_form_t *const log = link->log_message;
    if (log != NULL && id == log->id) {
        const bool has_mask = length >= ICDGEN_SIZE(log->mask_at) + log->mask_bytes;
        const size_t slots = has_mask ? icdgen_log_slots(message + log->mask_at, log->mask_bytes) : 0u;
        return has_mask && length == log->frames_at + (slots * log->slot_bytes) ? ICD_UART_LOG : ICD_UART_OTHER;
    }
    if (id >= link->telemetry_first && id <= link->telemetry_last) {
        return ICD_UART_REPLY;
    }
    if (link->acknowledge != NULL && length == link->acknowledge->length) {
        return ICD_UART_ACKNOWLEDGE;
    }
    return icdgen_unsolicited(link, message, length) != NULL ? ICD_UART_ARRIVED : ICD_UART_OTHER;
}

#endif /* ICDGEN_WIRE_UART_C */
