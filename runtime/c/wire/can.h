#ifndef ICDGEN_WIRE_CAN_H
#define ICDGEN_WIRE_CAN_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"

/* ---- CAN --------------------------------------------------------------------------------------------------------- */

/** A CAN frame: identifier of 29 bits, and data. */
typedef struct {
    uint32_t id;
    uint8_t length;
    uint8_t data[8];
} icd_can_packet_t;

/** The most data that a message of the kind can have. The node is on CAN. */
ICDGEN_API size_t icd_can_most(const icd_link_t *link, icd_can_kind_t kind);

/** Gives the packets of a message one by one. */
typedef struct {
    const icd_can_form_t *can;
    const uint8_t *data;
    size_t length;
    uint32_t id;
    uint32_t count; /* packets in all */
    uint32_t next;
    bool extended;
} icd_can_splitter_t;

/**
 * Begins a message, whose data must stay where they are. ICD_ERROR_LENGTH if they are too long, ICD_ERROR_RANGE if an
 * id or address does not fit the identifier.
 */
ICDGEN_API icd_status_t icd_can_split(
    icd_can_splitter_t *splitter,
    const icd_link_t *link,
    icd_can_kind_t kind,
    uint8_t id,
    uint8_t source,
    uint8_t destination,
    const uint8_t *data,
    size_t length);

/** The next packet; false after the last. */
ICDGEN_API bool icd_can_next(icd_can_splitter_t *splitter, icd_can_packet_t *packet);

#endif /* ICDGEN_WIRE_CAN_H */
