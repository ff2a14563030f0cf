#ifndef ICDGEN_SUPPORT_ROWS_H
#define ICDGEN_SUPPORT_ROWS_H

#include "base.h"
#include "words.h"

/*
 * A row of adjacent struct members of one size, from the first to the last named member. They are consecutive words in
 * the buffer and are copied at once if the machine has the same byte order.
 */
ICDGEN_INLINE bool icdgen_is_little(void)
{
#if ICDGEN_WORDS
    return ICDGEN_LITTLE != 0;
#else
    const uint16_t word = 1u;
    uint8_t first;
    (void)memcpy(&first, &word, sizeof first);
    return first == 1u;
#endif
}

ICDGEN_INLINE void icdgen_copy(void *target, const void *source, size_t length, size_t size, bool little)
{
    if (size == 1u || icdgen_is_little() == little) {
        (void)memcpy(target, source, length);
    } else {
        uint8_t *const to = ICDGEN_CAST(uint8_t *, target);
        const uint8_t *const from = ICDGEN_CAST(const uint8_t *, source);
        for (size_t i = 0; i < length; ++i) {
            to[i] = from[i ^ (size - 1u)];
        }
    }
}

ICDGEN_INLINE void icdgen_read_row(
    void *message, size_t offset, const uint8_t *buffer, size_t length, size_t size, bool little)
{
    icdgen_copy(ICDGEN_CAST(uint8_t *, message) + offset, buffer, length, size, little);
}

ICDGEN_INLINE void icdgen_write_row(
    const void *message, size_t offset, uint8_t *buffer, size_t length, size_t size, bool little)
{
    icdgen_copy(buffer, ICDGEN_CAST(const uint8_t *, message) + offset, length, size, little);
}

/* Size of a row in bytes. Compilation fails if there is padding between its members. */
#define ICDGEN_ROW(type, size, count, first, last)                                                                     \
    (sizeof(char[offsetof(type, last) - offsetof(type, first) == ((count) - 1u) * (size) ? 1 : -1]) * (count) * (size))

#define ICDGEN_READ_ROW_LE(type, message, buffer, count, first, last)                                                  \
    icdgen_read_row(                                                                                                   \
        message, offsetof(type, first), buffer, ICDGEN_ROW(type, sizeof((message)->first), count, first, last),        \
        sizeof((message)->first), true)
#define ICDGEN_READ_ROW_BE(type, message, buffer, count, first, last)                                                  \
    icdgen_read_row(                                                                                                   \
        message, offsetof(type, first), buffer, ICDGEN_ROW(type, sizeof((message)->first), count, first, last),        \
        sizeof((message)->first), false)

#define ICDGEN_WRITE_ROW_LE(type, message, buffer, count, first, last)                                                 \
    icdgen_write_row(                                                                                                  \
        message, offsetof(type, first), buffer, ICDGEN_ROW(type, sizeof((message)->first), count, first, last),        \
        sizeof((message)->first), true)
#define ICDGEN_WRITE_ROW_BE(type, message, buffer, count, first, last)                                                 \
    icdgen_write_row(                                                                                                  \
        message, offsetof(type, first), buffer, ICDGEN_ROW(type, sizeof((message)->first), count, first, last),        \
        sizeof((message)->first), false)

#endif /* ICDGEN_SUPPORT_ROWS_H */
