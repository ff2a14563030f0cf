/* Answers, and what they tell of a message. */

#ifndef TESTEE_ANSWER_H
#define TESTEE_ANSWER_H

#include "testee.h"
#include "testee_json.h"

/* One request: what it asks about, and the answer as far as it is made. */
typedef struct {
    json_row_t row;
    json_out_t out;
    const testee_node_t *node;
    const testee_dispatcher_t *dispatcher;
    const testee_message_t *message;
    uint32_t id;
    void *any;   /* a value of the dispatcher */
    void *value; /* the message in it */
} talk_t;

/* Refusals: they replace what was answered so far and are false, so that a function can end with them. */
bool refuse(talk_t *talk, const char *error);
bool refuse_request(talk_t *talk, const char *detail);
bool refuse_field(talk_t *talk, const char *error, const char *name, size_t length);
bool refuse_named(talk_t *talk, const char *error, const testee_field_t *field);

/* The bits of a member that is not an array. */
uint64_t member_bits(const testee_field_t *field, const void *value);
void set_member(const testee_field_t *field, void *value, uint64_t bits);

uint64_t double_bits(double value);
double double_of(uint64_t bits);

void put_name_or_null(json_out_t *out, const char *name);
void put_raw(talk_t *talk);
void put_special(talk_t *talk);
void put_limits(talk_t *talk);

/* Encodes the message and tells what went into it: the answer to decode and encode. */
bool answer_message(talk_t *talk, bool names);

#endif
