#ifndef ICDGEN_WIRE_LIST_C
#define ICDGEN_WIRE_LIST_C

#include "list.h"
#include "link.c"
#include "procedure.c"

enum { ICDGEN_LIST_START, ICDGEN_LIST_RESET, ICDGEN_LIST_FRAME, ICDGEN_LIST_ADVANCED };

static inline void icdgen_list_poll(icd_procedure_t *procedure)
{
    const icd_list_form_t *const form = procedure->link->list;
    icdgen_poll(
        procedure, &form->information, ICD_ROLE_BUSY, false, form->poll_interval, form->timeout, ICDGEN_LIST_FRAME);
}

static inline void icdgen_list_tell(const icd_list_t *list, const uint8_t *frame)
{
    const icd_link_t *const link = list->procedure.link;
    const icd_step_t *const step = &link->list->information;
    icd_file_t file;
    file.type = icdgen_get(link, step, frame, ICD_ROLE_TYPE);
    file.counter = icdgen_get(link, step, frame, ICD_ROLE_COUNTER);
    file.size = icdgen_get(link, step, frame, ICD_ROLE_SIZE);
    file.time = icdgen_get(link, step, frame, ICD_ROLE_TIME);
    file.checksum = icdgen_get(link, step, frame, ICD_ROLE_CHECKSUM);
    list->on_file(list->context, &file);
}

static inline void icdgen_list_frame(icd_list_t *list, const uint8_t *frame, size_t length)
{
    icd_procedure_t *const procedure = &list->procedure;
    uint8_t any = 0;
    for (size_t i = 0; i < length; ++i) {
        any = ICDGEN_U8(any | frame[i]);
    }
    if (any == 0u) {
        icdgen_end(procedure, ICD_DONE);
        return;
    }
    if (!list->has_last || memcmp(list->last, frame, length) != 0) {
        if (list->count == procedure->link->list->max_entries) {
            icdgen_end(procedure, ICD_LIMIT);
            return;
        }
        icdgen_list_tell(list, frame);
        list->count++;
        list->again = 0;
    } else if (list->again > procedure->link->client.retries) {
        icdgen_end(procedure, ICD_TIMED_OUT);
        return;
    } else {
        /* the node may not have advanced yet */
    }
    (void)memcpy(list->last, frame, length);
    list->has_last = true;
    list->again++;
    /* Sent only once: the next frame shows whether it arrived, even if the acknowledge is lost. */
    icdgen_command(procedure, &procedure->link->list->advance, false, ICDGEN_LIST_ADVANCED);
    procedure->tolerant = true;
}

static inline void icdgen_list_resume(icd_procedure_t *procedure, const icd_event_t *outcome)
{
    icd_list_t *const list = ICDGEN_CAST(icd_list_t *, ICDGEN_CAST(void *, procedure));
    switch (procedure->state) {
    case ICDGEN_LIST_START:
        icdgen_command(procedure, &procedure->link->list->reset, true, ICDGEN_LIST_RESET);
        break;
    case ICDGEN_LIST_FRAME:
        icdgen_list_frame(list, outcome->data, outcome->length);
        break;
    case ICDGEN_LIST_ADVANCED:
        if (outcome->kind == ICD_EVENT_REFUSED) {
            icdgen_end(procedure, ICD_REFUSED);
            break;
        }
        icdgen_list_poll(procedure);
        break;
    case ICDGEN_LIST_RESET:
    default:
        icdgen_list_poll(procedure);
        break;
    }
}

ICDGEN_API icd_status_t icd_list_init(icd_list_t *list, const icd_link_t *link, icd_file_fn *on_file, void *context)
{
    (void)memset(list, 0, sizeof *list);
    list->on_file = on_file;
    list->context = context;
    return icdgen_procedure_init(&list->procedure, link, link->list != NULL, icdgen_list_resume);
}

#endif /* ICDGEN_WIRE_LIST_C */
