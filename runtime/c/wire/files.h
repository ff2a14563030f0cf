#ifndef ICDGEN_WIRE_FILES_H
#define ICDGEN_WIRE_FILES_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"

/* ---- hole maps and the index file -------------------------------------------------------------------------------- */

/** Makes the map of a block of so many packets, none of which was received. ICD_ERROR_RANGE if there are too many. */
ICDGEN_API icd_status_t icd_hole_map_init(const icd_link_t *link, uint8_t *map, uint32_t packets);

/** Marks a packet as received. ICD_ERROR_RANGE if the block has no packet of that number. */
ICDGEN_API icd_status_t icd_hole_map_set(const icd_link_t *link, uint8_t *map, uint32_t packets, uint32_t number);

/** Whether the map says that the packet was received. The block has a packet of that number. */
ICDGEN_API bool icd_hole_map_get(const icd_link_t *link, const uint8_t *map, uint32_t number);

/** Packets of a block that were not received. */
ICDGEN_API uint32_t icd_hole_map_count(const icd_link_t *link, const uint8_t *map, uint32_t packets);

/** An entry of the index file; `time` is packed. */
typedef struct {
    uint32_t type;
    uint32_t counter;
    uint32_t checksum;
    uint32_t size;
    uint32_t time;
    const uint8_t *meta;
    size_t meta_length;
} icd_index_entry_t;

/** Reads an entry, whose meta-data stay where they are. */
ICDGEN_API icd_status_t
icd_index_entry_decode(const icd_link_t *link, const uint8_t *bytes, size_t length, icd_index_entry_t *entry);

/** Writes an entry. ICD_ERROR_RANGE if a number does not fit, ICD_ERROR_LENGTH if the meta-data have another length. */
ICDGEN_API icd_status_t
icd_index_entry_encode(const icd_link_t *link, const icd_index_entry_t *entry, uint8_t *bytes, size_t capacity);

#endif /* ICDGEN_WIRE_FILES_H */
