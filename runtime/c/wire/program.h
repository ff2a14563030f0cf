#ifndef ICDGEN_WIRE_PROGRAM_H
#define ICDGEN_WIRE_PROGRAM_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "procedure.h"

/** What a node does with a stored program. `procedure` goes to the functions of icd_procedure_t. */
typedef struct {
    icd_procedure_t procedure;
    const icd_operation_form_t *form;
    uint32_t size;     /**< Of the program in bytes, once the information is ICD_DONE. */
    uint32_t checksum; /**< Likewise. */
} icd_program_operation_t;

typedef icd_program_operation_t icd_program_copy_t;
typedef icd_program_operation_t icd_program_information_t;

/**
 * Copies a stored program to where it can run. ICD_ERROR_RANGE if it may not be asked for, ICD_ERROR_UNSUPPORTED if the
 * node has no such operation.
 */
ICDGEN_API icd_status_t icd_program_copy_init(icd_program_copy_t *copy, const icd_link_t *link, uint8_t program);

/** Reads `size` and `checksum` of a stored program; refuses as icd_program_copy_init() does. */
ICDGEN_API icd_status_t
icd_program_information_init(icd_program_information_t *information, const icd_link_t *link, uint8_t program);

#endif /* ICDGEN_WIRE_PROGRAM_H */
