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

/** State and result of a procedure. */
typedef enum {
    ICD_RUNNING,
    ICD_DONE,
    ICD_REFUSED,   /**< The node rejected a necessary request. */
    ICD_TIMED_OUT, /**< No reply to a necessary request, or a flag did not change in time. */
    ICD_PARAMETER, /**< The node cannot load the block. */
    ICD_LENGTH,    /**< A block or frame has a different length than requested. */
    ICD_LIMIT,     /**< The file or the list is longer than the ICD allows. */
    ICD_ROUNDS,    /**< Packets are still missing after the maximum number of rounds. */
    ICD_CHECKSUM,  /**< The checksum is still wrong after the maximum number of rounds. */
    ICD_FAILED     /**< The node reports that the operation failed. */
} icd_result_t;

typedef enum { ICDGEN_WANT_NOTHING, ICDGEN_WANT_REQUEST, ICDGEN_WANT_TIME } icdgen_want_t;

typedef struct icd_procedure icd_procedure_t;

/**
 * Common state of all procedures. A procedure returns the next request and processes its outcome. All members except
 * `result` are internal.
 */
struct icd_procedure {
    const icd_link_t *link;
    icd_result_t result;
    uint32_t now;
    uint32_t until;        /* time at which a wait ends */
    icd_request_t request; /* the next request, or the request in progress */
    icdgen_want_t want;
    bool started;
    bool asked;               /* the request was returned to the caller */
    bool tolerant;            /* the procedure continues after any outcome of the request */
    uint32_t damaged;         /* number of damaged acknowledges of the request */
    const icd_step_t *polled; /* frame that is polled until its flag has the value `wanted` */
    icd_role_t flag;
    bool wanted;
    uint8_t program; /* expected program, if the frame contains its number */
    uint32_t interval;
    uint32_t poll_end;
    uint8_t state;
    uint8_t data[ICD_STEP_BYTES]; /* data of the request */
    void (*resume)(
        icd_procedure_t *procedure, const icd_event_t *outcome); /* outcome is NULL at the start and after a wait */
    void (*packet)(icd_procedure_t *procedure, uint32_t number, const uint8_t *data, size_t length);
};

/**
 * Get the next request. Each request is returned once and is valid until the next call. `now` is in milliseconds.
 * Return false if there is nothing to send.
 */
ICDGEN_API bool icd_procedure_next(icd_procedure_t *procedure, uint32_t now, icd_request_t *request);

/** Pass an event of the client to the procedure. Unrelated events are ignored. */
ICDGEN_API void icd_procedure_event(icd_procedure_t *procedure, uint32_t now, const icd_event_t *event);

/**
 * Get the time in milliseconds at which icd_procedure_next() must be called again. Return false if the procedure is not
 * waiting for a time: before the first call and after an outcome (call icd_procedure_next() at once), while a request
 * is in progress, and at the end.
 */
ICDGEN_API bool icd_procedure_deadline(const icd_procedure_t *procedure, uint32_t *deadline);

/**
 * Start the next request of the procedure if there is one and the client is idle. `on_event` is the callback that is
 * also passed to the client; it must pass each event to icd_procedure_event().
 */
ICDGEN_API icd_status_t icd_procedure_step(
    icd_procedure_t *procedure, icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context);

#endif /* ICDGEN_WIRE_PROCEDURE_H */
