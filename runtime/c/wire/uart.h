#ifndef ICDGEN_WIRE_UART_H
#define ICDGEN_WIRE_UART_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"

/* ---- UART -------------------------------------------------------------------------------------------------------- */

/** Kinds of messages from the node on the UART. */
typedef enum { ICD_UART_REPLY, ICD_UART_ACKNOWLEDGE, ICD_UART_ARRIVED, ICD_UART_LOG, ICD_UART_OTHER } icd_uart_kind_t;

/** Encoder that frames a message piece by piece, so that no buffer for the whole message is needed. */
typedef struct {
    const icd_framing_t *framing;
    const uint8_t *message;
    size_t length;
    size_t at;
    uint8_t next[2]; /* bytes to be written next, initially the start sequence */
    uint8_t pending;
    bool ended;
} icd_uart_encoder_t;

/** Start to encode a message (id and data). `message` must stay valid until it is written completely. */
ICDGEN_API icd_status_t
icd_uart_encode_begin(icd_uart_encoder_t *encoder, const icd_link_t *link, const uint8_t *message, size_t length);

/** Write as many bytes as fit into the buffer. Return their number; 0 at the end of the message. */
ICDGEN_API size_t icd_uart_encode_some(icd_uart_encoder_t *encoder, uint8_t *buffer, size_t capacity);

/** Largest size in bytes of a framed message of `length` bytes. */
#define ICD_UART_BYTES(length) (2u * (length) + 4u)

/** Frame a message (id and data). Return ICD_ERROR_LENGTH if the message is empty or the buffer is too small. */
ICDGEN_API icd_status_t icd_uart_encode(
    const icd_link_t *link, const uint8_t *message, size_t length, uint8_t *buffer, size_t capacity, size_t *written);

/** Decoder that finds the messages in a stream. */
typedef struct {
    const icd_framing_t *framing;
    uint8_t *buffer;
    size_t capacity;
    size_t length;      /**< Bytes of the current message received so far. */
    size_t pending;     /**< Received bytes that may still become part of a message. */
    uint32_t discarded; /**< Number of received bytes that are not part of a message. May wrap around. */
    bool inside;
    bool escaped;
} icd_uart_decoder_t;

/**
 * Initialize a decoder. `buffer` must be large enough for the longest message to be received (NODE_LONGEST bytes are
 * enough for all) and must stay valid while the decoder is in use.
 */
ICDGEN_API icd_status_t
icd_uart_decoder_init(icd_uart_decoder_t *decoder, const icd_link_t *link, uint8_t *buffer, size_t capacity);

/**
 * Pass received bytes to the decoder, in pieces of any size.
 * Events: ICD_EVENT_MESSAGE (`data` starts with the id), UNEXPECTED_START, PROTOCOL_ERROR, OVERRUN and EMPTY. They do
 * not depend on how the stream is divided into pieces.
 */
ICDGEN_API void icd_uart_feed(
    icd_uart_decoder_t *decoder, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context);

/** Return the kind of a message from the node, determined from its id and length. `length` must not be 0. */
ICDGEN_API icd_uart_kind_t icd_uart_kind(const icd_link_t *link, const uint8_t *message, size_t length);

#endif /* ICDGEN_WIRE_UART_H */
