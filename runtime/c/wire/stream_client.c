#ifndef ICDGEN_WIRE_STREAM_CLIENT_C
#define ICDGEN_WIRE_STREAM_CLIENT_C

#include "stream_client.h"
#include "events.c"
#include "stream_decode.c"

/* Return the largest number of data bytes of a request. */
static inline size_t icdgen_request_bytes(const icd_stream_form_t *form)
{
    size_t most = form->request != NULL ? form->packets[form->request->packet].reserved : 0u;
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

static inline uint32_t icdgen_verdict_bit(icd_verdict_t verdict)
{
    return UINT32_C(1) << ICDGEN_U32(verdict);
}

static inline bool icdgen_is_same_place(const icd_number_place_t *a, const icd_number_place_t *b)
{
    return a->at == b->at && a->size == b->size && a->shift == b->shift && a->bits == b->bits && a->little == b->little;
}

/* The reply that the caller specified, or the requested telemetry. Its id is in icd_stream_awaited_t. */
static const icd_response_t icdgen_specified_reply = {
    0u, ICD_VERDICT_REPLY, 0u, false, 0u, NULL, NULL, {0u, 0u, 0u, 0u, false}, {0u, 0u, 0u, 0u, false}};

/* Return what a response can mean, as a mask of verdicts. */
static inline uint32_t icdgen_verdicts(const icd_response_t *response)
{
    uint32_t verdicts = icdgen_verdict_bit(response->verdict);
    for (size_t i = 0; i < response->meaning_count; ++i) {
        verdicts |= icdgen_verdict_bit(response->meanings[i].verdict);
    }
    return verdicts;
}

static inline bool icdgen_can_be_reply(const icd_response_t *response)
{
    return (icdgen_verdicts(response) & icdgen_verdict_bit(ICD_VERDICT_REPLY)) != 0u;
}

/*
 * Return the possible response to a request at a position or after it, and advance the position. NULL if there is none.
 * The reply that the caller specified takes the place of those in the ICD, and is the last; requested telemetry is the
 * first.
 */
static inline const icd_response_t *icdgen_next_response(const icd_stream_awaited_t *awaited, size_t *position)
{
    const icd_exchange_t *const exchange = awaited->exchange;
    const bool has_reply = awaited->reply != NULL;
    const size_t own = exchange->is_request ? ICDGEN_SIZE(0) : exchange->response_count;
    while (*position <= exchange->response_count) {
        const size_t i = *position;
        (*position)++;
        if (i == own) {
            if (has_reply) {
                return &icdgen_specified_reply;
            }
        } else {
            const icd_response_t *const response = &exchange->responses[i - (i > own ? 1u : 0u)];
            if (!has_reply || !icdgen_can_be_reply(response)) {
                return response;
            }
        }
    }
    return NULL;
}

static inline uint32_t icdgen_response_source(const icd_stream_awaited_t *awaited, const icd_response_t *response)
{
    return response == &icdgen_specified_reply ? awaited->reply->id : response->source;
}

/* Return the verdicts without which a request is not done, as a mask. */
static inline uint32_t icdgen_needed(const icd_stream_awaited_t *awaited)
{
    uint32_t verdicts = 0;
    size_t position = 0;
    const icd_response_t *response = icdgen_next_response(awaited, &position);
    while (response != NULL) {
        verdicts |= icdgen_verdicts(response);
        response = icdgen_next_response(awaited, &position);
    }
    return verdicts & (icdgen_verdict_bit(ICD_VERDICT_ACK) | icdgen_verdict_bit(ICD_VERDICT_REPLY));
}

/* Return the response to a request that telemetry or a packet is; NULL if it is none of them. */
static inline const icd_response_t *icdgen_matching(
    const icd_stream_awaited_t *awaited, const icd_stream_event_t *event)
{
    const uint32_t source = event->is_packet ? event->packet : event->id;
    size_t position = 0;
    const icd_response_t *response = icdgen_next_response(awaited, &position);
    while (response != NULL) {
        bool matches = icdgen_response_source(awaited, response) == source && response->is_packet == event->is_packet;
        for (size_t i = 0; matches && i < response->echo_count; ++i) {
            const icd_echo_t *const echo = &response->echoes[i];
            matches = icdgen_stream_number(&echo->place, event->id, event->data, event->length) ==
                awaited->sources[echo->source];
        }
        if (matches) {
            break;
        }
        response = icdgen_next_response(awaited, &position);
    }
    return response;
}

/* Return the number of sources in id and data, which are known before the packet is sent: its header is not. */
static inline size_t icdgen_message_sources(const icd_stream_awaited_t *awaited)
{
    return ICDGEN_SIZE(awaited->exchange->source_count) - awaited->exchange->header_count;
}

/* Return whether the responses to two requests have different numbers at the same place. */
static inline bool icdgen_differs_in_echo(
    const icd_stream_awaited_t *a,
    const icd_response_t *response_a,
    const icd_stream_awaited_t *b,
    const icd_response_t *response_b)
{
    for (size_t i = 0; i < response_a->echo_count; ++i) {
        const icd_echo_t *const echo = &response_a->echoes[i];
        for (size_t j = 0; j < response_b->echo_count; ++j) {
            const icd_echo_t *const other = &response_b->echoes[j];
            if (icdgen_is_same_place(&echo->place, &other->place) && echo->source < icdgen_message_sources(a) &&
                other->source < icdgen_message_sources(b) && a->sources[echo->source] != b->sources[other->source]) {
                return true;
            }
        }
    }
    return false;
}

/* Return the expected telemetry, if it comes in a packet without its id; otherwise NULL. */
static inline const icd_stream_row_t *icdgen_nameless(const icd_stream_awaited_t *awaited)
{
    const icd_stream_row_t *const row = awaited->reply;
    return row != NULL && (row->flags & ICD_STREAM_NAMELESS) != 0u ? row : NULL;
}

/* Return whether a response to one request could be taken for a response to the other. */
static inline bool icdgen_is_like(const icd_stream_awaited_t *a, const icd_stream_awaited_t *b)
{
    if (icdgen_nameless(a) != NULL && icdgen_nameless(b) != NULL) {
        return true;
    }
    size_t position_a = 0;
    const icd_response_t *of_a = icdgen_next_response(a, &position_a);
    while (of_a != NULL) {
        size_t position_b = 0;
        const icd_response_t *of_b = icdgen_next_response(b, &position_b);
        while (of_b != NULL) {
            const bool is_same = icdgen_response_source(a, of_a) == icdgen_response_source(b, of_b) &&
                of_a->is_packet == of_b->is_packet;
            if (is_same && !icdgen_differs_in_echo(a, of_a, b, of_b)) {
                return true;
            }
            of_b = icdgen_next_response(b, &position_b);
        }
        of_a = icdgen_next_response(a, &position_a);
    }
    return false;
}

static inline icd_verdict_t icdgen_verdict(const icd_response_t *response, const icd_stream_event_t *event)
{
    if (response->status.bits != 0u) {
        const uint32_t status = icdgen_stream_number(&response->status, event->id, event->data, event->length);
        for (size_t i = 0; i < response->meaning_count; ++i) {
            if (response->meanings[i].value == status) {
                return response->meanings[i].verdict;
            }
        }
    }
    return response->verdict;
}

static inline bool icdgen_is_owed(const icd_stream_awaited_t *awaited)
{
    return awaited->owed[ICD_VERDICT_ACK] != 0u || awaited->owed[ICD_VERDICT_REPLY] != 0u;
}

/* Count a response. A refusal takes the place of all others to the same transmission. */
static inline void icdgen_settle(icd_stream_awaited_t *awaited, icd_verdict_t verdict)
{
    for (size_t i = 0; i < ICDGEN_NEEDED_VERDICTS; ++i) {
        const bool settles = ICDGEN_SIZE(verdict) == i || verdict == ICD_VERDICT_NAK || verdict == ICD_VERDICT_BUSY;
        if (settles && awaited->owed[i] != 0u) {
            awaited->owed[i]--;
        }
    }
}

static inline uint32_t icdgen_stream_timeout(const icd_stream_client_t *client, const icd_stream_awaited_t *awaited)
{
    return awaited->exchange->timeout != 0u ? awaited->exchange->timeout : client->settings.reply_timeout;
}

/* Return the time at which a late response to a request can no longer arrive. */
static inline uint32_t icdgen_late_end(const icd_stream_client_t *client, const icd_stream_awaited_t *awaited)
{
    return awaited->latest + client->settings.late;
}

/*
 * Return whether a late response to a request can still arrive. An idle client may not be called for so long that the
 * clock wraps around, so a time in the future is only one that is not further away than it can be.
 */
static inline bool icdgen_can_be_late(const icd_stream_client_t *client, const icd_stream_awaited_t *awaited)
{
    const uint32_t left = icdgen_late_end(client, awaited) - client->now;
    return left != 0u && left <= icdgen_stream_timeout(client, awaited) + client->settings.late;
}

/* Remove an entry of the late responses. */
static inline void icdgen_stream_forget(icd_stream_client_t *client, size_t index)
{
    client->late_count--;
    for (size_t i = index; i < client->late_count; ++i) {
        client->late[i] = client->late[i + 1u];
    }
}

/* Store the time, and drop what has passed. */
static inline void icdgen_stream_set_time(icd_stream_client_t *client, uint32_t now)
{
    size_t i = 0;
    client->now = now;
    client->in_gap = client->in_gap && now - client->sent_at < client->settings.gap;
    while (i < client->late_count) {
        if (icdgen_can_be_late(client, &client->late[i])) {
            i++;
        } else {
            icdgen_stream_forget(client, i);
        }
    }
}

/* Return whether the packet of requests is sent for a request, and `row` is the requested telemetry. */
static inline bool icdgen_is_by_packet(const icd_stream_slot_t *slot)
{
    return (slot->row->flags & ICD_STREAM_REQUESTED) != 0u;
}

/* Return the id with which a request was started. */
static inline uint32_t icdgen_request_id(const icd_stream_slot_t *slot)
{
    return slot->direction == ICD_TELEMETRY && !icdgen_is_by_packet(slot) ? slot->row->requested : slot->row->id;
}

/* End a request, and remember the responses that may still arrive. */
static inline void icdgen_request_end(icd_stream_client_t *client, size_t index)
{
    const icd_stream_awaited_t *const awaited = &client->slots[index].awaited;
    uint8_t *const data = client->slots[index].data;
    if (icdgen_is_owed(awaited) && icdgen_can_be_late(client, awaited) && client->late_count < ICDGEN_MOST_AWAITED) {
        client->late[client->late_count] = *awaited;
        client->late_count++;
    }
    client->started--;
    for (size_t i = index; i < client->started; ++i) {
        client->slots[i] = client->slots[i + 1u];
    }
    client->slots[client->started].data = data;
}

/* Return the oldest request that is to be sent; NULL if there is none. */
static inline icd_stream_slot_t *icdgen_stream_queued(const icd_stream_client_t *client)
{
    for (size_t i = 0; i < client->started; ++i) {
        if (client->slots[i].state == ICD_STREAM_SLOT_QUEUED) {
            return &client->slots[i];
        }
    }
    return NULL;
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

ICDGEN_API bool icd_stream_client_deadline(const icd_stream_client_t *client, uint32_t *deadline)
{
    icdgen_earliest_t earliest = {0u, false};
    for (size_t i = 0; i < client->started; ++i) {
        if (client->slots[i].state != ICD_STREAM_SLOT_QUEUED) {
            icdgen_earliest_add(&earliest, client->slots[i].until);
        }
    }
    if (icdgen_stream_queued(client) != NULL) {
        /* It may be possible to send the request then. */
        if (client->in_gap) {
            icdgen_earliest_add(&earliest, client->sent_at + client->settings.gap);
        }
        for (size_t i = 0; i < client->late_count; ++i) {
            icdgen_earliest_add(&earliest, icdgen_late_end(client, &client->late[i]));
        }
    }
    *deadline = earliest.time;
    return earliest.exists;
}

/*
 * Return what is sent to request telemetry: the first telecommand that requests it, or the telemetry itself for the
 * packet of requests. NULL if nothing requests it.
 */
static inline const icd_stream_row_t *icdgen_stream_asking(const icd_stream_form_t *form, uint32_t id)
{
    for (size_t i = 0; i < form->row_counts[ICD_TELECOMMAND]; ++i) {
        const icd_stream_row_t *const row = &form->rows[ICD_TELECOMMAND][i];
        if ((row->flags & ICD_STREAM_REQUESTS) != 0u && row->requested == id) {
            return row;
        }
    }
    const icd_stream_row_t *const telemetry = icdgen_stream_row(form, ICD_TELEMETRY, id);
    return telemetry != NULL && (telemetry->flags & ICD_STREAM_REQUESTED) != 0u ? telemetry : NULL;
}

/* Return whether telemetry is a possible reply in the ICD. */
static inline bool icdgen_has_reply(const icd_exchange_t *exchange, uint32_t id)
{
    for (size_t i = 0; i < exchange->response_count; ++i) {
        const icd_response_t *const response = &exchange->responses[i];
        if (!response->is_packet && response->source == id && icdgen_can_be_reply(response)) {
            return true;
        }
    }
    return false;
}

/* Return the packet that is sent for a request. */
static inline icdgen_outgoing_t icdgen_stream_outgoing(const icd_stream_client_t *client, const icd_stream_slot_t *slot)
{
    return icdgen_outgoing_row(client->sender.link->stream, ICD_TELECOMMAND, slot->row, slot->data, slot->length);
}

ICDGEN_API icd_status_t
icd_stream_client_start(icd_stream_client_t *client, uint32_t now, const icd_stream_request_t *request)
{
    static const icd_exchange_t no_exchange = {NULL, NULL, 0u, 0u, 0u, false, 0u};
    const bool asks = request->direction == ICD_TELEMETRY;
    if (!client->ready) {
        return ICD_ERROR_UNSUPPORTED;
    }
    const icd_stream_form_t *const form = client->sender.link->stream;
    const icd_stream_row_t *const row =
        asks ? icdgen_stream_asking(form, request->id) : icdgen_stream_row(form, ICD_TELECOMMAND, request->id);
    if (row == NULL) {
        const bool is_known = asks && icdgen_stream_row(form, ICD_TELEMETRY, request->id) != NULL;
        return is_known ? ICD_ERROR_UNSUPPORTED : ICD_ERROR_UNKNOWN_ID;
    }
    const bool has_reply = request->has_reply && !asks;
    const icd_stream_row_t *const reply = has_reply ? icdgen_stream_row(form, ICD_TELEMETRY, request->reply) : NULL;
    if (has_reply && reply == NULL) {
        return ICD_ERROR_UNKNOWN_ID;
    }
    if (client->started == client->slot_count) {
        return ICD_ERROR_BUSY;
    }
    icd_stream_slot_t *const slot = &client->slots[client->started];
    uint8_t *const data = slot->data;
    (void)memset(slot, 0, sizeof *slot);
    slot->row = row;
    slot->data = data;
    slot->direction = request->direction;
    const bool by_packet = icdgen_is_by_packet(slot);
    slot->length = request->length;
    if (by_packet) {
        slot->length = form->packets[form->request->packet].reserved;
    } else if (asks) {
        slot->length = row->least;
    } else if (request->length < row->least || request->length > row->most) {
        return ICD_ERROR_LENGTH;
    } else {
        /* the length fits */
    }
    for (size_t i = 0; i < slot->length; ++i) {
        data[i] = asks ? 0u : request->data[i];
    }
    /* Without a buffer, this only checks whether header and trailer values fit into their fields. */
    size_t written = 0;
    const icdgen_outgoing_t outgoing = icdgen_stream_outgoing(client, slot);
    if (icdgen_outgoing_encode(&outgoing, &client->sender.values, NULL, 0, &written) == ICD_ERROR_RANGE) {
        return ICD_ERROR_RANGE;
    }
    slot->repeat = request->repeat || asks || (row->flags & ICD_STREAM_REPEATS) != 0u;
    slot->state = ICD_STREAM_SLOT_QUEUED;
    const icd_exchange_t *exchange = by_packet ? form->request->exchange : row->exchange;
    if (exchange == NULL) {
        exchange = &no_exchange;
    }
    slot->awaited.exchange = exchange;
    if (by_packet) {
        slot->awaited.reply = row;
    } else if (reply != NULL && !icdgen_has_reply(exchange, reply->id)) {
        slot->awaited.reply = reply;
    } else {
        /* as in the ICD */
    }
    for (size_t i = 0; i < icdgen_message_sources(&slot->awaited); ++i) {
        slot->awaited.sources[i] = icdgen_stream_number(&exchange->sources[i], row->id, data, slot->length);
    }
    client->started++;
    icdgen_stream_set_time(client, now);
    return ICD_OK;
}

ICDGEN_API icd_status_t icd_stream_client_request(icd_stream_client_t *client, uint32_t now, uint32_t id)
{
    icd_stream_request_t request;
    (void)memset(&request, 0, sizeof request);
    request.direction = ICD_TELEMETRY;
    request.id = id;
    return icd_stream_client_start(client, now, &request);
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
    icd_stream_client_t *client, uint32_t now, uint32_t id, const uint8_t *data, size_t length, bool repeat)
{
    icd_stream_request_t request = icdgen_stream_telecommand(id, data, length);
    request.repeat = repeat;
    return icd_stream_client_start(client, now, &request);
}

ICDGEN_API icd_status_t icd_stream_client_ask(
    icd_stream_client_t *client, uint32_t now, uint32_t id, const uint8_t *data, size_t length, uint32_t reply)
{
    icd_stream_request_t request = icdgen_stream_telecommand(id, data, length);
    request.has_reply = true;
    request.reply = reply;
    return icd_stream_client_start(client, now, &request);
}

/*
 * Return whether the device handles the request now, and no response to another request could be taken for a response
 * to it.
 */
static inline bool icdgen_stream_may_be_sent(const icd_stream_client_t *client, const icd_stream_slot_t *slot)
{
    size_t in_flight = 0;
    size_t awaited = client->late_count;
    if (client->in_gap) {
        return false;
    }
    size_t position = 0;
    if (icdgen_next_response(&slot->awaited, &position) == NULL) {
        return true;
    }
    for (size_t i = 0; i < client->started; ++i) {
        const icd_stream_slot_t *const other = &client->slots[i];
        if (other == slot) {
            continue;
        }
        if (other->state == ICD_STREAM_SLOT_WAIT || other->state == ICD_STREAM_SLOT_PAUSE) {
            in_flight++;
        }
        /* Also a request that is to be sent again: otherwise each could wait until the other has ended. */
        if (other->missing != 0u) {
            awaited++;
            if (icdgen_is_like(&slot->awaited, &other->awaited)) {
                return false;
            }
        }
    }
    for (size_t i = 0; i < client->late_count; ++i) {
        if (icdgen_is_like(&slot->awaited, &client->late[i])) {
            return false;
        }
    }
    return in_flight < client->settings.in_flight && awaited < ICDGEN_MOST_AWAITED;
}

ICDGEN_API bool icd_stream_client_output(icd_stream_client_t *client, uint8_t *buffer, size_t capacity, size_t *written)
{
    icd_stream_slot_t *const slot = icdgen_stream_queued(client);
    if (slot == NULL || !icdgen_stream_may_be_sent(client, slot)) {
        return false;
    }
    icdgen_outgoing_t outgoing = icdgen_stream_outgoing(client, slot);
    outgoing.exchange = slot->awaited.exchange;
    outgoing.sources = slot->awaited.sources;
    if (icdgen_outgoing_send(&outgoing, &client->sender, &client->sender.values, buffer, capacity, written) != ICD_OK) {
        return false;
    }
    icd_stream_awaited_t *const awaited = &slot->awaited;
    client->sent_at = client->now;
    client->in_gap = client->settings.gap != 0u;
    slot->sent_at = client->now;
    slot->attempts++;
    slot->missing = ICDGEN_U8(icdgen_needed(awaited));
    slot->state = slot->missing != 0u ? ICD_STREAM_SLOT_WAIT : ICD_STREAM_SLOT_SENT;
    slot->until = client->now + (slot->missing != 0u ? icdgen_stream_timeout(client, awaited) : 0u);
    awaited->latest = slot->until;
    for (size_t i = 0; i < ICDGEN_NEEDED_VERDICTS; ++i) {
        awaited->owed[i] = ICDGEN_U16(awaited->owed[i] + ((ICDGEN_U32(slot->missing) >> i) & 1u));
    }
    return true;
}

/* A client and its event callback. */
typedef struct {
    icd_stream_client_t *client;
    icd_stream_event_fn *on_event;
    void *context;
} icdgen_stream_call_t;

/* Report an event of a request. An outcome ends the request. */
static inline void icdgen_stream_report(
    const icdgen_stream_call_t *call, icd_stream_kind_t kind, size_t index, icd_stream_event_t *event)
{
    const icd_stream_slot_t *const slot = &call->client->slots[index];
    event->kind = kind;
    event->has_id = true;
    event->id = icdgen_request_id(slot);
    event->link = call->client->sender.link;
    event->direction = slot->direction;
    event->attempts = slot->attempts;
    if (kind != ICD_STREAM_PROGRESS && kind != ICD_STREAM_REPLY) {
        icdgen_request_end(call->client, index);
    }
    call->on_event(call->context, event);
}

ICDGEN_API void icd_stream_client_tick(
    icd_stream_client_t *client, uint32_t now, icd_stream_event_fn *on_event, void *context)
{
    const icdgen_stream_call_t call = {client, on_event, context};
    size_t i = 0;
    icdgen_stream_set_time(client, now);
    while (i < client->started) {
        icd_stream_slot_t *const slot = &client->slots[i];
        const bool is_left = slot->repeat && slot->attempts <= client->settings.retries;
        if (slot->state == ICD_STREAM_SLOT_QUEUED || !icdgen_reached(now, slot->until)) {
            i++;
        } else if (slot->state == ICD_STREAM_SLOT_PAUSE || (slot->state == ICD_STREAM_SLOT_WAIT && is_left)) {
            slot->state = ICD_STREAM_SLOT_QUEUED;
            i++;
        } else {
            icd_stream_event_t event = icdgen_stream_event(ICD_STREAM_TIMEOUT);
            icdgen_stream_report(
                &call, slot->state == ICD_STREAM_SLOT_SENT ? ICD_STREAM_SENT : ICD_STREAM_TIMEOUT, i, &event);
        }
    }
}

/* Process a response to a request. */
static inline void icdgen_stream_responded(
    const icdgen_stream_call_t *call, size_t index, const icd_response_t *response, icd_stream_event_t *event)
{
    icd_stream_client_t *const client = call->client;
    icd_stream_slot_t *const slot = &client->slots[index];
    const icd_verdict_t verdict = icdgen_verdict(response, event);
    icd_stream_kind_t kind = ICD_STREAM_PROGRESS;
    event->has_reply = !event->is_packet;
    event->reply = event->id;
    icdgen_settle(&slot->awaited, verdict);
    if (verdict == ICD_VERDICT_PROGRESS) {
        const uint32_t limit = slot->sent_at + client->settings.progress_for;
        const uint32_t extended = client->now + icdgen_stream_timeout(client, &slot->awaited);
        const uint32_t latest = icdgen_reached(extended, limit) ? limit : extended;
        if (icdgen_reached(latest, slot->awaited.latest)) {
            slot->awaited.latest = latest;
        }
        if (slot->state == ICD_STREAM_SLOT_WAIT) {
            slot->until = slot->awaited.latest;
        }
    } else if (verdict == ICD_VERDICT_ACK || verdict == ICD_VERDICT_REPLY) {
        slot->missing = ICDGEN_U8(slot->missing & ~icdgen_verdict_bit(verdict));
        if (slot->missing == 0u) {
            kind = ICD_STREAM_DONE;
        } else if (verdict == ICD_VERDICT_REPLY) {
            kind = ICD_STREAM_REPLY;
        } else {
            /* the reply is still to come */
        }
    } else if (verdict == ICD_VERDICT_BUSY && slot->attempts <= client->settings.retries) {
        slot->state = ICD_STREAM_SLOT_PAUSE;
        slot->until = client->now + client->settings.busy_pause;
    } else {
        kind = verdict == ICD_VERDICT_BUSY ? ICD_STREAM_BUSY : ICD_STREAM_REFUSED;
        if (response->reason.bits != 0u) {
            event->has_code = true;
            event->code = icdgen_stream_number(&response->reason, event->id, event->data, event->length);
        }
    }
    icdgen_stream_report(call, kind, index, event);
}

/* Return whether telemetry is a response to a request that has ended. */
static inline bool icdgen_stream_is_late(icd_stream_client_t *client, const icd_stream_event_t *event)
{
    for (size_t i = 0; i < client->late_count; ++i) {
        const icd_response_t *const response = icdgen_matching(&client->late[i], event);
        if (response != NULL) {
            icdgen_settle(&client->late[i], icdgen_verdict(response, event));
            if (!icdgen_is_owed(&client->late[i])) {
                icdgen_stream_forget(client, i);
            }
            return true;
        }
    }
    return false;
}

/* Return whether telemetry only responds to telecommands. */
static inline bool icdgen_stream_confirms(const icd_stream_form_t *form, uint32_t id)
{
    for (size_t i = 0; i < form->confirming_count; ++i) {
        if (form->confirming[i] == id) {
            return true;
        }
    }
    return false;
}

/* Return whether data can be requested telemetry that comes without its id. Otherwise, keep it in `other`. */
static inline bool icdgen_names(
    const icd_stream_awaited_t *awaited, size_t length, const icd_stream_row_t **row, const icd_stream_row_t **other)
{
    *row = icdgen_nameless(awaited);
    const bool fits = *row != NULL && length >= (*row)->least && length <= (*row)->most;
    *other = *other == NULL ? *row : *other;
    return fits;
}

/*
 * A packet contains telemetry without its id: let the event be this telemetry, if it can be the response to a request.
 * If it has the length of none, it is ICD_STREAM_LENGTH; if no response is awaited, it stays the packet.
 */
static inline void icdgen_stream_identify(const icd_stream_client_t *client, icd_stream_event_t *event)
{
    const icd_packet_form_t *const packet = &client->sender.link->stream->packets[event->packet];
    const size_t length = event->length - icdgen_packet_around(packet);
    const icd_stream_row_t *row = NULL;
    const icd_stream_row_t *other = NULL;
    bool fits = false;
    for (size_t i = 0; !fits && i < client->started; ++i) {
        const icd_stream_slot_t *const slot = &client->slots[i];
        if (slot->state == ICD_STREAM_SLOT_WAIT || icdgen_is_owed(&slot->awaited)) {
            fits = icdgen_names(&slot->awaited, length, &row, &other);
        }
    }
    for (size_t i = 0; !fits && i < client->late_count; ++i) {
        fits = icdgen_names(&client->late[i], length, &row, &other);
    }
    if (fits) {
        event->kind = ICD_STREAM_MESSAGE;
        event->is_packet = false;
        event->id = row->id;
        event->data += packet->header_bytes;
        event->length = length;
    } else if (other != NULL) {
        *event = icdgen_stream_event(ICD_STREAM_LENGTH);
        event->has_id = true;
        event->id = other->id;
    } else {
        /* the packet itself */
    }
}

static inline void icdgen_stream_on_event(void *context, const icd_stream_event_t *found)
{
    const icdgen_stream_call_t *const call = ICDGEN_CAST(const icdgen_stream_call_t *, context);
    icd_stream_client_t *const client = call->client;
    icd_stream_event_t reported = *found;
    const icd_stream_event_t *const event = &reported;
    if (found->is_packet && client->sender.link->stream->packets[found->packet].content == ICD_PACKET_REQUESTED) {
        icdgen_stream_identify(client, &reported);
    }
    reported.link = client->sender.link;
    reported.direction = ICD_TELEMETRY;
    if (event->kind == ICD_STREAM_MESSAGE || event->kind == ICD_STREAM_PACKET) {
        for (size_t i = 0; i < client->started; ++i) {
            const icd_stream_slot_t *const slot = &client->slots[i];
            const bool is_awaited = slot->state == ICD_STREAM_SLOT_WAIT || icdgen_is_owed(&slot->awaited);
            const icd_response_t *const response = is_awaited ? icdgen_matching(&slot->awaited, event) : NULL;
            if (response != NULL) {
                icdgen_stream_responded(call, i, response, &reported);
                return;
            }
        }
        if (icdgen_stream_is_late(client, event)) {
            reported.kind = ICD_STREAM_LATE;
        } else if (event->is_packet || icdgen_stream_confirms(client->sender.link->stream, event->id)) {
            reported.kind = ICD_STREAM_STRAY;
        } else {
            /* unsolicited */
        }
    }
    call->on_event(call->context, &reported);
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
    call.on_event = on_event;
    call.context = context;
    icd_stream_client_tick(client, now, on_event, context);
    if (client->ready) {
        icd_stream_feed(&client->decoder, bytes, count, icdgen_stream_on_event, &call);
    }
}

ICDGEN_API void icd_stream_client_cancel(icd_stream_client_t *client)
{
    while (client->started != 0u) {
        icdgen_request_end(client, 0);
    }
}

ICDGEN_API void icd_stream_client_cancel_request(icd_stream_client_t *client, icd_direction_t direction, uint32_t id)
{
    size_t i = 0;
    while (i < client->started) {
        const icd_stream_slot_t *const slot = &client->slots[i];
        if (slot->direction == direction && icdgen_request_id(slot) == id) {
            icdgen_request_end(client, i);
        } else {
            i++;
        }
    }
}

ICDGEN_API bool icd_is_telemetry(const icd_stream_event_t *event, const char *node, uint32_t id)
{
    const bool arrived =
        event->kind == ICD_STREAM_MESSAGE || event->kind == ICD_STREAM_LATE || event->kind == ICD_STREAM_STRAY;
    const bool brings = event->has_reply || (arrived && event->direction == ICD_TELEMETRY && !event->is_packet);
    return brings && (event->has_reply ? event->reply : event->id) == id && event->link != NULL &&
        icd_has_messages_of(event->link, node);
}

#endif /* ICDGEN_WIRE_STREAM_CLIENT_C */
