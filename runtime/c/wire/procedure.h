#ifndef ICDGEN_WIRE_PROCEDURE_H
#define ICDGEN_WIRE_PROCEDURE_H

#include "../icdgen.h"
#include "linkage.h"
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

/** The next request, once; false while there is nothing to send. It lasts until the next call. */
ICDGEN_API bool icd_procedure_next(icd_procedure_t *procedure, uint32_t now, icd_request_t *request);

/** Takes an event of the client; those that are of no concern are ignored. */
ICDGEN_API void icd_procedure_event(icd_procedure_t *procedure, uint32_t now, const icd_event_t *event);

/**
 * When icd_procedure_next() wants to be called again. False while a request is ready, which is before the first call
 * and after an outcome: it may be called at once; false also while an outcome is awaited, and at the end.
 */
ICDGEN_API bool icd_procedure_deadline(const icd_procedure_t *procedure, uint32_t *deadline);

/**
 * Gives the client the next request as soon as there is one and the client is free. `on_event` is that of the client,
 * and hands each event to icd_procedure_event().
 */
ICDGEN_API icd_status_t icd_procedure_step(
    icd_procedure_t *procedure, icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context);

#endif /* ICDGEN_WIRE_PROCEDURE_H */
