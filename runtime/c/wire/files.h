#ifndef ICDGEN_WIRE_FILES_H
#define ICDGEN_WIRE_FILES_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"

/* ---- the index file ---------------------------------------------------------------------------------------------- */

/** An entry of the index file. `time` is packed; see icd_dos_time_unpack(). */
typedef struct {
    uint32_t type;
    uint32_t counter;
    uint32_t checksum;
    uint32_t size;
    uint32_t time;
    const uint8_t *meta;
    size_t meta_length;
} icd_index_entry_t;

/** Decode an entry. `entry->meta` points into `bytes`. */
ICDGEN_API icd_status_t
icd_index_entry_decode(const icd_link_t *link, const uint8_t *bytes, size_t length, icd_index_entry_t *entry);

/**
 * Encode an entry. Return ICD_ERROR_RANGE if a number does not fit into its field, ICD_ERROR_LENGTH if the meta-data
 * have the wrong length or the buffer is too small.
 */
ICDGEN_API icd_status_t
icd_index_entry_encode(const icd_link_t *link, const icd_index_entry_t *entry, uint8_t *bytes, size_t capacity);

#endif /* ICDGEN_WIRE_FILES_H */
