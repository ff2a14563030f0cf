/* Scripts for the client: what happens at which time, and what it does then. */

#include "testee_wire.h"

static const char *event_name(icd_event_kind_t kind)
{
    switch (kind) {
    case ICD_EVENT_UNEXPECTED_START:
        return "unexpected_start";
    case ICD_EVENT_PROTOCOL_ERROR:
        return "protocol_error";
    case ICD_EVENT_OVERRUN:
        return "overrun";
    case ICD_EVENT_EMPTY:
        return "empty";
    case ICD_EVENT_DUPLICATE:
        return "duplicate";
    case ICD_EVENT_INCOMPLETE:
        return "incomplete";
    case ICD_EVENT_MALFORMED:
        return "malformed";
    case ICD_EVENT_BUSY:
        return "busy";
    case ICD_EVENT_UNKNOWN_TYPE:
        return "unknown_type";
    case ICD_EVENT_DONE:
        return "done";
    case ICD_EVENT_REFUSED:
        return "refused";
    case ICD_EVENT_TIMEOUT:
        return "timeout";
    case ICD_EVENT_PACKET:
        return "packet";
    case ICD_EVENT_LOG:
        return "log";
    case ICD_EVENT_STRAY:
        return "stray";
    case ICD_EVENT_MESSAGE:
    default:
        return "message";
    }
}

static void put_reason(json_out_t *out, icd_reason_t reason)
{
    static const char *const names[] = {"", "none", "unknown_id", "length", "parameter", "checksum"};
    if (reason == ICD_REASON_UNKNOWN) {
        json_put_text(out, ",\"reason\":null");
    } else {
        put_key_text(out, "reason", names[reason]);
    }
}

static void on_event(void *context, const icd_event_t *event)
{
    json_out_t *out = (json_out_t *)context;
    const char *name = event_name(event->kind);
    json_put_text(out, "{\"event\":");
    json_put_string(out, name, strlen(name));
    switch (event->kind) {
    case ICD_EVENT_DONE:
    case ICD_EVENT_REFUSED:
    case ICD_EVENT_TIMEOUT:
        put_key_number(out, "id", event->id);
        put_key_number(out, "attempts", event->attempts);
        if (event->kind == ICD_EVENT_DONE) {
            put_key_octets(out, "bytes", event->data, event->length);
        } else if (event->kind == ICD_EVENT_REFUSED) {
            put_key_or_null(out, "code", event->code);
            put_key_or_null(out, "parameter", event->parameter);
            put_reason(out, event->reason);
        }
        break;
    case ICD_EVENT_DUPLICATE:
    case ICD_EVENT_INCOMPLETE:
    case ICD_EVENT_MALFORMED:
    case ICD_EVENT_BUSY:
    case ICD_EVENT_UNKNOWN_TYPE:
        put_key_number(out, "id", event->id);
        break;
    case ICD_EVENT_PACKET:
        put_key_number(out, "number", event->number);
        put_key_octets(out, "bytes", event->data, event->length);
        break;
    case ICD_EVENT_LOG:
    case ICD_EVENT_STRAY:
        put_key_octets(out, "bytes", event->data, event->length);
        break;
    case ICD_EVENT_MESSAGE:
    case ICD_EVENT_UNEXPECTED_START:
    case ICD_EVENT_PROTOCOL_ERROR:
    case ICD_EVENT_OVERRUN:
    case ICD_EVENT_EMPTY:
    default:
        break;
    }
    json_put_text(out, "},");
}

/* All messages on the line are the request, so one ends where the client says that it begins the next. */
static void take_uart(icd_client_t *client, json_out_t *out)
{
    const uint8_t *bytes;
    size_t count, i;
    bool inside = false, escaped = false;
    while (icd_client_output(client, &bytes, &count)) {
        for (i = 0; i < count; i++) {
            const icd_framing_t *framing = client->link->framing;
            json_put(out, "\"", inside ? 0u : 1u);
            inside = true;
            json_put_hex(out, bytes[i], 2);
            if (escaped && bytes[i] == framing->end) {
                json_put_text(out, "\",");
                inside = false;
            }
            escaped = inside && !escaped && bytes[i] == framing->escape;
        }
    }
}

static void take_all(icd_client_t *client, json_out_t *out)
{
    icd_can_packet_t packet;
    const uint8_t *bytes;
    size_t count, read;
    out->length = 0;
    take_uart(client, out);
    while (icd_client_next_packet(client, &packet)) {
        json_put_text(out, "{\"id\":");
        json_put_unsigned(out, packet.id);
        put_key_octets(out, "bytes", packet.data, packet.length);
        json_put_text(out, "},");
    }
    while (icd_client_transfer(client, &bytes, &count, &read)) {
        json_put_text(out, "{\"write\":");
        put_octets(out, bytes, count);
        put_key_number(out, "read", (int64_t)read);
        json_put_text(out, "},");
    }
}

static bool receive(talk_t *talk, icd_client_t *client, uint32_t now, size_t index, json_out_t *events)
{
    octets_t octets;
    if (client->bus == ICD_BUS_CAN) {
        icd_can_packet_t packet;
        memset(&packet, 0, sizeof packet);
        if (talk->row.values[index].type != JSON_OBJECT) {
            return refuse_request(talk, "receive is no packet");
        }
        if (!ask_number(talk, index, "id", 0, 0x1FFFFFFFu, REQUIRED, &packet.id) ||
            !ask_octets(talk, index, "bytes", &octets)) {
            return false;
        }
        packet.length = (uint8_t)(octets.length < 255u ? octets.length : 255u);
        memcpy(packet.data, octets.data, packet.length < sizeof packet.data ? packet.length : sizeof packet.data);
        icd_client_packet(client, now, &packet, on_event, events);
        return true;
    }
    if (client->bus == ICD_BUS_I2C && talk->row.values[index].type == JSON_NULL) {
        icd_client_transferred(client, now, NULL, 0, on_event, events);
        return true;
    }
    if (!octets_of(talk, index, &octets)) {
        return false;
    }
    if (client->bus == ICD_BUS_I2C) {
        icd_client_transferred(client, now, octets.data, octets.length, on_event, events);
    } else {
        icd_client_received(client, now, octets.data, octets.length, on_event, events);
    }
    return true;
}

/* What became of starting a request; a length that is wrong is told. */
static bool start(
    talk_t *talk, icd_client_t *client, uint32_t now, size_t row, icd_direction_t direction, json_out_t *events,
    json_out_t *error)
{
    icd_request_t request;
    octets_t octets;
    uint32_t id;
    memset(&request, 0, sizeof request);
    if (!ask_number(talk, row, direction == ICD_TELECOMMAND ? "telecommand" : "telemetry", 0, 255, REQUIRED, &id)) {
        return false;
    }
    request.direction = direction;
    request.id = (uint8_t)id;
    if (direction == ICD_TELECOMMAND) {
        if (!ask_octets(talk, row, "bytes", &octets) || !ask_flag(talk, row, "repeat", &request.repeat)) {
            return false;
        }
        request.data = octets.data;
        request.length = octets.length;
    }
    switch (icd_client_start(client, now, &request, on_event, events)) {
    case ICD_OK:
        break;
    case ICD_ERROR_UNKNOWN_ID:
        put_key_text(error, "error", "unknown-id");
        break;
    case ICD_ERROR_BUSY:
        put_key_text(error, "error", "busy");
        break;
    default:
        put_key_text(error, "error", "length");
        put_key_number(error, "expected", icd_find_message(client->link, direction, id)->length);
        put_key_number(error, "actual", (int64_t)request.length);
        break;
    }
    return true;
}

static bool client_step(talk_t *talk, icd_client_t *client, size_t row, json_out_t *steps)
{
    static json_out_t events, out, error;
    uint32_t now, deadline;
    size_t index;
    bool well = true, cancel;
    if (!ask_number(talk, row, "at", 0, MOST_NUMBER, REQUIRED, &now)) {
        return false;
    }
    events.length = 0;
    error.length = 0;
    if (json_find(&talk->row, row, "telecommand") != 0u) {
        well = start(talk, client, now, row, ICD_TELECOMMAND, &events, &error);
    } else if (json_find(&talk->row, row, "telemetry") != 0u) {
        well = start(talk, client, now, row, ICD_TELEMETRY, &events, &error);
    } else {
        index = json_find(&talk->row, row, "receive");
        if (index != 0u) {
            well = receive(talk, client, now, index, &events);
        } else {
            well = ask_flag(talk, row, "cancel", &cancel);
            if (well && cancel) {
                icd_client_cancel(client);
            } else if (well) {
                icd_client_tick(client, now, on_event, &events);
            }
        }
    }
    if (!well) {
        return false;
    }
    take_all(client, &out);
    json_put_text(steps, "{\"deadline\":");
    if (icd_client_deadline(client, &deadline)) {
        json_put_unsigned(steps, deadline);
    } else {
        json_put_text(steps, "null");
    }
    put_list(steps, "out", &out);
    put_list(steps, "events", &events);
    json_put(steps, error.length != 0u ? error.at : "", error.length);
    json_put_text(steps, "},");
    return true;
}

static bool ask_settings(talk_t *talk, icd_client_settings_t *settings)
{
    const size_t index = json_find(&talk->row, 0, "settings");
    uint32_t retries = 0;
    if (index == 0u) {
        return true;
    }
    if (talk->row.values[index].type != JSON_OBJECT) {
        return refuse_request(talk, "settings is no object");
    }
    if (!ask_number(talk, index, "reply_timeout", 1, MOST_NUMBER, settings->reply_timeout, &settings->reply_timeout) ||
        !ask_number(talk, index, "retries", 0, 255, settings->retries, &retries) ||
        !ask_number(talk, index, "poll_interval", 1, MOST_NUMBER, settings->poll_interval, &settings->poll_interval) ||
        !ask_number(talk, index, "poll_timeout", 1, MOST_NUMBER, settings->poll_timeout, &settings->poll_timeout)) {
        return false;
    }
    settings->retries = (uint8_t)retries;
    return true;
}

void client_script(talk_t *talk, const icd_link_t *link)
{
    static json_out_t steps;
    icd_client_t *client = (icd_client_t *)memory(sizeof *client);
    icd_client_settings_t settings = link->client;
    icd_bus_t bus;
    uint32_t address;
    size_t list, at, i, text, size;
    bool checked;
    if (!ask_text(talk, 0, "bus", &text)) {
        return;
    }
    if (!bus_named(&talk->row.values[text], &bus)) {
        (void)refuse_request(talk, "there is no such bus");
        return;
    }
    if (!ask_flag(talk, 0, "crc", &checked) || !ask_number(talk, 0, "address", 0, 255, 0, &address) ||
        !ask_settings(talk, &settings)) {
        return;
    }
    size = icd_client_bytes(link);
    if (icd_client_init(client, link, bus, (uint8_t *)memory(size), size) != ICD_OK) {
        (void)refuse(talk, "unsupported");
        return;
    }
    client->settings = settings;
    icd_client_set_address(client, (uint8_t)address);
    if (checked) {
        icd_client_use_checksums(client);
    }
    if (!ask_mappings(talk, 0, "script", &list)) {
        return;
    }
    steps.length = 0;
    for (i = 0, at = list + 1u; i < talk->row.values[list].count; i++, at = talk->row.values[at].after) {
        if (!client_step(talk, client, at, &steps)) {
            return;
        }
    }
    put_ok(talk);
    put_list(&talk->out, "steps", &steps);
}
