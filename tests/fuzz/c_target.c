/* libFuzzer harness on the dispatchers of the generated C, reached by the tables of the testee. See README.md. */

#include "testee.h"

#include <stdlib.h>

#define DIRECTION 1u
#define FIT 2u
#define FILL 8u

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void *memory(size_t size)
{
    void *found = malloc(size != 0u ? size : 1u);
    if (found == NULL) {
        abort();
    }
    return found;
}

static void require(bool holds)
{
    if (!holds) {
        abort();
    }
}

static const testee_message_t *message_of(const testee_dispatcher_t *dispatcher, unsigned id)
{
    size_t i;
    for (i = 0; i < dispatcher->route_count; i++) {
        if (dispatcher->routes[i].id == id) {
            return dispatcher->routes[i].message;
        }
    }
    return NULL;
}

/* Encodes into a buffer of just the message's length; NULL if a value does not fit. */
static uint8_t *encoded(const testee_dispatcher_t *dispatcher, const testee_message_t *message, const void *any)
{
    uint8_t *buffer = (uint8_t *)memory(message->length);
    icd_status_t status = dispatcher->encode(any, buffer, message->length);
    const void *value = (const char *)any + dispatcher->offset;
    const bool misfit = message->misfit != NULL && message->misfit(value) != NULL;
    require(status == (misfit ? ICD_ERROR_RANGE : ICD_OK));
    require(message->length == 0u || dispatcher->encode(any, buffer, message->length - 1u) == ICD_ERROR_LENGTH);
    if (status != ICD_OK) {
        free(buffer);
        return NULL;
    }
    return buffer;
}

/* Sets every physical value that can be set, and looks up every name. */
static void touch(const testee_message_t *message, void *value)
{
    size_t i;
    for (i = 0; i < message->field_count; i++) {
        const testee_field_t *field = &message->fields[i];
        if (field->get != NULL) {
            (void)field->set(value, field->get(value));
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
}

static void same_again(const testee_dispatcher_t *dispatcher, const testee_message_t *message, void *any, unsigned id)
{
    uint8_t *first = encoded(dispatcher, message, any);
    uint8_t *second;
    if (first == NULL) {
        return;
    }
    require(dispatcher->decode(any, (uint8_t)id, first, message->length) == ICD_OK);
    touch(message, (char *)any + dispatcher->offset);
    second = encoded(dispatcher, message, any);
    require(second != NULL && memcmp(first, second, message->length) == 0);
    free(first);
    free(second);
}

static void fill(const testee_message_t *message, char *value, const uint8_t *data, size_t size)
{
    size_t i, at = 0;
    for (i = 0; i < message->field_count; i++) {
        const testee_field_t *field = &message->fields[i];
        size_t byte;
        for (byte = 0; byte < field->size; byte++) {
            const uint8_t given = size != 0u ? data[at++ % size] : 0u;
            value[field->offset + byte] = (char)(field->type == TESTEE_BOOL ? given & 1u : given);
        }
    }
}

static void try_message(
    const testee_dispatcher_t *dispatcher, unsigned id, unsigned flags, const uint8_t *data, size_t size)
{
    const testee_message_t *message = message_of(dispatcher, id);
    void *any = memory(dispatcher->size);
    size_t i, length = size, known = 0;
    uint8_t *frame;
    memset(any, 0, dispatcher->size);
    require((dispatcher->length((uint8_t)id, &known) == ICD_OK) == (message != NULL));
    if (message != NULL && (flags & FILL) != 0u) {
        dispatcher->select(any, (uint8_t)id);
        fill(message, (char *)any + dispatcher->offset, data, size);
        same_again(dispatcher, message, any, id);
        free(any);
        return;
    }
    if (message != NULL && (flags & FIT) != 0u) {
        length = message->length;
    }
    frame = (uint8_t *)memory(length);
    for (i = 0; i < length; i++) {
        frame[i] = size != 0u ? data[i % size] : 0u;
    }
    switch (dispatcher->decode(any, (uint8_t)id, frame, length)) {
    case ICD_OK:
        require(message != NULL && length == message->length);
        same_again(dispatcher, message, any, id);
        break;
    case ICD_ERROR_LENGTH:
        require(message != NULL && length != message->length);
        break;
    case ICD_ERROR_UNKNOWN_ID:
        require(message == NULL);
        break;
    default:
        require(false);
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
    if (dispatcher != NULL) {
        try_message(dispatcher, data[2], data[1], data + 3, size - 3u);
    }
    return 0;
}
