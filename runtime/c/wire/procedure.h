#ifndef ICDGEN_WIRE_PROCEDURE_H
#define ICDGEN_WIRE_PROCEDURE_H

#include "../icdgen.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "client.h"
#include "sizes.h"

/* ---- procedures -------------------------------------------------------------------------------------------------- */

/** How a procedure ended. */
typedef enum {
    ICD_RUNNING,
    ICD_DONE,
    ICD_REFUSED,   /**< The node refused a request without which it cannot go on. */
    ICD_TIMED_OUT, /**< No reply to such a request, or a flag never became what was waited for. */
    ICD_PARAMETER, /**< The node cannot load this block. */
    ICD_LENGTH,    /**< The block, or a frame, has another length than was asked for. */
    ICD_ROUNDS,    /**< Packets were still missing after so many rounds. */
    ICD_CHECKSUM,  /**< After so many rounds the checksum was still wrong. */
    ICD_FAILED     /**< The node tells that what it was asked for failed. */
} icd_result_t;

typedef enum { ICDGEN_WANT_NOTHING, ICDGEN_WANT_REQUEST, ICDGEN_WANT_TIME } icdgen_want_t;

typedef struct icd_procedure icd_procedure_t;

/** What all procedures share. It says which request comes next and is told what became of it. */
struct icd_procedure {
    const icd_link_t *link;
    icd_result_t result;
    uint32_t now;
    uint32_t until;        /* when a wait ends */
    icd_request_t request; /* that comes next, or whose outcome is waited for */
    icdgen_want_t want;
    bool started;
    bool asked;               /* the request was given out */
    bool tolerant;            /* it may end in any way */
    uint32_t damaged;         /* acknowledges of it that were */
    const icd_step_t *polled; /* the frame that is polled until a flag is as wanted */
    icd_role_t flag;
    bool wanted;
    uint8_t program; /* of which the frame must be, if it says of which one it is */
    uint32_t interval;
    uint32_t poll_end;
    uint8_t state;
    uint8_t data[ICD_STEP_BYTES]; /* of the request */
    void (*resume)(
        icd_procedure_t *procedure, const icd_event_t *outcome); /* outcome NULL: at the start, after a wait */
    void (*packet)(icd_procedure_t *procedure, uint32_t number, const uint8_t *data, size_t length);
};

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

/* Requests a frame. */
static inline void icdgen_ask(icd_procedure_t *procedure, int16_t id, uint8_t state)
{
    memset(&procedure->request, 0, sizeof procedure->request);
    procedure->request.direction = ICD_TELEMETRY;
    procedure->request.id = ICDGEN_U8(id);
    procedure->request.repeat = true;
    procedure->want = ICDGEN_WANT_REQUEST;
    procedure->tolerant = false;
    procedure->state = state;
}

/* A telecommand as a fresh message has it; values are put into `data` then. */
static inline void icdgen_command(icd_procedure_t *procedure, const icd_step_t *step, bool repeat, uint8_t state)
{
    if (step->fresh != NULL) {
        memcpy(procedure->data, step->fresh, step->length);
    } else {
        memset(procedure->data, 0, step->length);
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

/* Requests the frame until its flag is as wanted, or its error flag is set; `state` is told of that frame. */
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

/* Whether the frame is about what was asked for. */
static inline bool icdgen_is_meant(const icd_procedure_t *procedure, const uint8_t *frame)
{
    const icd_step_t *const step = procedure->polled;
    return icdgen_place(step, ICD_ROLE_PROGRAM) == NULL ||
        icdgen_get(procedure->link, step, frame, ICD_ROLE_PROGRAM) == procedure->program;
}

/* Whether polling goes on after this outcome. */
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
    }
}

/** The next request, once; false while there is nothing to send. It lasts until the next call. */
static inline bool icd_procedure_next(icd_procedure_t *procedure, uint32_t now, icd_request_t *request)
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
 * A refusal with a code that the ICD does not have is a damaged acknowledge, which tells nothing: what may be repeated
 * is asked again, and else it is as if none had come.
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

/** Takes an event of the client; those that are of no concern are ignored. */
static inline void icd_procedure_event(icd_procedure_t *procedure, uint32_t now, const icd_event_t *event)
{
    procedure->now = now;
    switch (event->kind) {
    case ICD_EVENT_PACKET:
        if (procedure->packet != NULL) {
            procedure->packet(procedure, event->number, event->data, event->length);
        }
        break;
    case ICD_EVENT_DONE:
    case ICD_EVENT_REFUSED:
    case ICD_EVENT_TIMEOUT:
        if (procedure->asked) {
            procedure->asked = false;
            if (event->kind == ICD_EVENT_REFUSED && event->code >= 0 && event->reason == ICD_REASON_UNKNOWN) {
                icdgen_damaged(procedure, event);
            } else {
                procedure->damaged = 0;
                icdgen_resume(procedure, event);
            }
        }
        break;
    default:
        break;
    }
}

/**
 * When icd_procedure_next() wants to be called again. False while a request is ready, which is before the first call
 * and after an outcome: it may be called at once; false also while an outcome is awaited, and at the end.
 */
static inline bool icd_procedure_deadline(const icd_procedure_t *procedure, uint32_t *deadline)
{
    *deadline = procedure->until;
    return procedure->want == ICDGEN_WANT_TIME;
}

/**
 * Gives the client the next request as soon as there is one and the client is free. `on_event` is that of the client,
 * and hands each event to icd_procedure_event().
 */
static inline icd_status_t icd_procedure_step(
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
    memset(procedure, 0, sizeof *procedure);
    procedure->link = link;
    procedure->resume = resume;
    procedure->result = ICD_RUNNING;
    return supported ? ICD_OK : ICD_ERROR_UNSUPPORTED;
}

#endif /* ICDGEN_WIRE_PROCEDURE_H */
