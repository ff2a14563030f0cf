
#include "testee_request.h"

#include <stdlib.h>
#include <string.h>

const json_value_t *of_type(const talk_t *talk, const char *key, json_type_t type)
{
    size_t index = json_find(&talk->row, 0, key);
    return index != 0u && talk->row.values[index].type == type ? &talk->row.values[index] : NULL;
}

bool is_word(const json_value_t *value, const char *word)
{
    return json_same(value->text, word, strlen(word));
}

const testee_node_t *node_named(json_text_t name)
{
    size_t i;
    for (i = 0; i < testee_node_count; i++) {
        if (json_same(name, testee_nodes[i]->name, strlen(testee_nodes[i]->name))) {
            return testee_nodes[i];
        }
    }
    return NULL;
}

static bool pick_route(talk_t *talk, const testee_dispatcher_t *dispatcher, uint32_t id, bool configuration)
{
    size_t i;
    for (i = 0; dispatcher != NULL && i < dispatcher->route_count; i++) {
        const testee_route_t *route = &dispatcher->routes[i];
        if (route->id == id && (route->configuration || !configuration)) {
            talk->dispatcher = dispatcher;
            talk->message = route->message;
            talk->id = id;
            return true;
        }
    }
    return false;
}

bool find_message(talk_t *talk)
{
    const json_value_t *node = of_type(talk, "node", JSON_STRING);
    const json_value_t *kind = of_type(talk, "kind", JSON_STRING);
    const json_value_t *id = of_type(talk, "id", JSON_INTEGER);
    bool configuration, telecommand, telemetry, found;
    if (node == NULL || kind == NULL || id == NULL) {
        return refuse_request(talk, "node, kind or id is missing or has the wrong type");
    }
    configuration = is_word(kind, "configuration");
    telecommand = configuration || is_word(kind, "telecommand");
    telemetry = configuration || is_word(kind, "telemetry");
    if (!telecommand && !telemetry) {
        return refuse_request(talk, "there is no such kind");
    }
    talk->node = node_named(node->text);
    if (talk->node == NULL) {
        return refuse(talk, "unknown-node");
    }
    if (id->too_large || id->magnitude > UINT32_MAX || (id->negative && id->magnitude != 0u)) {
        return refuse(talk, "unknown-id");
    }
    found = (telecommand && pick_route(talk, talk->node->telecommand, (uint32_t)id->magnitude, configuration)) ||
        (telemetry && pick_route(talk, talk->node->telemetry, (uint32_t)id->magnitude, configuration));
    if (!found) {
        return refuse(talk, "unknown-id");
    }
    talk->any = realloc(talk->any, talk->dispatcher->size);
    if (talk->any == NULL) {
        abort();
    }
    memset(talk->any, 0xA5, talk->dispatcher->size);
    talk->value = (char *)talk->any + talk->dispatcher->offset;
    talk->dispatcher->select(talk->any, talk->id);
    return true;
}

static bool is_hex(json_text_t text)
{
    size_t i;
    for (i = 0; i < text.length; i++) {
        if (json_hex_digit(text.at[i]) < 0) {
            return false;
        }
    }
    return text.length % 2u == 0u;
}

static uint8_t hex_byte(const char *at)
{
    return (uint8_t)(json_hex_digit(at[0]) * 16 + json_hex_digit(at[1]));
}

static bool hex_bits(const json_value_t *value, size_t bytes, uint64_t *bits)
{
    size_t i;
    if (value->type != JSON_STRING || value->text.length != bytes * 2u || !is_hex(value->text)) {
        return false;
    }
    *bits = 0;
    for (i = 0; i < bytes; i++) {
        *bits = (*bits << 8) | hex_byte(&value->text.at[i * 2u]);
    }
    return true;
}

bool decode(talk_t *talk)
{
    const json_value_t *bytes = of_type(talk, "bytes", JSON_STRING);
    size_t names = json_find(&talk->row, 0, "names");
    bool wanted = names != 0u && talk->row.values[names].type == JSON_TRUE;
    icd_status_t status;
    uint8_t *buffer;
    size_t length, i;
    if (bytes == NULL || !is_hex(bytes->text) ||
        (names != 0u && !wanted && talk->row.values[names].type != JSON_FALSE)) {
        return refuse_request(talk, "bytes or names is missing or is not what it should be");
    }
    if (!find_message(talk)) {
        return false;
    }
    length = bytes->text.length / 2u;
    buffer = (uint8_t *)malloc(length != 0u ? length : 1u);
    if (buffer == NULL) {
        abort();
    }
    for (i = 0; i < length; i++) {
        buffer[i] = hex_byte(&bytes->text.at[i * 2u]);
    }
    status = talk->dispatcher->decode(talk->any, talk->id, buffer, length);
    free(buffer);
    if (status == ICD_ERROR_LENGTH) {
        size_t expected = 0;
        (void)talk->dispatcher->length(talk->id, &expected);
        (void)refuse(talk, "length");
        json_put_text(&talk->out, ",\"expected\":");
        json_put_unsigned(&talk->out, expected);
        json_put_text(&talk->out, ",\"actual\":");
        json_put_unsigned(&talk->out, length);
        return false;
    }
    if (status != ICD_OK) {
        return refuse(talk, status == ICD_ERROR_UNKNOWN_ID ? "unknown-id" : "range");
    }
    return answer_message(talk, wanted);
}

const testee_field_t *field_named(const testee_message_t *message, json_text_t name)
{
    size_t i;
    for (i = 0; i < message->field_count; i++) {
        if (json_same(name, message->fields[i].name, strlen(message->fields[i].name))) {
            return &message->fields[i];
        }
    }
    return NULL;
}

/* Refuses names that are no field's (for physical values: no scaled field's). */
static bool check_names(talk_t *talk, size_t object, bool physical)
{
    size_t at = object + 1u;
    size_t left;
    for (left = object == 0u ? 0u : talk->row.values[object].count; left != 0u; left--) {
        json_text_t name = talk->row.values[at].text;
        const testee_field_t *field = field_named(talk->message, name);
        if (field == NULL || (physical && field->set == NULL)) {
            return refuse_field(talk, "unknown-field", name.at, name.length);
        }
        at = talk->row.values[at + 1u].after;
    }
    return true;
}

bool take_integer(talk_t *talk, const testee_field_t *field, const json_value_t *given)
{
    uint64_t most = UINT64_MAX >> (64u - field->size * 8u);
    uint64_t bits = given->negative ? 0u - given->magnitude : given->magnitude;
    bool fits;
    if (field->type == TESTEE_BOOL) {
        most = 1;
    } else if (field->type == TESTEE_SIGNED) {
        most = (most >> 1) + (given->negative ? 1u : 0u);
    }
    fits = !given->too_large && given->magnitude <= most;
    if (field->type != TESTEE_SIGNED && given->negative && given->magnitude != 0u) {
        fits = false;
    }
    if (!fits) {
        return refuse_named(talk, "range", field);
    }
    set_member(field, talk->value, bits);
    return true;
}

static bool take_raw(talk_t *talk, const testee_field_t *field, const json_value_t *given)
{
    uint64_t bits;
    size_t i;
    if (field->type == TESTEE_BYTES) {
        if (given->type != JSON_STRING || !is_hex(given->text)) {
            return refuse_request(talk, "a byte array is hex");
        }
        if (given->text.length != field->size * 2u) {
            return refuse_named(talk, "range", field);
        }
        for (i = 0; i < field->size; i++) {
            ((uint8_t *)talk->value + field->offset)[i] = hex_byte(&given->text.at[i * 2u]);
        }
        return true;
    }
    if (field->type == TESTEE_FLOAT) {
        if (!hex_bits(given, field->size, &bits)) {
            return refuse_request(talk, "a float is the hex of its bits");
        }
        set_member(field, talk->value, bits);
        return true;
    }
    if (field->type == TESTEE_BOOL && (given->type == JSON_TRUE || given->type == JSON_FALSE)) {
        set_member(field, talk->value, given->type == JSON_TRUE ? 1u : 0u);
        return true;
    }
    return given->type == JSON_INTEGER ? take_integer(talk, field, given)
                                       : refuse_request(talk, "a number is an integer");
}

static bool take_physical(talk_t *talk, const testee_field_t *field, const json_value_t *given)
{
    uint64_t bits;
    if (!hex_bits(given, 8, &bits)) {
        return refuse_request(talk, "a physical value is the hex of a double's bits");
    }
    return field->set(talk->value, double_of(bits)) == ICD_OK || refuse_named(talk, "range", field);
}

bool encode(talk_t *talk)
{
    size_t raw = json_find(&talk->row, 0, "raw");
    size_t physical = json_find(&talk->row, 0, "physical");
    size_t i;
    if ((raw != 0u && talk->row.values[raw].type != JSON_OBJECT) ||
        (physical != 0u && talk->row.values[physical].type != JSON_OBJECT)) {
        return refuse_request(talk, "raw and physical are objects");
    }
    if (!find_message(talk) || !check_names(talk, raw, false) || !check_names(talk, physical, true)) {
        return false;
    }
    talk->message->init(talk->value);
    for (i = 0; i < talk->message->field_count; i++) {
        const testee_field_t *field = &talk->message->fields[i];
        size_t from_physical = physical != 0u ? json_find(&talk->row, physical, field->name) : 0u;
        size_t from_raw = raw != 0u ? json_find(&talk->row, raw, field->name) : 0u;
        if (from_physical == 0u && from_raw == 0u) {
            return refuse_named(talk, "missing-field", field);
        }
        if (from_physical != 0u ? !take_physical(talk, field, &talk->row.values[from_physical])
                                : !take_raw(talk, field, &talk->row.values[from_raw])) {
            return false;
        }
    }
    return answer_message(talk, false);
}
