#ifndef ICDGEN_WIRE_STREAM_CLIENT_C
#define ICDGEN_WIRE_STREAM_CLIENT_C

#include "stream_client.h"
#include "events.c"
#include "stream_decode.c"

/* Return the largest number of data bytes of a telecommand. */
static inline size_t icdgen_request_bytes(const icd_stream_form_t *form)
{
    size_t most = 0;
    for (size_t i = 0; i < form->row_counts[ICD_TELECOMMAND]; ++i) {
        const size_t bytes = form->rows[ICD_TELECOMMAND][i].most;
        most = bytes > most ? bytes : most;
    }
    return most;
}

ICDGEN_API size_t icd_stream_client_bytes(const icd_link_t *link, size_t requests)
{
    const icd_stream_form_t *const form = link->stream;
    return form != NULL ? ICDGEN_SIZE(link->longest) + (requests * icdgen_request_bytes(form)) : 0u;
}

ICDGEN_API icd_status_t icd_stream_client_init(
    icd_stream_client_t *client,
    const icd_link_t *link,
    icd_stream_slot_t *slots,
    size_t slot_count,
    uint8_t *buffer,
    size_t size,
    uint32_t *sequences,
    size_t sequence_count)
{
    const size_t half = sequence_count / 2u;
    icd_status_t status;
    (void)memset(client, 0, sizeof *client);
    client->link = link;
    client->settings = link->client;
    status = icd_stream_sender_init(&client->sender, link, ICD_TELECOMMAND, sequences, half);
    if (status == ICD_OK && size < icd_stream_client_bytes(link, slot_count)) {
        status = ICD_ERROR_LENGTH;
    }
    if (status == ICD_OK) {
        status = icd_stream_decoder_init(
            &client->decoder, link, ICD_TELEMETRY, buffer, ICDGEN_SIZE(link->longest),
            (sequence_count > 0u) ? (sequences + half) : NULL, sequence_count - half);
    }
    if (status == ICD_OK) {
        const size_t bytes = icdgen_request_bytes(link->stream);
        client->slots = slots;
        client->slot_count = slot_count;
        client->ready = true;
        for (size_t i = 0; i < slot_count; ++i) {
            (void)memset(&slots[i], 0, sizeof slots[i]);
            slots[i].data = buffer + ICDGEN_SIZE(link->longest) + (i * bytes);
        }
    }
    return status;
}

ICDGEN_API bool icd_stream_client_deadline(const icd_stream_client_t *client, uint32_t *deadline)
{
    bool waits = false;
    uint32_t first = 0;
    for (size_t i = 0; i < client->slot_count; ++i) {
        const icd_stream_slot_t *const slot = &client->slots[i];
        if (slot->state != ICD_CLIENT_IDLE) {
            first = waits && icdgen_reached(slot->until, first) ? first : slot->until;
            waits = true;
        }
    }
    *deadline = first;
    return waits;
}

/* A client and its event callback. */
typedef struct {
    icd_stream_client_t *client;
    uint32_t now;
    icd_stream_event_fn *on_event;
    void *context;
} icdgen_stream_call_t;

static inline void icdgen_stream_ignore(void *context, const icd_stream_event_t *event)
{
    (void)context;
    (void)event;
}

/* Report the outcome of a request. */
static inline void icdgen_stream_outcome(
    const icdgen_stream_call_t *call, icd_stream_kind_t kind, const icd_stream_slot_t *slot, icd_stream_event_t event)
{
    icd_stream_event_t told = event;
    told.kind = kind;
    told.has_id = true;
    told.id = slot->id;
    told.link = call->client->link;
    told.direction = slot->direction;
    told.attempts = slot->attempts;
    call->on_event(call->context, &told);
}

/* Remember that the reply may still arrive, or arrive again. */
static inline void icdgen_stream_remember(const icd_stream_client_t *client, icd_stream_slot_t *slot, uint32_t since)
{
    if (slot->was_taken && slot->has_reply) {
        slot->late = true;
        slot->late_id = slot->reply;
        slot->late_end = since + client->settings.reply_timeout;
    }
}

/* Send a request, for the first time or again. */
static inline void icdgen_stream_transmit(const icdgen_stream_call_t *call, icd_stream_slot_t *slot)
{
    icd_stream_client_t *const client = call->client;
    slot->attempts++;
    if (!slot->untaken) {
        slot->untaken = true;
        slot->ticket = client->tickets;
        client->tickets++;
    }
    if (slot->has_reply) {
        slot->state = ICD_CLIENT_WAIT;
        slot->until = call->now + client->settings.reply_timeout;
    } else {
        slot->state = ICD_CLIENT_IDLE;
        icdgen_stream_outcome(call, ICD_STREAM_DONE, slot, icdgen_stream_event(ICD_STREAM_DONE));
    }
}

/* Return the telecommand that requests telemetry: the first one without data whose reply it is. */
static inline const icd_stream_row_t *icdgen_stream_asking(const icd_stream_form_t *form, uint32_t id)
{
    for (size_t i = 0; i < form->row_counts[ICD_TELECOMMAND]; ++i) {
        const icd_stream_row_t *const row = &form->rows[ICD_TELECOMMAND][i];
        if (row->is_answered && row->reply == id && row->least == 0u) {
            return row;
        }
    }
    return NULL;
}

/*
 * Return a free slot for a request with this reply; NULL if there is none, or another request waits for the same reply.
 */
static inline icd_stream_slot_t *icdgen_stream_free(const icd_stream_client_t *client, bool has_reply, uint32_t reply)
{
    icd_stream_slot_t *found = NULL;
    for (size_t i = 0; i < client->slot_count; ++i) {
        icd_stream_slot_t *const slot = &client->slots[i];
        if (slot->state == ICD_CLIENT_IDLE) {
            found = found == NULL && !slot->untaken ? slot : found;
        } else if (has_reply && slot->reply == reply) {
            return NULL;
        } else {
            /* it waits for another reply */
        }
    }
    return found;
}

/* Return whether header and trailer values fit into their fields. */
static inline bool icdgen_stream_fits(const icd_stream_client_t *client, uint32_t id, size_t length)
{
    const icd_stream_sender_t *const sender = &client->sender;
    uint8_t header[ICDGEN_ENVELOPE_BYTES] = {0};
    uint8_t trailer[ICDGEN_ENVELOPE_BYTES] = {0};
    return icdgen_envelope_fill(client->link->stream, ICD_TELECOMMAND, id, length, &sender->values, header, trailer);
}

/* Return how long telemetry may be a late reply to a previous request. */
static inline uint32_t icdgen_stream_late(const icd_stream_client_t *client, uint32_t now, uint32_t reply)
{
    uint32_t longest = 0;
    for (size_t i = 0; i < client->slot_count; ++i) {
        const icd_stream_slot_t *const slot = &client->slots[i];
        if (slot->late && slot->late_id == reply && !icdgen_reached(now, slot->late_end)) {
            const uint32_t left = slot->late_end - now;
            longest = left > longest ? left : longest;
        }
    }
    return longest;
}

ICDGEN_API icd_status_t icd_stream_client_start(
    icd_stream_client_t *client,
    uint32_t now,
    const icd_stream_request_t *request,
    icd_stream_event_fn *on_event,
    void *context)
{
    const icdgen_stream_call_t call = {client, now, on_event != NULL ? on_event : icdgen_stream_ignore, context};
    const bool asks = request->direction == ICD_TELEMETRY;
    const size_t length = asks ? 0u : request->length;
    if (!client->ready) {
        return ICD_ERROR_UNSUPPORTED;
    }
    const icd_stream_form_t *const form = client->link->stream;
    const icd_stream_row_t *const row =
        asks ? icdgen_stream_asking(form, request->id) : icdgen_stream_row(form, ICD_TELECOMMAND, request->id);
    if (row == NULL) {
        const bool is_known = asks && icdgen_stream_row(form, ICD_TELEMETRY, request->id) != NULL;
        return is_known ? ICD_ERROR_UNSUPPORTED : ICD_ERROR_UNKNOWN_ID;
    }
    const bool named = request->has_reply && !asks;
    const bool has_reply = named || row->is_answered;
    const uint32_t reply = named ? request->reply : row->reply;
    if (named && icdgen_stream_row(form, ICD_TELEMETRY, reply) == NULL) {
        return ICD_ERROR_UNKNOWN_ID;
    }
    icd_stream_slot_t *const slot = icdgen_stream_free(client, has_reply, reply);
    if (slot == NULL) {
        return ICD_ERROR_BUSY;
    }
    if (length < row->least || length > row->most) {
        return ICD_ERROR_LENGTH;
    }
    if (!icdgen_stream_fits(client, row->id, length)) {
        return ICD_ERROR_RANGE;
    }
    slot->direction = request->direction;
    slot->id = request->id;
    slot->sent = row->id;
    slot->length = length;
    for (size_t i = 0; i < length; ++i) {
        slot->data[i] = request->data[i];
    }
    slot->repeat = request->repeat || asks;
    slot->has_reply = has_reply;
    slot->reply = reply;
    slot->attempts = 0;
    slot->was_taken = false;
    const uint32_t held = has_reply ? icdgen_stream_late(client, now, reply) : 0u;
    if (held != 0u) {
        slot->state = ICD_CLIENT_HOLD;
        slot->until = now + held;
    } else {
        icdgen_stream_transmit(&call, slot);
    }
    return ICD_OK;
}

ICDGEN_API icd_status_t icd_stream_client_request(icd_stream_client_t *client, uint32_t now, uint32_t id)
{
    icd_stream_request_t request;
    (void)memset(&request, 0, sizeof request);
    request.direction = ICD_TELEMETRY;
    request.id = id;
    return icd_stream_client_start(client, now, &request, NULL, NULL);
}

static icd_stream_request_t icdgen_stream_telecommand(uint32_t id, const uint8_t *data, size_t length)
{
    icd_stream_request_t request;
    (void)memset(&request, 0, sizeof request);
    request.direction = ICD_TELECOMMAND;
    request.id = id;
    request.data = data;
    request.length = length;
    return request;
}

ICDGEN_API icd_status_t icd_stream_client_send(
    icd_stream_client_t *client,
    uint32_t now,
    uint32_t id,
    const uint8_t *data,
    size_t length,
    bool repeat,
    icd_stream_event_fn *on_event,
    void *context)
{
    icd_stream_request_t request = icdgen_stream_telecommand(id, data, length);
    request.repeat = repeat;
    return icd_stream_client_start(client, now, &request, on_event, context);
}

ICDGEN_API icd_status_t icd_stream_client_ask(
    icd_stream_client_t *client, uint32_t now, uint32_t id, const uint8_t *data, size_t length, uint32_t reply)
{
    icd_stream_request_t request = icdgen_stream_telecommand(id, data, length);
    request.has_reply = true;
    request.reply = reply;
    return icd_stream_client_start(client, now, &request, NULL, NULL);
}

ICDGEN_API bool icd_stream_client_output(icd_stream_client_t *client, uint8_t *buffer, size_t capacity, size_t *written)
{
    icd_stream_slot_t *next = NULL;
    for (size_t i = 0; i < client->slot_count; ++i) {
        icd_stream_slot_t *const slot = &client->slots[i];
        if (slot->untaken && (next == NULL || !icdgen_reached(slot->ticket, next->ticket))) {
            next = slot;
        }
    }
    if (next == NULL ||
        icd_stream_send(&client->sender, next->sent, next->data, next->length, buffer, capacity, written) != ICD_OK) {
        return false;
    }
    next->untaken = false;
    next->was_taken = true;
    return true;
}

ICDGEN_API void icd_stream_client_tick(
    icd_stream_client_t *client, uint32_t now, icd_stream_event_fn *on_event, void *context)
{
    const icdgen_stream_call_t call = {client, now, on_event, context};
    for (size_t i = 0; i < client->slot_count; ++i) {
        icd_stream_slot_t *const slot = &client->slots[i];
        slot->late = slot->late && !icdgen_reached(now, slot->late_end);
        if (slot->state == ICD_CLIENT_IDLE || !icdgen_reached(now, slot->until)) {
            continue;
        }
        if (slot->state == ICD_CLIENT_HOLD || (slot->repeat && slot->attempts <= client->settings.retries)) {
            icdgen_stream_transmit(&call, slot);
        } else {
            slot->state = ICD_CLIENT_IDLE;
            slot->untaken = false;
            icdgen_stream_remember(client, slot, now);
            icdgen_stream_outcome(&call, ICD_STREAM_TIMEOUT, slot, icdgen_stream_event(ICD_STREAM_TIMEOUT));
        }
    }
}

static inline void icdgen_stream_on_event(void *context, const icd_stream_event_t *event)
{
    const icdgen_stream_call_t *const call = ICDGEN_CAST(const icdgen_stream_call_t *, context);
    icd_stream_client_t *const client = call->client;
    icd_stream_event_t told = *event;
    for (size_t i = 0; i < client->slot_count && event->kind == ICD_STREAM_MESSAGE; ++i) {
        icd_stream_slot_t *const slot = &client->slots[i];
        if (slot->state == ICD_CLIENT_WAIT && slot->was_taken && slot->reply == event->id) {
            slot->state = ICD_CLIENT_IDLE;
            slot->untaken = false;
            if (slot->attempts > 1u) {
                icdgen_stream_remember(client, slot, call->now);
            }
            told.has_reply = true;
            told.reply = event->id;
            icdgen_stream_outcome(call, ICD_STREAM_DONE, slot, told);
            return;
        }
    }
    told.link = client->link;
    told.direction = ICD_TELEMETRY;
    call->on_event(call->context, &told);
}

ICDGEN_API void icd_stream_client_received(
    icd_stream_client_t *client,
    uint32_t now,
    const uint8_t *bytes,
    size_t count,
    icd_stream_event_fn *on_event,
    void *context)
{
    icdgen_stream_call_t call;
    call.client = client;
    call.now = now;
    call.on_event = on_event;
    call.context = context;
    icd_stream_client_tick(client, now, on_event, context);
    if (client->ready) {
        icd_stream_feed(&client->decoder, bytes, count, icdgen_stream_on_event, &call);
    }
}

static inline void icdgen_stream_give_up(const icd_stream_client_t *client, icd_stream_slot_t *slot)
{
    slot->untaken = false;
    if (slot->state != ICD_CLIENT_IDLE) {
        icdgen_stream_remember(client, slot, slot->until);
    }
    slot->state = ICD_CLIENT_IDLE;
}

ICDGEN_API void icd_stream_client_cancel(icd_stream_client_t *client)
{
    for (size_t i = 0; i < client->slot_count; ++i) {
        icdgen_stream_give_up(client, &client->slots[i]);
    }
}

ICDGEN_API void icd_stream_client_cancel_request(icd_stream_client_t *client, icd_direction_t direction, uint32_t id)
{
    for (size_t i = 0; i < client->slot_count; ++i) {
        if (client->slots[i].direction == direction && client->slots[i].id == id) {
            icdgen_stream_give_up(client, &client->slots[i]);
        }
    }
}

ICDGEN_API bool icd_is_telemetry(const icd_stream_event_t *event, const char *node, uint32_t id)
{
    const bool is_reply = event->kind == ICD_STREAM_DONE && event->has_reply;
    const bool brings = is_reply || (event->kind == ICD_STREAM_MESSAGE && event->direction == ICD_TELEMETRY);
    return brings && (is_reply ? event->reply : event->id) == id && event->link != NULL &&
        icd_has_messages_of(event->link, node);
}

#endif /* ICDGEN_WIRE_STREAM_CLIENT_C */
