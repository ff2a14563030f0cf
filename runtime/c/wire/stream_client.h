#ifndef ICDGEN_WIRE_STREAM_CLIENT_H
#define ICDGEN_WIRE_STREAM_CLIENT_H

#include "../icdgen.h"
#include "linkage.h"
#include "link.h"
#include "stream.h"
#include "client.h"

/* ---- client for messages with header and trailer ----------------------------------------------------------------- */

/**
 * A request. `repeat`: whether the client may send it again if the node may already have received it. Telemetry
 * requests are always repeated.
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

/** Memory for a request, and for the previous request if its reply may still arrive. */
typedef struct {
    icd_client_state_t state;
    icd_direction_t direction;
    uint32_t id;
    uint32_t sent; /* id of the telecommand */
    uint8_t *data; /* data of the telecommand */
    size_t length;
    bool repeat;
    bool has_reply;
    uint32_t reply;
    uint32_t attempts;
    uint32_t until;  /* time at which the state ends */
    bool untaken;    /* the request is still to be sent */
    uint32_t ticket; /* order of sending */
    bool was_taken;  /* sent at least once */
    bool late;       /* telemetry with late_id may arrive until late_end */
    uint32_t late_id;
    uint32_t late_end;
} icd_stream_slot_t;

/**
 * A client for messages with framing. Several requests may be in progress if their replies differ. Also reports
 * unsolicited telemetry.
 */
typedef struct {
    const icd_link_t *link;
    icd_client_settings_t
        settings; /**< Timeouts and retries. They and `sender.values` may be changed while no request is in progress. */
    icd_stream_sender_t sender;
    icd_stream_decoder_t decoder;
    icd_stream_slot_t *slots;
    size_t slot_count;
    uint32_t tickets;
    bool ready; /* initialized without an error */
} icd_stream_client_t;

/**
 * Return the buffer size in bytes for this number of requests: NODE_LONGEST, plus NODE_REQUEST_BYTES for each request.
 */
ICDGEN_API size_t icd_stream_client_bytes(const icd_link_t *link, size_t requests);

/**
 * Initialize a client with the timeouts and values of the ICD. `slot_count` is the number of requests that can be in
 * progress at the same time. `sequences` has twice NODE_SEQUENCES elements; with fewer elements, some messages are not
 * counted. All three arrays must stay valid while the client is in use.
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
 * Start a request. The data are copied. `now` is in milliseconds. A request without a reply is reported at once as
 * ICD_STREAM_DONE; `on_event` may be NULL to ignore this.
 * Return ICD_ERROR_UNKNOWN_ID if the node has no such message, ICD_ERROR_BUSY if another request waits for the same
 * reply or no slot is free, ICD_ERROR_LENGTH if the data have the wrong length, ICD_ERROR_RANGE if a header or trailer
 * value does not fit into its field, or ICD_ERROR_UNSUPPORTED if no telecommand without parameters requests this
 * telemetry or the client is not initialized. After an error the client is unchanged.
 */
ICDGEN_API icd_status_t icd_stream_client_start(
    icd_stream_client_t *client,
    uint32_t now,
    const icd_stream_request_t *request,
    icd_stream_event_fn *on_event,
    void *context);

/** Request telemetry by sending the telecommand that it replies to. Errors: see icd_stream_client_start(). */
ICDGEN_API icd_status_t icd_stream_client_request(icd_stream_client_t *client, uint32_t now, uint32_t id);

/** Send a telecommand. The ICD decides which reply it has. Errors: see icd_stream_client_start(). */
ICDGEN_API icd_status_t icd_stream_client_send(
    icd_stream_client_t *client,
    uint32_t now,
    uint32_t id,
    const uint8_t *data,
    size_t length,
    bool repeat,
    icd_stream_event_fn *on_event,
    void *context);

/** Send a telecommand and wait for telemetry `reply`, regardless of the ICD. Errors: see icd_stream_client_start(). */
ICDGEN_API icd_status_t icd_stream_client_ask(
    icd_stream_client_t *client, uint32_t now, uint32_t id, const uint8_t *data, size_t length, uint32_t reply);

/**
 * Write the next message to send into the buffer. Return false if there is none or the buffer is too small;
 * NODE_LINE_BYTES are always enough.
 */
ICDGEN_API bool icd_stream_client_output(
    icd_stream_client_t *client, uint8_t *buffer, size_t capacity, size_t *written);

/**
 * Pass received bytes to the client: a piece of the stream of any size, or one packet. Unsolicited telemetry is
 * reported as ICD_STREAM_MESSAGE. `now` is in milliseconds.
 */
ICDGEN_API void icd_stream_client_received(
    icd_stream_client_t *client,
    uint32_t now,
    const uint8_t *bytes,
    size_t count,
    icd_stream_event_fn *on_event,
    void *context);

/**
 * Process timeouts: send again or end the request whose time is up. Call at the time of the deadline function at the
 * latest; calling more often is harmless. `now` is the current time in milliseconds.
 */
ICDGEN_API void icd_stream_client_tick(
    icd_stream_client_t *client, uint32_t now, icd_stream_event_fn *on_event, void *context);

/**
 * Cancel all requests without events, and drop their remaining output. A late reply is reported as ICD_STREAM_MESSAGE.
 */
ICDGEN_API void icd_stream_client_cancel(icd_stream_client_t *client);

/** Cancel only the requests of this message. */
ICDGEN_API void icd_stream_client_cancel_request(icd_stream_client_t *client, icd_direction_t direction, uint32_t id);

/**
 * Return whether the event contains telemetry `id` of `node`, or of a node that includes `node`, unsolicited or as a
 * reply.
 */
ICDGEN_API bool icd_is_telemetry(const icd_stream_event_t *event, const char *node, uint32_t id);

#endif /* ICDGEN_WIRE_STREAM_CLIENT_H */
