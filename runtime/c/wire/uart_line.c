#ifndef ICDGEN_WIRE_UART_LINE_C
#define ICDGEN_WIRE_UART_LINE_C

#include "uart.c"
#include "bus_line.c"

static inline bool icdgen_uart_output(icd_client_t *client, uint8_t *buffer, size_t capacity, size_t *written)
{
    icd_uart_encoder_t *const encoder = &client->uart->encoder;
    if (client->partial == NULL) {
        icd_slot_t *const slot = capacity != 0u ? icdgen_next_to_send(client) : NULL;
        if (slot == NULL) {
            return false;
        }
        (void)icd_uart_encode_begin(encoder, client->link, slot->data, slot->length);
        client->partial = slot->data;
        icdgen_count_sent(client, slot);
    }
    *written = icd_uart_encode_some(encoder, buffer, capacity);
    if (encoder->ended && encoder->pending == 0u) {
        icdgen_output_ends(client);
    }
    return *written != 0u;
}

/* Process a message: id and data. */
static inline void icdgen_uart_message(const icdgen_call_t *call, icd_event_t *event)
{
    const icd_link_t *const link = call->client->link;
    const uint8_t *const message = event->data;
    const size_t length = event->length;
    const icd_unsolicited_t *contained = NULL;
    const icd_uart_kind_t kind = icdgen_uart_kind(link, message, length, &contained);
    if (kind == ICD_UART_LOG) {
        icdgen_bus_tell(call, ICD_EVENT_LOG, event);
        return;
    }
    if (kind == ICD_UART_ACKNOWLEDGE) {
        icdgen_bus_packet(call, ICDGEN_ACKNOWLEDGE, event);
        return;
    }
    event->data++; /* without the id */
    event->length--;
    if (kind == ICD_UART_REPLY) {
        icdgen_bus_telemetry(call, event);
    } else if (contained != NULL) {
        event->id = contained->telemetry;
        event->link = link;
        event->direction = ICD_TELEMETRY;
        icdgen_bus_tell(call, ICD_EVENT_ARRIVED, event);
    } else {
        icdgen_bus_tell(call, ICD_EVENT_STRAY, event);
    }
}

static inline void icdgen_on_uart(const void *context, icd_event_t *event)
{
    const icdgen_call_t *const call = ICDGEN_CAST(const icdgen_call_t *, context);
    if (event->kind == ICD_EVENT_MESSAGE) {
        icdgen_uart_message(call, event);
    } else {
        call->on_event(call->context, event);
    }
}

static inline void icdgen_uart_received(const icdgen_call_t *call, const uint8_t *bytes, size_t count)
{
    const icdgen_listener_t listener = {icdgen_on_uart, call};
    icdgen_uart_feed(&call->client->uart->decoder, bytes, count, &listener);
}

ICDGEN_API icd_status_t icd_client_uart(
    icd_client_t *client,
    const icd_link_t *link,
    icd_uart_line_t *line,
    icd_slot_t *slots,
    size_t slot_count,
    uint8_t *buffer,
    size_t size)
{
    static const icd_line_t functions = {
        false, ICD_BUS_UART, icdgen_bus_plan, icdgen_bus_store, icdgen_uart_output, icdgen_uart_received, NULL,
    };
    icd_status_t status = icdgen_bus_init(client, link, ICD_BUS_UART, slots, slot_count, buffer, size);
    (void)memset(line, 0, sizeof *line);
    if (status == ICD_OK) {
        status = icd_uart_decoder_init(&line->decoder, link, buffer, ICDGEN_SIZE(link->longest));
    }
    if (status == ICD_OK) {
        client->uart = line;
        client->line = &functions;
    }
    return status;
}

#endif /* ICDGEN_WIRE_UART_LINE_C */
