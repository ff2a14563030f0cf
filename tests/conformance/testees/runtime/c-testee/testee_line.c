/* Answers the conformance run about the generated C: reads lines of words, and writes such. */

#include "testee_line.h"
#include "testee.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    char *at;
    size_t length;
    size_t capacity;
} text_t;

static text_t line_in, line_out;
static char *rest; /* of the request; NULL at its end */

static void *checked(void *found)
{
    if (found == NULL) {
        abort();
    }
    return found;
}

static void append(text_t *text, const char *more, size_t length)
{
    if (text->at == NULL || text->capacity - text->length < length) {
        text->capacity = text->capacity * 2u + length + 1024u;
        text->at = (char *)checked(realloc(text->at, text->capacity));
    }
    memcpy(text->at + text->length, more, length);
    text->length += length;
}

/* ---- the request -------------------------------------------------------------------------------------------------- */

const char *next_word(void)
{
    char *word = rest, *end;
    if (word == NULL) {
        return "";
    }
    end = strchr(word, ' ');
    if (end != NULL) {
        *end = '\0';
    }
    rest = end != NULL ? end + 1 : NULL;
    return word;
}

bool has_words(void)
{
    return rest != NULL;
}

bool is_word(const char *word, const char *other)
{
    return strcmp(word, other) == 0;
}

uint32_t number_of(const char *word)
{
    return (uint32_t)strtoul(word, NULL, 10);
}

uint32_t next_or(uint32_t otherwise)
{
    const char *word = next_word();
    return *word != '\0' ? number_of(word) : otherwise;
}

uint32_t next_number(void)
{
    return next_or(0);
}

uint8_t next_byte(void)
{
    return (uint8_t)next_or(0);
}

octets_t octets_of(const char *word)
{
    octets_t octets;
    size_t i;
    octets.length = strlen(word) / 2u;
    octets.data = (uint8_t *)memory(octets.length);
    for (i = 0; i < octets.length; i++) {
        const char digits[3] = {word[i * 2u], word[i * 2u + 1u], '\0'};
        octets.data[i] = (uint8_t)strtoul(digits, NULL, 16);
    }
    return octets;
}

octets_t next_octets(void)
{
    return octets_of(next_word());
}

static void **taken;
static size_t taken_count;

void *memory(size_t size)
{
    void *found = checked(malloc(size != 0u ? size : 1u));
    taken = (void **)checked(realloc(taken, (taken_count + 1u) * sizeof *taken));
    taken[taken_count++] = found;
    return memset(found, 0xA5, size);
}

static void forget_all(void)
{
    while (taken_count != 0u) {
        free(taken[--taken_count]);
    }
}

/* ---- the answer ------------------------------------------------------------------------------------------------------ */

static void put(const char *text)
{
    append(&line_out, text, strlen(text));
}

static void put_key(const char *key)
{
    put(" ");
    put(key);
    put("=");
}

static void put_decimal(uint64_t number)
{
    char text[24];
    (void)snprintf(text, sizeof text, "%" PRIu64, number);
    put(text);
}

static void put_hex(const uint8_t *data, size_t length)
{
    static const char digits[] = "0123456789abcdef";
    size_t i;
    for (i = 0; i < length; i++) {
        append(&line_out, &digits[data[i] >> 4], 1);
        append(&line_out, &digits[data[i] & 15u], 1);
    }
}

void put_row(const char *word)
{
    put(line_out.length != 0u ? " " : "");
    put(word);
}

void put_word(const char *key, const char *word)
{
    put_key(key);
    put(word);
}

void put_number(const char *key, uint64_t number)
{
    put_key(key);
    put_decimal(number);
}

void put_absent(const char *key)
{
    put_key(key);
    put("-");
}

static void put_signed_decimal(int64_t number)
{
    put(number < 0 ? "-" : "");
    put_decimal(number < 0 ? 0u - (uint64_t)number : (uint64_t)number);
}

void put_signed(const char *key, int64_t number)
{
    put_key(key);
    put_signed_decimal(number);
}

void put_octets(const char *key, const void *data, size_t length)
{
    put_key(key);
    put_hex((const uint8_t *)data, length);
}

void put_text(const char *key, const char *text)
{
    if (text != NULL) {
        put_octets(key, text, strlen(text));
    }
}

void put_list(const char *key)
{
    put_key(key);
}

void put_item(uint64_t number)
{
    put_decimal(number);
    put(",");
}

void put_signed_item(int64_t number)
{
    put_signed_decimal(number);
    put(",");
}

void put_octets_item(const void *data, size_t length)
{
    put_hex((const uint8_t *)data, length);
    put(",");
}

void refuse(const char *error)
{
    line_out.length = 0;
    put_row("refused");
    put_row(error);
}

void refuse_status(icd_status_t status)
{
    refuse(
        status == ICD_ERROR_UNSUPPORTED      ? "unsupported"
            : status == ICD_ERROR_UNKNOWN_ID ? "unknown-id"
            : status == ICD_ERROR_RANGE      ? "range"
            : status == ICD_ERROR_CHECKSUM   ? "checksum"
            : status == ICD_ERROR_BUSY       ? "busy"
                                             : "length");
}

void refuse_length(const char *error, size_t expected, size_t actual)
{
    refuse(error);
    put_number("expected", expected);
    put_number("actual", actual);
}

/* ---- lines -------------------------------------------------------------------------------------------------------------- */

/* Reads a line without its end; false at the end of the input. */
static bool read_line(void)
{
    int c;
    char one;
    line_in.length = 0;
    while ((c = getc(stdin)) != EOF && c != '\n') {
        one = (char)c;
        append(&line_in, &one, 1);
    }
    append(&line_in, "", 1);
    rest = line_in.at;
    return c != EOF;
}

static void answer_line(void)
{
    const char *name = next_word();
    size_t part, i;
    for (part = 0; testee_ops[part] != NULL; part++) {
        for (i = 0; testee_ops[part][i].name != NULL; i++) {
            if (is_word(name, testee_ops[part][i].name)) {
                testee_ops[part][i].answer();
                return;
            }
        }
    }
    refuse("request");
}

int main(void)
{
    while (read_line()) {
        line_out.length = 0;
        answer_line();
        forget_all();
        put("\n");
        if (fwrite(line_out.at, 1, line_out.length, stdout) != line_out.length || fflush(stdout) != 0) {
            return 1;
        }
    }
    free(line_in.at);
    free(line_out.at);
    free(taken);
    return 0;
}
