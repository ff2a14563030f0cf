#ifndef ICDGEN_WIRE_CLIENT_INPUT_C
#define ICDGEN_WIRE_CLIENT_INPUT_C

#include "client_input.h"
#include "link.c"
#include "events.c"
#include "uart.c"
#include "client.c"

/*
 * Process a rejected request. If the node reports a wrong checksum, the request was damaged on the bus and is sent
 * again.
 */
static inline void icdgen_client_refused(
    icd_client_t *client, uint32_t now, int64_t code, int64_t parameter, icd_event_fn *on_event, void *context)
{
    icd_event_t event = icdgen_event(ICD_EVENT_REFUSED, 0);
    for (size_t i = 0; i < client->link->error_count; ++i) {
        if (event.reason == ICD_REASON_UNKNOWN && ICDGEN_I64(client->link->errors[i].code) == code) {
            event.reason = client->link->errors[i].reason;
        }
    }
    if (event.reason == ICD_REASON_CHECKSUM && client->checks_telecommands &&
        client->attempts <= client->settings.retries) {
        client->awaited -= client->awaited != 0u ? 1u : 0u;
        icdgen_client_send(client, now, on_event, context);
        return;
    }
    event.code = code;
    event.parameter = parameter;
    icdgen_client_end(client, &event, on_event, context);
}

/* Process a missing or unusable reply: send again or end the request. */
static inline void icdgen_client_no_reply(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context)
{
    if (!client->repeat || client->attempts > client->settings.retries) {
        icdgen_client_timeout(client, on_event, context);
    } else if (client->bus == ICD_BUS_I2C) { /* the bus reports the failure immediately: wait before the next attempt */
        client->state = ICD_CLIENT_PAUSE;
        client->until = now + client->settings.poll_interval;
        client->give_up = now + client->settings.poll_timeout;
    } else {
        icdgen_client_send(client, now, on_event, context);
    }
}

/* Poll again after the poll interval. */
static inline void icdgen_client_again(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context)
{
    if (icdgen_reached(now, client->give_up)) {
        icdgen_client_timeout(client, on_event, context);
    } else {
        client->state = ICD_CLIENT_PAUSE;
        client->until = now + client->settings.poll_interval;
    }
}

static inline void icdgen_client_poll(icd_client_t *client, uint32_t now)
{
    client->state = ICD_CLIENT_POLL;
    client->until = now + client->settings.reply_timeout;
    client->poll = true;
    client->poll_id = ICDGEN_U8(client->link->polled->telemetry);
}

static inline void icdgen_client_tell(
    icd_event_kind_t kind, uint8_t id, const uint8_t *data, size_t length, icd_event_fn *on_event, void *context)
{
    icd_event_t event = icdgen_event(kind, id);
    event.data = data;
    event.length = length;
    on_event(context, &event);
}

/* A client and its event callback, as context for the callbacks of its decoder or joiner. */
typedef struct {
    icd_client_t *client;
    uint32_t now;
    icd_event_fn *on_event;
    void *context;
} icdgen_client_call_t;

/* Report the fault of telemetry that was read or received: ICD_ERROR_CHECKSUM, otherwise a wrong length. */
static inline void icdgen_client_fault(uint8_t id, icd_status_t status, icd_event_fn *on_event, void *context)
{
    const icd_event_kind_t kind = status == ICD_ERROR_CHECKSUM ? ICD_EVENT_CHECKSUM : ICD_EVENT_LENGTH;
    icdgen_client_tell(kind, id, NULL, 0, on_event, context);
}

/* Report a response that the request does not wait for. */
static inline void icdgen_client_unawaited(
    const icdgen_client_call_t *call, icd_direction_t direction, uint32_t command, const icd_event_t *response)
{
    icd_event_t event = *response;
    if (icdgen_client_is_late(call->client, call->now, direction, command)) {
        event.kind = ICD_EVENT_LATE;
    }
    call->on_event(call->context, &event);
}

/* Process telemetry. Its length shows whether it has a checksum. */
static inline void icdgen_client_replied(const icdgen_client_call_t *call, icd_event_t *reply)
{
    icd_client_t *const client = call->client;
    const icd_checksum_form_t *const form = client->link->checksum;
    const icd_message_t *const message = icd_find_message(client->link, ICD_TELEMETRY, reply->id);
    size_t frame = message != NULL ? message->length : 0u;
    icd_status_t status = reply->length == frame ? ICD_OK : ICD_ERROR_LENGTH;
    bool is_checked = false;
    if (message == NULL) {
        call->on_event(call->context, reply); /* stray */
        return;
    }
    if (form != NULL && icdgen_on_bus(form->telemetry_buses, client->bus) && reply->length == frame + form->bytes) {
        is_checked = true;
        status = icd_i2c_reply(client->link, reply->id, reply->data, reply->length, true, &frame);
    }
    if (status != ICD_OK) {
        icdgen_client_fault(reply->id, status, call->on_event, call->context);
    } else if (client->checks_telemetry && !is_checked) {
        icdgen_client_tell(ICD_EVENT_UNCHECKED, reply->id, NULL, 0, call->on_event, call->context);
    } else if (icdgen_client_waits_for(client, ICD_TELEMETRY, reply->id)) {
        icdgen_client_done(client, reply->data, frame, call->on_event, call->context);
    } else {
        reply->length = frame;
        icdgen_client_unawaited(call, ICD_TELEMETRY, reply->id, reply);
    }
}

/* Process an acknowledge with this code, or a refusal, of a request. */
static inline void icdgen_client_answered(
    const icdgen_client_call_t *call,
    icd_direction_t direction,
    uint32_t id,
    bool is_positive,
    int64_t code,
    const icd_event_t *response)
{
    icd_client_t *const client = call->client;
    if (!icdgen_client_waits_for(client, direction, id)) {
        icdgen_client_unawaited(call, direction, id, response);
    } else if (is_positive) {
        icdgen_client_done(client, NULL, 0, call->on_event, call->context);
    } else {
        icdgen_client_refused(client, call->now, code, -1, call->on_event, call->context);
    }
}

static inline void icdgen_client_uart_message(const icdgen_client_call_t *call, const uint8_t *message, size_t length)
{
    const icd_link_t *const link = call->client->link;
    const icd_uart_kind_t kind = icd_uart_kind(link, message, length);
    icd_event_t event = icdgen_event(ICD_EVENT_STRAY, message[0]);
    event.data = message + 1;
    event.length = length - 1u;
    if (kind == ICD_UART_REPLY) {
        icdgen_client_replied(call, &event);
        return;
    }
    if (kind == ICD_UART_ACKNOWLEDGE) {
        const uint8_t code = message[link->acknowledge->error_at];
        icdgen_client_answered(
            call, ICD_TELECOMMAND, message[link->acknowledge->id_at], code == link->no_error, code, &event);
        return;
    }
    if (kind == ICD_UART_LOG) {
        event.kind = ICD_EVENT_LOG;
        event.data = message;
        event.length = length;
    } else if (kind == ICD_UART_ARRIVED) {
        event.kind = ICD_EVENT_ARRIVED;
        event.id = icdgen_unsolicited(link, message, length)->telemetry;
    } else {
        /* stray */
    }
    call->on_event(call->context, &event);
}

static inline void icdgen_client_on_uart(void *context, const icd_event_t *event)
{
    const icdgen_client_call_t *const call = ICDGEN_CAST(const icdgen_client_call_t *, context);
    if (event->kind == ICD_EVENT_MESSAGE) {
        icdgen_client_uart_message(call, event->data, event->length);
    } else {
        call->on_event(call->context, event);
    }
}

static inline void icdgen_client_on_can(void *context, const icd_event_t *event)
{
    const icdgen_client_call_t *const call = ICDGEN_CAST(const icdgen_client_call_t *, context);
    const icd_can_kind_t kind = event->can_kind;
    icd_event_t response = icdgen_event(ICD_EVENT_STRAY, event->id);
    response.data = event->data;
    response.length = event->length;
    if (event->kind != ICD_EVENT_MESSAGE) {
        call->on_event(call->context, event);
    } else if (event->source != call->client->link->can->node_address) {
        call->on_event(call->context, &response);
    } else if (kind == ICD_CAN_REPLY) {
        icdgen_client_replied(call, &response);
    } else if (kind == ICD_CAN_ACKNOWLEDGE || kind == ICD_CAN_REFUSAL || kind == ICD_CAN_REQUEST_REFUSAL) {
        const icd_direction_t direction = kind == ICD_CAN_REQUEST_REFUSAL ? ICD_TELEMETRY : ICD_TELECOMMAND;
        icdgen_client_answered(call, direction, event->id, kind == ICD_CAN_ACKNOWLEDGE, -1, &response);
    } else {
        call->on_event(call->context, &response);
    }
}

ICDGEN_API void icd_client_tick(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context)
{
    if (client->expire != NULL) {
        client->expire(client, now, on_event, context);
    }
    icdgen_client_forget(client, now); /* the time may wrap until the next request */
    if (client->state == ICD_CLIENT_IDLE || !icdgen_reached(now, client->until)) {
        return;
    }
    switch (client->state) {
    case ICD_CLIENT_HOLD:
        icdgen_client_send_or_hold(client, now, on_event, context);
        break;
    case ICD_CLIENT_PAUSE:
        if (icdgen_reached(now, client->give_up)) {
            icdgen_client_timeout(client, on_event, context);
        } else if (client->sent_whole) {
            icdgen_client_poll(client, now);
        } else {
            icdgen_client_send(client, now, on_event, context);
        }
        break;
    case ICD_CLIENT_POLL:
        icdgen_client_again(client, now, on_event, context);
        break;
    case ICD_CLIENT_WAIT:
        icdgen_client_no_reply(client, now, on_event, context);
        break;
    case ICD_CLIENT_IDLE:
    default:
        break;
    }
}

/* Send the request if the late response has arrived for which it waits. */
static inline void icdgen_client_no_longer_held(const icdgen_client_call_t *call)
{
    if (call->client->state == ICD_CLIENT_HOLD) {
        icdgen_client_send_or_hold(call->client, call->now, call->on_event, call->context);
    }
}

ICDGEN_API void icd_client_received(
    icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context)
{
    icdgen_client_call_t call;
    call.client = client;
    call.now = now;
    call.on_event = on_event;
    call.context = context;
    icd_client_tick(client, now, on_event, context);
    if (client->ready) {
        icd_uart_feed(&client->decoder, bytes, count, icdgen_client_on_uart, &call);
        icdgen_client_no_longer_held(&call);
    }
}

ICDGEN_API void icd_client_packet(
    icd_client_t *client, uint32_t now, const icd_can_packet_t *packet, icd_event_fn *on_event, void *context)
{
    icdgen_client_call_t call;
    call.client = client;
    call.now = now;
    call.on_event = on_event;
    call.context = context;
    icd_client_tick(client, now, on_event, context);
    if (client->ready) {
        icd_can_feed(&client->joiner, now, packet, icdgen_client_on_can, &call);
        icdgen_client_no_longer_held(&call);
    }
}

/* I2C: process the acknowledge frame. */
static inline void icdgen_client_polled(
    icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context)
{
    const icd_link_t *const link = client->link;
    const icd_report_t *const report = link->polled;
    size_t length = 0;
    uint32_t code;
    const icd_status_t status = icd_i2c_reply(link, client->poll_id, bytes, count, client->checks_telemetry, &length);
    if (status != ICD_OK) {
        icdgen_client_fault(client->poll_id, status, on_event, context);
        icdgen_client_again(client, now, on_event, context);
        return;
    }
    if (icdgen_get(link, report, bytes, ICD_ROLE_ID) != client->message->id ||
        icdgen_get(link, report, bytes, ICD_ROLE_PROCESSED) == 0u) {
        icdgen_client_again(client, now, on_event, context);
        return;
    }
    code = icdgen_get(link, report, bytes, ICD_ROLE_ERROR);
    if (code == link->no_error) {
        icdgen_client_done(client, NULL, 0, on_event, context);
    } else {
        icdgen_client_refused(
            client, now, code, icdgen_get(link, report, bytes, ICD_ROLE_PARAMETER), on_event, context);
    }
}

/* I2C: remove the oldest transaction whose result is missing. Return false if there is none. */
static inline bool icdgen_client_untake(icd_client_t *client, icd_transaction_t *transaction)
{
    if (client->taken_count == 0u) {
        return false;
    }
    *transaction = client->taken[0];
    client->taken_count--;
    for (uint8_t i = 0; i < client->taken_count; ++i) {
        client->taken[i] = client->taken[i + 1u];
    }
    return true;
}

/* I2C: report the result of a transaction that nothing awaits any more. */
static inline void icdgen_client_transferred_late(
    const icd_client_t *client,
    const icd_transaction_t *transaction,
    const uint8_t *bytes,
    size_t count,
    icd_event_fn *on_event,
    void *context)
{
    size_t length = 0;
    icd_status_t status = ICD_OK;
    if (transaction->reads && bytes != NULL) {
        status = icd_i2c_reply(client->link, transaction->id, bytes, count, client->checks_telemetry, &length);
    }
    if (status == ICD_OK) {
        icdgen_client_tell(ICD_EVENT_LATE, transaction->id, bytes, length, on_event, context);
    } else {
        icdgen_client_fault(transaction->id, status, on_event, context);
    }
}

/* I2C: return whether the last transaction is taken and belongs to the current request. */
static inline bool icdgen_client_awaits_transfer(const icd_client_t *client)
{
    return (client->state == ICD_CLIENT_WAIT || client->state == ICD_CLIENT_POLL) && !icdgen_client_has_output(client);
}

ICDGEN_API void icd_client_transferred(
    icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context)
{
    size_t length = 0;
    icd_transaction_t transaction;
    const bool awaited = client->taken_count == 1u && icdgen_client_awaits_transfer(client);
    const bool was_taken = icdgen_client_untake(client, &transaction);
    icd_client_tick(client, now, on_event, context); /* may end this request and start the next one */
    if (!was_taken) {
        icdgen_client_tell(ICD_EVENT_STRAY, 0, bytes, bytes != NULL ? count : 0u, on_event, context);
    } else if (!awaited || !icdgen_client_awaits_transfer(client)) {
        icdgen_client_transferred_late(client, &transaction, bytes, count, on_event, context);
    } else if (client->state == ICD_CLIENT_POLL) {
        if (bytes == NULL) {
            icdgen_client_again(client, now, on_event, context);
        } else {
            icdgen_client_polled(client, now, bytes, count, on_event, context);
        }
    } else if (bytes == NULL) {
        client->awaited = 0;
        icdgen_client_no_reply(client, now, on_event, context);
    } else if (client->direction == ICD_TELEMETRY) {
        const uint8_t id = client->message->id;
        const icd_status_t status = icd_i2c_reply(client->link, id, bytes, count, client->checks_telemetry, &length);
        if (status == ICD_OK) {
            icdgen_client_done(client, bytes, length, on_event, context);
        } else {
            icdgen_client_fault(id, status, on_event, context);
            icdgen_client_no_reply(client, now, on_event, context);
        }
    } else if ((client->message->flags & ICD_ACKNOWLEDGED) == 0u || client->link->polled == NULL) {
        icdgen_client_sent(client, on_event, context);
    } else {
        client->sent_whole = true;
        client->give_up = now + client->settings.poll_timeout;
        client->latest = client->give_up;
        icdgen_client_again(client, now, on_event, context);
    }
}

#endif /* ICDGEN_WIRE_CLIENT_INPUT_C */
