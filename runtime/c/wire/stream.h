#ifndef ICDGEN_WIRE_STREAM_H
#define ICDGEN_WIRE_STREAM_H

#include "../icdgen.h"
#include "linkage.h"
#include "link.h"
#include "crc.h"

/* ---- messages in an envelope, in a stream of bytes or in packets ------------------------------------------------- */

/** Values of the fields that the sender chooses, by icd_envelope_role_t. */
typedef struct {
    uint32_t of[ICD_ENVELOPE_VALUES];
} icd_envelope_values_t;

/** Those of the ICD, and 0. */
ICDGEN_API icd_envelope_values_t icd_envelope_values(const icd_link_t *link, icd_direction_t direction);

/**
 * A message as it is sent; `values` NULL: those of the ICD. ICD_ERROR_UNKNOWN_ID if there is none of that id,
 * ICD_ERROR_LENGTH if its data have another length or the buffer is too small (NODE_LINE_BYTES are enough),
 * ICD_ERROR_RANGE if a value does not fit its field.
 */
ICDGEN_API icd_status_t icd_stream_encode(
    const icd_link_t *link,
    icd_direction_t direction,
    uint32_t id,
    const uint8_t *data,
    size_t length,
    const icd_envelope_values_t *values,
    uint8_t *buffer,
    size_t capacity,
    size_t *written);

/** Sends messages of a direction, and counts them. */
typedef struct {
    const icd_link_t *link;
    icd_direction_t direction;
    icd_envelope_values_t values; /**< Those of the ICD, until others are set; the sequence is the first one. */
    uint32_t *sequences;
    size_t sequence_count;
} icd_stream_sender_t;

/**
 * `sequences` are NODE_SEQUENCES numbers, the last ones that were sent; with less, some messages are not counted.
 * ICD_ERROR_UNSUPPORTED if the ICD describes no envelope.
 */
ICDGEN_API icd_status_t icd_stream_sender_init(
    icd_stream_sender_t *sender,
    const icd_link_t *link,
    icd_direction_t direction,
    uint32_t *sequences,
    size_t sequence_count);

/** A message as it is sent, with the next sequence number, as icd_stream_encode(). */
ICDGEN_API icd_status_t icd_stream_send(
    icd_stream_sender_t *sender,
    uint32_t id,
    const uint8_t *data,
    size_t length,
    uint8_t *buffer,
    size_t capacity,
    size_t *written);

typedef enum {
    ICD_STREAM_MESSAGE = 0,
    ICD_STREAM_GAP = 1,        /**< Before this message `missing` others did not come; 0: it came again. */
    ICD_STREAM_CHECKSUM = 2,   /**< Dropped: the checksum is wrong. */
    ICD_STREAM_LENGTH = 3,     /**< Dropped: no message, or not that one, has such a length. */
    ICD_STREAM_UNKNOWN_ID = 4, /**< Dropped: the node has no such message. */
    ICD_STREAM_OVERRUN = 5,    /**< Dropped: longer than the buffer. */
    ICD_STREAM_FRAMING = 6,    /**< Dropped: a constant or a delimiter is not what it must be. */
    ICD_STREAM_DONE = 7,       /**< Client: the request succeeded; with its reply, if it has one. */
    ICD_STREAM_TIMEOUT = 8     /**< Client: no reply. */
} icd_stream_kind_t;

/** What a decoder or a client found, valid during the call that tells of it. */
typedef struct {
    icd_stream_kind_t kind;
    bool has_id; /**< Whether so much of it could be read. */
    uint32_t id;
    const uint8_t *data;
    size_t length;
    icd_envelope_values_t values;
    uint32_t missing;
    const icd_link_t *link;    /**< Of a client: that of the node, else NULL. */
    icd_direction_t direction; /**< Of DONE and TIMEOUT: that of the request, and so the id. */
    uint32_t attempts;         /**< Of DONE and TIMEOUT: how often it was sent. */
    bool has_reply;            /**< Of DONE: whether telemetry answered it, ... */
    uint32_t reply;            /**< ... its id. */
} icd_stream_event_t;

typedef void icd_stream_event_fn(void *context, const icd_stream_event_t *event);

/** Finds the messages of a direction in a stream. */
typedef struct {
    const icd_link_t *link;
    const icd_stream_form_t *form;
    icd_direction_t direction;
    uint8_t *buffer;
    size_t capacity;
    size_t length; /**< Bytes in the buffer. */
    size_t needed; /* bytes in the buffer with which the next thing is decided, where a field tells the length */
    uint32_t *sequences;
    size_t sequence_count;
    size_t pending;     /**< Bytes of the stream about which nothing is decided yet. */
    uint64_t discarded; /**< Bytes of the stream that became part of no message. */
    bool escaped;
    bool zero;    /* whether a zero follows the block of COBS */
    uint8_t left; /* bytes that the block of COBS still has */
    bool faulty;
    icd_stream_kind_t fault;
} icd_stream_decoder_t;

/**
 * `buffer` holds the longest message that is taken; that of the node is NODE_LONGEST bytes long. `sequences` are
 * NODE_SEQUENCES numbers, by which gaps are noticed; with less, gaps of some messages are not. ICD_ERROR_LENGTH if
 * header and trailer do not fit the buffer.
 */
ICDGEN_API icd_status_t icd_stream_decoder_init(
    icd_stream_decoder_t *decoder,
    const icd_link_t *link,
    icd_direction_t direction,
    uint8_t *buffer,
    size_t capacity,
    uint32_t *sequences,
    size_t sequence_count);

/** Takes the next bytes of the stream, or a packet. Events do not depend on how a stream was cut. */
ICDGEN_API void icd_stream_feed(
    icd_stream_decoder_t *decoder, const uint8_t *bytes, size_t count, icd_stream_event_fn *on_event, void *context);

#endif /* ICDGEN_WIRE_STREAM_H */
