#ifndef ICDGEN_WIRE_PROGRAM_H
#define ICDGEN_WIRE_PROGRAM_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "procedure.h"

/** Operation on a stored program. Pass `&operation.procedure` to the icd_procedure_...() functions. */
typedef struct {
    icd_procedure_t procedure;
    const icd_operation_form_t *form;
    uint32_t size;     /**< Size of the program in bytes. Valid if icd_program_information_t ended with ICD_DONE. */
    uint32_t checksum; /**< Checksum of the program. Valid as `size`. */
} icd_program_operation_t;

typedef icd_program_operation_t icd_program_copy_t;
typedef icd_program_operation_t icd_program_information_t;

/**
 * Initialize copying of a stored program to the memory from which it runs. Return ICD_ERROR_RANGE if the program is not
 * supported, ICD_ERROR_UNSUPPORTED if the node has no such operation.
 */
ICDGEN_API icd_status_t icd_program_copy_init(icd_program_copy_t *copy, const icd_link_t *link, uint8_t program);

/** Initialize reading of `size` and `checksum` of a stored program. Errors: see icd_program_copy_init(). */
ICDGEN_API icd_status_t
icd_program_information_init(icd_program_information_t *information, const icd_link_t *link, uint8_t program);

#endif /* ICDGEN_WIRE_PROGRAM_H */
