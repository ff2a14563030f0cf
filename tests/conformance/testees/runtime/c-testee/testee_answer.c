
#include "testee_answer.h"

#include <stdlib.h>
#include <string.h>

/* ---- answers ---------------------------------------------------------------------------------------------------- */

bool refuse(talk_t *talk, const char *error)
{
    talk->out.length = 0;
    json_put_text(&talk->out, "{\"ok\":false,\"error\":\"");
    json_put_text(&talk->out, error);
    json_put_text(&talk->out, "\"");
    return false;
}

bool refuse_request(talk_t *talk, const char *detail)
{
    (void)refuse(talk, "request");
    json_put_text(&talk->out, ",\"detail\":");
    json_put_string(&talk->out, detail, strlen(detail));
    return false;
}

bool refuse_field(talk_t *talk, const char *error, const char *name, size_t length)
{
    (void)refuse(talk, error);
    json_put_text(&talk->out, ",\"field\":");
    json_put_string(&talk->out, name, length);
    return false;
}

bool refuse_named(talk_t *talk, const char *error, const testee_field_t *field)
{
    return refuse_field(talk, error, field->name, strlen(field->name));
}

static void put_key(json_out_t *out, const char *name, bool *first)
{
    if (!*first) {
        json_put(out, ",", 1);
    }
    *first = false;
    json_put_string(out, name, strlen(name));
    json_put(out, ":", 1);
}

/* ---- members of structs ----------------------------------------------------------------------------------------- */

uint64_t member_bits(const testee_field_t *field, const void *value)
{
    const char *at = (const char *)value + field->offset;
    uint8_t one;
    uint16_t two;
    uint32_t four;
    uint64_t eight;
    bool flag;
    if (field->type == TESTEE_BOOL) {
        memcpy(&flag, at, sizeof flag);
        return flag ? 1u : 0u;
    }
    switch (field->size) {
    case 1:
        memcpy(&one, at, 1);
        return one;
    case 2:
        memcpy(&two, at, 2);
        return two;
    case 4:
        memcpy(&four, at, 4);
        return four;
    default:
        memcpy(&eight, at, 8);
        return eight;
    }
}

static int64_t member_signed(const testee_field_t *field, const void *value)
{
    uint64_t bits = member_bits(field, value);
    uint64_t sign = UINT64_C(1) << (field->size * 8u - 1u);
    return (bits & sign) == 0u ? (int64_t)bits : -(int64_t)(sign - 1u - (bits & (sign - 1u))) - 1;
}

void set_member(const testee_field_t *field, void *value, uint64_t bits)
{
    char *at = (char *)value + field->offset;
    uint8_t one = (uint8_t)bits;
    uint16_t two = (uint16_t)bits;
    uint32_t four = (uint32_t)bits;
    bool flag = bits != 0u;
    if (field->type == TESTEE_BOOL) {
        memcpy(at, &flag, sizeof flag);
        return;
    }
    switch (field->size) {
    case 1:
        memcpy(at, &one, 1);
        break;
    case 2:
        memcpy(at, &two, 2);
        break;
    case 4:
        memcpy(at, &four, 4);
        break;
    default:
        memcpy(at, &bits, 8);
        break;
    }
}

uint64_t double_bits(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

double double_of(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void put_hex_bytes(json_out_t *out, const uint8_t *bytes, size_t count)
{
    size_t i;
    json_put(out, "\"", 1);
    for (i = 0; i < count; i++) {
        json_put_hex(out, bytes[i], 2);
    }
    json_put(out, "\"", 1);
}

static void put_member(json_out_t *out, const testee_field_t *field, const void *value)
{
    switch (field->type) {
    case TESTEE_UNSIGNED:
        json_put_unsigned(out, member_bits(field, value));
        break;
    case TESTEE_SIGNED:
        json_put_signed(out, member_signed(field, value));
        break;
    case TESTEE_BOOL:
        json_put_text(out, member_bits(field, value) != 0u ? "true" : "false");
        break;
    case TESTEE_FLOAT:
        json_put(out, "\"", 1);
        json_put_hex(out, member_bits(field, value), (unsigned)(field->size * 2u));
        json_put(out, "\"", 1);
        break;
    case TESTEE_BYTES:
    default:
        put_hex_bytes(out, (const uint8_t *)value + field->offset, field->size);
        break;
    }
}

void put_raw(talk_t *talk)
{
    bool first = true;
    size_t i;
    json_put(&talk->out, "{", 1);
    for (i = 0; i < talk->message->field_count; i++) {
        put_key(&talk->out, talk->message->fields[i].name, &first);
        put_member(&talk->out, &talk->message->fields[i], talk->value);
    }
    json_put(&talk->out, "}", 1);
}

static void put_physical(talk_t *talk)
{
    bool first = true;
    size_t i;
    json_put(&talk->out, "{", 1);
    for (i = 0; i < talk->message->field_count; i++) {
        const testee_field_t *field = &talk->message->fields[i];
        if (field->get != NULL) {
            put_key(&talk->out, field->name, &first);
            json_put(&talk->out, "\"", 1);
            json_put_hex(&talk->out, double_bits(field->get(talk->value)), 16);
            json_put(&talk->out, "\"", 1);
        }
    }
    json_put(&talk->out, "}", 1);
}

void put_name_or_null(json_out_t *out, const char *name)
{
    if (name == NULL) {
        json_put_text(out, "null");
    } else {
        json_put_string(out, name, strlen(name));
    }
}

static void put_names(talk_t *talk)
{
    bool first = true;
    size_t i;
    json_put(&talk->out, "{", 1);
    for (i = 0; i < talk->message->field_count; i++) {
        const testee_field_t *field = &talk->message->fields[i];
        if (field->name_of != NULL) {
            put_key(&talk->out, field->name, &first);
            put_name_or_null(&talk->out, field->name_of(member_bits(field, talk->value)));
        }
    }
    json_put(&talk->out, "}", 1);
}

bool answer_message(talk_t *talk, bool names)
{
    /* No byte more than needed, so that a sanitizer sees what is written beyond. */
    uint8_t *buffer = (uint8_t *)malloc(talk->message->length != 0u ? talk->message->length : 1u);
    icd_status_t status;
    if (buffer == NULL) {
        abort();
    }
    memset(buffer, 0xA5, talk->message->length != 0u ? talk->message->length : 1u);
    status = talk->dispatcher->encode(talk->any, buffer, talk->message->length);
    if (status == ICD_ERROR_RANGE) {
        const char *misfit = talk->message->misfit != NULL ? talk->message->misfit(talk->value) : NULL;
        free(buffer);
        return misfit == NULL ? refuse(talk, "range") : refuse_field(talk, "range", misfit, strlen(misfit));
    }
    if (status != ICD_OK || (talk->message->misfit != NULL && talk->message->misfit(talk->value) != NULL)) {
        free(buffer);
        return refuse_request(talk, "the message cannot be encoded");
    }
    json_put_text(&talk->out, "{\"ok\":true,\"raw\":");
    put_raw(talk);
    json_put_text(&talk->out, ",\"physical\":");
    put_physical(talk);
    if (names) {
        json_put_text(&talk->out, ",\"names\":");
        put_names(talk);
    }
    json_put_text(&talk->out, ",\"bytes\":");
    put_hex_bytes(&talk->out, buffer, talk->message->length);
    free(buffer);
    return true;
}

void put_special(talk_t *talk)
{
    bool first = true;
    size_t i, k;
    json_put(&talk->out, "{", 1);
    for (i = 0; i < talk->message->field_count; i++) {
        const testee_field_t *field = &talk->message->fields[i];
        for (k = 0; k < field->special_count; k++) {
            if (k == 0u) {
                put_key(&talk->out, field->name, &first);
            }
            json_put(&talk->out, k == 0u ? "[" : ",", 1);
            if (field->type == TESTEE_SIGNED && field->special[k] > (uint64_t)INT64_MAX) {
                json_put(&talk->out, "-", 1);
                json_put_unsigned(&talk->out, 0u - field->special[k]);
            } else {
                json_put_unsigned(&talk->out, field->special[k]);
            }
        }
        json_put(&talk->out, "]", field->special_count != 0u ? 1u : 0u);
    }
    json_put(&talk->out, "}", 1);
}

void put_limits(talk_t *talk)
{
    bool first = true;
    size_t i, k;
    json_put(&talk->out, "{", 1);
    for (i = 0; i < talk->message->field_count; i++) {
        const testee_field_t *field = &talk->message->fields[i];
        bool first_limit = true;
        for (k = 0; k < field->limit_count; k++) {
            if (k == 0u) {
                put_key(&talk->out, field->name, &first);
                json_put(&talk->out, "{", 1);
            }
            put_key(&talk->out, field->limits[k].key, &first_limit);
            json_put(&talk->out, "\"", 1);
            json_put_hex(&talk->out, double_bits(field->limits[k].value), 16);
            json_put(&talk->out, "\"", 1);
        }
        json_put(&talk->out, "}", field->limit_count != 0u ? 1u : 0u);
    }
    json_put(&talk->out, "}", 1);
}
