#ifndef ICDGEN_WIRE_UART_H
#define ICDGEN_WIRE_UART_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"

/* ---- UART -------------------------------------------------------------------------------------------------------- */

/** Writes a message to the line piece by piece, so that no buffer must hold the whole. */
typedef struct {
    const icd_framing_t *framing;
    const uint8_t *message;
    size_t length;
    size_t at;
    uint8_t next[2]; /* what comes next, begun with the start */
    uint8_t pending;
    bool ended;
} icd_uart_encoder_t;

/** Begins a message: id and data, which must stay where they are until all is written. */
ICDGEN_API icd_status_t
icd_uart_encode_begin(icd_uart_encoder_t *encoder, const icd_link_t *link, const uint8_t *message, size_t length);

/** Writes what fits the buffer; the count, 0 at the end of the message. */
ICDGEN_API size_t icd_uart_encode_some(icd_uart_encoder_t *encoder, uint8_t *buffer, size_t capacity);

/** The most bytes that a message of `length` bytes takes on the line. */
#define ICD_UART_BYTES(length) (2u * (length) + 4u)

/** A message, id and data, on the line; ICD_ERROR_LENGTH if it has no id or does not fit the buffer. */
ICDGEN_API icd_status_t icd_uart_encode(
    const icd_link_t *link, const uint8_t *message, size_t length, uint8_t *buffer, size_t capacity, size_t *written);

/** Finds the messages in a stream. */
typedef struct {
    const icd_framing_t *framing;
    uint8_t *buffer;
    size_t capacity;
    size_t length;      /**< Of the message so far. */
    size_t pending;     /**< Bytes of the stream about which nothing is decided yet. */
    uint64_t discarded; /**< Bytes of the stream that became part of no message. */
    bool inside;
    bool escaped;
} icd_uart_decoder_t;

/** `buffer` holds the longest message that is taken; that of the node is NODE_LONGEST bytes long. */
ICDGEN_API icd_status_t
icd_uart_decoder_init(icd_uart_decoder_t *decoder, const icd_link_t *link, uint8_t *buffer, size_t capacity);

/**
 * Takes the next bytes of the stream and tells of ICD_EVENT_MESSAGE, whose data begin with the id, UNEXPECTED_START,
 * PROTOCOL_ERROR, OVERRUN and EMPTY. Events do not depend on how the stream was cut.
 */
ICDGEN_API void icd_uart_feed(
    icd_uart_decoder_t *decoder, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context);

/** What a message from the node is, as far as its id and its length tell. `length` is not 0. */
ICDGEN_API icd_uart_kind_t icd_uart_kind(const icd_link_t *link, const uint8_t *message, size_t length);

#endif /* ICDGEN_WIRE_UART_H */
