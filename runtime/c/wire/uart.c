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
    decoder->discarded += decoder->pending - 2u; /* all except the two bytes of the start sequence */
    decoder->pending = 2;
    decoder->inside = true;
    decoder->escaped = false;
    decoder->length = 0;
}

/* Drop bytes that are not part of a message. A final escape byte is kept because it may start one. */
static inline void icdgen_uart_outside(icd_uart_decoder_t *decoder, bool escaped)
{
    decoder->discarded += decoder->pending - (escaped ? 1u : 0u);
    decoder->pending = escaped ? 1u : 0u;
    decoder->inside = false;
    decoder->escaped = escaped;
    decoder->length = 0;
}

static inline void icdgen_uart_tell(
    const icd_uart_decoder_t *decoder, icd_event_kind_t kind, icd_event_fn *on_event, void *context)
{
    icd_event_t event = icdgen_event(kind);
    if (kind == ICD_EVENT_MESSAGE) {
        event.has_id = true;
        event.id = decoder->buffer[0];
        event.data = decoder->buffer;
        event.length = decoder->length;
    }
    on_event(context, &event);
}

static inline void icdgen_uart_data(icd_uart_decoder_t *decoder, uint8_t byte, icd_event_fn *on_event, void *context)
{
    if (decoder->length < decoder->capacity) {
        decoder->buffer[decoder->length] = byte;
        decoder->length++;
    } else {
        icdgen_uart_tell(decoder, ICD_EVENT_OVERRUN, on_event, context);
        icdgen_uart_outside(decoder, false);
    }
}

static inline void icdgen_uart_end(icd_uart_decoder_t *decoder, icd_event_fn *on_event, void *context)
{
    if (decoder->length != 0u) {
        icdgen_uart_tell(decoder, ICD_EVENT_MESSAGE, on_event, context);
        decoder->pending = 0;
    } else {
        icdgen_uart_tell(decoder, ICD_EVENT_EMPTY, on_event, context);
    }
    icdgen_uart_outside(decoder, false);
}

/* Process the byte after an escape byte within a message. */
static inline void icdgen_uart_escaped(icd_uart_decoder_t *decoder, uint8_t byte, icd_event_fn *on_event, void *context)
{
    const icd_framing_t *const framing = decoder->framing;
    decoder->escaped = false;
    if (byte == framing->start) {
        icdgen_uart_tell(decoder, ICD_EVENT_UNEXPECTED_START, on_event, context);
        icdgen_uart_start(decoder);
    } else if (byte == framing->end) {
        icdgen_uart_end(decoder, on_event, context);
    } else if (byte == framing->escaped) {
        icdgen_uart_data(decoder, framing->escape, on_event, context);
    } else if (!framing->ignores_other) {
        icdgen_uart_tell(decoder, ICD_EVENT_PROTOCOL_ERROR, on_event, context);
        icdgen_uart_outside(decoder, byte == framing->escape);
    } else {
        /* both bytes are skipped */
    }
}

ICDGEN_API void icd_uart_feed(
    icd_uart_decoder_t *decoder, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context)
{
    const icd_framing_t *const framing = decoder->framing;
    for (size_t i = 0; i < count; ++i) {
        const uint8_t byte = bytes[i];
        decoder->pending++;
        if (!decoder->inside) {
            if (decoder->escaped && byte == framing->start) {
                icdgen_uart_start(decoder);
            } else {
                icdgen_uart_outside(decoder, byte == framing->escape);
            }
        } else if (decoder->escaped) {
            icdgen_uart_escaped(decoder, byte, on_event, context);
        } else if (byte == framing->escape && (decoder->length != 0u || framing->escapes_id)) {
            decoder->escaped = true;
        } else {
            icdgen_uart_data(decoder, byte, on_event, context);
        }
    }
}

/* Return the number of slots that a mask selects. Missing bytes of an incomplete mask count as 0. */
static inline size_t icdgen_log_slots(const icd_link_t *link, const uint8_t *mask, size_t length)
{
    size_t count = 0;
    for (size_t i = 0; i < length && i < link->log_mask->size; ++i) {
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
        const size_t given = length > log->mask_at ? length - log->mask_at : 0u;
        const size_t slots = icdgen_log_slots(link, given != 0u ? message + log->mask_at : message, given);
        return length == log->frames_at + (slots * link->log_mask->slot_bytes) ? ICD_UART_LOG : ICD_UART_OTHER;
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
