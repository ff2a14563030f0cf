#ifndef ICDGEN_SUPPORT_TEXT_H
#define ICDGEN_SUPPORT_TEXT_H

#include "base.h"

/* Text in a fixed number of bytes: ASCII, filled with NUL. */

static inline icd_status_t icdgen_get_text(const uint8_t *bytes, size_t size, char *text, size_t capacity)
{
    size_t length = 0;
    size_t i;
    while (length < size && bytes[length] != 0u) {
        if (bytes[length] > 0x7Fu) {
            return ICD_ERROR_RANGE;
        }
        length++;
    }
    if (length >= capacity) {
        return ICD_ERROR_LENGTH;
    }
    for (i = 0; i < length; i++) {
        text[i] = ICDGEN_CAST(char, bytes[i]);
    }
    text[length] = '\0';
    return ICD_OK;
}

static inline icd_status_t icdgen_set_text(uint8_t *bytes, size_t size, const char *text)
{
    size_t length = 0;
    size_t i;
    while (text[length] != '\0') {
        if (length == size || ICDGEN_U8(text[length]) > 0x7Fu) {
            return ICD_ERROR_RANGE;
        }
        length++;
    }
    for (i = 0; i < size; i++) {
        bytes[i] = i < length ? ICDGEN_U8(text[i]) : ICDGEN_U8(0);
    }
    return ICD_OK;
}

#endif /* ICDGEN_SUPPORT_TEXT_H */
