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

static inline icd_status_t icdgen_can_store(const icd_client_t *client, icd_slot_t *slot, const uint8_t *data)
{
    icd_can_splitter_t splitter;
    const icd_status_t status = icdgen_bus_store(client, slot, data);
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

static inline void icdgen_on_can(const void *context, icd_event_t *event)
{
    const icdgen_call_t *const call = ICDGEN_CAST(const icdgen_call_t *, context);
    const icd_can_kind_t kind = event->can_kind;
    if (event->kind != ICD_EVENT_MESSAGE) {
        call->on_event(call->context, event);
    } else if (event->source != call->client->link->can->node_address) {
        icdgen_bus_tell(call, ICD_EVENT_STRAY, event);
    } else if (kind == ICD_CAN_REPLY) {
        icdgen_bus_telemetry(call, event);
    } else if (kind == ICD_CAN_ACKNOWLEDGE || kind == ICD_CAN_REFUSAL || kind == ICD_CAN_REQUEST_REFUSAL) {
        event->data--; /* the id */
        event->length++;
        icdgen_bus_packet(
            call,
            kind == ICD_CAN_ACKNOWLEDGE   ? ICDGEN_ACKNOWLEDGE
                : kind == ICD_CAN_REFUSAL ? ICDGEN_REFUSAL
                                          : ICDGEN_REQUEST_REFUSAL,
            event);
    } else {
        icdgen_bus_tell(call, ICD_EVENT_STRAY, event);
    }
}

static inline void icdgen_can_overdue(const icdgen_call_t *call, uint32_t now)
{
    const icdgen_listener_t listener = {icdgen_on_can, call};
    icdgen_can_expire(&call->client->can->joiner, now, &listener);
}

ICDGEN_API void icd_client_packet(
    icd_client_t *client, uint32_t now, const icd_can_packet_t *packet, icd_event_fn *on_event, void *context)
{
    const icdgen_call_t call = {client, on_event, context};
    const icdgen_listener_t listener = {icdgen_on_can, &call};
    icd_client_tick(client, now, on_event, context);
    if (client->can != NULL) {
        icdgen_can_feed(&client->can->joiner, now, packet, &listener);
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
        status = icd_can_joiner_init(
            &line->joiner, link, address, &line->slot, 1, buffer, ICDGEN_SIZE(link->received_bytes));
    }
    if (status == ICD_OK) {
        client->can = line;
        client->line = &functions;
    }
    return status;
}

#endif /* ICDGEN_WIRE_CAN_LINE_C */
