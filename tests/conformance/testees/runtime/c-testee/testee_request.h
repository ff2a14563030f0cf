/* What requests ask for: messages, fields, frames. */

#ifndef TESTEE_REQUEST_H
#define TESTEE_REQUEST_H

#include "testee_answer.h"

/* The value of a key of the request if it has that type, else NULL. */
const json_value_t *of_type(const talk_t *talk, const char *key, json_type_t type);
bool is_word(const json_value_t *value, const char *word);

/* NULL if there is none of that name. */
const testee_node_t *node_named(json_text_t name);
const testee_field_t *field_named(const testee_message_t *message, json_text_t name);

/* Finds the message that the request means and makes room for a value of it. */
bool find_message(talk_t *talk);

/* Gives an integer, enum or bool field the number of a request. */
bool take_integer(talk_t *talk, const testee_field_t *field, const json_value_t *given);

bool decode(talk_t *talk);
bool encode(talk_t *talk);

#endif
