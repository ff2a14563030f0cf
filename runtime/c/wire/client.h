#ifndef ICDGEN_WIRE_CLIENT_H
#define ICDGEN_WIRE_CLIENT_H

#include "../icdgen.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "uart.h"
#include "i2c.h"
#include "can.h"
#include "can_join.h"

/* ---- client ------------------------------------------------------------------------------------------------------ */

typedef enum {
    ICD_CLIENT_IDLE,
    ICD_CLIENT_HOLD,  /* a late reply to the request before may still come */
    ICD_CLIENT_WAIT,  /* for the reply */
    ICD_CLIENT_PAUSE, /* I2C: before polling or sending again */
    ICD_CLIENT_POLL   /* I2C: for the acknowledge frame */
} icd_client_state_t;

/**
 * A request. `repeat`: whether it may be sent again although it may have arrived; of telemetry and settings it always
 * may.
 */
typedef struct {
    icd_direction_t direction;
    uint8_t id;
    bool repeat;
    const uint8_t *data;
    size_t length;
} icd_request_t;

/** One request at a time, from sending to its outcome. */
typedef struct {
    const icd_link_t *link;
    icd_client_settings_t settings; /**< May be changed while no request is going on. */
    icd_bus_t bus;
    bool ready; /* icd_client_init() was successful */
    icd_client_state_t state;
    bool checks_telecommands;
    bool checks_telemetry;
    bool sent_whole; /* I2C: the telecommand is sent, its acknowledge is polled */
    bool repeat;
    icd_direction_t direction;
    const icd_message_t *message; /* that is requested */
    uint8_t *whole;               /* the request with its id and checksum */
    size_t whole_length;
    uint32_t attempts;
    uint32_t until;   /* when the state ends by itself */
    uint32_t give_up; /* when polling ends */
    bool echo;        /* a second reply to echo_id may come until echo_end */
    uint8_t echo_id;
    uint32_t echo_end;
    uint8_t address;
    uint8_t poll_id;
    bool poll;        /* to be sent: the request for the acknowledge frame ... */
    uint32_t pending; /* ... and the request, so many times */
    uint32_t owed;    /* I2C: transactions taken of which icd_client_transferred() was not told */
    icd_uart_encoder_t encoder;
    icd_can_splitter_t splitter;
    uint8_t chunk[32];
    icd_uart_decoder_t decoder;
    icd_can_joiner_t joiner;
    icd_can_slot_t slot;
} icd_client_t;

/** Bytes of buffer that a client needs: NODE_CLIENT_BYTES is the constant for a node. */
static inline size_t icd_client_bytes(const icd_link_t *link)
{
    const size_t slot = link->can != NULL ? icd_can_slot_bytes(link) : 0u;
    return link->longest_telecommand + (slot > link->longest ? slot : link->longest);
}

static inline icd_status_t icdgen_client_input_init(icd_client_t *client, uint8_t *buffer, size_t size)
{
    const icd_link_t *const link = client->link;
    const size_t first = link->longest_telecommand;
    if (size < icd_client_bytes(link)) {
        return ICD_ERROR_LENGTH;
    }
    switch (client->bus) {
    case ICD_BUS_UART:
        return icd_uart_decoder_init(&client->decoder, link, buffer + first, link->longest);
    case ICD_BUS_CAN:
        return icd_can_joiner_init(&client->joiner, link, 0, &client->slot, 1, buffer + first, size - first);
    case ICD_BUS_I2C:
    default:
        return link->i2c_address < 0 ? ICD_ERROR_UNSUPPORTED : ICD_OK;
    }
}

/**
 * A client on one bus with the times of the ICD. ICD_ERROR_UNSUPPORTED if the node is not on that bus, ICD_ERROR_LENGTH
 * if the buffer is smaller than icd_client_bytes(); it refuses every request then. The client must stay where it is.
 */
static inline icd_status_t icd_client_init(
    icd_client_t *client, const icd_link_t *link, icd_bus_t bus, uint8_t *buffer, size_t size)
{
    icd_status_t status;
    memset(client, 0, sizeof *client);
    client->link = link;
    client->bus = bus;
    client->settings = link->client;
    client->whole = buffer;
    client->encoder.ended = true;
    status = icdgen_client_input_init(client, buffer, size);
    client->ready = status == ICD_OK;
    return status;
}

/** Uses checksums where the ICD has them for the bus. */
static inline void icd_client_use_checksums(icd_client_t *client)
{
    const icd_checksum_form_t *const form = client->link->checksum;
    client->checks_telecommands = form != NULL && ((ICDGEN_U32(form->telecommand_buses) >> client->bus) & 1u) != 0u;
    client->checks_telemetry = form != NULL && ((ICDGEN_U32(form->telemetry_buses) >> client->bus) & 1u) != 0u;
}

/** Our address on CAN. */
static inline void icd_client_set_address(icd_client_t *client, uint8_t address)
{
    client->address = address;
    client->joiner.address = address;
}

/** When icd_client_tick() wants to be called at the latest; false: not at all. */
static inline bool icd_client_deadline(const icd_client_t *client, uint32_t *deadline)
{
    *deadline = client->until;
    return client->state != ICD_CLIENT_IDLE;
}

static inline void icdgen_client_end(
    icd_client_t *client, uint32_t now, icd_event_t *event, icd_event_fn *on_event, void *context)
{
    event->id = client->message->id;
    event->attempts = client->attempts;
    client->echo = client->attempts > 1u || event->kind == ICD_EVENT_TIMEOUT;
    client->echo_id = event->id;
    client->echo_end = now + client->settings.reply_timeout;
    client->state = ICD_CLIENT_IDLE;
    on_event(context, event);
}

static inline void icdgen_client_done(
    icd_client_t *client, uint32_t now, const uint8_t *data, size_t length, icd_event_fn *on_event, void *context)
{
    icd_event_t event = icdgen_event(ICD_EVENT_DONE, 0);
    event.data = data;
    event.length = length;
    icdgen_client_end(client, now, &event, on_event, context);
}

static inline void icdgen_client_timeout(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context)
{
    icd_event_t event = icdgen_event(ICD_EVENT_TIMEOUT, 0);
    icdgen_client_end(client, now, &event, on_event, context);
}

/* Sends the request, for the first time or again. */
static inline void icdgen_client_send(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context)
{
    client->attempts++;
    client->sent_whole = false;
    client->state = ICD_CLIENT_WAIT;
    client->until = now + client->settings.reply_timeout;
    client->pending++;
    if (client->bus != ICD_BUS_I2C && client->direction == ICD_TELECOMMAND &&
        (client->message->flags & ICD_ACKNOWLEDGED) == 0u) {
        icdgen_client_done(client, now, NULL, 0, on_event, context);
    }
}

/* Whether anything that is to be sent has not been taken. */
static inline bool icdgen_client_has_output(const icd_client_t *client)
{
    return client->pending != 0u || client->poll || !client->encoder.ended || client->encoder.pending != 0u ||
        client->splitter.next < client->splitter.count;
}

static inline bool icdgen_client_fits_bus(const icd_client_t *client)
{
    icd_can_splitter_t splitter;
    const icd_link_t *const link = client->link;
    return client->bus != ICD_BUS_CAN ||
        icd_can_split(
            &splitter, link, client->direction == ICD_TELECOMMAND ? ICD_CAN_TELECOMMAND : ICD_CAN_REQUEST,
            client->whole[0], client->address, link->can->node_address, client->whole + 1,
            client->whole_length - 1u) == ICD_OK;
}

/**
 * Begins a request; its data are copied. ICD_ERROR_UNKNOWN_ID, ICD_ERROR_BUSY while another one is going on or has not
 * been taken by the output functions, ICD_ERROR_LENGTH, ICD_ERROR_UNSUPPORTED if icd_client_init() failed; nothing has
 * happened then.
 */
static inline icd_status_t icd_client_start(
    icd_client_t *client, uint32_t now, const icd_request_t *request, icd_event_fn *on_event, void *context)
{
    const icd_message_t *message;
    const bool telecommand = request->direction == ICD_TELECOMMAND;
    icd_status_t status;
    if (!client->ready) {
        return ICD_ERROR_UNSUPPORTED;
    }
    message = icd_find_message(client->link, request->direction, request->id);
    if (message == NULL) {
        return ICD_ERROR_UNKNOWN_ID;
    }
    if (client->state != ICD_CLIENT_IDLE || icdgen_client_has_output(client)) {
        return ICD_ERROR_BUSY;
    }
    if (telecommand && request->length != message->length) {
        return ICD_ERROR_LENGTH;
    }
    status = icd_i2c_write(
        client->link, request->id, request->data, telecommand ? request->length : 0u,
        telecommand && client->checks_telecommands, client->whole, client->link->longest_telecommand,
        &client->whole_length);
    client->direction = request->direction;
    if (status != ICD_OK || !icdgen_client_fits_bus(client)) {
        return status != ICD_OK ? status : ICD_ERROR_LENGTH;
    }
    client->message = message;
    client->repeat = request->repeat || !telecommand || (message->flags & ICD_SETTING) != 0u;
    client->attempts = 0;
    if (client->echo && client->echo_id == request->id && !icdgen_reached(now, client->echo_end)) {
        client->state = ICD_CLIENT_HOLD;
        client->until = client->echo_end;
    } else {
        icdgen_client_send(client, now, on_event, context);
    }
    return ICD_OK;
}

/**
 * Gives up the request, without an event, and what of it has not been taken: the next one may begin. A late reply to
 * this one is ICD_EVENT_STRAY.
 */
static inline void icd_client_cancel(icd_client_t *client)
{
    client->pending = 0;
    client->poll = false;
    client->encoder.ended = true;
    client->encoder.pending = 0;
    client->splitter.next = client->splitter.count;
    if (client->state != ICD_CLIENT_IDLE && client->attempts != 0u) {
        client->echo = true;
        client->echo_id = client->message->id;
        client->echo_end = client->until + client->settings.reply_timeout;
    }
    client->state = ICD_CLIENT_IDLE;
}

static inline void icdgen_client_ignore(void *context, const icd_event_t *event)
{
    (void)context;
    (void)event;
}

/** Requests telemetry. */
static inline icd_status_t icd_client_request(icd_client_t *client, uint32_t now, uint8_t id)
{
    icd_request_t request;
    memset(&request, 0, sizeof request);
    request.direction = ICD_TELEMETRY;
    request.id = id;
    return icd_client_start(client, now, &request, icdgen_client_ignore, NULL);
}

/** Sends a telecommand, whose data are copied. One that is not acknowledged is ICD_EVENT_DONE at once. */
static inline icd_status_t icd_client_send(
    icd_client_t *client,
    uint32_t now,
    uint8_t id,
    const uint8_t *data,
    size_t length,
    bool repeat,
    icd_event_fn *on_event,
    void *context)
{
    icd_request_t request;
    memset(&request, 0, sizeof request);
    request.direction = ICD_TELECOMMAND;
    request.id = id;
    request.data = data;
    request.length = length;
    request.repeat = repeat;
    return icd_client_start(client, now, &request, on_event, context);
}

static inline icd_status_t icdgen_client_request_of(icd_client_t *client, uint32_t now, const char *node, unsigned id)
{
    if (!icd_has_messages_of(client->link, node)) {
        return ICD_ERROR_UNKNOWN_ID;
    }
    return icd_client_request(client, now, ICDGEN_U8(id));
}

/**
 * Requests the telemetry of that name, such as ICD_REQUEST(&client, now, NODE_IDENTIFICATION); ICD_ERROR_UNKNOWN_ID if
 * it is a message of another node, whatever its id.
 */
#define ICD_REQUEST(client, now, name) icdgen_client_request_of(client, now, name##_TELEMETRY)

/** The next bytes for the UART; false when there are none. They last until the next call. */
static inline bool icd_client_output(icd_client_t *client, const uint8_t **bytes, size_t *count)
{
    *bytes = client->chunk;
    *count = 0;
    if (client->bus != ICD_BUS_UART) {
        return false;
    }
    while (*count < sizeof client->chunk) {
        *count += icd_uart_encode_some(&client->encoder, client->chunk + *count, sizeof client->chunk - *count);
        if (client->encoder.ended && client->encoder.pending == 0u) {
            if (client->pending == 0u) {
                break;
            }
            client->pending--;
            (void)icd_uart_encode_begin(&client->encoder, client->link, client->whole, client->whole_length);
        }
    }
    return *count != 0u;
}

/** The next packet for CAN; false when there is none. */
static inline bool icd_client_next_packet(icd_client_t *client, icd_can_packet_t *packet)
{
    if (client->bus != ICD_BUS_CAN) {
        return false;
    }
    if (client->splitter.next >= client->splitter.count && client->pending != 0u) {
        const icd_can_kind_t kind = client->direction == ICD_TELECOMMAND ? ICD_CAN_TELECOMMAND : ICD_CAN_REQUEST;
        client->pending--;
        (void)icd_can_split(
            &client->splitter, client->link, kind, client->whole[0], client->address, client->link->can->node_address,
            client->whole + 1, client->whole_length - 1u);
    }
    return icd_can_next(&client->splitter, packet);
}

/**
 * The next transaction on I2C: bytes to write, and how many to read then; false when there is none.
 * icd_client_transferred() is told of each that was taken, once and in this order.
 */
static inline bool icd_client_transfer(icd_client_t *client, const uint8_t **bytes, size_t *count, size_t *read)
{
    *read = 0;
    if (client->bus == ICD_BUS_I2C && client->poll) {
        client->poll = false;
        client->owed++;
        *bytes = &client->poll_id;
        *count = 1;
        return icd_i2c_read_length(client->link, client->poll_id, client->checks_telemetry, read) == ICD_OK;
    }
    if (client->bus != ICD_BUS_I2C || client->pending == 0u) {
        return false;
    }
    client->pending--;
    client->owed++;
    *bytes = client->whole;
    *count = client->whole_length;
    if (client->direction == ICD_TELEMETRY) {
        (void)icd_i2c_read_length(client->link, client->whole[0], client->checks_telemetry, read);
    }
    return true;
}

#endif /* ICDGEN_WIRE_CLIENT_H */
