#ifndef ICDGEN_WIRE_CLIENT_C
#define ICDGEN_WIRE_CLIENT_C

#include "client.h"
#include "packet_fields.h"
#include "events.c"

/* A client and its event callback. */
typedef struct {
    icd_client_t *client;
    icd_event_fn *on_event;
    void *context;
} icdgen_call_t;

/* What the client needs to know of a line. Functions that a line does not need are NULL. */
struct icd_line {
    bool has_results; /* of its transmissions, which can fail */
    icd_bus_t bus;    /* except on framed links */
    /*
     * Set in a slot how a request is sent, what responds to it, and the number of its data bytes. Return
     * ICD_ERROR_LENGTH only if there is no other error.
     */
    icd_status_t (*plan)(const icd_client_t *client, const icd_request_t *request, icd_slot_t *slot);
    /* Store the data of a request; zeros if they are NULL. Return an error if it cannot be encoded. */
    icd_status_t (*store)(const icd_client_t *client, icd_slot_t *slot, const uint8_t *data);
    bool (*output)(icd_client_t *client, uint8_t *buffer, size_t capacity, size_t *written);
    void (*received)(const icdgen_call_t *call, const uint8_t *bytes, size_t count);
    void (*expire)(const icdgen_call_t *call, uint32_t now); /* incomplete messages */
};

ICDGEN_API size_t icd_client_bytes(const icd_link_t *link, size_t requests)
{
    return ICDGEN_SIZE(link->received_bytes) + (requests * ICDGEN_SIZE(link->longest_telecommand));
}

/* Initialize what is the same on all lines. The first bytes of the buffer are for what is received. */
static inline icd_status_t icdgen_client_init(
    icd_client_t *client, const icd_link_t *link, icd_slot_t *slots, size_t slot_count, uint8_t *buffer, size_t size)
{
    const size_t first = ICDGEN_SIZE(link->received_bytes);
    const size_t each = ICDGEN_SIZE(link->longest_telecommand);
    (void)memset(client, 0, sizeof *client);
    client->link = link;
    client->settings = link->client;
    if (size < first + (slot_count * each)) {
        return ICD_ERROR_LENGTH;
    }
    client->slots = slots;
    client->free = slots;
    client->end = slots + slot_count;
    for (size_t i = 0; i < slot_count; ++i) {
        (void)memset(&slots[i], 0, sizeof slots[i]);
        slots[i].data = buffer + first + (i * each);
    }
    return ICD_OK;
}

static inline uint32_t icdgen_verdict_bit(icd_verdict_t verdict)
{
    return UINT32_C(1) << ICDGEN_U32(verdict);
}

/* The reply that the caller specified, or the requested telemetry. Its id is in icd_awaited_t. */
static const icd_response_t icdgen_specified_reply = {
    0u, ICD_VERDICT_REPLY, 0u, false, 1u << ICD_VERDICT_REPLY, 0u, NULL, NULL, NULL, NULL, NULL,
};

static inline bool icdgen_can_be_reply(const icd_response_t *response)
{
    return (response->verdicts & icdgen_verdict_bit(ICD_VERDICT_REPLY)) != 0u;
}

/* Return how many possible responses a request has; some of them are NULL. */
static inline size_t icdgen_response_count(const icd_awaited_t *awaited)
{
    return ICDGEN_SIZE(awaited->exchange->response_count) + 1u;
}

/*
 * Return a possible response to a request. The reply that the caller specified takes the place of those in the ICD, and
 * is the last; requested telemetry is the first.
 */
static inline const icd_response_t *icdgen_response(const icd_awaited_t *awaited, size_t index)
{
    const icd_exchange_t *const exchange = awaited->exchange;
    const size_t own = exchange->is_request ? ICDGEN_SIZE(0) : exchange->response_count;
    if (index == own) {
        return awaited->has_reply ? &icdgen_specified_reply : NULL;
    }
    const icd_response_t *const response = &exchange->responses[index - (index > own ? 1u : 0u)];
    return awaited->has_reply && icdgen_can_be_reply(response) ? NULL : response;
}

static inline uint32_t icdgen_response_source(const icd_awaited_t *awaited, const icd_response_t *response)
{
    return response == &icdgen_specified_reply ? awaited->reply : response->source;
}

/* Return the verdicts without which a request is not done, as a mask. */
static inline uint32_t icdgen_needed(const icd_awaited_t *awaited)
{
    uint32_t verdicts = 0;
    for (size_t i = 0; i < icdgen_response_count(awaited); ++i) {
        const icd_response_t *const response = icdgen_response(awaited, i);
        verdicts |= response != NULL ? response->verdicts : 0u;
    }
    return verdicts & (icdgen_verdict_bit(ICD_VERDICT_ACK) | icdgen_verdict_bit(ICD_VERDICT_REPLY));
}

/* Return how many numbers of the telecommand a response repeats. */
static inline size_t icdgen_echo_count(const icd_response_t *response)
{
    return ICDGEN_RESPONSES_HAVE(ICDGEN_RESPONSE_ECHO) ? ICDGEN_SIZE(response->echo_count) : 0u;
}

/* Return whether telemetry or a packet is this response to a request. */
static inline bool icdgen_matches(
    const icd_awaited_t *awaited, const icd_response_t *response, const icd_event_t *event)
{
    const uint32_t source = event->is_packet ? event->packet : event->id;
    bool matches = icdgen_response_source(awaited, response) == source && response->is_packet == event->is_packet;
    for (size_t i = 0; matches && i < icdgen_echo_count(response); ++i) {
        const icd_echo_t *const echo = &response->echoes[i];
        matches =
            icdgen_stream_number(echo->place, event->id, event->data, event->length) == awaited->sources[echo->source];
    }
    return matches;
}

/* Return the response to a request that telemetry or a packet is; NULL if it is none of them. */
static inline const icd_response_t *icdgen_matching(const icd_awaited_t *awaited, const icd_event_t *event)
{
    for (size_t i = 0; i < icdgen_response_count(awaited); ++i) {
        const icd_response_t *const response = icdgen_response(awaited, i);
        if (response != NULL && icdgen_matches(awaited, response, event)) {
            return response;
        }
    }
    return NULL;
}

/* Return the number of sources in id and data, which are known before the packet is sent: its header is not. */
static inline size_t icdgen_message_sources(const icd_awaited_t *awaited)
{
    const size_t in_header =
        ICDGEN_RESPONSES_HAVE(ICDGEN_RESPONSE_HEADER_ECHO) ? ICDGEN_SIZE(awaited->exchange->header_count) : 0u;
    return ICDGEN_RESPONSES_HAVE(ICDGEN_RESPONSE_ECHO) ? awaited->exchange->source_count - in_header : 0u;
}

/* Return whether the number that a response repeats is known before the packet is sent. */
static inline bool icdgen_is_known(const icd_awaited_t *awaited, const icd_echo_t *echo)
{
    return !ICDGEN_RESPONSES_HAVE(ICDGEN_RESPONSE_HEADER_ECHO) || echo->source < icdgen_message_sources(awaited);
}

/* Return whether the responses to two requests have different numbers at the same place. */
static inline bool icdgen_differs_in_echo(
    const icd_awaited_t *a, const icd_response_t *response_a, const icd_awaited_t *b, const icd_response_t *response_b)
{
    for (size_t i = 0; i < icdgen_echo_count(response_a); ++i) {
        const icd_echo_t *const echo = &response_a->echoes[i];
        for (size_t j = 0; j < icdgen_echo_count(response_b); ++j) {
            const icd_echo_t *const other = &response_b->echoes[j];
            if (echo->place == other->place && icdgen_is_known(a, echo) && icdgen_is_known(b, other) &&
                a->sources[echo->source] != b->sources[other->source]) {
                return true;
            }
        }
    }
    return false;
}

/* I2C: return whether the reply comes with its request, and never late. */
static inline bool icdgen_is_in_order(const icd_awaited_t *awaited)
{
    return ICDGEN_HAS_BUS(ICD_BUS_I2C) && awaited->is_in_order;
}

/* Return whether a response to one request could be taken for a response to the other. */
static inline bool icdgen_is_like(const icd_awaited_t *a, const icd_awaited_t *b)
{
    if (icdgen_is_in_order(a) || icdgen_is_in_order(b)) {
        return false;
    }
    if ((ICDGEN_STREAM_FLAGS & ICD_STREAM_NAMELESS) != 0u && a->is_nameless && b->is_nameless) {
        return true;
    }
    for (size_t i = 0; i < icdgen_response_count(a); ++i) {
        const icd_response_t *const of_a = icdgen_response(a, i);
        for (size_t j = 0; of_a != NULL && j < icdgen_response_count(b); ++j) {
            const icd_response_t *const of_b = icdgen_response(b, j);
            if (of_b != NULL && icdgen_response_source(a, of_a) == icdgen_response_source(b, of_b) &&
                of_a->is_packet == of_b->is_packet && !icdgen_differs_in_echo(a, of_a, b, of_b)) {
                return true;
            }
        }
    }
    return false;
}

static inline icd_verdict_t icdgen_verdict(const icd_response_t *response, const icd_event_t *event)
{
    return icdgen_verdict_of(response, event->id, event->data, event->length);
}

static inline bool icdgen_is_owed(const icd_awaited_t *awaited)
{
    return awaited->owed[ICD_VERDICT_ACK] != 0u || awaited->owed[ICD_VERDICT_REPLY] != 0u;
}

/* Return whether a response to a request may arrive, also to an earlier attempt. */
static inline bool icdgen_is_awaited(const icd_slot_t *slot)
{
    return slot->state == ICD_SLOT_WAIT || icdgen_is_owed(&slot->awaited);
}

/* Count a response. A refusal takes the place of all others to the same transmission. */
static inline void icdgen_settle(icd_awaited_t *awaited, icd_verdict_t verdict)
{
    for (size_t i = 0; i < ICDGEN_NEEDED_VERDICTS; ++i) {
        const bool settles = ICDGEN_SIZE(verdict) == i || ICDGEN_IS_VERDICT(verdict, ICD_VERDICT_NAK) ||
            ICDGEN_IS_VERDICT(verdict, ICD_VERDICT_BUSY) || ICDGEN_IS_VERDICT(verdict, ICD_VERDICT_AGAIN);
        if (settles && awaited->owed[i] != 0u) {
            awaited->owed[i]--;
        }
    }
}

static inline uint32_t icdgen_timeout(const icd_client_t *client, const icd_awaited_t *awaited)
{
    return awaited->exchange->timeout != 0u ? awaited->exchange->timeout : client->settings.reply_timeout;
}

/* Return the time at which a late response to a request can no longer arrive. */
static inline uint32_t icdgen_late_end(const icd_client_t *client, const icd_awaited_t *awaited)
{
    return awaited->latest + client->settings.late;
}

/*
 * Return whether a late response to a request can still arrive. An idle client may not be called for so long that the
 * clock wraps around, so a time in the future is only one that is not further away than it can be.
 */
static inline bool icdgen_can_be_late(const icd_client_t *client, const icd_awaited_t *awaited)
{
    const uint32_t left = icdgen_late_end(client, awaited) - client->now;
    uint32_t longest = icdgen_timeout(client, awaited);
    if (ICDGEN_HAS_BUS(ICD_BUS_I2C) && awaited->exchange->poll != NULL && client->settings.poll_timeout > longest) {
        longest = client->settings.poll_timeout;
    }
    return icdgen_is_owed(awaited) && left != 0u && left <= longest + client->settings.late;
}

/* Forget the late responses that have arrived, or can no longer arrive. */
static inline void icdgen_forget(icd_client_t *client)
{
    uint8_t kept = 0;
    for (size_t i = 0; i < client->late_count; ++i) {
        if (icdgen_can_be_late(client, &client->late[i])) {
            client->late[kept] = client->late[i];
            kept++;
        }
    }
    client->late_count = kept;
}

/* Store the time, and drop what has passed. */
static inline void icdgen_set_time(icd_client_t *client, uint32_t now)
{
    client->now = now;
    client->in_gap = client->in_gap && now - client->sent_at < client->settings.gap;
    icdgen_forget(client);
}

/* End a request, and remember the responses that may still arrive. */
static inline void icdgen_request_end(icd_client_t *client, icd_slot_t *slot)
{
    if (icdgen_can_be_late(client, &slot->awaited) && client->late_count < ICDGEN_MOST_AWAITED) {
        client->late[client->late_count] = slot->awaited;
        client->late_count++;
    }
    client->free--;
    icd_slot_t *each = slot;
    while (each != client->free) {
        uint8_t *const data = each->data; /* free memory: it moves to the end */
        *each = each[1];
        each++;
        each->data = data;
    }
}

/* Return the oldest request that is to be sent; NULL if there is none. */
static inline icd_slot_t *icdgen_queued(const icd_client_t *client)
{
    for (icd_slot_t *slot = client->slots; slot != client->free; ++slot) {
        if (slot->state == ICD_SLOT_QUEUED) {
            return slot;
        }
    }
    return NULL;
}

/* Return whether the state of a request ends at a time: it was sent, and its output is taken. */
static inline bool icdgen_has_end(const icd_client_t *client, const icd_slot_t *slot)
{
    return slot->state != ICD_SLOT_QUEUED && slot->data != client->partial;
}

/* I2C: return whether a telecommand is written, and its outcome is polled. */
static inline bool icdgen_is_polled(const icd_slot_t *slot)
{
    return ICDGEN_HAS_BUS(ICD_BUS_I2C) && slot->is_polled;
}

/* Return whether transmissions have a result: those on I2C. */
static inline bool icdgen_has_results(const icd_client_t *client)
{
    return ICDGEN_HAS_BUS(ICD_BUS_I2C) && client->line->has_results;
}

/* Return whether a response may arrive for a request, and it does not poll. */
static inline bool icdgen_has_responses(const icd_slot_t *slot)
{
    return !icdgen_is_polled(slot) && (slot->awaited.has_reply || slot->awaited.exchange->response_count != 0u);
}

/* Return how many other requests in progress wait for responses, also those that are to be sent again. */
static inline size_t icdgen_unfinished(const icd_client_t *client, const icd_slot_t *slot)
{
    size_t count = 0;
    for (const icd_slot_t *other = client->slots; other != client->free; ++other) {
        count += (other != slot && other->missing != 0u) ? 1u : 0u;
    }
    return count;
}

/*
 * Return whether a late response must arrive, or be forgotten, before a request is sent: it could be taken for its own,
 * or no more of them can be remembered.
 */
static inline bool icdgen_is_blocked(const icd_client_t *client, const icd_slot_t *slot, const icd_awaited_t *late)
{
    return icdgen_has_responses(slot) &&
        (icdgen_unfinished(client, slot) + client->late_count >= ICDGEN_MOST_AWAITED ||
         icdgen_is_like(&slot->awaited, late));
}

/* The earliest of some times. */
typedef struct {
    uint32_t time;
    bool exists;
} icdgen_earliest_t;

static inline void icdgen_earliest_add(icdgen_earliest_t *earliest, uint32_t time)
{
    if (!earliest->exists || icdgen_reached(earliest->time, time)) {
        earliest->time = time;
        earliest->exists = true;
    }
}

ICDGEN_API bool icd_client_deadline(const icd_client_t *client, uint32_t *deadline)
{
    icdgen_earliest_t earliest = {0u, false};
    const icd_slot_t *const queued = icdgen_queued(client);
    for (const icd_slot_t *slot = client->slots; slot != client->free; ++slot) {
        if (icdgen_has_end(client, slot)) {
            icdgen_earliest_add(&earliest, slot->until);
        }
    }
    if (queued != NULL) {
        /* It may be possible to send the request then. */
        if (client->in_gap) {
            icdgen_earliest_add(&earliest, client->sent_at + client->settings.gap);
        }
        for (size_t i = 0; i < client->late_count; ++i) {
            if (icdgen_is_blocked(client, queued, &client->late[i])) {
                icdgen_earliest_add(&earliest, icdgen_late_end(client, &client->late[i]));
            }
        }
    }
    *deadline = earliest.time;
    return earliest.exists;
}

/* Return whether there is memory for another request. */
static inline bool icdgen_has_room(const icd_client_t *client)
{
    return client->free != client->end && client->free->data != client->partial;
}

ICDGEN_API icd_status_t icd_client_start(icd_client_t *client, uint32_t now, const icd_request_t *request)
{
    static const icd_exchange_t no_exchange = {NULL, NULL, 0u, 0u, 0u, false, 0u, NULL};
    const bool asks = request->direction == ICD_TELEMETRY;
    icd_slot_t slot;
    icd_awaited_t *const awaited = &slot.awaited;
    (void)memset(&slot, 0, sizeof slot);
    slot.id = request->id;
    slot.direction = request->direction;
    slot.repeat = request->repeat || asks;
    awaited->exchange = &no_exchange;
    icd_status_t status = client->line != NULL ? client->line->plan(client, request, &slot) : ICD_ERROR_UNSUPPORTED;
    if ((status == ICD_OK || status == ICD_ERROR_LENGTH) && !icdgen_has_room(client)) {
        status = ICD_ERROR_BUSY;
    }
    if (status == ICD_OK) {
        slot.data = client->free->data;
        status = client->line->store(client, &slot, asks ? NULL : request->data);
    }
    if (status == ICD_OK) {
        for (size_t i = 0; i < icdgen_message_sources(awaited); ++i) {
            awaited->sources[i] =
                icdgen_stream_number(&awaited->exchange->sources[i], slot.sent_id, slot.data, slot.length);
        }
        *client->free = slot;
        client->free++;
        icdgen_set_time(client, now);
    }
    return status;
}

ICDGEN_API icd_status_t icd_client_request(icd_client_t *client, uint32_t now, uint32_t id)
{
    const icd_request_t request = {ICD_TELEMETRY, id, false, false, 0u, NULL, 0u};
    return icd_client_start(client, now, &request);
}

ICDGEN_API icd_status_t
icd_client_send(icd_client_t *client, uint32_t now, uint32_t id, const uint8_t *data, size_t length, bool repeat)
{
    const icd_request_t request = {ICD_TELECOMMAND, id, repeat, false, 0u, data, length};
    return icd_client_start(client, now, &request);
}

ICDGEN_API icd_status_t
icd_client_ask(icd_client_t *client, uint32_t now, uint32_t id, const uint8_t *data, size_t length, uint32_t reply)
{
    const icd_request_t request = {ICD_TELECOMMAND, id, false, true, reply, data, length};
    return icd_client_start(client, now, &request);
}

/*
 * Return whether the device handles the request now, and no response to another request could be taken for a response
 * to it.
 */
static inline bool icdgen_may_be_sent(const icd_client_t *client, const icd_slot_t *slot)
{
    size_t in_flight = 0;
    size_t awaited = client->late_count;
    if (client->in_gap || !icdgen_has_responses(slot)) {
        return !client->in_gap;
    }
    for (const icd_slot_t *other = client->slots; other != client->free; ++other) {
        if (other == slot) {
            continue;
        }
        if (other->state == ICD_SLOT_WAIT || other->state == ICD_SLOT_PAUSE) {
            in_flight++;
        }
        /* Also a request that is to be sent again: otherwise each could wait until the other has ended. */
        if (other->missing != 0u) {
            if (icdgen_is_like(&slot->awaited, &other->awaited)) {
                return false;
            }
            awaited++;
        }
    }
    for (size_t i = 0; i < client->late_count; ++i) {
        if (icdgen_is_like(&slot->awaited, &client->late[i])) {
            return false;
        }
    }
    return in_flight < client->settings.in_flight && awaited < ICDGEN_MOST_AWAITED;
}

/* Return the next request to send; NULL if none may be sent. */
static inline icd_slot_t *icdgen_next_to_send(const icd_client_t *client)
{
    icd_slot_t *const slot = icdgen_queued(client);
    return slot != NULL && icdgen_may_be_sent(client, slot) ? slot : NULL;
}

/* The output of a request is taken: its times count from now. */
static inline void icdgen_count_times(icd_client_t *client, icd_slot_t *slot)
{
    client->sent_at = client->now;
    client->in_gap = client->settings.gap != 0u;
    slot->sent_at = client->now;
    slot->until = client->now + (slot->state == ICD_SLOT_WAIT ? icdgen_timeout(client, &slot->awaited) : 0u);
    if (!icdgen_is_polled(slot)) {
        slot->awaited.latest = slot->until;
    }
}

/* Begin an attempt of a request. */
static inline void icdgen_begin_attempt(icd_client_t *client, icd_slot_t *slot)
{
    slot->attempts++;
    slot->missing = ICDGEN_U8(icdgen_needed(&slot->awaited));
    slot->state = slot->missing != 0u || icdgen_has_results(client) ? ICD_SLOT_WAIT : ICD_SLOT_SENT;
    icdgen_count_times(client, slot);
}

/* Expect the responses to a transmission of a request. */
static inline void icdgen_owe(icd_slot_t *slot)
{
    icd_awaited_t *const awaited = &slot->awaited;
    for (size_t i = 0; i < ICDGEN_NEEDED_VERDICTS && !icdgen_is_in_order(awaited); ++i) {
        awaited->owed[i] = ICDGEN_U16(awaited->owed[i] + ((ICDGEN_U32(slot->missing) >> i) & 1u));
    }
}

/* Count a transmission of a request. */
static inline void icdgen_count_sent(icd_client_t *client, icd_slot_t *slot)
{
    icdgen_begin_attempt(client, slot);
    icdgen_owe(slot);
}

/* The last part of the output of a request is taken. The request may have ended before. */
static inline void icdgen_output_ends(icd_client_t *client)
{
    for (icd_slot_t *slot = client->slots; slot != client->free; ++slot) {
        if (slot->data == client->partial && slot->state != ICD_SLOT_QUEUED) {
            icdgen_count_times(client, slot);
        }
    }
    client->partial = NULL;
}

ICDGEN_API bool icd_client_output(icd_client_t *client, uint8_t *buffer, size_t capacity, size_t *written)
{
    *written = 0;
    return client->line != NULL && client->line->output != NULL &&
        client->line->output(client, buffer, capacity, written);
}

/* Report an event of a request. An outcome ends the request. */
static inline void icdgen_report(const icdgen_call_t *call, icd_event_kind_t kind, icd_slot_t *slot, icd_event_t *event)
{
    event->kind = kind;
    event->has_id = true;
    event->id = slot->id;
    event->link = call->client->link;
    event->direction = slot->direction;
    event->attempts = slot->attempts;
    if (kind != ICD_EVENT_PROGRESS && kind != ICD_EVENT_REPLY) {
        icdgen_request_end(call->client, slot);
    }
    call->on_event(call->context, event);
}

/* End a request without a response. */
static inline void icdgen_end_request(const icdgen_call_t *call, icd_event_kind_t kind, icd_slot_t *slot)
{
    icd_event_t event;
    icdgen_event_init(&event, kind);
    icdgen_report(call, kind, slot, &event);
}

/*
 * Process a missing or unusable response: poll or send again, or end the request. Return whether the request has ended.
 */
static inline bool icdgen_unanswered(const icdgen_call_t *call, icd_slot_t *slot)
{
    const icd_client_t *const client = call->client;
    const bool is_left = icdgen_is_polled(slot) ? !icdgen_reached(client->now, slot->poll_end)
                                                : slot->repeat && slot->attempts <= client->settings.retries;
    slot->transaction = 0; /* I2C */
    if (!is_left) {
        icdgen_end_request(call, ICD_EVENT_TIMEOUT, slot);
    } else if (!icdgen_has_results(client)) {
        slot->state = ICD_SLOT_QUEUED;
    } else { /* a failure can be immediate: wait before the next attempt */
        slot->state = ICD_SLOT_PAUSE;
        slot->until = client->now + client->settings.poll_interval;
        if (!slot->is_polled) {
            slot->poll_end = client->now + client->settings.poll_timeout;
        }
    }
    return !is_left;
}

/* Process the end of the time of a state. Return whether the request has ended. */
static inline bool icdgen_state_ends(const icdgen_call_t *call, icd_slot_t *slot)
{
    const icd_client_t *const client = call->client;
    if (slot->state == ICD_SLOT_SENT) {
        icdgen_end_request(call, ICD_EVENT_SENT, slot);
        return true;
    }
    if (slot->state == ICD_SLOT_WAIT) {
        return icdgen_unanswered(call, slot);
    }
    if (icdgen_has_results(client) && icdgen_reached(client->now, slot->poll_end)) {
        icdgen_end_request(call, ICD_EVENT_TIMEOUT, slot);
        return true;
    }
    slot->state = ICD_SLOT_QUEUED;
    return false;
}

ICDGEN_API void icd_client_tick(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context)
{
    const icdgen_call_t call = {client, on_event, context};
    icd_slot_t *slot = client->slots;
    if (client->line == NULL) {
        return;
    }
    if (ICDGEN_HAS_BUS(ICD_BUS_CAN) && client->line->expire != NULL) {
        client->line->expire(&call, now);
    }
    icdgen_set_time(client, now);
    while (slot < client->free) { /* a callback may cancel requests */
        const bool is_over = icdgen_has_end(client, slot) && icdgen_reached(now, slot->until);
        if (!is_over || !icdgen_state_ends(&call, slot)) {
            slot++;
        }
    }
}

/* Get the reason of a refusal, or why the device is busy. */
static inline void icdgen_set_reason(const icd_link_t *link, const icd_response_t *response, icd_event_t *event)
{
    if (ICDGEN_RESPONSES_HAVE(ICDGEN_RESPONSE_REASON) && response->reason != NULL) {
        event->has_code = true;
        event->code = icdgen_stream_number(response->reason, event->id, event->data, event->length);
        event->may_be_damaged = link->reason_count > 0u;
        for (size_t i = 0; i < link->reason_count; ++i) {
            event->may_be_damaged = event->may_be_damaged && link->reasons[i] != event->code;
        }
    }
    if (ICDGEN_RESPONSES_HAVE(ICDGEN_RESPONSE_DETAIL) && response->detail != NULL) {
        event->has_detail = true;
        event->detail = icdgen_stream_number(response->detail, event->id, event->data, event->length);
    }
}

/* Process a response to a request. */
static inline void icdgen_responded(
    const icdgen_call_t *call, icd_slot_t *slot, const icd_response_t *response, icd_event_t *event)
{
    icd_client_t *const client = call->client;
    const icd_verdict_t verdict = icdgen_verdict(response, event);
    const bool is_left = slot->attempts <= client->settings.retries;
    icd_event_kind_t kind = ICD_EVENT_PROGRESS;
    event->has_reply = !event->is_packet;
    event->reply = event->id;
    icdgen_settle(&slot->awaited, verdict);
    if (ICDGEN_IS_VERDICT(verdict, ICD_VERDICT_PROGRESS)) {
        const uint32_t limit = slot->sent_at + client->settings.progress_for;
        const uint32_t extended = client->now + icdgen_timeout(client, &slot->awaited);
        const uint32_t latest = icdgen_reached(extended, limit) ? limit : extended;
        if (icdgen_reached(latest, slot->awaited.latest)) {
            slot->awaited.latest = latest;
        }
        if (slot->state == ICD_SLOT_WAIT) {
            slot->until = slot->awaited.latest;
        }
    } else if (ICDGEN_IS_VERDICT(verdict, ICD_VERDICT_ACK) || ICDGEN_IS_VERDICT(verdict, ICD_VERDICT_REPLY)) {
        slot->missing = ICDGEN_U8(slot->missing & ~icdgen_verdict_bit(verdict));
        if (slot->missing == 0u) {
            kind = ICD_EVENT_DONE;
        } else if (ICDGEN_IS_VERDICT(verdict, ICD_VERDICT_REPLY)) {
            kind = ICD_EVENT_REPLY;
        } else {
            /* the reply is still to come */
        }
    } else if (ICDGEN_IS_VERDICT(verdict, ICD_VERDICT_BUSY) && is_left) {
        slot->state = ICD_SLOT_PAUSE;
        slot->until = client->now + client->settings.busy_pause;
    } else if (ICDGEN_IS_VERDICT(verdict, ICD_VERDICT_AGAIN) && is_left && client->checks_telecommands) {
        slot->state = ICD_SLOT_QUEUED;
        slot->is_polled = false;
        return;
    } else {
        kind = ICDGEN_IS_VERDICT(verdict, ICD_VERDICT_BUSY) ? ICD_EVENT_BUSY : ICD_EVENT_REFUSED;
        icdgen_set_reason(client->link, response, event);
    }
    icdgen_report(call, kind, slot, event);
}

/* Return whether telemetry is a response to a request that has ended. */
static inline bool icdgen_is_late(icd_client_t *client, const icd_event_t *event)
{
    for (size_t i = 0; i < client->late_count; ++i) {
        const icd_response_t *const response = icdgen_matching(&client->late[i], event);
        if (response != NULL) {
            icdgen_settle(&client->late[i], icdgen_verdict(response, event));
            icdgen_forget(client);
            return true;
        }
    }
    return false;
}

/* Process telemetry or a packet without a message. `unawaited` is its event if it is no response to any request. */
static inline void icdgen_client_arrived(const icdgen_call_t *call, icd_event_t *event, icd_event_kind_t unawaited)
{
    icd_client_t *const client = call->client;
    event->link = client->link;
    event->direction = ICD_TELEMETRY;
    for (icd_slot_t *slot = client->slots; slot != client->free; ++slot) {
        const icd_response_t *const response = icdgen_is_awaited(slot) ? icdgen_matching(&slot->awaited, event) : NULL;
        if (response != NULL) {
            icdgen_responded(call, slot, response, event);
            return;
        }
    }
    event->kind = icdgen_is_late(client, event) ? ICD_EVENT_LATE : unawaited;
    call->on_event(call->context, event);
}

ICDGEN_API void icd_client_received(
    icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context)
{
    const icdgen_call_t call = {client, on_event, context};
    icd_client_tick(client, now, on_event, context);
    if (client->line != NULL && client->line->received != NULL) {
        client->line->received(&call, bytes, count);
    }
}

ICDGEN_API void icd_client_cancel(icd_client_t *client)
{
    client->partial = NULL;
    while (client->free != client->slots) {
        icdgen_request_end(client, client->slots);
    }
}

ICDGEN_API void icd_client_cancel_request(icd_client_t *client, icd_direction_t direction, uint32_t id)
{
    icd_slot_t *slot = client->slots;
    while (slot != client->free) {
        if (slot->direction == direction && slot->id == id) {
            client->partial = slot->data == client->partial ? NULL : client->partial;
            icdgen_request_end(client, slot);
        } else {
            slot++;
        }
    }
}

ICDGEN_API bool icd_is_telemetry(const icd_event_t *event, const char *node, uint32_t id)
{
    const bool arrived = event->kind == ICD_EVENT_ARRIVED || event->kind == ICD_EVENT_LATE ||
        event->kind == ICD_EVENT_STRAY || event->kind == ICD_EVENT_MESSAGE;
    const bool brings = event->has_reply || (arrived && event->direction == ICD_TELEMETRY && !event->is_packet);
    return brings && (event->has_reply ? event->reply : event->id) == id && event->link != NULL &&
        icd_has_messages_of(event->link, node);
}

#endif /* ICDGEN_WIRE_CLIENT_C */
