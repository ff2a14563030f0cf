#ifndef ICDGEN_WIRE_PROCEDURE_H
#define ICDGEN_WIRE_PROCEDURE_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "procedure_forms.h"
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
    ICD_BUSY,      /**< The node was too busy for a necessary request. */
    ICD_TIMED_OUT, /**< No reply to a necessary request, or the node was not ready in time. */
    ICD_FAILED,    /**< The node reports an error. */
    ICD_LENGTH,    /**< A block has a different length than requested. */
    ICD_CHECKSUM,  /**< The checksum of a block is wrong after the maximum number of rounds. */
    ICD_ROUNDS,    /**< Packets are still missing after the maximum number of rounds. */
    ICD_LIMIT      /**< The procedure exceeds a limit of the ICD: time, requests, bytes or entries. */
} icd_result_t;

/** Callback for each received block. `data` is valid during the call; `offset` and `length` are in bytes. */
typedef void icd_block_fn(void *context, uint32_t offset, const uint8_t *data, size_t length);

/** Callback for each entry of a list: the data of telemetry, valid during the call. */
typedef void icd_entry_fn(void *context, const uint8_t *data, size_t length);

/** Memory and callbacks of a procedure. The memory must stay valid while the procedure runs. */
typedef struct {
    const uint8_t *bytes; /**< Bytes to send. */
    size_t byte_count;
    uint32_t block;  /**< Largest number of bytes of a block; 0: that of the ICD. */
    uint8_t *buffer; /**< For a received block. */
    size_t buffer_size;
    uint8_t *bitmap; /**< For the packets of a block. */
    size_t bitmap_size;
    icd_block_fn *on_block;
    icd_entry_fn *on_entry;
    void *context; /**< For the callbacks. */
} icd_procedure_memory_t;

/**
 * A procedure: returns the next request and processes its outcome. NODE_PROCEDURE() initializes it. All members except
 * `result` are internal.
 */
typedef struct {
    icd_result_t result;
    const icd_link_t *link;
    const icd_procedure_form_t *form;
    icd_procedure_memory_t memory;
    icd_bus_t bus;
    uint32_t registers[ICD_REGISTERS];
    uint16_t at;           /* index of the current step */
    bool is_entered;       /* the current step has begun */
    bool is_started;       /* icd_procedure_next() was called */
    bool has_request;      /* the current step has a request */
    bool is_requested;     /* icd_procedure_next() returned it */
    bool has_reply;        /* its telemetry arrived before its outcome */
    bool waits;            /* the current step waits */
    bool has_block;        /* a block has begun */
    bool has_round;        /* a round has begun since the block began, or began again */
    uint8_t damaged;       /* number of damaged acknowledges of the request */
    icd_request_t request; /* the next request, or the request in progress */
    uint32_t requests;     /* number of requests */
    uint32_t now;
    uint32_t begin;       /* time of the first call */
    uint32_t until;       /* time at which the wait ends */
    uint32_t end;         /* of a poll */
    uint32_t last_packet; /* time of the last new packet */
    uint32_t left;        /* messages of a map or packets that the step requests */
    uint32_t requested;   /* length of the block */
    uint32_t count;       /* packets of the block */
    uint32_t missing;     /* packets of the block that are not there */
    uint32_t cursor;      /* position in the block after the selected packet */
    uint32_t rounds;      /* of the block */
    uint32_t entries;     /* number of entries */
    uint32_t repetitions; /* of the last entry */
    size_t frame_length;
    size_t entry_length;
    uint8_t frame[ICD_STEP_BYTES]; /* the last telemetry */
    uint8_t entry[ICD_STEP_BYTES]; /* the last entry */
    uint8_t data[ICD_STEP_BYTES];  /* of the request */
} icd_procedure_t;

/**
 * Initialize a procedure. NODE_PROCEDURE() is the typed version. `inputs` are the inputs that are numbers.
 * Return ICD_ERROR_RANGE if an input is not supported, ICD_ERROR_LENGTH if there are too many bytes to send or a buffer
 * is too small, ICD_ERROR_UNSUPPORTED if procedures are left out. After an error the procedure must not be used.
 */
ICDGEN_API icd_status_t icd_procedure_init(
    icd_procedure_t *procedure,
    const icd_link_t *link,
    const icd_procedure_form_t *form,
    icd_bus_t bus,
    const uint32_t *inputs,
    const icd_procedure_memory_t *memory);

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

/** Return the number of bytes transferred, and get their total; ICD_UNKNOWN if it is unknown. */
ICDGEN_API uint32_t icd_procedure_progress(const icd_procedure_t *procedure, uint32_t *total);

/**
 * Start the next request of the procedure if there is one and the client has a free slot. The callback of the client
 * must pass each event to icd_procedure_event().
 */
ICDGEN_API icd_status_t icd_procedure_step(icd_procedure_t *procedure, icd_client_t *client, uint32_t now);

#endif /* ICDGEN_WIRE_PROCEDURE_H */
