#ifndef ICDGEN_WIRE_STREAM_LINE_C
#define ICDGEN_WIRE_STREAM_LINE_C

#include "client.c"
#include "stream_decode.c"

/* ---- client of a framed link ------------------------------------------------------------------------------------- */

/*
 * Return what is sent to request telemetry: the first telecommand that requests it, or the telemetry itself for the
 * packet of requests. NULL if nothing requests it.
 */
static inline const icd_stream_row_t *icdgen_stream_asking(const icd_stream_form_t *form, uint32_t id)
{
    for (size_t i = 0; i < form->row_counts[ICD_TELECOMMAND]; ++i) {
        const icd_stream_row_t *const row = &form->rows[ICD_TELECOMMAND][i];
        if (ICDGEN_HAS_FLAG(row, ICD_STREAM_REQUESTS) && row->requested == id) {
            return row;
        }
    }
    const icd_stream_row_t *const telemetry = icdgen_stream_row(form, ICD_TELEMETRY, id);
    return telemetry != NULL && ICDGEN_HAS_FLAG(telemetry, ICD_STREAM_REQUESTED) ? telemetry : NULL;
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

static inline icd_status_t icdgen_stream_plan(
    const icd_client_t *client, const icd_request_t *request, icd_slot_t *slot)
{
    const icd_stream_form_t *const form = client->link->stream;
    const bool asks = request->direction == ICD_TELEMETRY;
    const icd_stream_row_t *const row =
        asks ? icdgen_stream_asking(form, request->id) : icdgen_stream_row(form, ICD_TELECOMMAND, request->id);
    if (row == NULL) {
        const bool is_known = asks && icdgen_stream_row(form, ICD_TELEMETRY, request->id) != NULL;
        return is_known ? ICD_ERROR_UNSUPPORTED : ICD_ERROR_UNKNOWN_ID;
    }
    icd_awaited_t *const awaited = &slot->awaited;
    const bool by_id = ICDGEN_HAS_FLAG(row, ICD_STREAM_REQUESTED);
    const icd_exchange_t *const exchange = by_id ? form->request->exchange : row->exchange;
    awaited->exchange = exchange != NULL ? exchange : awaited->exchange;
    slot->asks_by_id = by_id;
    slot->sent_id = row->id;
    slot->repeat = slot->repeat || ICDGEN_HAS_FLAG(row, ICD_STREAM_REPEATS);
    if (by_id || (request->has_reply && !asks)) {
        awaited->reply = by_id ? row->id : request->reply;
        const icd_stream_row_t *const reply = icdgen_stream_row(form, ICD_TELEMETRY, awaited->reply);
        if (reply == NULL) {
            return ICD_ERROR_UNKNOWN_ID;
        }
        awaited->has_reply = by_id || !icdgen_has_reply(awaited->exchange, awaited->reply);
        awaited->is_nameless = awaited->has_reply && ICDGEN_HAS_FLAG(reply, ICD_STREAM_NAMELESS);
    }
    if (asks) {
        slot->length = by_id ? form->packets[form->request->packet].reserved : row->least;
        return ICD_OK;
    }
    slot->length = request->length;
    return request->length >= row->least && request->length <= row->most ? ICD_OK : ICD_ERROR_LENGTH;
}

/* Return the packet that is sent for a request. */
static inline icdgen_outgoing_t icdgen_stream_outgoing(const icd_client_t *client, const icd_slot_t *slot)
{
    const icd_stream_form_t *const form = client->link->stream;
    const icd_stream_row_t *const row =
        icdgen_stream_row(form, slot->asks_by_id ? ICD_TELEMETRY : ICD_TELECOMMAND, slot->sent_id);
    return icdgen_outgoing_row(form, ICD_TELECOMMAND, row, slot->data, slot->length);
}

static inline icd_status_t icdgen_stream_store(const icd_client_t *client, icd_slot_t *slot, const uint8_t *data)
{
    size_t written = 0;
    for (size_t i = 0; i < slot->length; ++i) {
        slot->data[i] = data != NULL ? data[i] : 0u;
    }
    /* Without a buffer, this only checks whether header and trailer values fit into their fields. */
    const icdgen_outgoing_t outgoing = icdgen_stream_outgoing(client, slot);
    const icd_status_t status = icdgen_outgoing_encode(&outgoing, &client->stream->sender.values, NULL, 0, &written);
    return status == ICD_ERROR_RANGE ? status : ICD_OK;
}

static inline bool icdgen_stream_output(icd_client_t *client, uint8_t *buffer, size_t capacity, size_t *written)
{
    icd_stream_sender_t *const sender = &client->stream->sender;
    icd_slot_t *const slot = icdgen_next_to_send(client);
    if (slot == NULL) {
        return false;
    }
    icdgen_outgoing_t outgoing = icdgen_stream_outgoing(client, slot);
    outgoing.exchange = slot->awaited.exchange;
    outgoing.sources = slot->awaited.sources;
    if (icdgen_outgoing_send(&outgoing, sender, &sender->values, buffer, capacity, written) != ICD_OK) {
        return false;
    }
    icdgen_count_sent(client, slot);
    return true;
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
    const icd_stream_form_t *form,
    const icd_awaited_t *awaited,
    size_t length,
    const icd_stream_row_t **row,
    const icd_stream_row_t **other)
{
    *row = awaited->is_nameless ? icdgen_stream_row(form, ICD_TELEMETRY, awaited->reply) : NULL;
    const bool fits = *row != NULL && length >= (*row)->least && length <= (*row)->most;
    *other = *other == NULL ? *row : *other;
    return fits;
}

/*
 * A packet contains telemetry without its id: let the event be this telemetry, if it can be the response to a request.
 * If it has the length of none, it is ICD_EVENT_LENGTH; if no response is awaited, it stays the packet.
 */
static inline void icdgen_stream_identify(const icd_client_t *client, icd_event_t *event)
{
    const icd_stream_form_t *const form = client->link->stream;
    const icd_packet_form_t *const packet = &form->packets[event->packet];
    const size_t length = event->length - icdgen_packet_around(packet);
    const icd_stream_row_t *row = NULL;
    const icd_stream_row_t *other = NULL;
    bool fits = false;
    for (const icd_slot_t *slot = client->slots; !fits && slot != client->free; ++slot) {
        if (icdgen_is_awaited(slot)) {
            fits = icdgen_names(form, &slot->awaited, length, &row, &other);
        }
    }
    for (size_t i = 0; !fits && i < client->late_count; ++i) {
        fits = icdgen_names(form, &client->late[i], length, &row, &other);
    }
    if (fits) {
        event->kind = ICD_EVENT_MESSAGE;
        event->is_packet = false;
        event->id = row->id;
        event->data += packet->header_bytes;
        event->length = length;
    } else if (other != NULL) {
        icdgen_event_of(event, ICD_EVENT_LENGTH, other->id);
    } else {
        /* the packet itself */
    }
}

static inline void icdgen_on_stream(const void *context, icd_event_t *event)
{
    const icdgen_call_t *const call = ICDGEN_CAST(const icdgen_call_t *, context);
    const icd_stream_form_t *const form = call->client->link->stream;
    if (event->is_packet && ICDGEN_CONTAINS(&form->packets[event->packet], ICD_PACKET_REQUESTED)) {
        icdgen_stream_identify(call->client, event);
    }
    if (event->kind == ICD_EVENT_MESSAGE || event->kind == ICD_EVENT_PACKET) {
        const bool is_stray = event->is_packet || icdgen_stream_confirms(form, event->id);
        icdgen_client_arrived(call, event, is_stray ? ICD_EVENT_STRAY : ICD_EVENT_ARRIVED);
    } else {
        event->link = call->client->link;
        event->direction = ICD_TELEMETRY;
        call->on_event(call->context, event);
    }
}

static inline void icdgen_stream_received(const icdgen_call_t *call, const uint8_t *bytes, size_t count)
{
    const icdgen_listener_t listener = {icdgen_on_stream, call};
    icdgen_stream_feed(&call->client->stream->decoder, bytes, count, &listener);
}

ICDGEN_API icd_status_t icd_client_stream(
    icd_client_t *client,
    const icd_link_t *link,
    icd_stream_line_t *line,
    icd_slot_t *slots,
    size_t slot_count,
    uint8_t *buffer,
    size_t size,
    uint32_t *sequences,
    size_t sequence_count)
{
    static const icd_line_t functions = {
        false, ICD_BUS_UART, icdgen_stream_plan, icdgen_stream_store, icdgen_stream_output, icdgen_stream_received,
        NULL,
    };
    const size_t half = sequence_count / 2u;
    icd_status_t status = icdgen_client_init(client, link, slots, slot_count, buffer, size);
    (void)memset(line, 0, sizeof *line);
    if (link->stream == NULL) {
        status = ICD_ERROR_UNSUPPORTED;
    }
    if (status == ICD_OK) {
        status = icd_stream_sender_init(&line->sender, link, ICD_TELECOMMAND, sequences, half);
    }
    if (status == ICD_OK) {
        status = icd_stream_decoder_init(
            &line->decoder, link, ICD_TELEMETRY, buffer, ICDGEN_SIZE(link->longest),
            (sequence_count > 0u) ? (sequences + half) : NULL, sequence_count - half);
    }
    if (status == ICD_OK) {
        client->stream = line;
        client->line = &functions;
        client->checks_telecommands = true; /* if a refusal can say that the checksum was wrong, there is one */
    }
    return status;
}

#endif /* ICDGEN_WIRE_STREAM_LINE_C */
