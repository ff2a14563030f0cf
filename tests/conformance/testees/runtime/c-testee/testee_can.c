/* CAN. */

#include "testee_wire.h"

static const char *const can_kinds[] = {"telecommand", "acknowledge", "refusal", "request", "reply", "request_refusal"};

void can_split(talk_t *talk, const icd_link_t *link)
{
    static json_out_t packets;
    octets_t octets;
    icd_can_splitter_t splitter;
    icd_can_packet_t packet;
    icd_status_t status;
    size_t text;
    unsigned kind = 0;
    uint32_t id, source, destination;
    if (!ask_text(talk, 0, "kind", &text) || !ask_octets(talk, 0, "bytes", &octets)) {
        return;
    }
    while (kind < ICD_CAN_KINDS && !is_word(&talk->row.values[text], can_kinds[kind])) {
        kind++;
    }
    if (kind == ICD_CAN_KINDS) {
        (void)refuse_request(talk, "there is no such kind");
        return;
    }
    if (!ask_number(talk, 0, "id", 0, 255, REQUIRED, &id) || !ask_number(talk, 0, "source", 0, 255, REQUIRED, &source) ||
        !ask_number(talk, 0, "destination", 0, 255, REQUIRED, &destination)) {
        return;
    }
    status = icd_can_split(
        &splitter, link, (icd_can_kind_t)kind, (uint8_t)id, (uint8_t)source, (uint8_t)destination, octets.data,
        octets.length);
    if (status == ICD_ERROR_LENGTH) {
        (void)refuse_length(talk, "too-long", icd_can_most(link, (icd_can_kind_t)kind), octets.length);
        return;
    }
    if (status != ICD_OK) {
        (void)refuse_status(talk, status);
        return;
    }
    packets.length = 0;
    while (icd_can_next(&splitter, &packet)) {
        json_put_text(&packets, "{\"id\":");
        json_put_unsigned(&packets, packet.id);
        put_key_octets(&packets, "bytes", packet.data, packet.length);
        json_put_text(&packets, "},");
    }
    put_ok(talk);
    put_list(&talk->out, "packets", &packets);
}

static void on_can(void *context, const icd_event_t *event)
{
    json_out_t *out = (json_out_t *)context;
    const char *name = event->kind == ICD_EVENT_MESSAGE ? "message"
        : event->kind == ICD_EVENT_DUPLICATE            ? "duplicate"
        : event->kind == ICD_EVENT_INCOMPLETE           ? "incomplete"
        : event->kind == ICD_EVENT_MALFORMED            ? "malformed"
        : event->kind == ICD_EVENT_BUSY                 ? "busy"
                                                        : "unknown_type";
    json_put_text(out, "{\"event\":");
    json_put_string(out, name, strlen(name));
    put_key_number(out, "id", event->id);
    put_key_number(out, "source", event->source);
    if (event->kind == ICD_EVENT_MESSAGE) {
        put_key_text(out, "kind", can_kinds[event->can_kind]);
        put_key_number(out, "destination", event->destination);
        put_key_octets(out, "bytes", event->data, event->length);
    } else if (event->kind == ICD_EVENT_INCOMPLETE) {
        put_key_number(out, "missing", event->missing);
    }
    json_put_text(out, "},");
}

typedef struct {
    uint32_t at;
    icd_can_packet_t packet;
} timed_packet_t;

static bool ask_packet(talk_t *talk, size_t object, timed_packet_t *timed)
{
    octets_t octets;
    memset(timed, 0, sizeof *timed);
    if (!ask_number(talk, object, "id", 0, 0x1FFFFFFFu, REQUIRED, &timed->packet.id) ||
        !ask_octets(talk, object, "bytes", &octets)) {
        return false;
    }
    if (octets.length > sizeof timed->packet.data) {
        return refuse_request(talk, "a packet has too many bytes");
    }
    memcpy(timed->packet.data, octets.data, octets.length);
    timed->packet.length = (uint8_t)octets.length;
    return ask_number(talk, object, "at", 0, MOST_NUMBER, 0, &timed->at);
}

void can_join(talk_t *talk, const icd_link_t *link)
{
    static json_out_t events;
    icd_can_joiner_t joiner;
    icd_can_slot_t *slots;
    timed_packet_t *packets;
    uint32_t senders, address = 0, end = 0;
    size_t list, at, i, count, size;
    const bool ours = json_find(&talk->row, 0, "address") != 0u, ends = json_find(&talk->row, 0, "end") != 0u;
    if ((ours && !ask_number(talk, 0, "address", 0, 255, REQUIRED, &address)) ||
        !ask_number(talk, 0, "senders", 1, 16, 4, &senders) || !ask_mappings(talk, 0, "packets", &list)) {
        return;
    }
    count = talk->row.values[list].count;
    packets = (timed_packet_t *)memory(count * sizeof *packets);
    for (i = 0, at = list + 1u; i < count; i++, at = talk->row.values[at].after) {
        if (!ask_packet(talk, at, &packets[i])) {
            return;
        }
    }
    if (link->can == NULL) {
        (void)refuse(talk, "unsupported");
        return;
    }
    if (ends && !ask_number(talk, 0, "end", 0, MOST_NUMBER, REQUIRED, &end)) {
        return;
    }
    slots = (icd_can_slot_t *)memory(senders * sizeof *slots);
    size = senders * icd_can_slot_bytes(link);
    (void)icd_can_joiner_init(
        &joiner, link, ours ? (int16_t)address : ICD_CAN_EVERYBODY, slots, senders, (uint8_t *)memory(size), size);
    events.length = 0;
    for (i = 0; i < count; i++) {
        icd_can_feed(&joiner, packets[i].at, &packets[i].packet, on_can, &events);
    }
    if (ends) {
        icd_can_expire(&joiner, end, on_can, &events);
    }
    put_ok(talk);
    put_list(&talk->out, "events", &events);
}
