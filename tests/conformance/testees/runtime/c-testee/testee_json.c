
#include "testee_json.h"

#include <string.h>

#define MOST_LEVELS 16u

typedef struct {
    char *at;
    char *end;
    json_row_t *row;
} reader_t;

static bool read_value(reader_t *reader, unsigned level);

static size_t add(json_row_t *row, json_type_t type)
{
    json_value_t *value;
    if (row->count == row->capacity) {
        row->capacity = (row->capacity * 2u) + 64u;
        row->values = (json_value_t *)json_grown(row->values, row->capacity * sizeof *row->values);
    }
    value = &row->values[row->count];
    memset(value, 0, sizeof *value);
    value->type = type;
    return row->count++;
}

static void skip_space(reader_t *reader)
{
    while (reader->at < reader->end &&
           (*reader->at == ' ' || *reader->at == '\t' || *reader->at == '\r' || *reader->at == '\n')) {
        reader->at++;
    }
}

static bool take(reader_t *reader, char wanted)
{
    if (reader->at < reader->end && *reader->at == wanted) {
        reader->at++;
        return true;
    }
    return false;
}

int json_hex_digit(char c)
{
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    if (c >= 'a' && c <= 'f') {
        return c - 'a' + 10;
    }
    if (c >= 'A' && c <= 'F') {
        return c - 'A' + 10;
    }
    return -1;
}

static bool read_unit(reader_t *reader, uint32_t *unit)
{
    int i;
    *unit = 0;
    for (i = 0; i < 4; i++) {
        int digit = reader->at < reader->end ? json_hex_digit(*reader->at) : -1;
        if (digit < 0) {
            return false;
        }
        *unit = (*unit << 4) | (uint32_t)digit;
        reader->at++;
    }
    return true;
}

/* The code point after \u; a surrogate needs its other half. */
static bool read_code_point(reader_t *reader, uint32_t *code)
{
    uint32_t low;
    if (!read_unit(reader, code)) {
        return false;
    }
    if (*code < 0xD800u || *code > 0xDFFFu) {
        return true;
    }
    if (*code > 0xDBFFu || !take(reader, '\\') || !take(reader, 'u') || !read_unit(reader, &low)) {
        return false;
    }
    if (low < 0xDC00u || low > 0xDFFFu) {
        return false;
    }
    *code = 0x10000u + ((*code - 0xD800u) << 10) + (low - 0xDC00u);
    return true;
}

static char *put_code_point(char *to, uint32_t code)
{
    if (code < 0x80u) {
        *to++ = (char)code;
    } else if (code < 0x800u) {
        *to++ = (char)(0xC0u | (code >> 6));
        *to++ = (char)(0x80u | (code & 0x3Fu));
    } else if (code < 0x10000u) {
        *to++ = (char)(0xE0u | (code >> 12));
        *to++ = (char)(0x80u | ((code >> 6) & 0x3Fu));
        *to++ = (char)(0x80u | (code & 0x3Fu));
    } else {
        *to++ = (char)(0xF0u | (code >> 18));
        *to++ = (char)(0x80u | ((code >> 12) & 0x3Fu));
        *to++ = (char)(0x80u | ((code >> 6) & 0x3Fu));
        *to++ = (char)(0x80u | (code & 0x3Fu));
    }
    return to;
}

static bool read_escape(reader_t *reader, char **to)
{
    static const char from[] = "\"\\/bfnrt";
    static const char into[] = "\"\\/\b\f\n\r\t";
    const char *found;
    uint32_t code;
    char c;
    if (reader->at == reader->end) {
        return false;
    }
    c = *reader->at++;
    if (c == 'u') {
        if (!read_code_point(reader, &code)) {
            return false;
        }
        *to = put_code_point(*to, code);
        return true;
    }
    found = c == '\0' ? NULL : strchr(from, c);
    if (found == NULL) {
        return false;
    }
    *(*to)++ = into[found - from];
    return true;
}

static bool read_string(reader_t *reader)
{
    size_t index = add(reader->row, JSON_STRING);
    char *start = reader->at;
    char *to = start;
    while (reader->at < reader->end) {
        char c = *reader->at++;
        if (c == '"') {
            reader->row->values[index].text.at = start;
            reader->row->values[index].text.length = (size_t)(to - start);
            reader->row->values[index].after = reader->row->count;
            return true;
        }
        if ((unsigned char)c < 0x20u) {
            return false;
        }
        if (c != '\\') {
            *to++ = c;
        } else if (!read_escape(reader, &to)) {
            return false;
        }
    }
    return false;
}

static bool read_digits(reader_t *reader, json_value_t *value)
{
    char *start = reader->at;
    while (reader->at < reader->end && *reader->at >= '0' && *reader->at <= '9') {
        uint64_t digit = (uint64_t)(*reader->at++ - '0');
        if (value->magnitude > (UINT64_MAX - digit) / 10u) {
            value->too_large = true;
        }
        value->magnitude = (value->magnitude * 10u) + digit;
    }
    return reader->at != start;
}

static bool read_number(reader_t *reader)
{
    size_t index = add(reader->row, JSON_INTEGER);
    json_value_t *value = &reader->row->values[index];
    json_value_t ignored;
    bool zero;
    value->after = reader->row->count;
    value->negative = take(reader, '-');
    zero = reader->at < reader->end && *reader->at == '0';
    if (zero) {
        reader->at++;
    } else if (!read_digits(reader, value)) {
        return false;
    }
    memset(&ignored, 0, sizeof ignored);
    if (take(reader, '.')) {
        value->type = JSON_FRACTION;
        if (!read_digits(reader, &ignored)) {
            return false;
        }
    }
    if (take(reader, 'e') || take(reader, 'E')) {
        value->type = JSON_FRACTION;
        if (!take(reader, '-')) {
            (void)take(reader, '+');
        }
        return read_digits(reader, &ignored);
    }
    return true;
}

static bool read_word(reader_t *reader, const char *word, json_type_t type)
{
    size_t length = strlen(word);
    size_t index;
    if ((size_t)(reader->end - reader->at) < length || memcmp(reader->at, word, length) != 0) {
        return false;
    }
    reader->at += length;
    index = add(reader->row, type);
    reader->row->values[index].after = reader->row->count;
    return true;
}

static bool read_key(reader_t *reader)
{
    skip_space(reader);
    if (!take(reader, '"') || !read_string(reader)) {
        return false;
    }
    skip_space(reader);
    return take(reader, ':');
}

static bool read_items(reader_t *reader, json_type_t type, char close, unsigned level)
{
    size_t index = add(reader->row, type);
    size_t count = 0;
    skip_space(reader);
    if (!take(reader, close)) {
        do {
            if ((type == JSON_OBJECT && !read_key(reader)) || !read_value(reader, level + 1u)) {
                return false;
            }
            count++;
            skip_space(reader);
        } while (take(reader, ','));
        if (!take(reader, close)) {
            return false;
        }
    }
    reader->row->values[index].count = count;
    reader->row->values[index].after = reader->row->count;
    return true;
}

static bool read_value(reader_t *reader, unsigned level)
{
    skip_space(reader);
    if (level > MOST_LEVELS) {
        return false;
    }
    if (take(reader, '{')) {
        return read_items(reader, JSON_OBJECT, '}', level);
    }
    if (take(reader, '[')) {
        return read_items(reader, JSON_ARRAY, ']', level);
    }
    if (take(reader, '"')) {
        return read_string(reader);
    }
    return read_word(reader, "true", JSON_TRUE) || read_word(reader, "false", JSON_FALSE) ||
        read_word(reader, "null", JSON_NULL) || read_number(reader);
}

/* Length of the UTF-8 sequence at `at`, 0 if it is none. */
static size_t sequence(const unsigned char *at, size_t left)
{
    size_t length = at[0] < 0x80u ? 1u
        : at[0] < 0xC2u           ? 0u
        : at[0] < 0xE0u           ? 2u
        : at[0] < 0xF0u           ? 3u
        : at[0] < 0xF5u           ? 4u
                                  : 0u;
    size_t i;
    if (length == 0u || length > left) {
        return 0;
    }
    for (i = 1; i < length; i++) {
        if ((at[i] & 0xC0u) != 0x80u) {
            return 0;
        }
    }
    if ((at[0] == 0xE0u && at[1] < 0xA0u) || (at[0] == 0xEDu && at[1] > 0x9Fu) || (at[0] == 0xF0u && at[1] < 0x90u) ||
        (at[0] == 0xF4u && at[1] > 0x8Fu)) {
        return 0;
    }
    return length;
}

static bool is_utf8(const char *text, size_t length)
{
    size_t at = 0;
    while (at < length) {
        size_t step = sequence((const unsigned char *)text + at, length - at);
        if (step == 0u) {
            return false;
        }
        at += step;
    }
    return true;
}

bool json_read(json_row_t *row, char *line, size_t length)
{
    reader_t reader;
    reader.at = line;
    reader.end = line + length;
    reader.row = row;
    row->count = 0;
    if (!is_utf8(line, length) || !read_value(&reader, 0)) {
        return false;
    }
    skip_space(&reader);
    return reader.at == reader.end;
}

bool json_same(json_text_t text, const char *other, size_t length)
{
    return text.length == length && memcmp(text.at, other, length) == 0;
}

size_t json_find(const json_row_t *row, size_t object, const char *key)
{
    size_t length = strlen(key);
    size_t at = object + 1u;
    size_t left;
    size_t found = 0;
    for (left = row->values[object].count; left != 0u; left--) {
        if (json_same(row->values[at].text, key, length)) {
            found = at + 1u;
        }
        at = row->values[at + 1u].after;
    }
    return found;
}
