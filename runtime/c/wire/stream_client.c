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

static inline uint32_t icdgen_verdict_bit(icd_verdict_t verdict)
{
    return UINT32_C(1) << ICDGEN_U32(verdict);
}

#define ICDGEN_NEEDED_VERDICTS 3u /* mask of ICD_VERDICT_ACK and ICD_VERDICT_REPLY */

/* Return a number of a message. See icd_number_place_t. */
static inline uint32_t icdgen_stream_number(
    const icd_number_place_t *place, uint32_t id, const uint8_t *data, size_t length)
{
    uint32_t number = 0;
    for (size_t i = 0; i < place->size; ++i) {
        const size_t at = ICDGEN_SIZE(place->at) + (place->little ? place->size - 1u - i : i);
        uint32_t byte = 0;
        if (at < sizeof id) {
            const uint32_t shift = 8u * (3u - ICDGEN_U32(at));
            byte = (id >> shift) & 0xFFu;
        } else if (at - sizeof id < length) {
            byte = data[at - sizeof id];
        } else {
            /* the message has no such byte */
        }
        number = (number << 8) | byte;
    }
    return (number >> place->shift) & (UINT32_C(0xFFFFFFFF) >> (32u - place->bits));
}

static inline bool icdgen_is_same_place(const icd_number_place_t *a, const icd_number_place_t *b)
{
    return a->at == b->at && a->size == b->size && a->shift == b->shift && a->bits == b->bits && a->little == b->little;
}

/* Return the number of possible responses to a request. */
static inline size_t icdgen_response_count(const icd_stream_awaited_t *awaited)
{
    return (awaited->exchange != NULL ? awaited->exchange->response_count : ICDGEN_SIZE(0)) +
        (awaited->has_reply ? 1u : 0u);
}

/*
 * Return a possible response to a request, and its id. The last is the reply that the caller specified, which replaces
 * that of the ICD: NULL for the latter.
 */
static inline const icd_response_t *icdgen_response(const icd_stream_awaited_t *awaited, size_t index, uint32_t *id)
{
    static const icd_response_t specified = {
        0u, ICD_VERDICT_REPLY, 0u, 0u, NULL, NULL, {0u, 0u, 0u, 0u, false}, {0u, 0u, 0u, 0u, false}};
    if (awaited->exchange == NULL || index == awaited->exchange->response_count) {
        *id = awaited->reply;
        return &specified;
    }
    const icd_response_t *const response = &awaited->exchange->responses[index];
    *id = response->telemetry;
    return awaited->has_reply && response->verdict == ICD_VERDICT_REPLY ? NULL : response;
}

/* Return the verdicts without which a request is not done, as a mask. */
static inline uint8_t icdgen_needed(const icd_stream_awaited_t *awaited)
{
    uint32_t needed = 0;
    for (size_t i = 0; i < icdgen_response_count(awaited); ++i) {
        uint32_t id = 0;
        const icd_response_t *const response = icdgen_response(awaited, i, &id);
        if (response != NULL) {
            needed |= icdgen_verdict_bit(response->verdict);
            for (size_t j = 0; j < response->meaning_count; ++j) {
                needed |= icdgen_verdict_bit(response->meanings[j].verdict);
            }
        }
    }
    return ICDGEN_U8(needed & ICDGEN_NEEDED_VERDICTS);
}

static inline uint32_t icdgen_needed_count(const icd_stream_awaited_t *awaited)
{
    return awaited->needed == ICDGEN_NEEDED_VERDICTS ? 2u : 1u;
}

/* Return the response to a request that telemetry is; NULL if it is none of them. */
static inline const icd_response_t *icdgen_matching(
    const icd_stream_awaited_t *awaited, const icd_stream_event_t *event)
{
    for (size_t i = 0; i < icdgen_response_count(awaited); ++i) {
        uint32_t id = 0;
        const icd_response_t *const response = icdgen_response(awaited, i, &id);
        bool matches = response != NULL && id == event->id;
        for (size_t j = 0; matches && j < response->echo_count; ++j) {
            const icd_echo_t *const echo = &response->echoes[j];
            matches = icdgen_stream_number(&echo->place, event->id, event->data, event->length) ==
                awaited->sources[echo->source];
        }
        if (matches) {
            return response;
        }
    }
    return NULL;
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
            if (icdgen_is_same_place(&echo->place, &other->place) &&
                a->sources[echo->source] != b->sources[other->source]) {
                return true;
            }
        }
    }
    return false;
}

/* Return whether a response to one request could be taken for a response to the other. */
static inline bool icdgen_is_like(const icd_stream_awaited_t *a, const icd_stream_awaited_t *b)
{
    for (size_t i = 0; i < icdgen_response_count(a); ++i) {
        uint32_t id_a = 0;
        const icd_response_t *const response_a = icdgen_response(a, i, &id_a);
        for (size_t j = 0; response_a != NULL && j < icdgen_response_count(b); ++j) {
            uint32_t id_b = 0;
            const icd_response_t *const response_b = icdgen_response(b, j, &id_b);
            if (response_b != NULL && id_a == id_b && !icdgen_differs_in_echo(a, response_a, b, response_b)) {
                return true;
            }
        }
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

/* Return the number of awaited responses that one stands for. */
static inline uint32_t icdgen_settled(const icd_stream_awaited_t *awaited, icd_verdict_t verdict)
{
    if (verdict == ICD_VERDICT_PROGRESS) {
        return 0u;
    }
    return verdict == ICD_VERDICT_ACK || verdict == ICD_VERDICT_REPLY ? 1u : icdgen_needed_count(awaited);
}

/* Count a response. */
static inline void icdgen_settle(icd_stream_awaited_t *awaited, icd_verdict_t verdict)
{
    const uint32_t count = icdgen_settled(awaited, verdict);
    awaited->owed = awaited->owed > count ? ICDGEN_U16(awaited->owed - count) : ICDGEN_U16(0);
}

static inline uint32_t icdgen_stream_timeout(const icd_stream_client_t *client, const icd_stream_awaited_t *awaited)
{
    const bool is_own = awaited->exchange != NULL && awaited->exchange->timeout != 0u;
    return is_own ? awaited->exchange->timeout : client->settings.reply_timeout;
}

/* Return how long after the transmission responses to a request can arrive. */
static inline uint32_t icdgen_stream_arrival(const icd_stream_client_t *client, const icd_stream_awaited_t *awaited)
{
    return icdgen_stream_timeout(client, awaited) + client->settings.late;
}

/* Remove an entry of the late responses. */
static inline void icdgen_stream_forget(icd_stream_client_t *client, size_t index)
{
    client->late_count--;
    for (size_t i = index; i < client->late_count; ++i) {
        client->late[i] = client->late[i + 1u];
    }
}

/*
 * Store the time, and drop what has passed. Times are compared by the time since the transmission: an idle client may
 * not be called for so long that the clock wraps around.
 */
static inline void icdgen_stream_set_time(icd_stream_client_t *client, uint32_t now)
{
    size_t i = 0;
    client->now = now;
    client->in_gap = client->in_gap && now - client->sent_at < client->settings.gap;
    while (i < client->late_count) {
        if (now - client->late[i].sent_at < icdgen_stream_arrival(client, &client->late[i])) {
            i++;
        } else {
            icdgen_stream_forget(client, i);
        }
    }
}

/* End a request, and remember the responses that may still arrive. */
static inline void icdgen_request_end(icd_stream_client_t *client, size_t index)
{
    const icd_stream_awaited_t *const awaited = &client->slots[index].awaited;
    uint8_t *const data = client->slots[index].data;
    if (awaited->owed != 0u && client->now - awaited->sent_at < icdgen_stream_arrival(client, awaited) &&
        client->late_count < ICDGEN_MOST_AWAITED) {
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

ICDGEN_API bool icd_stream_client_deadline(const icd_stream_client_t *client, uint32_t *deadline)
{
    uint32_t first = 0;
    bool waits = false;
    const bool queued = icdgen_stream_queued(client) != NULL;
    for (size_t i = 0; i < client->started; ++i) {
        const icd_stream_slot_t *const slot = &client->slots[i];
        if (slot->state != ICD_STREAM_SLOT_QUEUED) {
            first = waits && icdgen_reached(slot->until, first) ? first : slot->until;
            waits = true;
        }
    }
    if (queued && client->in_gap) {
        const uint32_t end = client->sent_at + client->settings.gap;
        first = waits && icdgen_reached(end, first) ? first : end;
        waits = true;
    }
    for (size_t i = 0; queued && i < client->late_count; ++i) {
        const uint32_t end = client->late[i].sent_at + icdgen_stream_arrival(client, &client->late[i]);
        first = waits && icdgen_reached(end, first) ? first : end;
        waits = true;
    }
    *deadline = first;
    return waits;
}

/* Return whether header and trailer values fit into their fields. */
static inline bool icdgen_stream_fits(const icd_stream_client_t *client, uint32_t id, size_t length)
{
    const icd_stream_sender_t *const sender = &client->sender;
    uint8_t header[ICDGEN_ENVELOPE_BYTES] = {0};
    uint8_t trailer[ICDGEN_ENVELOPE_BYTES] = {0};
    return icdgen_envelope_fill(client->link->stream, ICD_TELECOMMAND, id, length, &sender->values, header, trailer);
}

/* Return the telecommand that requests telemetry: the first one; NULL if there is none. */
static inline const icd_stream_row_t *icdgen_stream_asking(const icd_stream_form_t *form, uint32_t id)
{
    for (size_t i = 0; i < form->row_counts[ICD_TELECOMMAND]; ++i) {
        const icd_stream_row_t *const row = &form->rows[ICD_TELECOMMAND][i];
        if (row->is_request && row->requested == id) {
            return row;
        }
    }
    return NULL;
}

ICDGEN_API icd_status_t
icd_stream_client_start(icd_stream_client_t *client, uint32_t now, const icd_stream_request_t *request)
{
    const bool asks = request->direction == ICD_TELEMETRY;
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
    const size_t length = asks ? row->least : request->length;
    const bool has_reply = request->has_reply && !asks;
    if (has_reply && icdgen_stream_row(form, ICD_TELEMETRY, request->reply) == NULL) {
        return ICD_ERROR_UNKNOWN_ID;
    }
    if (client->started == client->slot_count) {
        return ICD_ERROR_BUSY;
    }
    if (length < row->least || length > row->most) {
        return ICD_ERROR_LENGTH;
    }
    if (!icdgen_stream_fits(client, row->id, length)) {
        return ICD_ERROR_RANGE;
    }
    icd_stream_slot_t *const slot = &client->slots[client->started];
    uint8_t *const data = slot->data;
    (void)memset(slot, 0, sizeof *slot);
    slot->row = row;
    slot->data = data;
    slot->length = length;
    for (size_t i = 0; i < length; ++i) {
        data[i] = asks ? 0u : request->data[i];
    }
    slot->repeat = request->repeat || asks || row->repeats;
    slot->direction = request->direction;
    slot->state = ICD_STREAM_SLOT_QUEUED;
    slot->awaited.exchange = row->exchange;
    slot->awaited.has_reply = has_reply;
    slot->awaited.reply = request->reply;
    slot->awaited.needed = icdgen_needed(&slot->awaited);
    for (size_t i = 0; row->exchange != NULL && i < row->exchange->source_count; ++i) {
        slot->awaited.sources[i] = icdgen_stream_number(&row->exchange->sources[i], row->id, data, length);
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
    if (icdgen_response_count(&slot->awaited) == 0u) {
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
    if (slot == NULL || !icdgen_stream_may_be_sent(client, slot) ||
        icd_stream_send(&client->sender, slot->row->id, slot->data, slot->length, buffer, capacity, written) !=
            ICD_OK) {
        return false;
    }
    icd_stream_awaited_t *const awaited = &slot->awaited;
    client->sent_at = client->now;
    client->in_gap = client->settings.gap != 0u;
    awaited->sent_at = client->now;
    slot->attempts++;
    slot->missing = awaited->needed;
    if (awaited->needed != 0u) {
        awaited->owed = ICDGEN_U16(awaited->owed + icdgen_needed_count(awaited));
        slot->state = ICD_STREAM_SLOT_WAIT;
        slot->until = client->now + icdgen_stream_timeout(client, awaited);
    } else {
        slot->state = ICD_STREAM_SLOT_SENT;
        slot->until = client->now;
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
    const icdgen_stream_call_t *call, icd_stream_kind_t kind, size_t index, const icd_stream_event_t *event)
{
    const icd_stream_slot_t *const slot = &call->client->slots[index];
    icd_stream_event_t reported = *event;
    reported.kind = kind;
    reported.has_id = true;
    reported.id = slot->direction == ICD_TELEMETRY ? slot->row->requested : slot->row->id;
    reported.link = call->client->link;
    reported.direction = slot->direction;
    reported.attempts = slot->attempts;
    if (kind != ICD_STREAM_PROGRESS && kind != ICD_STREAM_REPLY) {
        icdgen_request_end(call->client, index);
    }
    call->on_event(call->context, &reported);
}

ICDGEN_API void icd_stream_client_tick(
    icd_stream_client_t *client, uint32_t now, icd_stream_event_fn *on_event, void *context)
{
    const icdgen_stream_call_t call = {client, on_event, context};
    const icd_stream_event_t event = icdgen_stream_event(ICD_STREAM_TIMEOUT);
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
            icdgen_stream_report(
                &call, slot->state == ICD_STREAM_SLOT_SENT ? ICD_STREAM_SENT : ICD_STREAM_TIMEOUT, i, &event);
        }
    }
}

/* Process a response to a request. */
static inline void icdgen_stream_responded(
    const icdgen_stream_call_t *call, size_t index, const icd_response_t *response, const icd_stream_event_t *event)
{
    icd_stream_client_t *const client = call->client;
    icd_stream_slot_t *const slot = &client->slots[index];
    const icd_verdict_t verdict = icdgen_verdict(response, event);
    icd_stream_kind_t kind = ICD_STREAM_PROGRESS;
    icd_stream_event_t reported = *event;
    reported.has_reply = true;
    reported.reply = event->id;
    icdgen_settle(&slot->awaited, verdict);
    if (verdict == ICD_VERDICT_PROGRESS) {
        const uint32_t limit = slot->awaited.sent_at + client->settings.progress_for;
        const uint32_t extended = client->now + icdgen_stream_timeout(client, &slot->awaited);
        const uint32_t until = icdgen_reached(extended, limit) ? limit : extended;
        slot->until = icdgen_reached(slot->until, until) ? slot->until : until;
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
            reported.has_code = true;
            reported.code = icdgen_stream_number(&response->reason, event->id, event->data, event->length);
        }
    }
    icdgen_stream_report(call, kind, index, &reported);
}

/* Return whether telemetry is a response to a request that has ended. */
static inline bool icdgen_stream_is_late(icd_stream_client_t *client, const icd_stream_event_t *event)
{
    for (size_t i = 0; i < client->late_count; ++i) {
        const icd_response_t *const response = icdgen_matching(&client->late[i], event);
        if (response != NULL) {
            icdgen_settle(&client->late[i], icdgen_verdict(response, event));
            if (client->late[i].owed == 0u) {
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

static inline void icdgen_stream_on_event(void *context, const icd_stream_event_t *event)
{
    const icdgen_stream_call_t *const call = ICDGEN_CAST(const icdgen_stream_call_t *, context);
    icd_stream_client_t *const client = call->client;
    icd_stream_event_t reported = *event;
    reported.link = client->link;
    reported.direction = ICD_TELEMETRY;
    if (event->kind == ICD_STREAM_MESSAGE) {
        for (size_t i = 0; i < client->started; ++i) {
            const icd_stream_slot_t *const slot = &client->slots[i];
            const bool is_awaited = slot->state == ICD_STREAM_SLOT_WAIT || slot->awaited.owed != 0u;
            const icd_response_t *const response = is_awaited ? icdgen_matching(&slot->awaited, event) : NULL;
            if (response != NULL) {
                icdgen_stream_responded(call, i, response, event);
                return;
            }
        }
        if (icdgen_stream_is_late(client, event)) {
            reported.kind = ICD_STREAM_LATE;
        } else if (icdgen_stream_confirms(client->link->stream, event->id)) {
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
        const uint32_t own = slot->direction == ICD_TELEMETRY ? slot->row->requested : slot->row->id;
        if (slot->direction == direction && own == id) {
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
    const bool brings = event->has_reply || (arrived && event->direction == ICD_TELEMETRY);
    return brings && (event->has_reply ? event->reply : event->id) == id && event->link != NULL &&
        icd_has_messages_of(event->link, node);
}

#endif /* ICDGEN_WIRE_STREAM_CLIENT_C */
