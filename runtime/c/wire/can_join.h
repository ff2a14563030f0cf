#ifndef ICDGEN_WIRE_CAN_JOIN_H
#define ICDGEN_WIRE_CAN_JOIN_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "can.h"

/** A partly received message of several packets. */
typedef struct {
    uint8_t *data; /* data of all packets; the byte before them is the id of the message */
    uint32_t key;  /* CAN identifier */
    icd_can_kind_t kind;
    uint32_t count;  /* number of packets of the message */
    uint32_t length; /* bytes of the message; 0: all bytes of its packets */
    uint32_t there;  /* number of packets received */
    uint32_t last;   /* time of the last packet in ms */
    uint32_t run;    /* packets 0 to run - 1 were received last, in this order */
    uint32_t completed_by;
    bool done;
    uint8_t got[32];
} icd_can_slot_t;

/** Assembles messages from CAN packets. Needs one slot for each message that is received at the same time. */
typedef struct {
    const icd_link_t *link;
    icd_can_slot_t *slots; /* ordered by the start of their messages */
    size_t slot_count;
    size_t used;
    uint32_t room; /* largest number of packets of a message */
    int16_t address;
} icd_can_joiner_t;

/** Value of `address`: accept messages for any destination. */
#define ICD_CAN_EVERYBODY (-1)

/**
 * Return the buffer size per slot in bytes. NODE_CAN_SLOT_BYTES is the constant of a node. The link must describe CAN.
 */
ICDGEN_API size_t icd_can_slot_bytes(const icd_link_t *link);

/**
 * Initialize a joiner with `count` slots and a buffer of `size` bytes. Both must stay valid while it is in use.
 * `address`: accept only messages for this destination, or ICD_CAN_EVERYBODY.
 * Return ICD_ERROR_LENGTH if the buffer is too small for the slots.
 */
ICDGEN_API icd_status_t icd_can_joiner_init(
    icd_can_joiner_t *joiner,
    const icd_link_t *link,
    int16_t address,
    icd_can_slot_t *slots,
    size_t count,
    uint8_t *buffer,
    size_t size);

/** Discard messages whose next packet is overdue and report each as ICD_EVENT_INCOMPLETE. `now` is in milliseconds. */
ICDGEN_API void icd_can_expire(icd_can_joiner_t *joiner, uint32_t now, icd_event_fn *on_event, void *context);

/**
 * Pass one received packet to the joiner. `now` is in milliseconds.
 * Events: ICD_EVENT_MESSAGE (`data` without the id), INCOMPLETE, MALFORMED, DUPLICATE, NO_SLOT and UNKNOWN_TYPE.
 */
ICDGEN_API void icd_can_feed(
    icd_can_joiner_t *joiner, uint32_t now, const icd_can_packet_t *packet, icd_event_fn *on_event, void *context);

#endif /* ICDGEN_WIRE_CAN_JOIN_H */
