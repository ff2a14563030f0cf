/* Reads one line of JSON into a row of values, and writes answers. Part of the testee, not of the library. */

#ifndef TESTEE_JSON_H
#define TESTEE_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Text with a length: it may hold any character. */
typedef struct {
    const char *at;
    size_t length;
} json_text_t;

typedef enum {
    JSON_NULL,
    JSON_FALSE,
    JSON_TRUE,
    JSON_INTEGER,
    JSON_FRACTION,
    JSON_STRING,
    JSON_ARRAY,
    JSON_OBJECT
} json_type_t;

/** A value; those within an array or object (there: key, value, key, value ...) follow it directly. */
typedef struct {
    json_type_t type;
    json_text_t text;   /* of a string: decoded, UTF-8 */
    uint64_t magnitude; /* of an integer */
    bool negative;      /* of an integer */
    bool too_large;     /* of an integer whose magnitude takes more than 64 bits */
    size_t count;       /* items of an array, keys of an object */
    size_t after;       /* index of the value that follows this one and all within it */
} json_value_t;

typedef struct {
    json_value_t *values;
    size_t count;
    size_t capacity;
} json_row_t;

/** Reads a whole line. Strings are decoded in place, so the line is changed. False if it is not JSON. */
bool json_read(json_row_t *row, char *line, size_t length);

/** The value of a key of the object at index `object`; 0 if it has no such key. */
size_t json_find(const json_row_t *row, size_t object, const char *key);

/** Whether two texts are the same. */
bool json_same(json_text_t text, const char *other, size_t length);

/** The value of a hex digit in either case; -1 if it is none. */
int json_hex_digit(char c);

/** Memory of that size with what was in it; ends the program if there is none. */
void *json_grown(void *memory, size_t size);

/** Output that grows. */
typedef struct {
    char *at;
    size_t length;
    size_t capacity;
} json_out_t;

void json_put(json_out_t *out, const char *text, size_t length);
void json_put_text(json_out_t *out, const char *text);
void json_put_string(json_out_t *out, const char *text, size_t length);
void json_put_unsigned(json_out_t *out, uint64_t value);
void json_put_signed(json_out_t *out, int64_t value);
/** The lowest `digits` hex digits, most significant first. */
void json_put_hex(json_out_t *out, uint64_t value, unsigned digits);

#endif
