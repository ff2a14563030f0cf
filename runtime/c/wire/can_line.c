#ifndef ICDGEN_WIRE_CAN_LINE_C
#define ICDGEN_WIRE_CAN_LINE_C

#include "can_join.c"
#include "bus_line.c"

static inline icd_status_t icdgen_can_split(
    const icd_client_t *client, const icd_slot_t *slot, icd_can_splitter_t *splitter)
{
    const icd_can_kind_t kind = slot->asks_by_id ? ICD_CAN_REQUEST : ICD_CAN_TELECOMMAND;
    return icd_can_split(
        splitter, client->link, kind, slot->data[0], client->can->address, client->link->can->node_address,
        slot->data + 1, slot->length - 1u);
}

static inline icd_status_t icdgen_can_store(
    const icd_client_t *client, icd_slot_t *slot, const uint8_t *data, size_t length)
{
    icd_can_splitter_t splitter;
    const icd_status_t status = icdgen_bus_store(client, slot, data, length);
    if (status != ICD_OK) {
        return status;
    }
    return icdgen_can_split(client, slot, &splitter) == ICD_OK ? ICD_OK : ICD_ERROR_LENGTH;
}

ICDGEN_API bool icd_client_next_packet(icd_client_t *client, icd_can_packet_t *packet)
{
    if (client->can == NULL) {
        return false;
    }
    icd_can_splitter_t *const splitter = &client->can->splitter;
    if (client->partial == NULL) {
        icd_slot_t *const slot = icdgen_next_to_send(client);
        if (slot == NULL || icdgen_can_split(client, slot, splitter) != ICD_OK) {
            return false;
        }
        client->partial = slot->data;
        icdgen_count_sent(client, slot);
    }
    const bool has_packet = icd_can_next(splitter, packet);
    if (splitter->next >= splitter->count) {
        icdgen_output_ends(client);
    }
    return has_packet;
}

static inline void icdgen_on_can(void *context, const icd_event_t *event)
{
    const icdgen_call_t *const call = ICDGEN_CAST(const icdgen_call_t *, context);
    const icd_can_kind_t kind = event->can_kind;
    if (event->kind != ICD_EVENT_MESSAGE) {
        call->on_event(call->context, event);
    } else if (event->source != call->client->link->can->node_address) {
        icdgen_bus_stray(call, event->id, event->data, event->length);
    } else if (kind == ICD_CAN_REPLY) {
        icdgen_bus_telemetry(call, event->id, event->data, event->length);
    } else if (kind == ICD_CAN_ACKNOWLEDGE) {
        icdgen_bus_packet(call, ICDGEN_ACKNOWLEDGE, event->data - 1, event->length + 1u);
    } else if (kind == ICD_CAN_REFUSAL) {
        icdgen_bus_packet(call, ICDGEN_REFUSAL, event->data - 1, event->length + 1u);
    } else if (kind == ICD_CAN_REQUEST_REFUSAL) {
        icdgen_bus_packet(call, ICDGEN_REQUEST_REFUSAL, event->data - 1, event->length + 1u);
    } else {
        icdgen_bus_stray(call, event->id, event->data, event->length);
    }
}

static inline void icdgen_can_overdue(const icdgen_call_t *call, uint32_t now)
{
    icd_can_expire(&call->client->can->joiner, now, call->on_event, call->context);
}

ICDGEN_API void icd_client_packet(
    icd_client_t *client, uint32_t now, const icd_can_packet_t *packet, icd_event_fn *on_event, void *context)
{
    icdgen_call_t call = {client, on_event, context};
    icd_client_tick(client, now, on_event, context);
    if (client->can != NULL) {
        icd_can_feed(&client->can->joiner, now, packet, icdgen_on_can, &call);
    }
}

ICDGEN_API icd_status_t icd_client_can(
    icd_client_t *client,
    const icd_link_t *link,
    icd_can_line_t *line,
    uint8_t address,
    icd_slot_t *slots,
    size_t slot_count,
    uint8_t *buffer,
    size_t size)
{
    static const icd_line_t functions = {
        false, ICD_BUS_CAN, icdgen_bus_plan, icdgen_can_store, NULL, NULL, icdgen_can_overdue,
    };
    icd_status_t status = icdgen_bus_init(client, link, ICD_BUS_CAN, slots, slot_count, buffer, size);
    (void)memset(line, 0, sizeof *line);
    line->address = address;
    if (status == ICD_OK) {
        status = icd_can_joiner_init(&line->joiner, link, address, &line->slot, 1, buffer, icdgen_receive_bytes(link));
    }
    if (status == ICD_OK) {
        client->can = line;
        client->line = &functions;
    }
    return status;
}

#endif /* ICDGEN_WIRE_CAN_LINE_C */
