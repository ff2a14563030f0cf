#ifndef ICDGEN_WIRE_ERASE_H
#define ICDGEN_WIRE_ERASE_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "procedure.h"

/**
 * Deletion of one file or all files, or formatting of the medium. Pass `&erase.procedure` to the icd_procedure_...()
 * functions.
 */
typedef struct {
    icd_procedure_t procedure;
    const icd_erase_form_t *form;
    uint8_t type;
    uint8_t counter;
    bool all;
} icd_erase_t;

typedef icd_erase_t icd_format_t;

/**
 * Initialize the deletion of one file, or of all files if `all` is true. Deleting all files ends when the node is no
 * longer busy.
 */
ICDGEN_API icd_status_t
icd_erase_init(icd_erase_t *erase, const icd_link_t *link, uint8_t type, uint8_t counter, bool all);

/** Initialize the formatting of the medium. It ends when the node is no longer busy. */
ICDGEN_API icd_status_t icd_format_init(icd_format_t *format, const icd_link_t *link);

#endif /* ICDGEN_WIRE_ERASE_H */
