/* Writes answers. */

#include "testee_json.h"

#include <stdlib.h>
#include <string.h>

void *json_grown(void *memory, size_t size)
{
    void *larger = realloc(memory, size);
    if (larger == NULL) {
        abort();
    }
    return larger;
}

void json_put(json_out_t *out, const char *text, size_t length)
{
    if (out->capacity - out->length < length) {
        out->capacity = (out->capacity * 2u) + length;
        out->at = (char *)json_grown(out->at, out->capacity);
    }
    memcpy(out->at + out->length, text, length);
    out->length += length;
}

void json_put_text(json_out_t *out, const char *text)
{
    json_put(out, text, strlen(text));
}

void json_put_string(json_out_t *out, const char *text, size_t length)
{
    size_t i;
    json_put(out, "\"", 1);
    for (i = 0; i < length; i++) {
        unsigned char c = (unsigned char)text[i];
        if (c == '"' || c == '\\') {
            json_put(out, "\\", 1);
            json_put(out, &text[i], 1);
        } else if (c < 0x20u) {
            json_put(out, "\\u", 2);
            json_put_hex(out, c, 4);
        } else {
            json_put(out, &text[i], 1);
        }
    }
    json_put(out, "\"", 1);
}

void json_put_unsigned(json_out_t *out, uint64_t value)
{
    char digits[20];
    size_t at = sizeof digits;
    do {
        digits[--at] = (char)('0' + (int)(value % 10u));
        value /= 10u;
    } while (value != 0u);
    json_put(out, &digits[at], sizeof digits - at);
}

void json_put_signed(json_out_t *out, int64_t value)
{
    if (value < 0) {
        json_put(out, "-", 1);
        json_put_unsigned(out, 0u - (uint64_t)value);
    } else {
        json_put_unsigned(out, (uint64_t)value);
    }
}

void json_put_hex(json_out_t *out, uint64_t value, unsigned digits)
{
    static const char digit[] = "0123456789abcdef";
    while (digits != 0u) {
        digits--;
        json_put(out, &digit[(value >> (digits * 4u)) & 0xFu], 1);
    }
}
