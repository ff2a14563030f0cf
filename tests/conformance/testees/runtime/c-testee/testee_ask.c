
#include "testee_wire.h"

#include <stdlib.h>

/* ---- memory -------------------------------------------------------------------------------------------------------- */

static void **blocks;
static size_t block_count, block_capacity;

void *memory(size_t size)
{
    void *block = malloc(size != 0u ? size : 1u);
    if (block_count == block_capacity) {
        block_capacity = (block_capacity * 2u) + 64u;
        blocks = (void **)realloc(blocks, block_capacity * sizeof *blocks);
    }
    if (block == NULL || blocks == NULL) {
        abort();
    }
    blocks[block_count++] = block;
    return block;
}

void forget_all(void)
{
    while (block_count != 0u) {
        free(blocks[--block_count]);
    }
    free(blocks);
    blocks = NULL;
    block_capacity = 0;
}

/* ---- keys ---------------------------------------------------------------------------------------------------------- */

static const json_value_t *value_at(const talk_t *talk, size_t index)
{
    return &talk->row.values[index];
}

bool ask_number(
    talk_t *talk, size_t object, const char *key, uint64_t least, uint64_t most, int64_t otherwise, uint32_t *number)
{
    const size_t index = json_find(&talk->row, object, key);
    const json_value_t *value = value_at(talk, index);
    if (index == 0u && otherwise >= 0) {
        *number = (uint32_t)otherwise;
        return true;
    }
    if (index == 0u || value->type != JSON_INTEGER || value->too_large || value->magnitude < least ||
        value->magnitude > most || (value->negative && value->magnitude != 0u)) {
        return refuse_request(talk, "a number is missing or out of range");
    }
    *number = (uint32_t)value->magnitude;
    return true;
}

bool octets_of(talk_t *talk, size_t index, octets_t *octets)
{
    const json_value_t *value = value_at(talk, index);
    size_t i;
    if (index == 0u || value->type != JSON_STRING || value->text.length % 2u != 0u) {
        return refuse_request(talk, "not hex digits, two a byte");
    }
    octets->length = value->text.length / 2u;
    octets->data = (uint8_t *)memory(octets->length);
    for (i = 0; i < octets->length; i++) {
        const int high = json_hex_digit(value->text.at[2u * i]);
        const int low = json_hex_digit(value->text.at[(2u * i) + 1u]);
        if (high < 0 || low < 0) {
            return refuse_request(talk, "not hex digits, two a byte");
        }
        octets->data[i] = (uint8_t)((high * 16) + low);
    }
    return true;
}

bool ask_octets(talk_t *talk, size_t object, const char *key, octets_t *octets)
{
    return octets_of(talk, json_find(&talk->row, object, key), octets);
}

bool ask_flag(talk_t *talk, size_t object, const char *key, bool *flag)
{
    const size_t index = json_find(&talk->row, object, key);
    const json_value_t *value = value_at(talk, index);
    *flag = index != 0u && value->type == JSON_TRUE;
    return index == 0u || *flag || value->type == JSON_FALSE || refuse_request(talk, "neither true nor false");
}

static bool ask_type(talk_t *talk, size_t object, const char *key, json_type_t type, size_t *index)
{
    *index = json_find(&talk->row, object, key);
    return (*index != 0u && value_at(talk, *index)->type == type) ||
        refuse_request(talk, "a key is missing or has the wrong type");
}

bool ask_text(talk_t *talk, size_t object, const char *key, size_t *index)
{
    return ask_type(talk, object, key, JSON_STRING, index);
}

bool ask_rows(talk_t *talk, size_t object, const char *key, size_t *index)
{
    return ask_type(talk, object, key, JSON_ARRAY, index);
}

bool ask_mappings(talk_t *talk, size_t object, const char *key, size_t *index)
{
    size_t i, at;
    if (!ask_rows(talk, object, key, index)) {
        return false;
    }
    at = *index + 1u;
    for (i = 0; i < value_at(talk, *index)->count; i++) {
        if (value_at(talk, at)->type != JSON_OBJECT) {
            return refuse_request(talk, "an entry is no object");
        }
        at = value_at(talk, at)->after;
    }
    return true;
}

bool bus_named(const json_value_t *name, icd_bus_t *bus)
{
    *bus = is_word(name, "i2c") ? ICD_BUS_I2C : is_word(name, "can") ? ICD_BUS_CAN : ICD_BUS_UART;
    return *bus != ICD_BUS_UART || is_word(name, "uart");
}

/* ---- answers ------------------------------------------------------------------------------------------------------- */

void put_octets(json_out_t *out, const uint8_t *data, size_t length)
{
    size_t i;
    json_put(out, "\"", 1);
    for (i = 0; i < length; i++) {
        json_put_hex(out, data[i], 2);
    }
    json_put(out, "\"", 1);
}

static void put_name(json_out_t *out, const char *key)
{
    json_put_text(out, ",\"");
    json_put_text(out, key);
    json_put_text(out, "\":");
}

void put_key_text(json_out_t *out, const char *key, const char *text)
{
    put_name(out, key);
    json_put_string(out, text, strlen(text));
}

void put_key_number(json_out_t *out, const char *key, int64_t number)
{
    put_name(out, key);
    json_put_signed(out, number);
}

void put_key_or_null(json_out_t *out, const char *key, int64_t number)
{
    if (number < 0) {
        put_name(out, key);
        json_put_text(out, "null");
    } else {
        put_key_number(out, key, number);
    }
}

void put_key_octets(json_out_t *out, const char *key, const uint8_t *data, size_t length)
{
    put_name(out, key);
    put_octets(out, data, length);
}

void put_list(json_out_t *out, const char *key, const json_out_t *items)
{
    put_name(out, key);
    json_put(out, "[", 1);
    json_put(out, items->length != 0u ? items->at : "", items->length != 0u ? items->length - 1u : 0u);
    json_put(out, "]", 1);
}

bool refuse_length(talk_t *talk, const char *error, size_t expected, size_t actual)
{
    (void)refuse(talk, error);
    put_key_number(&talk->out, "expected", (int64_t)expected);
    put_key_number(&talk->out, "actual", (int64_t)actual);
    return false;
}

bool refuse_status(talk_t *talk, icd_status_t status)
{
    return refuse(
        talk,
        status == ICD_ERROR_UNSUPPORTED      ? "unsupported"
            : status == ICD_ERROR_UNKNOWN_ID ? "unknown-id"
            : status == ICD_ERROR_RANGE      ? "range"
            : status == ICD_ERROR_CHECKSUM   ? "checksum"
            : status == ICD_ERROR_BUSY       ? "busy"
                                             : "length");
}
