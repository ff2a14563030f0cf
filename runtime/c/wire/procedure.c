#ifndef ICDGEN_WIRE_PROCEDURE_C
#define ICDGEN_WIRE_PROCEDURE_C

#include "procedure.h"
#include "link.c"
#include "events.c"
#include "client.c"

static inline void icdgen_end(icd_procedure_t *procedure, icd_result_t result)
{
    procedure->want = ICDGEN_WANT_NOTHING;
    procedure->result = result;
}

static inline void icdgen_wait(icd_procedure_t *procedure, uint32_t until)
{
    procedure->want = ICDGEN_WANT_TIME;
    procedure->until = until;
}

/* Request a frame. */
static inline void icdgen_ask(icd_procedure_t *procedure, int16_t id, uint8_t state)
{
    (void)memset(&procedure->request, 0, sizeof procedure->request);
    procedure->request.direction = ICD_TELEMETRY;
    procedure->request.id = ICDGEN_U8(id);
    procedure->request.repeat = true;
    procedure->want = ICDGEN_WANT_REQUEST;
    procedure->tolerant = false;
    procedure->state = state;
}

/* Prepare a telecommand with its initial content. The caller then writes values into `data`. */
static inline void icdgen_command(icd_procedure_t *procedure, const icd_step_t *step, bool repeat, uint8_t state)
{
    if (step->fresh != NULL) {
        (void)memcpy(procedure->data, step->fresh, step->length);
    } else {
        (void)memset(procedure->data, 0, step->length);
    }
    procedure->request.direction = ICD_TELECOMMAND;
    procedure->request.id = ICDGEN_U8(step->telecommand);
    procedure->request.data = procedure->data;
    procedure->request.length = step->length;
    procedure->request.repeat = repeat;
    procedure->want = ICDGEN_WANT_REQUEST;
    procedure->tolerant = false;
    procedure->state = state;
}

/*
 * Poll a frame until its flag has the wanted value or its error flag is set. The procedure then continues in `state`
 * with this frame.
 */
static inline void icdgen_poll(
    icd_procedure_t *procedure,
    const icd_step_t *step,
    icd_role_t flag,
    bool wanted,
    uint32_t interval,
    uint32_t timeout,
    uint8_t state)
{
    icdgen_ask(procedure, step->telemetry, state);
    procedure->polled = step;
    procedure->flag = flag;
    procedure->wanted = wanted;
    procedure->interval = interval;
    procedure->poll_end = procedure->now + timeout;
}

/* Return whether the frame belongs to the requested program. */
static inline bool icdgen_is_meant(const icd_procedure_t *procedure, const uint8_t *frame)
{
    const icd_step_t *const step = procedure->polled;
    return icdgen_place(step, ICD_ROLE_PROGRAM) == NULL ||
        icdgen_get(procedure->link, step, frame, ICD_ROLE_PROGRAM) == procedure->program;
}

/* Return whether polling continues after this outcome. */
static inline bool icdgen_polls_on(icd_procedure_t *procedure, const icd_event_t *outcome)
{
    const icd_step_t *const step = procedure->polled;
    const icd_link_t *const link = procedure->link;
    if (outcome == NULL) {
        icdgen_ask(procedure, step->telemetry, procedure->state);
        return true;
    }
    if (outcome->length != step->length) {
        icdgen_end(procedure, ICD_LENGTH);
        return true;
    }
    if (((icdgen_get(link, step, outcome->data, procedure->flag) != 0u) == procedure->wanted &&
         icdgen_is_meant(procedure, outcome->data)) ||
        icdgen_get(link, step, outcome->data, ICD_ROLE_ERROR) != 0u) {
        procedure->polled = NULL;
        return false;
    }
    if (icdgen_reached(procedure->now, procedure->poll_end)) {
        icdgen_end(procedure, ICD_TIMED_OUT);
    } else {
        icdgen_wait(procedure, procedure->now + procedure->interval);
    }
    return true;
}

static inline void icdgen_resume(icd_procedure_t *procedure, const icd_event_t *outcome)
{
    procedure->want = ICDGEN_WANT_NOTHING;
    if (outcome != NULL && outcome->kind != ICD_EVENT_DONE && !procedure->tolerant) {
        icdgen_end(procedure, outcome->kind == ICD_EVENT_REFUSED ? ICD_REFUSED : ICD_TIMED_OUT);
    } else if (procedure->polled == NULL || !icdgen_polls_on(procedure, outcome)) {
        procedure->resume(procedure, outcome);
    } else {
        /* the frame is polled again */
    }
}

ICDGEN_API bool icd_procedure_next(icd_procedure_t *procedure, uint32_t now, icd_request_t *request)
{
    procedure->now = now;
    if (!procedure->started) {
        procedure->started = true;
        icdgen_resume(procedure, NULL);
    }
    while (procedure->want == ICDGEN_WANT_TIME && icdgen_reached(now, procedure->until)) {
        icdgen_resume(procedure, NULL);
    }
    if (procedure->want != ICDGEN_WANT_REQUEST || procedure->asked) {
        return false;
    }
    procedure->asked = true;
    *request = procedure->request;
    return true;
}

/*
 * A negative acknowledge with a code that the ICD does not have is treated as damaged: a request that may be repeated
 * is sent again, any other is treated as if no acknowledge was received.
 */
static inline void icdgen_damaged(icd_procedure_t *procedure, const icd_event_t *event)
{
    icd_event_t timeout = *event;
    timeout.kind = ICD_EVENT_TIMEOUT;
    if (procedure->request.repeat && procedure->damaged < procedure->link->client.retries) {
        procedure->damaged++;
    } else {
        procedure->damaged = 0;
        icdgen_resume(procedure, &timeout);
    }
}

ICDGEN_API void icd_procedure_event(icd_procedure_t *procedure, uint32_t now, const icd_event_t *event)
{
    procedure->now = now;
    if (event->kind == ICD_EVENT_PACKET) {
        if (procedure->packet != NULL) {
            procedure->packet(procedure, event->number, event->data, event->length);
        }
    } else if (
        procedure->asked &&
        (event->kind == ICD_EVENT_DONE || event->kind == ICD_EVENT_REFUSED || event->kind == ICD_EVENT_TIMEOUT)) {
        procedure->asked = false;
        if (event->kind == ICD_EVENT_REFUSED && event->code >= 0 && event->reason == ICD_REASON_UNKNOWN) {
            icdgen_damaged(procedure, event);
        } else {
            procedure->damaged = 0;
            icdgen_resume(procedure, event);
        }
    } else {
        /* not related to this procedure */
    }
}

ICDGEN_API bool icd_procedure_deadline(const icd_procedure_t *procedure, uint32_t *deadline)
{
    *deadline = procedure->until;
    return procedure->want == ICDGEN_WANT_TIME;
}

ICDGEN_API icd_status_t icd_procedure_step(
    icd_procedure_t *procedure, icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context)
{
    icd_request_t request;
    if (client->state != ICD_CLIENT_IDLE || icdgen_client_has_output(client) ||
        !icd_procedure_next(procedure, now, &request)) {
        return ICD_OK;
    }
    return icd_client_start(client, now, &request, on_event, context);
}

static inline icd_status_t icdgen_procedure_init(
    icd_procedure_t *procedure,
    const icd_link_t *link,
    bool supported,
    void (*resume)(icd_procedure_t *procedure, const icd_event_t *outcome))
{
    (void)memset(procedure, 0, sizeof *procedure);
    procedure->link = link;
    procedure->resume = resume;
    procedure->result = ICD_RUNNING;
    return supported ? ICD_OK : ICD_ERROR_UNSUPPORTED;
}

#endif /* ICDGEN_WIRE_PROCEDURE_C */
