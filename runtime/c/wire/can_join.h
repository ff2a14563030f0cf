#ifndef ICDGEN_WIRE_CAN_JOIN_H
#define ICDGEN_WIRE_CAN_JOIN_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "can.h"

/** A message of several packets on its way. */
typedef struct {
    uint8_t *data; /* of all its packets; the byte before it is the id of the message */
    uint32_t key;  /* the identifier */
    icd_can_kind_t kind;
    uint32_t count;  /* of all its packets */
    uint32_t length; /* of the message; 0: that of all its packets */
    uint32_t there;  /* packets that have come */
    uint32_t last;   /* when the last one came */
    uint32_t run;    /* packets 0 to run - 1 came last, one after the other */
    uint32_t completed_by;
    bool done;
    uint8_t got[32];
} icd_can_slot_t;

/** Puts messages together, from so many senders at once as there are slots. */
typedef struct {
    const icd_link_t *link;
    icd_can_slot_t *slots; /* in the order in which their messages began */
    size_t slot_count;
    size_t used;
    uint32_t room; /* packets */
    int16_t address;
} icd_can_joiner_t;

/** Whose messages are taken: everybody's. */
#define ICD_CAN_EVERYBODY (-1)

/** Bytes that each slot takes of the buffer: NODE_CAN_SLOT_BYTES is the constant for a node. The node is on CAN. */
ICDGEN_API size_t icd_can_slot_bytes(const icd_link_t *link);

/**
 * `address`: whose messages are taken, or ICD_CAN_EVERYBODY. ICD_ERROR_LENGTH if the buffer is too small for the
 * slots.
 */
ICDGEN_API icd_status_t icd_can_joiner_init(
    icd_can_joiner_t *joiner,
    const icd_link_t *link,
    int16_t address,
    icd_can_slot_t *slots,
    size_t count,
    uint8_t *buffer,
    size_t size);

/** Gives up what has waited too long for its next packet: ICD_EVENT_INCOMPLETE. */
ICDGEN_API void icd_can_expire(icd_can_joiner_t *joiner, uint32_t now, icd_event_fn *on_event, void *context);

/**
 * Takes one packet; `now` in milliseconds. Tells of ICD_EVENT_MESSAGE, whose data have no id, and of INCOMPLETE,
 * MALFORMED, DUPLICATE, BUSY and UNKNOWN_TYPE.
 */
ICDGEN_API void icd_can_feed(
    icd_can_joiner_t *joiner, uint32_t now, const icd_can_packet_t *packet, icd_event_fn *on_event, void *context);

#endif /* ICDGEN_WIRE_CAN_JOIN_H */
