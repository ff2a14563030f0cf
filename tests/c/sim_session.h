/* A connection with a simulated node: asks and waits, and runs procedures. Included by sim_client.c alone. */
#ifndef SIM_SESSION_H
#define SIM_SESSION_H

#include "port.h"

typedef struct {
    int port;
    icd_link_t link; /* that of the node, with short waits: the simulator is never slow */
    icd_client_t client;
    icd_uart_line_t line;
    icd_slot_t slot;
    icd_procedure_t *procedure; /* that is running, or NULL */
    icd_event_t outcome;        /* of the last request */
    bool ended;
    uint8_t *buffer;
    uint8_t *frame; /* of the outcome */
} session_t;

static inline void session_on_event(void *context, const icd_event_t *event)
{
    session_t *const session = (session_t *)context;
    if (session->procedure != NULL) {
        icd_procedure_event(session->procedure, port_now(), event);
    } else if (
        event->kind == ICD_EVENT_DONE || event->kind == ICD_EVENT_SENT || event->kind == ICD_EVENT_REFUSED ||
        event->kind == ICD_EVENT_TIMEOUT) {
        session->outcome = *event;
        session->outcome.data = session->frame;
        session->ended = true;
        if (event->length != 0) {
            memcpy(session->frame, event->data, event->length);
        }
    }
}

static inline void session_forget(session_t *session)
{
    free(session->buffer);
    free(session->frame);
}

/* The same device, while the program of that link runs. */
static inline void session_becomes(session_t *session, const icd_link_t *link)
{
    const icd_client_settings_t settings = {150, 4, 5, 2000, 1000, 100, 0, 1, 60000};
    const int port = session->port;
    session_forget(session);
    memset(session, 0, sizeof *session);
    session->port = port;
    session->link = *link;
    session->link.client = settings;
    session->buffer = (uint8_t *)malloc(icd_client_bytes(link, 1));
    session->frame = (uint8_t *)malloc(link->longest);
    if (session->buffer == NULL || session->frame == NULL) {
        port_failed("no memory");
    }
    icd_client_uart(&session->client, &session->link, &session->line, &session->slot, 1, session->buffer, icd_client_bytes(link, 1));
}

static inline void session_open(session_t *session, const icd_link_t *link, const char *host, const char *number)
{
    memset(session, 0, sizeof *session);
    session->port = port_open(host, number);
    session_becomes(session, link);
}

static inline void session_close(session_t *session)
{
    close(session->port);
    session_forget(session);
}

/* Waits until the client or the procedure wants to go on. */
static inline void session_wait(session_t *session)
{
    uint32_t until = 0, other;
    const bool asked = icd_client_deadline(&session->client, &until);
    if (session->procedure != NULL && icd_procedure_deadline(session->procedure, &other) &&
        (!asked || (int32_t)(other - until) < 0)) {
        until = other;
    }
    port_receive(session->port, &session->client, until, session_on_event, session);
    port_send(session->port, &session->client);
}

/* What became of a request; the frame is in `frame`. */
static inline const icd_event_t *session_ask(session_t *session, const icd_request_t *request)
{
    session->ended = false;
    session->outcome.kind = ICD_EVENT_TIMEOUT;
    if (icd_client_start(&session->client, port_now(), request) == ICD_OK) {
        port_send(session->port, &session->client);
        while (!session->ended) {
            session_wait(session);
        }
    }
    return &session->outcome;
}

static inline const icd_event_t *session_get(session_t *session, uint8_t id)
{
    icd_request_t request;
    memset(&request, 0, sizeof request);
    request.direction = ICD_TELEMETRY;
    request.id = id;
    return session_ask(session, &request);
}

/* A refusal with a code that the ICD does not have is a damaged acknowledge: it is asked again. */
static inline const icd_event_t *session_send(session_t *session, uint8_t id, const uint8_t *data, size_t length)
{
    const icd_event_t *outcome;
    icd_request_t request = {ICD_TELECOMMAND, id, true, false, 0, data, length};
    uint32_t left = session->link.client.retries;
    do {
        outcome = session_ask(session, &request);
    } while (outcome->kind == ICD_EVENT_REFUSED && outcome->may_be_damaged && left-- != 0);
    return outcome;
}

/* The same procedure with short waits. */
static inline void session_hurry(session_t *session, icd_procedure_t *procedure)
{
    static icd_procedure_form_t form;
    static icd_poll_form_t polls[8];
    static icd_receive_form_t receives[2];
    form = *procedure->form;
    for (size_t i = 0; i < form.step_count; ++i) {
        const icd_step_form_t *const step = &form.steps[i];
        if (step->kind == ICD_STEP_POLL) {
            polls[step->index] = form.polls[step->index];
            polls[step->index].interval = 5;
        }
    }
    for (size_t i = 0; i < form.receive_count; ++i) {
        receives[i] = form.receives[i];
        receives[i].silence = 60;
    }
    form.polls = polls;
    form.receives = receives;
    procedure->form = &form;
    procedure->link = &session->link;
}

static inline icd_result_t session_run(session_t *session, icd_procedure_t *procedure)
{
    session_hurry(session, procedure);
    session->procedure = procedure;
    while (procedure->result == ICD_RUNNING) {
        uint32_t later;
        if (icd_procedure_step(procedure, &session->client, port_now()) != ICD_OK) {
            break;
        }
        port_send(session->port, &session->client);
        if (session->client.free != session->client.slots || icd_procedure_deadline(procedure, &later)) {
            session_wait(session);
        }
    }
    session->procedure = NULL;
    return procedure->result;
}

#endif /* SIM_SESSION_H */
