#ifndef ICDGEN_WIRE_I2C_LINE_C
#define ICDGEN_WIRE_I2C_LINE_C

#include "bus_line.c"

/* Return the request whose attempt has begun and whose transaction is not taken yet; NULL if there is none. */
static inline icd_slot_t *icdgen_i2c_untaken(const icd_client_t *client)
{
    for (icd_slot_t *slot = client->slots; slot != client->free; ++slot) {
        if (slot->state == ICD_SLOT_WAIT && slot->transaction == 0u) {
            return slot;
        }
    }
    return NULL;
}

/* Begin the next request or poll, whose times count from now. Return NULL if there is none. */
static inline icd_slot_t *icdgen_i2c_begun(icd_client_t *client)
{
    icd_slot_t *const slot = icdgen_next_to_send(client);
    if (slot != NULL && slot->is_polled) {
        slot->state = ICD_SLOT_WAIT;
        icdgen_count_times(client, slot);
    } else if (slot != NULL) {
        icdgen_begin_attempt(client, slot);
    } else {
        /* nothing is to be sent */
    }
    return slot;
}

ICDGEN_API bool icd_client_transfer(icd_client_t *client, const uint8_t **bytes, size_t *count, size_t *read)
{
    icd_i2c_line_t *const line = client->i2c;
    *read = 0;
    if (line == NULL) {
        return false;
    }
    icd_slot_t *slot = icdgen_i2c_untaken(client);
    if (slot == NULL) {
        slot = icdgen_i2c_begun(client);
    }
    if (slot == NULL || line->taken_count == ICDGEN_MOST_AWAITED) {
        return false;
    }
    icd_transaction_t *const transaction =
        &line->taken[(ICDGEN_U32(line->first) + line->taken_count) % ICDGEN_MOST_AWAITED];
    if (slot->is_polled) {
        line->poll_id = ICDGEN_U8(slot->awaited.exchange->poll->telemetry);
        *bytes = &line->poll_id;
        *count = 1;
    } else {
        *bytes = slot->data;
        *count = slot->length;
        icdgen_owe(slot);
    }
    line->taken_count++;
    line->last = line->last == 0xFFFFu ? ICDGEN_U16(1) : ICDGEN_U16(line->last + 1u);
    slot->transaction = line->last;
    transaction->number = line->last;
    transaction->id = **bytes;
    transaction->reads = slot->is_polled || slot->asks_by_id;
    if (transaction->reads) {
        (void)icd_i2c_read_length(client->link, transaction->id, client->checks_telemetry, read);
    }
    return true;
}

/* Remove the oldest transaction whose result is missing. Its number is 0 if there is none. */
static inline icd_transaction_t icdgen_i2c_untake(icd_i2c_line_t *line)
{
    icd_transaction_t transaction = {0u, 0u, false};
    if (line->taken_count != 0u) {
        transaction = line->taken[line->first];
        line->first = ICDGEN_U8((ICDGEN_U32(line->first) + 1u) % ICDGEN_MOST_AWAITED);
        line->taken_count--;
    }
    return transaction;
}

/* Return the request that awaits the result of a transaction; NULL if there is none. */
static inline icd_slot_t *icdgen_i2c_awaiting(const icd_client_t *client, uint16_t number)
{
    for (icd_slot_t *slot = client->slots; slot != client->free; ++slot) {
        if (slot->transaction == number && number != 0u) {
            return slot;
        }
    }
    return NULL;
}

/* Process telemetry that was read for a request. */
static inline void icdgen_i2c_result(const icdgen_call_t *call, icd_slot_t *slot, icd_event_t *event)
{
    const icd_outcome_poll_t *const poll = slot->awaited.exchange->poll;
    const icd_response_t *const response = icdgen_matching(&slot->awaited, event);
    if (response == NULL ||
        (poll != NULL && icdgen_stream_number(&poll->until, event->id, event->data, event->length) == 0u)) {
        (void)icdgen_unanswered(call, slot);
    } else {
        slot->transaction = 0;
        icdgen_responded(call, slot, response, event);
    }
}

/* A telecommand is written: poll its response, if it has one. */
static inline void icdgen_i2c_written(const icdgen_call_t *call, icd_slot_t *slot)
{
    if (slot->missing == 0u) {
        icdgen_end_request(call, ICD_EVENT_SENT, slot);
    } else {
        slot->is_polled = true;
        slot->poll_end = call->client->now + call->client->settings.poll_timeout;
        slot->awaited.latest = slot->poll_end;
        (void)icdgen_unanswered(call, slot);
    }
}

ICDGEN_API void icd_client_transferred(
    icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context)
{
    const icdgen_call_t call = {client, on_event, context};
    icd_event_t event;
    icd_status_t status = ICD_OK;
    if (client->i2c == NULL) {
        return;
    }
    const icd_transaction_t transaction = icdgen_i2c_untake(client->i2c);
    icd_client_tick(client, now, on_event, context); /* may end the request */
    icd_slot_t *slot = icdgen_i2c_awaiting(client, transaction.number);
    if (transaction.number == 0u) {
        icdgen_event_init(&event, ICD_EVENT_STRAY);
        event.data = bytes;
        event.length = bytes != NULL ? count : 0u;
        on_event(context, &event);
        return;
    }
    icdgen_event_of(&event, ICD_EVENT_LATE, transaction.id);
    if (transaction.reads && bytes != NULL) {
        event.data = bytes;
        status = icd_i2c_reply(client->link, transaction.id, bytes, count, client->checks_telemetry, &event.length);
        if (status == ICD_OK) {
            event.link = client->link;
            event.direction = ICD_TELEMETRY;
        }
    }
    if (status != ICD_OK) {
        const bool is_damaged = status == ICD_ERROR_CHECKSUM;
        icdgen_bus_fault(&call, is_damaged ? ICD_EVENT_CHECKSUM : ICD_EVENT_LENGTH, &event);
        slot = icdgen_i2c_awaiting(client, transaction.number); /* the callback may have cancelled the request */
        if (slot != NULL) {
            (void)icdgen_unanswered(&call, slot);
        }
    } else if (slot == NULL) {
        on_event(context, &event);
    } else if (bytes == NULL) {
        if (!slot->is_polled) { /* the node has not received the telecommand */
            (void)memset(slot->awaited.owed, 0, sizeof slot->awaited.owed);
        }
        (void)icdgen_unanswered(&call, slot);
    } else if (transaction.reads) {
        icdgen_i2c_result(&call, slot, &event);
    } else {
        icdgen_i2c_written(&call, slot);
    }
}

ICDGEN_API icd_status_t icd_client_i2c(
    icd_client_t *client,
    const icd_link_t *link,
    icd_i2c_line_t *line,
    icd_slot_t *slots,
    size_t slot_count,
    uint8_t *buffer,
    size_t size)
{
    static const icd_line_t functions = {true, ICD_BUS_I2C, icdgen_bus_plan, icdgen_bus_store, NULL, NULL, NULL};
    const icd_status_t status = icdgen_bus_init(client, link, ICD_BUS_I2C, slots, slot_count, buffer, size);
    (void)memset(line, 0, sizeof *line);
    if (status == ICD_OK) {
        client->i2c = line;
        client->line = &functions;
    }
    return status;
}

#endif /* ICDGEN_WIRE_I2C_LINE_C */
