/* libFuzzer harness on the dispatchers of the generated C, reached by the tables of the testee. See README.md. */

#include "testee.h"

#include <stdio.h>
#include <stdlib.h>

#define DIRECTION 1u
#define FIT 2u
#define AS_ID 4u
#define FILL 8u
#define EXACT_BYTES 4u /* physical values of wider fields need not lead back to the same raw value */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void *memory(size_t size)
{
    void *found = malloc(size != 0u ? size : 1u);
    if (found == NULL) {
        abort();
    }
    return found;
}

#define REQUIRE(holds) require((holds), __LINE__)

static void require(bool holds, int line)
{
    if (!holds) {
        (void)fprintf(stderr, "line %d of the harness does not hold\n", line);
        abort();
    }
}

/* The message of an id; of several that share it, the one that was found. */
static const testee_route_t *route_of(const testee_dispatcher_t *dispatcher, uint32_t id, const unsigned *which)
{
    size_t i;
    for (i = 0; i < dispatcher->route_count; i++) {
        if (dispatcher->routes[i].id == id && (which == NULL || dispatcher->routes[i].which == *which)) {
            return &dispatcher->routes[i];
        }
    }
    return NULL;
}

/* Encodes into a buffer of just the frame's length, which is put into `size`; NULL if a value does not fit. */
static uint8_t *encoded(
    const testee_dispatcher_t *dispatcher, const testee_message_t *message, const void *any, size_t *size)
{
    uint8_t *buffer;
    icd_status_t status;
    const void *value = (const char *)any + dispatcher->offset;
    const bool misfit = message->misfit != NULL && message->misfit(value) != NULL;
    size_t told = 0u;
    *size = message->length;
    if (!misfit && message->frame_size != NULL) {
        *size = message->frame_size(value);
        REQUIRE(*size <= message->length);
        REQUIRE(dispatcher->frame_size(any, &told) == ICD_OK && told == *size);
    }
    buffer = (uint8_t *)memory(*size);
    status = dispatcher->encode(any, buffer, *size);
    REQUIRE(status == (misfit ? ICD_ERROR_RANGE : ICD_OK));
    REQUIRE(misfit || *size == 0u || dispatcher->encode(any, buffer, *size - 1u) == ICD_ERROR_LENGTH);
    if (status != ICD_OK) {
        free(buffer);
        return NULL;
    }
    return buffer;
}

/* Sets every physical value and text that can be set, in a copy, and looks up every name. */
static void touch(const testee_dispatcher_t *dispatcher, const testee_message_t *message, void *any)
{
    void *copy = memory(dispatcher->size);
    char *text = (char *)memory(message->length + 1u);
    void *value = (char *)any + dispatcher->offset, *other = (char *)copy + dispatcher->offset;
    size_t i;
    memcpy(copy, any, dispatcher->size);
    for (i = 0; i < message->field_count; i++) {
        const testee_field_t *field = &message->fields[i];
        const bool is_exact = !field->is_float && field->size <= EXACT_BYTES;
        if (field->has != NULL && !field->has(value)) {
            continue;
        }
        if (field->get != NULL && field->set != NULL) {
            const double physical = field->get(value);
            const icd_status_t status = field->set(other, physical);
            const void *raw = (const char *)value + field->offset, *set = (const char *)other + field->offset;
            if (is_exact && memcmp(raw, set, field->size) != 0) { /* raw values that have the same double */
                REQUIRE(status == ICD_OK && field->get(other) >= physical && field->get(other) <= physical);
            } else { /* what a table refuses reads as no number, which cannot be set */
                REQUIRE(status == (physical == physical ? ICD_OK : ICD_ERROR_RANGE) || !is_exact);
            }
        }
        if (field->get_text != NULL && field->get_text(value, text, message->length + 1u) == ICD_OK) {
            REQUIRE(field->set_text(other, text) == ICD_OK);
        }
        if (field->name_of != NULL) {
            uint64_t raw = 0;
            const uint8_t *at = (const uint8_t *)value + field->offset;
            size_t byte;
            for (byte = 0; byte < field->size; byte++) {
                raw = (raw << 8) | at[byte];
            }
            (void)field->name_of(raw, false);
            (void)field->name_of(raw, true);
        }
    }
    free(text);
    free(copy);
}

/* A message that was filled may be, by its constants, another one of its id: so its own decoder is asked. */
static void same_again(
    const testee_dispatcher_t *dispatcher, const testee_message_t *message, void *any, uint32_t id, bool is_found)
{
    size_t size, again;
    uint8_t *first = encoded(dispatcher, message, any, &size);
    uint8_t *second;
    unsigned which;
    if (first == NULL) {
        return;
    }
    if (is_found) {
        which = dispatcher->which != NULL ? dispatcher->which(any) : 0u;
        REQUIRE(dispatcher->decode(any, id, first, size) == ICD_OK);
        REQUIRE(dispatcher->which == NULL || dispatcher->which(any) == which);
    } else {
        REQUIRE(message->decode((char *)any + dispatcher->offset, first, size) == ICD_OK);
    }
    touch(dispatcher, message, any);
    second = encoded(dispatcher, message, any, &again);
    REQUIRE(second != NULL && again == size && memcmp(first, second, size) == 0);
    free(first);
    free(second);
}

static void fill(const testee_message_t *message, char *value, const uint8_t *data, size_t size)
{
    size_t i, at = 0;
    for (i = 0; i < message->field_count; i++) {
        const testee_field_t *field = &message->fields[i];
        size_t byte;
        for (byte = 0; field->view == NULL && byte < field->size; byte++) {
            const uint8_t given = size != 0u ? data[at++ % size] : 0u;
            value[field->offset + byte] = (char)(field->type == TESTEE_BOOL ? given & 1u : given);
        }
    }
}

/* The bytes again and again; of a message that is open at the end, as many as it takes, if it takes any. */
static size_t fitted(const testee_message_t *message, const uint8_t *data, size_t size, void *value)
{
    uint8_t *frame = (uint8_t *)memory(message->length);
    size_t i, length = message->length;
    for (i = 0; i < length; i++) {
        frame[i] = size != 0u ? data[i % size] : 0u;
    }
    while (message->frame_size != NULL && length > 0u && message->decode(value, frame, length) != ICD_OK) {
        length--;
    }
    free(frame);
    return length;
}

static void try_message(
    const testee_dispatcher_t *dispatcher, const testee_route_t *route, uint32_t id, unsigned flags,
    const uint8_t *data, size_t size)
{
    const testee_message_t *message = route != NULL ? route->message : NULL;
    void *any = memory(dispatcher->size);
    size_t i, length = size, known = 0;
    uint8_t *frame;
    unsigned which;
    memset(any, 0, dispatcher->size);
    REQUIRE(dispatcher->which != NULL || (dispatcher->length(id, 0u, &known) == ICD_OK) == (message != NULL));
    if (message != NULL && (flags & FILL) != 0u) {
        dispatcher->select(any, id, route->which);
        fill(message, (char *)any + dispatcher->offset, data, size);
        same_again(dispatcher, message, any, id, false);
        free(any);
        return;
    }
    if (message != NULL && (flags & FIT) != 0u) {
        length = fitted(message, data, size, (char *)any + dispatcher->offset);
    }
    frame = (uint8_t *)memory(length);
    for (i = 0; i < length; i++) {
        frame[i] = size != 0u ? data[i % size] : 0u;
    }
    switch (dispatcher->decode(any, id, frame, length)) {
    case ICD_OK:
        REQUIRE(message != NULL);
        which = dispatcher->which != NULL ? dispatcher->which(any) : route->which;
        message = route_of(dispatcher, id, &which)->message;
        REQUIRE(length <= message->length);
        REQUIRE(message->frame_size == NULL || message->frame_size((char *)any + dispatcher->offset) == length);
        same_again(dispatcher, message, any, id, true);
        break;
    case ICD_ERROR_LENGTH:
        REQUIRE(message != NULL && (length != message->length || message->frame_size != NULL || dispatcher->which != NULL));
        break;
    case ICD_ERROR_UNKNOWN_ID:
        REQUIRE(message == NULL || dispatcher->which != NULL);
        break;
    default:
        REQUIRE(false);
    }
    free(frame);
    free(any);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const testee_node_t *node;
    const testee_dispatcher_t *dispatcher;
    if (size < 3u) {
        return 0;
    }
    node = testee_nodes[data[0] % testee_node_count];
    dispatcher = (data[1] & DIRECTION) != 0u ? node->telemetry : node->telecommand;
    if (dispatcher != NULL && (data[1] & AS_ID) != 0u) {
        try_message(dispatcher, route_of(dispatcher, data[2], NULL), data[2], data[1], data + 3, size - 3u);
    } else if (dispatcher != NULL) {
        const testee_route_t *route = &dispatcher->routes[data[2] % dispatcher->route_count];
        try_message(dispatcher, route, route->id, data[1], data + 3, size - 3u);
    }
    return 0;
}
