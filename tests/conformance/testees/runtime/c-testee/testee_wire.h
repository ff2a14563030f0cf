/* Requests about the wire layer. */

#ifndef TESTEE_WIRE_H
#define TESTEE_WIRE_H

#include "testee.h"
#include "testee_line.h"

#include <icdgen_wire.h>

/* That of a node; NULL if the ICD says nothing of how its messages travel. */
const icd_link_t *testee_link(size_t node);

/* A checksum of a node by its name in the ICD, in hexadecimal; NULL if there is none. */
const icd_checksum_algorithm_t *testee_checksum(size_t node, const char *name);

/* A procedure of a node. */
typedef struct {
    const icd_procedure_form_t *(*form)(void);
    /* Initializes it with its typed function. */
    icd_status_t (*begin)(icd_procedure_t *procedure, icd_bus_t bus, const uint32_t *numbers,
                          const icd_procedure_memory_t *given);
    uint32_t (*const *outputs)(const icd_procedure_t *procedure);
    size_t output_count;
} testee_procedure_t;

/* That of a node with this number; NULL if there is none. */
const testee_procedure_t *testee_procedure(size_t node, size_t place);

/* That of the node that the next word is the number of. */
const icd_link_t *next_link(void);
icd_bus_t next_bus(void);

const char *event_name(icd_event_kind_t kind);
void put_known(const char *key, int64_t number); /* A negative one is not known. */

/* Begins the answer and is true, or the answer is a refusal. */
static inline bool answers(icd_status_t status)
{
    if (status != ICD_OK) {
        refuse_status(status);
        return false;
    }
    put_row("ok");
    return true;
}

/* Id and data. */
icd_can_packet_t next_packet(void);
void put_packet(const char *row, const icd_can_packet_t *packet);

extern const testee_op_t testee_wire_ops[], testee_bus_ops[], testee_file_ops[], testee_log_ops[], testee_script_ops[],
    testee_stream_ops[];

#endif
