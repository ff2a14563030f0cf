#ifndef ICDGEN_WIRE_PROGRAM_C
#define ICDGEN_WIRE_PROGRAM_C

#include "program.h"
#include "link.c"
#include "procedure.c"

enum { ICDGEN_PROGRAM_START, ICDGEN_PROGRAM_BEGUN, ICDGEN_PROGRAM_ENDED };

/* Process the frame in which the node reports success or failure. */
static inline void icdgen_program_ended(icd_program_operation_t *operation, const uint8_t *frame)
{
    const icd_link_t *const link = operation->procedure.link;
    const icd_step_t *const step = &operation->form->progress;
    if (icdgen_get(link, step, frame, ICD_ROLE_ERROR) != 0u) {
        icdgen_end(&operation->procedure, ICD_FAILED);
    } else {
        operation->size = icdgen_get(link, step, frame, ICD_ROLE_SIZE);
        operation->checksum = icdgen_get(link, step, frame, ICD_ROLE_CHECKSUM);
        icdgen_end(&operation->procedure, ICD_DONE);
    }
}

static inline void icdgen_program_resume(icd_procedure_t *procedure, const icd_event_t *outcome)
{
    icd_program_operation_t *const operation = ICDGEN_CAST(icd_program_operation_t *, ICDGEN_CAST(void *, procedure));
    const icd_operation_form_t *const form = operation->form;
    const bool tells_ready = icdgen_place(&form->progress, ICD_ROLE_READY) != NULL;
    if (procedure->state == ICDGEN_PROGRAM_START) {
        icdgen_command(procedure, &form->request, true, ICDGEN_PROGRAM_BEGUN);
        icdgen_put(procedure->link, &form->request, procedure->data, ICD_ROLE_PROGRAM, procedure->program);
    } else if (procedure->state == ICDGEN_PROGRAM_BEGUN) {
        icdgen_poll(
            procedure, &form->progress, tells_ready ? ICD_ROLE_READY : ICD_ROLE_BUSY, tells_ready, form->poll_interval,
            form->timeout, ICDGEN_PROGRAM_ENDED);
    } else {
        icdgen_program_ended(operation, outcome->data);
    }
}

static inline icd_status_t icdgen_program_init(
    icd_program_operation_t *operation, const icd_link_t *link, const icd_operation_form_t *form, uint8_t program)
{
    const icd_status_t status = icdgen_procedure_init(&operation->procedure, link, form != NULL, icdgen_program_resume);
    operation->form = form;
    operation->size = 0;
    operation->checksum = 0;
    operation->procedure.program = program;
    if (status == ICD_OK && !icdgen_allowed(form->programs, form->programs_count, program)) {
        return ICD_ERROR_RANGE;
    }
    return status;
}

ICDGEN_API icd_status_t icd_program_copy_init(icd_program_copy_t *copy, const icd_link_t *link, uint8_t program)
{
    return icdgen_program_init(copy, link, link->program_copy, program);
}

ICDGEN_API icd_status_t
icd_program_information_init(icd_program_information_t *information, const icd_link_t *link, uint8_t program)
{
    return icdgen_program_init(information, link, link->program_information, program);
}

#endif /* ICDGEN_WIRE_PROGRAM_C */
