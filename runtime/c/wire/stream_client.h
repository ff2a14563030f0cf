#ifndef ICDGEN_WIRE_STREAM_CLIENT_H
#define ICDGEN_WIRE_STREAM_CLIENT_H

#include "../icdgen.h"
#include "linkage.h"
#include "link.h"
#include "stream.h"

/* ---- client for messages with header and trailer ----------------------------------------------------------------- */

/**
 * A request. `repeat`: whether the client may send it again after a time-out, although the node may have received it.
 * Telemetry requests are always repeated, and so are telecommands that the ICD marks.
 */
typedef struct {
    icd_direction_t direction;
    uint32_t id;
    bool repeat;
    bool has_reply; /**< Whether `reply` is the id of the reply to a telecommand. If not, the ICD decides. */
    uint32_t reply;
    const uint8_t *data;
    size_t length;
} icd_stream_request_t;

typedef enum {
    ICD_STREAM_SLOT_QUEUED, /* is to be sent */
    ICD_STREAM_SLOT_SENT,   /* was sent, and nothing responds to it */
    ICD_STREAM_SLOT_WAIT,   /* waits for a response */
    ICD_STREAM_SLOT_PAUSE   /* the device was busy */
} icd_stream_slot_state_t;

#define ICDGEN_NEEDED_VERDICTS 2u /* ICD_VERDICT_ACK and ICD_VERDICT_REPLY: without these a request is not done */

/* The responses that may arrive for a request that was sent. */
typedef struct {
    const icd_exchange_t *exchange;
    const icd_stream_row_t *reply;         /* specified by the caller, or requested; NULL: as in the ICD */
    uint32_t sources[ICD_MOST_SOURCES];    /* numbers that responses must repeat */
    uint32_t latest;                       /* time until which a response is not late */
    uint16_t owed[ICDGEN_NEEDED_VERDICTS]; /* numbers of responses that may still arrive, by verdict */
} icd_stream_awaited_t;

/** Memory for a request. */
typedef struct {
    icd_stream_awaited_t awaited;
    const icd_stream_row_t *row; /* the telecommand, or telemetry that a packet requests */
    uint8_t *data;
    size_t length;
    uint32_t sent_at; /* time of the last transmission */
    uint32_t until;   /* time at which the state ends */
    uint16_t attempts;
    uint8_t missing; /* needed verdicts that did not arrive, as a mask; 0: never sent, or nothing responds */
    bool repeat;
    icd_direction_t direction;
    icd_stream_slot_state_t state;
} icd_stream_slot_t;

/**
 * A client for messages with framing. Also reports unsolicited telemetry. Members without a description are internal.
 *
 * Requests are sent in the order in which they were started. A request waits while as many are in progress as the
 * device handles, or while a response to another request could be taken for a response to it.
 */
typedef struct {
    icd_client_settings_t
        settings; /**< Times and retries. They and `sender.values` may be changed while no request is in progress. */
    icd_stream_sender_t sender;
    icd_stream_decoder_t decoder;
    icd_stream_slot_t *slots; /* the requests, in the order in which they were started, then free memory */
    size_t slot_count;
    size_t started;   /* number of requests */
    uint32_t now;     /* time of the last call */
    uint32_t sent_at; /* time of the last transmission */
    bool in_gap;      /* less than the gap has passed since */
    bool ready;       /* initialized without an error */
    uint8_t late_count;
    icd_stream_awaited_t late[ICDGEN_MOST_AWAITED]; /* requests that have ended */
} icd_stream_client_t;

/**
 * Return the buffer size in bytes for this number of requests: NODE_LONGEST, plus NODE_REQUEST_BYTES for each request.
 */
ICDGEN_API size_t icd_stream_client_bytes(const icd_link_t *link, size_t requests);

/**
 * Initialize a client with the settings and values of the ICD. `slot_count` is the number of requests that can be
 * in progress or waiting at the same time. `sequences` has twice NODE_SEQUENCES elements; with fewer elements, some
 * messages are not counted. All three arrays must stay valid while the client is in use.
 * Return ICD_ERROR_UNSUPPORTED if the ICD describes no framing, ICD_ERROR_LENGTH if `size` is less than
 * icd_stream_client_bytes(). After an error the client rejects all requests.
 */
ICDGEN_API icd_status_t icd_stream_client_init(
    icd_stream_client_t *client,
    const icd_link_t *link,
    icd_stream_slot_t *slots,
    size_t slot_count,
    uint8_t *buffer,
    size_t size,
    uint32_t *sequences,
    size_t sequence_count);

/**
 * Get the time in milliseconds at which icd_stream_client_tick() must be called at the latest. Return false if no
 * request is in progress.
 */
ICDGEN_API bool icd_stream_client_deadline(const icd_stream_client_t *client, uint32_t *deadline);

/**
 * Start a request, which icd_stream_client_output() sends. The data are copied. `now` is in milliseconds.
 * Return ICD_ERROR_UNKNOWN_ID if the node has no such message, ICD_ERROR_BUSY if no slot is free, ICD_ERROR_LENGTH if
 * the data have the wrong length, ICD_ERROR_RANGE if a header or trailer value does not fit into its field, or
 * ICD_ERROR_UNSUPPORTED if nothing requests this telemetry without parameters or the client is not initialized.
 * After an error the client is unchanged.
 */
ICDGEN_API icd_status_t
icd_stream_client_start(icd_stream_client_t *client, uint32_t now, const icd_stream_request_t *request);

/**
 * Request telemetry by the telecommand that it replies to, or by a packet with its id. Errors: see
 * icd_stream_client_start().
 */
ICDGEN_API icd_status_t icd_stream_client_request(icd_stream_client_t *client, uint32_t now, uint32_t id);

/** Send a telecommand. The ICD decides which responses it has. Errors: see icd_stream_client_start(). */
ICDGEN_API icd_status_t icd_stream_client_send(
    icd_stream_client_t *client, uint32_t now, uint32_t id, const uint8_t *data, size_t length, bool repeat);

/**
 * Send a telecommand and wait for telemetry `reply`, whichever reply the ICD specifies. Errors: see
 * icd_stream_client_start().
 */
ICDGEN_API icd_status_t icd_stream_client_ask(
    icd_stream_client_t *client, uint32_t now, uint32_t id, const uint8_t *data, size_t length, uint32_t reply);

/**
 * Write the next message to send into the buffer. Its time-outs count from the `now` of the previous call of another
 * function. Return false if there is none or the buffer is too small; NODE_LINE_BYTES are always enough. Call it until
 * it returns false, after each call of another function.
 */
ICDGEN_API bool icd_stream_client_output(
    icd_stream_client_t *client, uint8_t *buffer, size_t capacity, size_t *written);

/**
 * Pass received bytes to the client: a piece of the stream of any size, or one packet. Unsolicited telemetry is
 * reported as ICD_STREAM_MESSAGE. `now` is in milliseconds. The callback may start and cancel requests.
 */
ICDGEN_API void icd_stream_client_received(
    icd_stream_client_t *client,
    uint32_t now,
    const uint8_t *bytes,
    size_t count,
    icd_stream_event_fn *on_event,
    void *context);

/**
 * Process time-outs: send again or end the requests whose time is up. Call at the time of the deadline function at the
 * latest; calling more often is harmless. `now` is the current time in milliseconds.
 */
ICDGEN_API void icd_stream_client_tick(
    icd_stream_client_t *client, uint32_t now, icd_stream_event_fn *on_event, void *context);

/** Cancel all requests without events, and drop their remaining output. A response is reported as ICD_STREAM_LATE. */
ICDGEN_API void icd_stream_client_cancel(icd_stream_client_t *client);

/** Cancel only the requests of this message. */
ICDGEN_API void icd_stream_client_cancel_request(icd_stream_client_t *client, icd_direction_t direction, uint32_t id);

/**
 * Return whether the event contains telemetry `id` of `node`, or of a node that includes `node`, unsolicited or as a
 * response.
 */
ICDGEN_API bool icd_is_telemetry(const icd_stream_event_t *event, const char *node, uint32_t id);

#endif /* ICDGEN_WIRE_STREAM_CLIENT_H */
