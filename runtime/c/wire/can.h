#ifndef ICDGEN_WIRE_CAN_H
#define ICDGEN_WIRE_CAN_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"

/* ---- CAN --------------------------------------------------------------------------------------------------------- */

/** A CAN frame with a 29-bit identifier. */
typedef struct {
    uint32_t id;
    uint8_t length;
    uint8_t data[8];
} icd_can_packet_t;

/** Return the largest number of data bytes of a message of this kind. The link must describe CAN. */
ICDGEN_API size_t icd_can_most(const icd_link_t *link, icd_can_kind_t kind);

/** Splits a message into CAN packets, one per call of icd_can_next(). */
typedef struct {
    const icd_can_form_t *can;
    const uint8_t *data;
    size_t length;
    uint32_t id;
    uint32_t count; /* number of packets */
    uint32_t next;
    bool extended;
} icd_can_splitter_t;

/**
 * Start splitting a message of `length` bytes. `data` must stay valid until the last packet is taken.
 * Return ICD_ERROR_LENGTH if the data are too long, ICD_ERROR_RANGE if an id or address does not fit into the
 * identifier.
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

/** Write the next packet to `packet`. Return false after the last packet. */
ICDGEN_API bool icd_can_next(icd_can_splitter_t *splitter, icd_can_packet_t *packet);

#endif /* ICDGEN_WIRE_CAN_H */
