/* A request is a line of words, an answer too. */

#ifndef TESTEE_LINE_H
#define TESTEE_LINE_H

#include <icdgen.h>

#include <stdbool.h>

/* ---- the request, word after word; after the last there are empty ones -------------------------------------------- */

typedef struct {
    uint8_t *data;
    size_t length;
} octets_t;

const char *next_word(void);
bool has_words(void);
bool is_word(const char *word, const char *other);
uint32_t number_of(const char *word);
/* A number, `otherwise` if the word is empty. */
uint32_t next_or(uint32_t otherwise);
uint32_t next_number(void);
uint8_t next_byte(void);
/* Of a word of hex digits, or of the next word. */
octets_t octets_of(const char *word);
octets_t next_octets(void);

/* Memory until the end of the request, of just that size, so that reading beyond it is noticed, and full of 0xA5. */
void *memory(size_t size);

/* ---- the answer ------------------------------------------------------------------------------------------------------ */

/* Begins a row: a word by itself. What follows, key=value, belongs to it. */
void put_row(const char *word);
void put_word(const char *key, const char *word);
void put_number(const char *key, uint64_t number);
void put_absent(const char *key); /* of what is not there */
void put_signed(const char *key, int64_t number);
void put_octets(const char *key, const void *data, size_t length);
/* As hex; nothing, if there is none. */
void put_text(const char *key, const char *text);
/* Begins a list; its items follow. */
void put_list(const char *key);
void put_item(uint64_t number);
void put_signed_item(int64_t number);
void put_octets_item(const void *data, size_t length);

/* The answer is a refusal, whatever it was before. */
void refuse(const char *error);
void refuse_status(icd_status_t status);
void refuse_length(const char *error, size_t expected, size_t actual);

#endif
