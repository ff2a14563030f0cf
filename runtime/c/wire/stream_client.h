#ifndef ICDGEN_WIRE_STREAM_CLIENT_H
#define ICDGEN_WIRE_STREAM_CLIENT_H

#include "../icdgen.h"
#include "linkage.h"
#include "link.h"
#include "stream.h"
#include "client.h"

/* ---- client over envelopes --------------------------------------------------------------------------------------- */

/** A request. `repeat`: whether it may be sent again although it may have arrived; of telemetry it always may. */
typedef struct {
    icd_direction_t direction;
    uint32_t id;
    bool repeat;
    bool has_reply; /**< Whether `reply` is the id of the telemetry that answers a telecommand; else as the ICD says. */
    uint32_t reply;
    const uint8_t *data;
    size_t length;
} icd_stream_request_t;

/** Room for a request, and the memory of the one before that may still be answered. */
typedef struct {
    icd_client_state_t state;
    icd_direction_t direction;
    uint32_t id;
    uint32_t sent; /* id of the telecommand */
    uint8_t *data; /* of the telecommand */
    size_t length;
    bool repeat;
    bool has_reply;
    uint32_t reply;
    uint32_t attempts;
    uint32_t until;  /* when the state ends by itself */
    bool untaken;    /* to be sent, ... */
    uint32_t ticket; /* ... in this order */
    bool was_taken;  /* sent at least once */
    bool late;       /* telemetry of late_id may come until late_end */
    uint32_t late_id;
    uint32_t late_end;
} icd_stream_slot_t;

/** Requests that different telemetry answers, each from sending to its outcome, and what comes unasked. */
typedef struct {
    const icd_link_t *link;
    icd_client_settings_t settings; /**< May be changed while no request is going on, and so `sender.values`. */
    icd_stream_sender_t sender;
    icd_stream_decoder_t decoder;
    icd_stream_slot_t *slots;
    size_t slot_count;
    uint32_t tickets;
    bool ready; /* it was begun without an error */
} icd_stream_client_t;

/** Bytes of buffer for so many requests: NODE_LONGEST, and NODE_REQUEST_BYTES for each. */
ICDGEN_API size_t icd_stream_client_bytes(const icd_link_t *link, size_t requests);

/**
 * Begins a client that has as many requests under way as there are `slots`, with the times and the values of the ICD.
 * `sequences` are twice NODE_SEQUENCES numbers; with less, some messages are not counted. ICD_ERROR_UNSUPPORTED if the
 * ICD describes no envelope, ICD_ERROR_LENGTH if the buffer is smaller than icd_stream_client_bytes(); it refuses every
 * request then.
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

/** When icd_stream_client_tick() wants to be called at the latest; false: not at all. */
ICDGEN_API bool icd_stream_client_deadline(const icd_stream_client_t *client, uint32_t *deadline);

/**
 * Begins a request; its data are copied. One that nothing answers is ICD_STREAM_DONE at once, which nobody is told of
 * if `on_event` is NULL. ICD_ERROR_UNKNOWN_ID; ICD_ERROR_BUSY while another one waits for the same reply, or no slot is
 * free; ICD_ERROR_LENGTH; ICD_ERROR_RANGE if a value of the envelope does not fit; ICD_ERROR_UNSUPPORTED for telemetry
 * that no telecommand without parameters is answered with, and if the client could not be begun. Nothing has happened
 * then.
 */
ICDGEN_API icd_status_t icd_stream_client_start(
    icd_stream_client_t *client,
    uint32_t now,
    const icd_stream_request_t *request,
    icd_stream_event_fn *on_event,
    void *context);

/** Asks for telemetry by the telecommand that it answers. */
ICDGEN_API icd_status_t icd_stream_client_request(icd_stream_client_t *client, uint32_t now, uint32_t id);

/** Sends a telecommand, which is answered as the ICD says. */
ICDGEN_API icd_status_t icd_stream_client_send(
    icd_stream_client_t *client,
    uint32_t now,
    uint32_t id,
    const uint8_t *data,
    size_t length,
    bool repeat,
    icd_stream_event_fn *on_event,
    void *context);

/** Sends a telecommand that telemetry `reply` answers, whatever the ICD says. */
ICDGEN_API icd_status_t icd_stream_client_ask(
    icd_stream_client_t *client, uint32_t now, uint32_t id, const uint8_t *data, size_t length, uint32_t reply);

/** Writes the next message to be sent; false if there is none, or it does not fit: NODE_LINE_BYTES always do. */
ICDGEN_API bool icd_stream_client_output(
    icd_stream_client_t *client, uint8_t *buffer, size_t capacity, size_t *written);

/** Takes the next bytes of the stream, or a packet. Telemetry that nobody waits for is ICD_STREAM_MESSAGE. */
ICDGEN_API void icd_stream_client_received(
    icd_stream_client_t *client,
    uint32_t now,
    const uint8_t *bytes,
    size_t count,
    icd_stream_event_fn *on_event,
    void *context);

/** Lets time pass. */
ICDGEN_API void icd_stream_client_tick(
    icd_stream_client_t *client, uint32_t now, icd_stream_event_fn *on_event, void *context);

/** Gives up all requests, without events, and what of them has not been taken. A late reply is ICD_STREAM_MESSAGE. */
ICDGEN_API void icd_stream_client_cancel(icd_stream_client_t *client);

/** Gives up the requests of that message only. */
ICDGEN_API void icd_stream_client_cancel_request(icd_stream_client_t *client, icd_direction_t direction, uint32_t id);

/** Whether the event brings that telemetry of that node, or of one that includes it: unasked, or as a reply. */
ICDGEN_API bool icd_is_telemetry(const icd_stream_event_t *event, const char *node, uint32_t id);

#endif /* ICDGEN_WIRE_STREAM_CLIENT_H */
