/* Messages: values in, values out. */

#include "testee.h"
#include "testee_line.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* ---- members of structs ------------------------------------------------------------------------------------------- */

static uint64_t member_bits(const testee_field_t *field, const void *value)
{
    const char *at = (const char *)value + field->offset;
    uint8_t seen[8];
    uint8_t one;
    uint16_t two;
    uint32_t four;
    uint64_t eight;
    bool flag;
    if (field->view != NULL) {
        field->view(value, seen);
        at = (const char *)seen;
    }
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

static void set_member(const testee_field_t *field, void *value, uint64_t bits)
{
    char *at = (char *)value + field->offset;
    const uint8_t one = (uint8_t)bits;
    const uint16_t two = (uint16_t)bits;
    const uint32_t four = (uint32_t)bits;
    const bool flag = bits != 0u;
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

static int64_t signed_of(uint64_t bits, size_t size)
{
    const uint64_t sign = UINT64_C(1) << (size * 8u - 1u);
    return (bits & sign) == 0u ? (int64_t)bits : -(int64_t)(sign - 1u - (bits & (sign - 1u))) - 1;
}

static uint64_t double_bits(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static double double_of(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* False for a number that the member's type cannot hold. */
static bool take_number(const testee_field_t *field, void *value, const char *word)
{
    uint64_t most = field->type == TESTEE_BOOL ? 1u : UINT64_MAX >> (64u - field->size * 8u);
    errno = 0;
    if (field->type == TESTEE_SIGNED) {
        const int64_t number = strtoll(word, NULL, 10);
        most >>= 1;
        set_member(field, value, (uint64_t)number);
        return errno == 0 && number <= (int64_t)most && number >= -(int64_t)most - 1;
    }
    set_member(field, value, strtoull(word, NULL, 10));
    return errno == 0 && *word != '-' && strtoull(word, NULL, 10) <= most;
}

static bool take_raw(const testee_field_t *field, void *value, const char *word)
{
    octets_t octets;
    if (field->type != TESTEE_BYTES) {
        return take_number(field, value, word);
    }
    octets = octets_of(word);
    if (octets.length == field->size) {
        memcpy((char *)value + field->offset, octets.data, octets.length);
    }
    return octets.length == field->size;
}

static bool is_there(const testee_field_t *field, const void *value)
{
    return field->has == NULL || field->has(value);
}

static void put_raw(const testee_field_t *field, const void *value)
{
    if (!is_there(field, value)) {
        put_absent("raw");
    } else if (field->type == TESTEE_BYTES) {
        put_octets("raw", (const char *)value + field->offset, field->size);
    } else if (field->type == TESTEE_SIGNED) {
        put_signed("raw", signed_of(member_bits(field, value), field->size));
    } else {
        put_number("raw", member_bits(field, value));
    }
}

/* ---- messages ----------------------------------------------------------------------------------------------------- */

typedef struct {
    const testee_dispatcher_t *dispatcher;
    const testee_message_t *message; /* NULL if the tables have none of that id */
    uint32_t id;
    unsigned which;
    bool is_named; /* one of several messages of that id */
    bool is_shared;
    void *any;
    void *value;
} subject_t;

/* Whether a word that begins with an id goes on with the name of a message, in hex. */
static bool names_it(const char *word, const char *name)
{
    const octets_t octets = octets_of(strchr(word, ':') + 1);
    return octets.length == strlen(name) && memcmp(octets.data, name, octets.length) == 0;
}

/* Finds the message that the next three words mean and makes room for a value of it. */
static bool find(subject_t *subject)
{
    const testee_node_t *node = testee_nodes[next_number()];
    const testee_dispatcher_t *dispatcher = next_number() == 0u ? node->telecommand : node->telemetry;
    const char *word = next_word();
    size_t i, found = 0;
    subject->id = number_of(word);
    subject->message = NULL;
    subject->which = 0u;
    subject->is_named = strchr(word, ':') != NULL;
    if (dispatcher == NULL) {
        refuse("unknown-id");
        return false;
    }
    for (i = 0; i < dispatcher->route_count; i++) {
        const testee_route_t *route = &dispatcher->routes[i];
        if (route->id == subject->id &&
            (!subject->is_named || names_it(word, dispatcher->name(route->id, route->which)))) {
            subject->message = route->message;
            subject->which = route->which;
            found++;
        }
    }
    subject->is_shared = found > 1u;
    subject->dispatcher = dispatcher;
    subject->any = memory(dispatcher->size);
    subject->value = (char *)subject->any + dispatcher->offset;
    dispatcher->select(subject->any, subject->id, subject->which);
    return true;
}

static void refuse_at(size_t place)
{
    refuse("range");
    put_number("at", place);
}

/* Nothing, where the bytes are no text. */
static void put_text_of(const testee_field_t *field, const void *value)
{
    char *text = (char *)memory(field->size + 1u);
    if (field->get_text(value, text, field->size + 1u) == ICD_OK) {
        put_octets("physical", text, strlen(text));
    }
}

static bool take_text(const testee_field_t *field, void *value, const char *word)
{
    const octets_t octets = octets_of(word);
    char *text = (char *)memory(octets.length + 1u);
    memcpy(text, octets.data, octets.length);
    text[octets.length] = '\0';
    return field->set_text(value, text) == ICD_OK;
}

static bool take_physical(const testee_field_t *field, void *value, const char *word)
{
    if (field->set_text != NULL) {
        return take_text(field, value, word);
    }
    return field->set(value, double_of(strtoull(word, NULL, 10))) == ICD_OK;
}

static const char *misfit_of(const subject_t *subject)
{
    return subject->message->misfit != NULL ? subject->message->misfit(subject->value) : NULL;
}

static void put_message(const subject_t *subject)
{
    const testee_message_t *message = subject->message;
    const char *misfit = misfit_of(subject);
    size_t size = message->length;
    size_t again = size;
    size_t i;
    uint8_t *buffer;
    icd_status_t status;
    if (message->frame_size != NULL && misfit == NULL) {
        size = message->frame_size(subject->value);
        if (subject->dispatcher->frame_size(subject->any, &again) != ICD_OK || again != size) {
            refuse("dispatcher");
            return;
        }
    }
    buffer = (uint8_t *)memory(size);
    status = subject->dispatcher->encode(subject->any, buffer, size);
    if (status == ICD_OK && size != 0u &&
        subject->dispatcher->encode(subject->any, buffer, size - 1u) != ICD_ERROR_LENGTH) {
        refuse("capacity");
        return;
    }
    if (status != ICD_OK || misfit != NULL) {
        refuse(status == (misfit != NULL ? ICD_ERROR_RANGE : ICD_OK) ? "range" : "encoding");
        put_text("field", misfit);
        return;
    }
    put_row("ok");
    put_octets("bytes", buffer, size);
    for (i = 0; i < message->field_count; i++) {
        const testee_field_t *field = &message->fields[i];
        put_row("field");
        put_raw(field, subject->value);
        if (!is_there(field, subject->value)) {
            continue;
        }
        if (field->get != NULL) {
            put_number("physical", double_bits(field->get(subject->value)));
        }
        if (field->get_text != NULL) {
            put_text_of(field, subject->value);
        }
        if (field->name_of != NULL) {
            const uint64_t bits = member_bits(field, subject->value);
            const int64_t number = field->type == TESTEE_SIGNED ? signed_of(bits, field->size) : 0;
            put_text("name", field->name_of(number < 0 ? (uint64_t)number : bits, number < 0));
        }
    }
}

/* The message that the dispatcher has found. */
static void put_found(const subject_t *subject)
{
    const unsigned which = subject->dispatcher->which(subject->any);
    size_t length = 0;
    uint8_t *buffer;
    if (subject->dispatcher->length(subject->id, which, &length) != ICD_OK) {
        refuse("dispatcher");
        return;
    }
    buffer = (uint8_t *)memory(length);
    if (subject->dispatcher->encode(subject->any, buffer, length) != ICD_OK) {
        refuse("encoding");
        return;
    }
    put_row("ok");
    put_text("name", subject->dispatcher->name(subject->id, which));
    put_octets("bytes", buffer, length);
}

static void decode(void)
{
    subject_t subject;
    octets_t frame;
    icd_status_t status;
    size_t expected = 0;
    if (!find(&subject)) {
        return;
    }
    frame = next_octets();
    if (subject.is_named && subject.message != NULL) {
        status = subject.message->decode(subject.value, frame.data, frame.length);
    } else {
        status = subject.dispatcher->decode(subject.any, subject.id, frame.data, frame.length);
    }
    if (status == ICD_ERROR_LENGTH && subject.message != NULL && subject.message->frame_size != NULL) {
        refuse("length"); /* which of its lengths it should have, is not told */
        put_number("actual", frame.length);
    } else if (status == ICD_ERROR_LENGTH) {
        (void)subject.dispatcher->length(subject.id, subject.which, &expected);
        refuse_length("length", expected, frame.length);
    } else if (status != ICD_OK) {
        refuse_status(status);
    } else if (subject.message == NULL) {
        refuse("dispatcher");
    } else if (subject.is_shared) {
        put_found(&subject);
    } else {
        put_message(&subject);
    }
}

static void encode(void)
{
    subject_t subject;
    const char **words;
    size_t i;
    if (!find(&subject)) {
        return;
    }
    words = (const char **)memory((subject.message->field_count + 1u) * sizeof *words);
    subject.message->init(subject.value);
    for (i = 0; i < subject.message->field_count; i++) {
        const testee_field_t *field = &subject.message->fields[i];
        const char *word = field->view == NULL ? next_word() : "";
        const bool fits = field->view != NULL || *word == 'n' ? true
            : *word == 'p'                                    ? take_physical(field, subject.value, word + 1)
                                                              : take_raw(field, subject.value, word + 1);
        if (!fits) {
            refuse_at(i);
            return;
        }
        words[i] = word;
    }
    for (i = 0; i < subject.message->field_count; i++) { /* a text sets what counts it, too */
        if (*words[i] == 'r') {
            (void)take_raw(&subject.message->fields[i], subject.value, words[i] + 1);
        }
    }
    put_message(&subject);
}

static void constants(void)
{
    subject_t subject;
    size_t expected = 0;
    size_t i, k;
    if (!find(&subject)) {
        return;
    }
    if (subject.dispatcher->length(subject.id, subject.which, &expected) != ICD_OK ||
        expected != subject.message->length) {
        refuse("dispatcher");
        return;
    }
    subject.message->init(subject.value);
    put_row("ok");
    put_text("name", subject.dispatcher->name(subject.id, subject.which));
    put_number("length", subject.message->length);
    put_list("ids");
    for (i = 0; i < subject.message->id_count; i++) {
        put_item(subject.message->ids[i]);
    }
    for (i = 0; i < subject.message->field_count; i++) {
        const testee_field_t *field = &subject.message->fields[i];
        put_row("field");
        put_raw(field, subject.value);
        put_list("special");
        for (k = 0; k < field->special_count; k++) {
            if (field->type == TESTEE_SIGNED) {
                put_signed_item(field->special[k]);
            } else if (field->special_of != NULL) {
                put_item(field->special_of(k));
            } else {
                put_item((uint64_t)field->special[k]);
            }
        }
        for (k = 0; k < field->limit_count; k++) {
            put_number(field->limits[k].key, double_bits(field->limits[k].value));
        }
    }
}

/* Raw -> physical -> raw. */
static void sweep(void)
{
    subject_t subject;
    const testee_field_t *field;
    size_t place;
    if (!find(&subject)) {
        return;
    }
    place = next_number();
    field = &subject.message->fields[place];
    subject.message->init(subject.value);
    put_row("ok");
    put_list("values");
    while (has_words()) {
        double physical;
        if (!take_raw(field, subject.value, next_word()) || misfit_of(&subject) != NULL) {
            refuse_at(place);
            return;
        }
        physical = field->get(subject.value);
        set_member(field, subject.value, ~member_bits(field, subject.value));
        put_item(double_bits(physical));
        if (field->set(subject.value, physical) != ICD_OK) {
            put_octets_item(NULL, 0);
        } else if (field->type == TESTEE_SIGNED) {
            put_signed_item(signed_of(member_bits(field, subject.value), field->size));
        } else {
            put_item(member_bits(field, subject.value));
        }
    }
}

static void enumeration(void)
{
    const testee_node_t *node = testee_nodes[next_number()];
    testee_enum_t *name_of = node->enums[next_number()];
    const char *word = next_word();
    uint64_t value;
    errno = 0;
    value = *word == '-' ? (uint64_t)strtoll(word, NULL, 10) : strtoull(word, NULL, 10);
    put_row("ok");
    put_text("name", errno != 0 ? NULL : name_of(value, *word == '-'));
}

static void about_node(void)
{
    const testee_node_t *node = testee_nodes[next_number()];
    put_row("ok");
    if (node->node_type >= 0) {
        put_signed("node_type", node->node_type);
    }
    if (node->interface_version >= 0) {
        put_signed("interface_version", node->interface_version);
    }
}

const testee_op_t testee_message_ops[] = {
    {"decode", decode},   {"encode", encode}, {"constants", constants}, {"sweep", sweep}, {"enum", enumeration},
    {"node", about_node}, {NULL, NULL},
};
