/* Requests about the wire layer. */

#ifndef TESTEE_WIRE_H
#define TESTEE_WIRE_H

#include "testee_request.h"

/* ---- keys of objects; `object` is the index of the object, false: the request is refused ------------------------- */

typedef struct {
    uint8_t *data;
    size_t length;
} octets_t;

#define REQUIRED (-1)
#define MOST_NUMBER 0xFFFFFFFFu

/* Memory until the end of the request, of just that size, so that reading beyond it is noticed. */
void *memory(size_t size);
void forget_all(void);

bool ask_number(
    talk_t *talk, size_t object, const char *key, uint64_t least, uint64_t most, int64_t otherwise, uint32_t *number);
bool ask_octets(talk_t *talk, size_t object, const char *key, octets_t *octets);
bool ask_flag(talk_t *talk, size_t object, const char *key, bool *flag);
/* The index of the value. */
bool ask_text(talk_t *talk, size_t object, const char *key, size_t *index);
bool ask_rows(talk_t *talk, size_t object, const char *key, size_t *index);
/* A list of objects. */
bool ask_mappings(talk_t *talk, size_t object, const char *key, size_t *index);
/* The bus of that name; false, and nothing refused, if there is none. */
bool bus_named(const json_value_t *name, icd_bus_t *bus);
bool octets_of(talk_t *talk, size_t index, octets_t *octets);

/* ---- answers ------------------------------------------------------------------------------------------------------- */

void put_ok(talk_t *talk);

void put_octets(json_out_t *out, const uint8_t *data, size_t length);
void put_key_text(json_out_t *out, const char *key, const char *text);
void put_key_number(json_out_t *out, const char *key, int64_t number);
/* null if the number is negative */
void put_key_or_null(json_out_t *out, const char *key, int64_t number);
void put_key_octets(json_out_t *out, const char *key, const uint8_t *data, size_t length);
bool refuse_length(talk_t *talk, const char *error, size_t expected, size_t actual);
bool refuse_status(talk_t *talk, icd_status_t status);

/* Events of the client and of the joiner, each followed by a comma. */
typedef struct {
    icd_bus_t bus;
    json_out_t out;
} events_t;

void put_list(json_out_t *out, const char *key, const json_out_t *items);

/* ---- ops: the answer is made, or the request is refused --------------------------------------------------------------- */

typedef void wire_op(talk_t *talk, const icd_link_t *link);

wire_op log_decode, log_encode, log_message_decode, log_message_encode, dos_time, hole_map, index_decode, index_encode;
wire_op identify, client_script, file_script, can_split, can_join;

/* False if it is no such op. */
bool answer_wire(talk_t *talk, const json_value_t *op);

#endif
