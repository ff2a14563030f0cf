#ifndef ICDGEN_WIRE_ERASE_C
#define ICDGEN_WIRE_ERASE_C

#include "erase.h"
#include "link.c"
#include "procedure.c"

enum { ICDGEN_ERASE_START, ICDGEN_ERASE_BEGUN, ICDGEN_ERASE_ENDED };

static inline void icdgen_erase_resume(icd_procedure_t *procedure, const icd_event_t *outcome)
{
    icd_erase_t *const erase = ICDGEN_CAST(icd_erase_t *, ICDGEN_CAST(void *, procedure));
    const icd_erase_form_t *const form = erase->form;
    (void)outcome;
    if (procedure->state == ICDGEN_ERASE_START) {
        icdgen_command(procedure, &form->request, true, ICDGEN_ERASE_BEGUN);
        icdgen_put(procedure->link, &form->request, procedure->data, ICD_ROLE_TYPE, erase->type);
        icdgen_put(procedure->link, &form->request, procedure->data, ICD_ROLE_COUNTER, erase->counter);
        icdgen_put(procedure->link, &form->request, procedure->data, ICD_ROLE_ALL, erase->all ? 1u : 0u);
    } else if (procedure->state == ICDGEN_ERASE_BEGUN && erase->all) {
        icdgen_poll(
            procedure, &form->progress, ICD_ROLE_BUSY, false, form->poll_interval, form->timeout, ICDGEN_ERASE_ENDED);
    } else {
        icdgen_end(procedure, ICD_DONE);
    }
}

ICDGEN_API icd_status_t
icd_erase_init(icd_erase_t *erase, const icd_link_t *link, uint8_t type, uint8_t counter, bool all)
{
    (void)memset(erase, 0, sizeof *erase);
    erase->form = link->erase;
    erase->type = type;
    erase->counter = counter;
    erase->all = all;
    return icdgen_procedure_init(&erase->procedure, link, link->erase != NULL, icdgen_erase_resume);
}

ICDGEN_API icd_status_t icd_format_init(icd_format_t *format, const icd_link_t *link)
{
    (void)memset(format, 0, sizeof *format);
    format->form = link->format;
    format->all = true;
    return icdgen_procedure_init(&format->procedure, link, link->format != NULL, icdgen_erase_resume);
}

#endif /* ICDGEN_WIRE_ERASE_C */
