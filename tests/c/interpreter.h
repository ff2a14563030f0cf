/*
 * Reads and writes frames bit by bit from a table of fields, as the reference codec does it: slow, obvious, and without
 * any knowledge of the generated code that it judges. The tests hold it to the reference codec itself.
 */
#ifndef INTERPRETER_H
#define INTERPRETER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef enum { UNSIGNED, SIGNED, FLAG, BITS, BYTES } field_type_t;

typedef struct {
    uint32_t at;
    uint32_t bits;
    field_type_t type;
    size_t place; /* of its 8 bytes (of its bytes, if it is an array) in the record of raw values */
} field_t;

typedef struct {
    bool big_endian;
    bool msb_first;
    size_t length;
    size_t count;
    const field_t *fields;
} layout_t;

static uint64_t record_get(const uint8_t *record, size_t place)
{
    uint64_t value = 0;
    for (size_t i = 0; i < 8; ++i) {
        value |= (uint64_t)record[place + i] << (8 * i);
    }
    return value;
}

static void record_put(uint8_t *record, size_t place, uint64_t value)
{
    for (size_t i = 0; i < 8; ++i) {
        record[place + i] = (uint8_t)(value >> (8 * i));
    }
}

/* Calls for every bit of a field, least significant first: which bit of which byte it is. */
#define FOR_BITS(layout, field, index, byte, weight)                                                                   \
    for (size_t index = 0, first_ = (field)->at / 8, last_ = ((field)->at + (field)->bits - 1) / 8, step_ = 0;         \
         step_ <= last_ - first_; ++step_)                                                                             \
        for (size_t byte = (layout)->big_endian ? last_ - step_ : first_ + step_, weight = 0; weight < 8; ++weight)    \
            if (bit_is_in(field, byte * 8 + ((layout)->msb_first ? 7 - weight : weight)))

static bool bit_is_in(const field_t *field, size_t number)
{
    return number >= field->at && number < field->at + field->bits;
}

static void interpreter_decode(const layout_t *layout, const uint8_t *frame, uint8_t *record)
{
    for (const field_t *field = layout->fields; field < layout->fields + layout->count; ++field) {
        if (field->type == BYTES) {
            memcpy(record + field->place, frame + field->at / 8, field->bits / 8);
            continue;
        }
        uint64_t value = 0;
        FOR_BITS(layout, field, index, byte, weight) {
            value |= (uint64_t)((frame[byte] >> weight) & 1) << index;
            ++index;
        }
        if (field->type == SIGNED && field->bits < 64 && (value >> (field->bits - 1)) != 0) {
            value |= UINT64_MAX << field->bits;
        }
        record_put(record, field->place, value);
    }
}

static bool interpreter_fits(const field_t *field, uint64_t value)
{
    if (field->bits == 64) {
        return true;
    }
    if (field->type == SIGNED) {
        const uint64_t sign = value >> (field->bits - 1);
        return sign == 0 || sign == UINT64_MAX >> (field->bits - 1);
    }
    return value >> field->bits == 0;
}

/* False, and nothing written, if a raw value does not fit. */
static bool interpreter_encode(const layout_t *layout, const uint8_t *record, uint8_t *frame)
{
    for (const field_t *field = layout->fields; field < layout->fields + layout->count; ++field) {
        if (field->type != BYTES && !interpreter_fits(field, record_get(record, field->place))) {
            return false;
        }
    }
    memset(frame, 0, layout->length);
    for (const field_t *field = layout->fields; field < layout->fields + layout->count; ++field) {
        if (field->type == BYTES) {
            memcpy(frame + field->at / 8, record + field->place, field->bits / 8);
            continue;
        }
        const uint64_t value = record_get(record, field->place);
        FOR_BITS(layout, field, index, byte, weight) {
            frame[byte] |= (uint8_t)(((value >> index) & 1) << weight);
            ++index;
        }
    }
    return true;
}

#endif
