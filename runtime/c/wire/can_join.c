#ifndef ICDGEN_WIRE_CAN_JOIN_C
#define ICDGEN_WIRE_CAN_JOIN_C

#include "can_join.h"
#include "events.c"
#include "can.c"

ICDGEN_API size_t icd_can_slot_bytes(const icd_link_t *link)
{
    const icd_can_extended_t *const form = link->can->extended;
    const uint32_t size = form != NULL ? form->data_bytes : 1u;
    return 1u + (form != NULL ? ICDGEN_SIZE((link->longest_data + size - 1u) / size * size) : 0u);
}

ICDGEN_API icd_status_t icd_can_joiner_init(
    icd_can_joiner_t *joiner,
    const icd_link_t *link,
    int16_t address,
    icd_can_slot_t *slots,
    size_t count,
    uint8_t *buffer,
    size_t size)
{
    size_t each;
    (void)memset(joiner, 0, sizeof *joiner);
    if (link->can == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    each = icd_can_slot_bytes(link);
    if (size / each < count) {
        return ICD_ERROR_LENGTH;
    }
    (void)memset(slots, 0, count * sizeof *slots);
    for (size_t i = 0; i < count; ++i) {
        slots[i].data = buffer + (i * each) + 1u;
    }
    joiner->link = link;
    joiner->address = address;
    joiner->slots = slots;
    joiner->slot_count = count;
    joiner->room = link->can->extended != NULL ? ICDGEN_U32((each - 1u) / link->can->extended->data_bytes) : 0u;
    return ICD_OK;
}

static inline void icdgen_can_tell(
    const icd_link_t *link, uint32_t key, icd_event_kind_t kind, uint32_t missing, const icdgen_listener_t *listener)
{
    icd_event_t event;
    icdgen_event_of(&event, kind, ICDGEN_U8(icdgen_can_part(link->can->channel, key)));
    event.source = ICDGEN_U8(icdgen_can_part(link->can->source, key));
    event.missing = missing;
    icdgen_tell(listener, &event);
}

/* The data start after the id byte. */
static inline void icdgen_can_tell_message(
    const icd_link_t *link,
    uint32_t key,
    icd_can_kind_t kind,
    uint8_t *data,
    size_t length,
    const icdgen_listener_t *listener)
{
    icd_event_t event;
    icdgen_event_of(&event, ICD_EVENT_MESSAGE, ICDGEN_U8(icdgen_can_part(link->can->channel, key)));
    event.source = ICDGEN_U8(icdgen_can_part(link->can->source, key));
    event.destination = ICDGEN_U8(icdgen_can_part(link->can->destination, key));
    event.can_kind = kind;
    data[-1] = ICDGEN_U8(event.id);
    event.data = data;
    event.length = length;
    icdgen_tell(listener, &event);
}

static inline bool icdgen_can_got(const icd_can_slot_t *slot, uint32_t number)
{
    return number < slot->count && ((ICDGEN_U32(slot->got[number / 8u]) >> (number % 8u)) & 1u) != 0u;
}

/* Free a slot and move its memory to the end of the array. */
static inline void icdgen_can_free(icd_can_joiner_t *joiner, size_t index)
{
    icd_can_slot_t *const slots = joiner->slots;
    joiner->used--;
    for (size_t i = index; i < joiner->used; ++i) {
        uint8_t *const data = slots[i].data;
        slots[i] = slots[i + 1u];
        slots[i + 1u].data = data;
    }
}

/* Discard a message. A complete message causes no event: its slot only serves to detect repeated packets. */
static inline void icdgen_can_give_up(icd_can_joiner_t *joiner, size_t index, const icdgen_listener_t *listener)
{
    const icd_can_slot_t *const slot = &joiner->slots[index];
    const uint32_t key = slot->key, missing = slot->count - slot->there;
    const bool done = slot->done;
    icdgen_can_free(joiner, index);
    if (!done) {
        icdgen_can_tell(joiner->link, key, ICD_EVENT_INCOMPLETE, missing, listener);
    }
}

static inline void icdgen_can_expire(icd_can_joiner_t *joiner, uint32_t now, const icdgen_listener_t *listener)
{
    size_t i = 0;
    while (i < joiner->used) {
        if (icdgen_reached(now, joiner->slots[i].last + joiner->link->can->extended->packet_timeout)) {
            icdgen_can_give_up(joiner, i, listener);
        } else {
            ++i;
        }
    }
}

/* Record a received packet, new or repeated. */
static inline void icdgen_can_came(icd_can_slot_t *slot, uint32_t number, uint32_t now)
{
    slot->last = now;
    if (number == slot->run) {
        slot->run++;
    } else if (number + 1u != slot->run) {
        slot->run = number == 0u ? 1u : 0u;
    } else {
        /* the previous packet was repeated */
    }
}

/*
 * Return a slot for a new message. If all are in use, reuse the oldest slot with a complete message; NULL if there is
 * none.
 */
static inline icd_can_slot_t *icdgen_can_slot(icd_can_joiner_t *joiner)
{
    for (size_t i = 0; joiner->used == joiner->slot_count && i < joiner->used; ++i) {
        if (joiner->slots[i].done) {
            icdgen_can_free(joiner, i);
        }
    }
    return joiner->used < joiner->slot_count ? &joiner->slots[joiner->used++] : NULL;
}

/* Return the length of the message in bytes if the ICD has it and it needs several packets; otherwise 0. */
static inline uint32_t icdgen_can_length(const icd_link_t *link, icd_can_kind_t kind, uint32_t id)
{
    const icd_message_t *const message = icd_find_message(
        link, kind == ICD_CAN_TELECOMMAND ? ICD_TELECOMMAND : ICD_TELEMETRY, ICDGEN_CAST(unsigned, id));
    return message != NULL && message->length > link->can->data_bytes ? message->length : 0u;
}

/*
 * Start a new message in the slot of another. Return the number of packets received so far that are kept, because they
 * are the same in both.
 */
static inline uint32_t icdgen_can_replace(
    icd_can_joiner_t *joiner, size_t index, uint32_t number, const icdgen_listener_t *listener)
{
    const icd_can_slot_t *const slot = &joiner->slots[index];
    const uint32_t kept = !slot->done && number == slot->run ? number : 0u;
    icdgen_can_give_up(joiner, index, listener);
    return kept;
}

static inline void icdgen_can_mark(icd_can_slot_t *slot, uint32_t number)
{
    slot->got[number / 8u] = ICDGEN_U8(slot->got[number / 8u] | (1u << (number % 8u)));
    slot->there++;
}

/* Begin a message in a slot, of which some packets are there. */
static inline void icdgen_can_begin(icd_can_slot_t *slot, uint32_t kept)
{
    uint8_t *const data = slot->data;
    (void)memset(slot, 0, sizeof *slot);
    slot->data = data;
    slot->run = kept;
    for (uint32_t n = 0; n < kept; ++n) {
        icdgen_can_mark(slot, n);
    }
}

/* Process a packet of a message of several packets. */
static inline void icdgen_can_extended(
    icd_can_joiner_t *joiner,
    uint32_t now,
    icd_can_kind_t kind,
    const icd_can_packet_t *packet,
    const icdgen_listener_t *listener)
{
    const icd_link_t *const link = joiner->link;
    const icd_can_form_t *const can = link->can;
    const uint32_t length = icdgen_can_length(link, kind, icdgen_can_part(can->channel, packet->id));
    const icd_can_extended_t *const form = can->extended;
    const size_t size = form->data_bytes;
    size_t index = 0;
    icd_can_slot_t *slot;
    uint32_t left, count, number, kept = 0;
    while (index < joiner->used && joiner->slots[index].key != packet->id) {
        ++index;
    }
    slot = index < joiner->used ? &joiner->slots[index] : NULL;
    left = packet->data[form->left_at] - ICDGEN_U32(form->left_in_last);
    if (length != 0u) {
        count = ICDGEN_U32((length + size - 1u) / size);
    } else if (slot != NULL && !slot->done && left < slot->count) {
        count = slot->count;
    } else { /* the first packet received contains the number of packets */
        count = left + 1u;
    }
    if (packet->length != form->left_at + 1u || left >= count || count > joiner->room) {
        if (slot != NULL) {
            icdgen_can_give_up(joiner, index, listener);
        }
        icdgen_can_tell(link, packet->id, ICD_EVENT_MALFORMED, 0, listener);
        return;
    }
    number = count - 1u - left;
    if (slot != NULL && (!slot->done || slot->completed_by == number) && icdgen_can_got(slot, number) &&
        memcmp(slot->data + (number * size), packet->data, size) == 0) {
        icdgen_can_came(slot, number, now);
        icdgen_can_tell(link, packet->id, ICD_EVENT_DUPLICATE, 0, listener);
        return;
    }
    if (slot != NULL && (slot->done || slot->count != count || icdgen_can_got(slot, number))) {
        kept = icdgen_can_replace(joiner, index, number, listener); /* the next free slot owns its memory */
        slot = NULL;
    }
    if (slot == NULL) {
        slot = icdgen_can_slot(joiner);
        if (slot == NULL) {
            icdgen_can_tell(link, packet->id, ICD_EVENT_NO_SLOT, 0, listener);
            return;
        }
        icdgen_can_begin(slot, kept);
        slot->key = packet->id;
        slot->kind = kind;
        slot->count = count;
        slot->length = length;
    }
    (void)memcpy(slot->data + (number * size), packet->data, size);
    icdgen_can_mark(slot, number);
    icdgen_can_came(slot, number, now);
    if (slot->there == slot->count) {
        slot->done = true;
        slot->completed_by = number;
        icdgen_can_tell_message(
            link, slot->key, kind, slot->data, ICDGEN_SIZE(slot->length != 0u ? slot->length : slot->count * size),
            listener);
    }
}

static inline void icdgen_can_feed(
    icd_can_joiner_t *joiner, uint32_t now, const icd_can_packet_t *packet, const icdgen_listener_t *listener)
{
    const icd_link_t *const link = joiner->link;
    const icd_can_form_t *const can = link->can;
    const uint32_t type = icdgen_can_part(can->type, packet->id);
    icdgen_can_expire(joiner, now, listener);
    if (joiner->address != ICD_CAN_EVERYBODY &&
        icdgen_can_part(can->destination, packet->id) != ICDGEN_U32(joiner->address)) {
        return;
    }
    for (unsigned i = 0; i < ICD_CAN_KINDS; ++i) {
        const icd_can_kind_t kind = ICDGEN_CAST(icd_can_kind_t, i);
        if (can->types[i] >= 0 && ICDGEN_U32(can->types[i]) == type) {
            uint8_t message[1u + sizeof packet->data];
            if (packet->length > (icdgen_can_has_data(kind) ? can->data_bytes : 0u)) {
                icdgen_can_tell(link, packet->id, ICD_EVENT_MALFORMED, 0, listener);
                return;
            }
            (void)memcpy(message + 1, packet->data, sizeof packet->data);
            icdgen_can_tell_message(link, packet->id, kind, message + 1, packet->length, listener);
            return;
        }
    }
    for (unsigned i = 0; can->extended != NULL && i < ICD_CAN_KINDS; ++i) {
        if (can->extended_types[i] >= 0 && ICDGEN_U32(can->extended_types[i]) == type) {
            icdgen_can_extended(joiner, now, ICDGEN_CAST(icd_can_kind_t, i), packet, listener);
            return;
        }
    }
    icdgen_can_tell(link, packet->id, ICD_EVENT_UNKNOWN_TYPE, 0, listener);
}

ICDGEN_API void icd_can_expire(icd_can_joiner_t *joiner, uint32_t now, icd_event_fn *on_event, void *context)
{
    const icdgen_caller_t caller = {on_event, context};
    const icdgen_listener_t listener = {icdgen_tell_caller, &caller};
    icdgen_can_expire(joiner, now, &listener);
}

ICDGEN_API void icd_can_feed(
    icd_can_joiner_t *joiner, uint32_t now, const icd_can_packet_t *packet, icd_event_fn *on_event, void *context)
{
    const icdgen_caller_t caller = {on_event, context};
    const icdgen_listener_t listener = {icdgen_tell_caller, &caller};
    icdgen_can_feed(joiner, now, packet, &listener);
}

#endif /* ICDGEN_WIRE_CAN_JOIN_C */
