#ifndef ICDGEN_WIRE_CLIENT_C
#define ICDGEN_WIRE_CLIENT_C

#include "client.h"
#include "events.c"

ICDGEN_API size_t icd_client_bytes(const icd_link_t *link)
{
    const size_t slot = link->can != NULL ? icd_can_slot_bytes(link) : 0u;
    return ICDGEN_SIZE(link->longest_telecommand + (slot > link->longest ? slot : link->longest));
}

static inline bool icdgen_on_bus(uint8_t buses, icd_bus_t bus)
{
    return ((ICDGEN_U32(buses) >> ICDGEN_U32(bus)) & 1u) != 0u;
}

/* Initialize the part that is the same for all buses. */
static inline icd_status_t icdgen_client_init(
    icd_client_t *client, const icd_link_t *link, icd_bus_t bus, uint8_t *buffer, size_t size)
{
    (void)memset(client, 0, sizeof *client);
    client->link = link;
    client->bus = bus;
    client->settings = link->client;
    if (link->checksum != NULL) {
        client->checks_telecommands = icdgen_on_bus(link->checksum->telecommand_always, bus);
        client->checks_telemetry = icdgen_on_bus(link->checksum->telemetry_always, bus);
    }
    client->whole = buffer;
    client->encoder.ended = true;
    return size < icd_client_bytes(link) ? ICD_ERROR_LENGTH : ICD_OK;
}

ICDGEN_API icd_status_t icd_client_uart(icd_client_t *client, const icd_link_t *link, uint8_t *buffer, size_t size)
{
    icd_status_t status = icdgen_client_init(client, link, ICD_BUS_UART, buffer, size);
    if (status == ICD_OK) {
        status = icd_uart_decoder_init(
            &client->decoder, link, buffer + ICDGEN_SIZE(link->longest_telecommand), ICDGEN_SIZE(link->longest));
    }
    client->ready = status == ICD_OK;
    return status;
}

ICDGEN_API icd_status_t icd_client_i2c(icd_client_t *client, const icd_link_t *link, uint8_t *buffer, size_t size)
{
    icd_status_t status = icdgen_client_init(client, link, ICD_BUS_I2C, buffer, size);
    if (status == ICD_OK && link->i2c_address < 0) {
        status = ICD_ERROR_UNSUPPORTED;
    }
    client->ready = status == ICD_OK;
    return status;
}

static inline icd_status_t icdgen_client_split(const icd_client_t *client, icd_can_splitter_t *splitter)
{
    const icd_can_kind_t kind = client->direction == ICD_TELECOMMAND ? ICD_CAN_TELECOMMAND : ICD_CAN_REQUEST;
    return icd_can_split(
        splitter, client->link, kind, client->whole[0], client->address, client->link->can->node_address,
        client->whole + 1, client->whole_length - 1u);
}

static inline bool icdgen_client_fits_can(const icd_client_t *client)
{
    icd_can_splitter_t splitter;
    return icdgen_client_split(client, &splitter) == ICD_OK;
}

static inline void icdgen_client_expire_can(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context)
{
    icd_can_expire(&client->joiner, now, on_event, context);
}

ICDGEN_API icd_status_t
icd_client_can(icd_client_t *client, const icd_link_t *link, uint8_t address, uint8_t *buffer, size_t size)
{
    const size_t first = ICDGEN_SIZE(link->longest_telecommand);
    icd_status_t status = icdgen_client_init(client, link, ICD_BUS_CAN, buffer, size);
    client->address = address;
    client->fits = icdgen_client_fits_can;
    client->expire = icdgen_client_expire_can;
    if (status == ICD_OK) {
        status = icd_can_joiner_init(&client->joiner, link, address, &client->slot, 1, buffer + first, size - first);
    }
    client->ready = status == ICD_OK;
    return status;
}

ICDGEN_API void icd_client_use_checksums(icd_client_t *client)
{
    const icd_checksum_form_t *const form = client->link->checksum;
    client->checks_telecommands = form != NULL && icdgen_on_bus(form->telecommand_buses, client->bus);
    client->checks_telemetry = form != NULL && icdgen_on_bus(form->telemetry_buses, client->bus);
}

ICDGEN_API bool icd_client_deadline(const icd_client_t *client, uint32_t *deadline)
{
    *deadline = client->until;
    return client->state != ICD_CLIENT_IDLE;
}

/* Forget the late responses that can no longer arrive. */
static inline void icdgen_client_forget(icd_client_t *client, uint32_t now)
{
    const icd_client_settings_t *const settings = &client->settings;
    const bool polls = client->bus == ICD_BUS_I2C && settings->poll_timeout > settings->reply_timeout;
    const uint32_t longest = (polls ? settings->poll_timeout : settings->reply_timeout) + settings->late;
    uint8_t kept = 0;
    for (uint8_t i = 0; i < client->late_count; ++i) {
        const icd_late_t late = client->late[i];
        const uint32_t left = late.until - now; /* large if the time is over */
        if (late.responses != 0u && left != 0u && left <= longest) {
            client->late[kept] = late;
            kept++;
        }
    }
    client->late_count = kept;
}

static inline bool icdgen_client_waits_for(const icd_client_t *client, icd_direction_t direction, uint32_t id)
{
    return client->state == ICD_CLIENT_WAIT && client->direction == direction && client->message->id == id;
}

/* Return whether this is a response to a request that has ended, and count it. */
static inline bool icdgen_client_is_late(icd_client_t *client, uint32_t now, icd_direction_t direction, uint32_t id)
{
    bool is_late = false;
    for (uint8_t i = 0; i < client->late_count; ++i) {
        icd_late_t *const late = &client->late[i];
        if (late->direction == direction && late->id == id) {
            late->responses--;
            is_late = true;
        }
    }
    icdgen_client_forget(client, now);
    return is_late;
}

/* End the request, and remember the responses that may still arrive. They count from the last transmission. */
static inline void icdgen_client_stop(icd_client_t *client)
{
    if (client->awaited != 0u && client->late_count < ICDGEN_MOST_AWAITED) {
        icd_late_t *const late = &client->late[client->late_count];
        late->direction = client->direction;
        late->id = client->message->id;
        late->responses = client->awaited;
        late->until = client->latest + client->settings.late;
        client->late_count++;
    }
    client->state = ICD_CLIENT_IDLE;
}

static inline void icdgen_client_end(icd_client_t *client, icd_event_t *event, icd_event_fn *on_event, void *context)
{
    event->link = client->link;
    event->direction = client->direction;
    event->id = client->message->id;
    event->attempts = client->attempts;
    client->awaited -= (event->kind != ICD_EVENT_TIMEOUT && client->awaited != 0u) ? 1u : 0u;
    icdgen_client_stop(client);
    on_event(context, event);
}

static inline void icdgen_client_done(
    icd_client_t *client, const uint8_t *data, size_t length, icd_event_fn *on_event, void *context)
{
    icd_event_t event = icdgen_event(ICD_EVENT_DONE, 0);
    event.data = data;
    event.length = length;
    icdgen_client_end(client, &event, on_event, context);
}

static inline void icdgen_client_timeout(icd_client_t *client, icd_event_fn *on_event, void *context)
{
    icd_event_t event = icdgen_event(ICD_EVENT_TIMEOUT, 0);
    icdgen_client_end(client, &event, on_event, context);
}

/* End a telecommand to which nothing responds. */
static inline void icdgen_client_sent(icd_client_t *client, icd_event_fn *on_event, void *context)
{
    icd_event_t event = icdgen_event(ICD_EVENT_SENT, 0);
    icdgen_client_end(client, &event, on_event, context);
}

/* Send the request, for the first time or again. */
static inline void icdgen_client_send(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context)
{
    const bool is_telecommand = client->direction == ICD_TELECOMMAND;
    const bool is_answered = !is_telecommand || (client->message->flags & ICD_ACKNOWLEDGED) != 0u;
    client->attempts++;
    client->sent_whole = false;
    client->state = ICD_CLIENT_WAIT;
    client->until = now + client->settings.reply_timeout;
    client->latest = client->until;
    client->pending++;
    if (client->bus == ICD_BUS_I2C) { /* a transaction brings telemetry itself; only an acknowledge is polled */
        client->awaited = (is_telecommand && is_answered) ? 1u : 0u;
    } else if (is_answered) {
        client->awaited++;
    } else {
        icdgen_client_sent(client, on_event, context);
    }
}

/* Send the request, or wait while a late response could be taken for its own. */
static inline void icdgen_client_send_or_hold(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context)
{
    bool is_held = false;
    icdgen_client_forget(client, now);
    /* So that the responses to all requests can be remembered, no other one is sent. */
    const bool is_full = client->late_count == ICDGEN_MOST_AWAITED;
    for (uint8_t i = 0; i < client->late_count; ++i) {
        const icd_late_t *const late = &client->late[i];
        const bool is_same = late->direction == client->direction && late->id == client->message->id;
        if ((is_same || is_full) && (!is_held || icdgen_reached(client->until, late->until))) {
            is_held = true;
            client->until = late->until;
        }
    }
    if (is_held) {
        client->state = ICD_CLIENT_HOLD;
    } else {
        icdgen_client_send(client, now, on_event, context);
    }
}

/* Return whether there is output that has not been taken. */
static inline bool icdgen_client_has_output(const icd_client_t *client)
{
    return client->pending != 0u || client->poll || !client->encoder.ended || client->encoder.pending != 0u ||
        client->splitter.next < client->splitter.count;
}

static inline void icdgen_client_ignore(void *context, const icd_event_t *event)
{
    (void)context;
    (void)event;
}

ICDGEN_API icd_status_t icd_client_start(
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
        client->link, message->id, request->data, telecommand ? request->length : 0u,
        telecommand && client->checks_telecommands, client->whole, ICDGEN_SIZE(client->link->longest_telecommand),
        &client->whole_length);
    client->direction = request->direction;
    if (status == ICD_OK && client->fits != NULL && !client->fits(client)) {
        status = ICD_ERROR_LENGTH;
    }
    if (status != ICD_OK) {
        return status;
    }
    client->message = message;
    client->repeat = request->repeat || !telecommand || (message->flags & ICD_SETTING) != 0u;
    client->attempts = 0;
    client->awaited = 0;
    icdgen_client_send_or_hold(client, now, on_event != NULL ? on_event : icdgen_client_ignore, context);
    return ICD_OK;
}

ICDGEN_API void icd_client_cancel(icd_client_t *client)
{
    /* Nothing responds to what was not sent. */
    client->awaited -= client->pending < client->awaited ? client->pending : client->awaited;
    client->pending = 0;
    client->poll = false;
    client->encoder.ended = true;
    client->encoder.pending = 0;
    client->splitter.next = client->splitter.count;
    if (client->state != ICD_CLIENT_IDLE) {
        icdgen_client_stop(client);
    }
}

ICDGEN_API icd_status_t icd_client_request(icd_client_t *client, uint32_t now, uint8_t id)
{
    icd_request_t request;
    (void)memset(&request, 0, sizeof request);
    request.direction = ICD_TELEMETRY;
    request.id = id;
    return icd_client_start(client, now, &request, NULL, NULL);
}

ICDGEN_API icd_status_t icd_client_send(
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
    (void)memset(&request, 0, sizeof request);
    request.direction = ICD_TELECOMMAND;
    request.id = id;
    request.data = data;
    request.length = length;
    request.repeat = repeat;
    return icd_client_start(client, now, &request, on_event, context);
}

ICDGEN_API bool icd_is_reply(const icd_event_t *event, const char *node, uint8_t id)
{
    return event->kind == ICD_EVENT_DONE && event->direction == ICD_TELEMETRY && event->id == id &&
        event->link != NULL && icd_has_messages_of(event->link, node);
}

ICDGEN_API bool icd_client_output(icd_client_t *client, const uint8_t **bytes, size_t *count)
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

ICDGEN_API bool icd_client_next_packet(icd_client_t *client, icd_can_packet_t *packet)
{
    if (client->bus != ICD_BUS_CAN) {
        return false;
    }
    if (client->splitter.next >= client->splitter.count && client->pending != 0u) {
        client->pending--;
        (void)icdgen_client_split(client, &client->splitter);
    }
    return icd_can_next(&client->splitter, packet);
}

ICDGEN_API bool icd_client_transfer(icd_client_t *client, const uint8_t **bytes, size_t *count, size_t *read)
{
    icd_transaction_t transaction;
    *read = 0;
    if (client->bus != ICD_BUS_I2C || client->taken_count == ICDGEN_MOST_AWAITED) {
        return false;
    }
    if (client->poll) {
        client->poll = false;
        *bytes = &client->poll_id;
        *count = 1;
        transaction.reads = true;
    } else if (client->pending != 0u) {
        client->pending--;
        *bytes = client->whole;
        *count = client->whole_length;
        transaction.reads = client->direction == ICD_TELEMETRY;
    } else {
        return false;
    }
    transaction.id = **bytes;
    if (transaction.reads) {
        (void)icd_i2c_read_length(client->link, transaction.id, client->checks_telemetry, read);
    }
    client->taken[client->taken_count] = transaction;
    client->taken_count++;
    return true;
}

#endif /* ICDGEN_WIRE_CLIENT_C */
