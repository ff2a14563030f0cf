#ifndef ICDGEN_WIRE_STREAM_H
#define ICDGEN_WIRE_STREAM_H

#include "../icdgen.h"
#include "linkage.h"
#include "link.h"
#include "events.h"
#include "crc.h"

/* ---- messages with header and trailer, in a stream of bytes or in packets ---------------------------------------- */

/**
 * Return the values of the ICD for this direction. Fields without a value in the ICD are 0. If packet formats have
 * different values, the value is ICD_HEADER_DEFAULT; for fields of 32 bits, it is that of the first format.
 */
ICDGEN_API icd_header_values_t icd_header_values(const icd_link_t *link, icd_direction_t direction);

/**
 * Encode a message with header, trailer and delimiters. `values`: fields that the sender chooses, or NULL for the
 * values of the ICD. A buffer of NODE_LINE_BYTES is always enough.
 * Return ICD_ERROR_UNKNOWN_ID if there is no message with this id, ICD_ERROR_LENGTH if the data have the wrong length
 * or the buffer is too small, ICD_ERROR_RANGE if a value does not fit into its field.
 */
ICDGEN_API icd_status_t icd_stream_encode(
    const icd_link_t *link,
    icd_direction_t direction,
    uint32_t id,
    const uint8_t *data,
    size_t length,
    const icd_header_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written);

/**
 * Encode the packet that requests telemetry. For the other parameters see icd_stream_encode().
 * Return ICD_ERROR_UNSUPPORTED if no packet requests telemetry, ICD_ERROR_UNKNOWN_ID if it cannot request this
 * telemetry, ICD_ERROR_LENGTH if the buffer is too small, ICD_ERROR_RANGE if a value does not fit into its field.
 */
ICDGEN_API icd_status_t icd_stream_encode_request(
    const icd_link_t *link,
    uint32_t telemetry,
    const icd_header_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written);

/**
 * Encode a packet without a message, such as an acknowledge or a refusal, as a device sends it. `packet` is the index
 * of its format in `link->stream->packets`, `id` the value of its id field. For the other parameters see
 * icd_stream_encode().
 * Return ICD_ERROR_RANGE if there is no such packet without a message in this direction, or if the id or a value does
 * not fit into its field, ICD_ERROR_LENGTH if the buffer is too small.
 */
ICDGEN_API icd_status_t icd_stream_encode_packet(
    const icd_link_t *link,
    icd_direction_t direction,
    size_t packet,
    uint32_t id,
    const icd_header_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written);

/** Encoder of the messages of one direction, with sequence numbers. */
typedef struct {
    const icd_link_t *link;
    icd_direction_t direction;
    icd_header_values_t values; /**< Initially those of the ICD. The sequence is the first number. */
    uint32_t *sequences;
    size_t sequence_count;
} icd_stream_sender_t;

/**
 * Initialize a sender. `sequences` is an array for the last sequence numbers sent, with NODE_SEQUENCES elements; with
 * fewer elements, some messages are not counted. It must stay valid while the sender is in use.
 * Return ICD_ERROR_UNSUPPORTED if the ICD describes no framing.
 */
ICDGEN_API icd_status_t icd_stream_sender_init(
    icd_stream_sender_t *sender,
    const icd_link_t *link,
    icd_direction_t direction,
    uint32_t *sequences,
    size_t sequence_count);

/** Encode a message with the next sequence number. For the other parameters and errors see icd_stream_encode(). */
ICDGEN_API icd_status_t icd_stream_send(
    icd_stream_sender_t *sender,
    uint32_t id,
    const uint8_t *data,
    size_t length,
    uint8_t *buffer,
    size_t capacity,
    size_t *written);

/**
 * Encode the packet that requests telemetry, with the next sequence number. For the other parameters and errors see
 * icd_stream_encode_request().
 */
ICDGEN_API icd_status_t icd_stream_send_request(
    icd_stream_sender_t *sender, uint32_t telemetry, uint8_t *buffer, size_t capacity, size_t *written);

/**
 * Encode a packet without a message, with the next sequence number. `values`: header and trailer values of this packet
 * in place of those of the sender, except for the sequence if the sender counts the packet; NULL for those of the
 * sender. For the other parameters and errors see icd_stream_encode_packet().
 */
ICDGEN_API icd_status_t icd_stream_send_packet(
    icd_stream_sender_t *sender,
    size_t packet,
    uint32_t id,
    const icd_header_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written);

/** What a device answers to a telecommand, or to a request of telemetry. */
typedef struct {
    icd_verdict_t verdict;
    bool has_reason; /**< Otherwise, a reason in `data` remains; in a packet without a message it is 0. */
    uint32_t reason; /**< Reason of a refusal. */
    /**
     * Telemetry that responds: the values of the device, which are `length` bytes; bytes that are missing are 0. Buffer
     * of `capacity` bytes, into which the function puts the response: NODE_LONGEST bytes are always enough.
     */
    uint8_t *data;
    size_t length;
    size_t capacity;
} icd_answer_t;

/**
 * Encode the response of a device to what it has received, with the next sequence number: for firmware, simulators and
 * tests of a client.
 *
 * `sender` sends telemetry. `received` is an event of the decoder of telecommands: MESSAGE or REQUEST; to refuse,
 * also UNKNOWN_ID, LENGTH or CHECKSUM with an id. The response repeats the numbers that the ICD describes as `echo`,
 * and has the status for the verdict: of several values, the first in the ICD.
 * Return ICD_ERROR_UNSUPPORTED if the ICD has no response with this verdict, ICD_ERROR_RANGE if the reason does not
 * fit into its field or is the status of another verdict, ICD_ERROR_LENGTH if a buffer is too small.
 */
ICDGEN_API icd_status_t icd_stream_respond(
    icd_stream_sender_t *sender,
    const icd_event_t *received,
    const icd_answer_t *answer,
    uint8_t *buffer,
    size_t capacity,
    size_t *written);

/** Decoder that finds the messages of one direction in a stream. */
typedef struct {
    const icd_link_t *link;
    const icd_stream_form_t *form;
    icd_direction_t direction;
    bool escaped;
    bool inside;  /* escape characters: whether a packet has begun */
    bool zero;    /* COBS: whether a zero follows the block */
    uint8_t left; /* COBS: remaining bytes of the block */
    bool faulty;
    icd_event_kind_t fault;
    uint8_t *buffer;
    size_t capacity;
    size_t length; /**< Number of bytes in the buffer. */
    size_t needed; /* with a length field: number of bytes in the buffer that the next step needs */
    uint32_t *sequences;
    size_t sequence_count;
    size_t pending;     /**< Received bytes that may still become part of a message. */
    uint32_t discarded; /**< Number of received bytes that are not part of a message. May wrap around. */
} icd_stream_decoder_t;

/**
 * Initialize a decoder. `buffer` must be large enough for the longest message to be received; NODE_LONGEST bytes are
 * enough for all. `sequences` has NODE_SEQUENCES elements and serves to detect gaps; with fewer elements, some gaps are
 * not detected. Both must stay valid while the decoder is in use.
 * Return ICD_ERROR_LENGTH if header and trailer do not fit into the buffer.
 */
ICDGEN_API icd_status_t icd_stream_decoder_init(
    icd_stream_decoder_t *decoder,
    const icd_link_t *link,
    icd_direction_t direction,
    uint8_t *buffer,
    size_t capacity,
    uint32_t *sequences,
    size_t sequence_count);

/**
 * Pass received bytes to the decoder: a piece of the stream of any size, or one packet. Events do not depend on how a
 * stream is divided into pieces.
 */
ICDGEN_API void icd_stream_feed(
    icd_stream_decoder_t *decoder, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context);

#endif /* ICDGEN_WIRE_STREAM_H */
