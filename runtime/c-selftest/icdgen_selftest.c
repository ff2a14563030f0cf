
#include "icdgen_selftest.h"

#define FILLER 0xA5u

typedef struct {
    const icdgen_selftest_node_t *node;
    const icdgen_selftest_message_t *message;
    icdgen_selftest_totals_t *totals;
    icdgen_selftest_report_t report;
    void *context;
    uint32_t vector;
} run_t;

static void check(run_t *run, bool holds, const char *what, const char *field)
{
    icdgen_selftest_failure_t failure;
    run->totals->checks++;
    if (holds) {
        return;
    }
    run->totals->failures++;
    if (run->report != NULL) {
        failure.node = run->node->name;
        failure.message = run->message != NULL ? run->message->name : run->node->name;
        failure.what = what;
        failure.field = field;
        failure.vector = run->vector;
        run->report(run->context, &failure);
    }
}

/* ---- members ---------------------------------------------------------------------------------------------------- */

static uint64_t extended(uint64_t bits, unsigned bytes)
{
    const uint64_t sign = UINT64_C(1) << (bytes * 8u - 1u);
    return bytes == 8u || (bits & sign) == 0u ? bits : bits | (UINT64_MAX << (bytes * 8u));
}

/* The raw value of a member; a negative one as its two's complement of 64 bits. */
static uint64_t member(const icdgen_selftest_field_t *field, const void *message)
{
    const uint8_t *at = (const uint8_t *)message + field->offset;
    uint8_t seen[8];
    uint64_t bits;
    uint16_t two;
    uint32_t four;
    bool flag;
    if (field->view != NULL) {
        field->view(message, seen);
        at = seen;
    }
    if (field->type == ICDGEN_SELFTEST_BOOL) {
        (void)memcpy(&flag, at, sizeof flag);
        return flag ? 1u : 0u;
    }
    if (field->size == 1u) {
        bits = *at;
    } else if (field->size == 2u) {
        (void)memcpy(&two, at, sizeof two);
        bits = two;
    } else if (field->size == 4u) {
        (void)memcpy(&four, at, sizeof four);
        bits = four;
    } else {
        (void)memcpy(&bits, at, sizeof bits);
    }
    return field->type == ICDGEN_SELFTEST_SIGNED ? extended(bits, field->size) : bits;
}

/* Whether a message has a raw value, where the field is there. */
static bool has_raw(const icdgen_selftest_field_t *field, const void *message, uint64_t bits)
{
    const bool is_there = field->type != ICDGEN_SELFTEST_DERIVED || field->view != NULL;
    return !is_there || member(field, message) == bits;
}

static void set_member(const icdgen_selftest_field_t *field, void *message, uint64_t bits)
{
    uint8_t *at = (uint8_t *)message + field->offset;
    const uint8_t one = (uint8_t)(bits & 0xFFu);
    const uint16_t two = (uint16_t)(bits & 0xFFFFu);
    const uint32_t four = (uint32_t)(bits & 0xFFFFFFFFu);
    const bool flag = bits != 0u;
    if (field->type == ICDGEN_SELFTEST_BOOL) {
        (void)memcpy(at, &flag, sizeof flag);
    } else if (field->size == 1u) {
        (void)memcpy(at, &one, sizeof one);
    } else if (field->size == 2u) {
        (void)memcpy(at, &two, sizeof two);
    } else if (field->size == 4u) {
        (void)memcpy(at, &four, sizeof four);
    } else {
        (void)memcpy(at, &bits, sizeof bits);
    }
}

static uint64_t packed(const icdgen_selftest_field_t *field, const uint8_t *at)
{
    uint64_t bits = 0;
    unsigned i;
    for (i = field->packed; i != 0u; i--) {
        bits = (bits << 8) | at[i - 1u];
    }
    return field->type == ICDGEN_SELFTEST_SIGNED ? extended(bits, field->packed) : bits;
}

static bool holds_bytes(const uint8_t *at, uint32_t count, uint8_t value)
{
    uint32_t i;
    for (i = 0; i < count; i++) {
        if (at[i] != value) {
            return false;
        }
    }
    return true;
}

static void fill(const run_t *run)
{
    (void)memset(run->node->value, (int)FILLER, run->node->value_size);
    (void)memset(run->node->buffer, (int)FILLER, run->node->buffer_size);
}

/* ---- messages --------------------------------------------------------------------------------------------------- */

static void raw_values(run_t *run, const uint8_t *at)
{
    uint16_t i;
    for (i = 0; i < run->message->field_count; i++) {
        const icdgen_selftest_field_t *field = &run->message->fields[i];
        const uint8_t *in_value = (const uint8_t *)run->node->value + field->offset;
        if (field->type == ICDGEN_SELFTEST_BYTES) {
            check(run, memcmp(in_value, at, field->packed) == 0, "raw value", field->name);
        } else {
            check(run, has_raw(field, run->node->value, packed(field, at)), "raw value", field->name);
        }
        at += field->packed;
    }
}

/* Makes the message from the packed raw values alone. */
static void assemble(const run_t *run, const uint8_t *at)
{
    uint16_t i;
    (void)memset(run->node->value, (int)FILLER, run->node->value_size);
    for (i = 0; i < run->message->field_count; i++) {
        const icdgen_selftest_field_t *field = &run->message->fields[i];
        if (field->type == ICDGEN_SELFTEST_BYTES) {
            (void)memcpy((uint8_t *)run->node->value + field->offset, at, field->packed);
        } else if (field->view != NULL || field->type == ICDGEN_SELFTEST_DERIVED) {
            /* what it reads is there with the members */
        } else {
            set_member(field, run->node->value, packed(field, at));
        }
        at += field->packed;
    }
}

static void encoded(run_t *run, const uint8_t *frame, uint16_t length)
{
    const icdgen_selftest_tail_t *tail = run->message->tail;
    const uint8_t *buffer = run->node->buffer;
    uint16_t i;
    bool same = true;
    (void)memset(run->node->buffer, (int)FILLER, run->node->buffer_size);
    check(run, run->message->encode(run->node->value, run->node->buffer, length) == ICD_OK, "encode refuses", NULL);
    for (i = 0; i < length; i++) {
        same = same && buffer[i] == (frame[i] & run->message->kept[i]);
    }
    check(run, same, "encoded bytes", NULL);
    check(run, tail == NULL || tail->size(run->node->value) == length, "size", NULL);
    check(run, holds_bytes(&buffer[length], ICDGEN_SELFTEST_MARGIN, FILLER), "encode writes past the end", NULL);
}

/* Whether `text` stands at the beginning of the buffer, and nothing but filler behind its NUL. */
static bool is_in_buffer(const run_t *run, const char *text)
{
    const uint32_t size = (uint32_t)strlen(text) + 1u;
    return memcmp(run->node->buffer, text, size) == 0 &&
        holds_bytes(&run->node->buffer[size], run->node->buffer_size - size, FILLER);
}

static void text_is(run_t *run, const icdgen_selftest_field_t *field, const char *expected)
{
    char *const text = (char *)run->node->buffer;
    const size_t size = expected != NULL ? strlen(expected) + 1u : field->size + 1u;
    (void)memset(text, (int)FILLER, run->node->buffer_size);
    if (expected == NULL) {
        check(run, field->get_text(run->node->value, text, size) == ICD_ERROR_RANGE, "text that is none", field->name);
    } else {
        check(
            run, field->get_text(run->node->value, text, size - 1u) == ICD_ERROR_LENGTH, "small capacity", field->name);
    }
    check(run, holds_bytes(run->node->buffer, run->node->buffer_size, FILLER), "written all the same", field->name);
    if (expected != NULL) {
        check(run, field->get_text(run->node->value, text, size) == ICD_OK, "text refused", field->name);
        check(run, is_in_buffer(run, expected), "text", field->name);
    }
}

static const char *const *texts(run_t *run, const char *const *expected)
{
    uint16_t i;
    for (i = 0; i < run->message->field_count; i++) {
        if (run->message->fields[i].get_text != NULL) {
            text_is(run, &run->message->fields[i], *expected++);
        }
    }
    return expected;
}

static void set_texts(run_t *run, const icdgen_selftest_field_t *field)
{
    const uint8_t *const at = (const uint8_t *)run->node->value + field->offset;
    uint16_t i;
    for (i = 0; i < field->text_count; i++) {
        const icdgen_selftest_text_t *one = &field->texts[i];
        icd_status_t status;
        run->vector = i;
        (void)memset(run->node->value, (int)FILLER, run->node->value_size);
        status = field->set_text(run->node->value, one->text);
        check(run, status == (one->bytes == NULL ? ICD_ERROR_RANGE : ICD_OK), "setting a text", field->name);
        if (one->bytes == NULL) {
            check(run, holds_bytes(at, field->size, FILLER), "set in spite of a refusal", field->name);
        } else {
            check(run, memcmp(at, one->bytes, field->size) == 0, "bytes of a text", field->name);
            text_is(run, field, one->text);
        }
    }
}

#ifndef ICDGEN_NO_DOUBLE
static double double_of(uint64_t bits)
{
    double value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

static uint64_t bits_of(double value)
{
    uint64_t bits;
    (void)memcpy(&bits, &value, sizeof bits);
    return bits;
}

static const uint64_t *physical_values(run_t *run, const uint64_t *expected)
{
    uint16_t i;
    for (i = 0; i < run->message->field_count; i++) {
        const icdgen_selftest_field_t *field = &run->message->fields[i];
        if (field->get != NULL) {
            check(run, bits_of(field->get(run->node->value)) == *expected++, "physical value", field->name);
        }
    }
    return expected;
}

static void settings(run_t *run, const icdgen_selftest_field_t *field)
{
    uint16_t i;
    for (i = 0; i < field->setting_count; i++) {
        const icdgen_selftest_setting_t *one = &field->settings[i];
        icd_status_t status;
        run->vector = i;
        run->message->init(run->node->value);
        set_member(field, run->node->value, field->fresh);
        status = field->set(run->node->value, double_of(one->value));
        check(run, status == (one->refused ? ICD_ERROR_RANGE : ICD_OK), "setting a physical value", field->name);
        check(
            run, member(field, run->node->value) == (one->refused ? field->fresh : one->raw), "raw value set",
            field->name);
    }
}
#endif

static void wholes(run_t *run, const icdgen_selftest_field_t *field)
{
    uint16_t i;
    for (i = 0; i < field->whole_count; i++) {
        const icdgen_selftest_whole_t *one = &field->wholes[i];
        run->vector = i;
        run->message->init(run->node->value);
        set_member(field, run->node->value, one->raw);
        check(run, field->get_whole(run->node->value) == one->whole, "physical value as an integer", field->name);
        set_member(field, run->node->value, ~one->raw);
        check(run, field->set_whole(run->node->value, one->whole) == ICD_OK, "setting an integer", field->name);
        check(run, member(field, run->node->value) == one->raw, "raw value set by an integer", field->name);
    }
}

static void field_values(run_t *run, const icdgen_selftest_field_t *field)
{
    uint16_t i;
    for (i = 0; i < field->unfit_count; i++) {
        run->vector = i;
        run->message->init(run->node->value);
        if (run->message->tail != NULL) {
            set_member(&run->message->fields[run->message->tail->counter], run->node->value, run->message->tail->high);
        }
        set_member(field, run->node->value, field->unfit[i]);
        (void)memset(run->node->buffer, (int)FILLER, run->node->buffer_size);
        check(
            run, run->message->encode(run->node->value, run->node->buffer, run->message->length) == ICD_ERROR_RANGE,
            "unfit raw value", field->name);
        check(
            run, holds_bytes(run->node->buffer, run->message->length, FILLER), "written in spite of a refusal",
            field->name);
    }
    wholes(run, field);
    set_texts(run, field);
#ifndef ICDGEN_NO_DOUBLE
    settings(run, field);
#endif
}

static void lengths(run_t *run)
{
    const icdgen_selftest_tail_t *tail = run->message->tail;
    const uint16_t least = tail != NULL ? tail->least : run->message->length;
    uint16_t i;
    for (i = 0; tail != NULL && i < tail->refused_frame_count; i++) {
        const uint8_t *frame = &tail->refused_frames[(size_t)i * run->message->length];
        run->vector = i;
        fill(run);
        check(
            run, run->message->decode(run->node->value, frame, tail->refused_frame_lengths[i]) == ICD_ERROR_LENGTH,
            "refused frame", NULL);
        check(
            run, holds_bytes((const uint8_t *)run->node->value, run->node->value_size, FILLER),
            "changed in spite of a refusal", NULL);
    }
    for (i = 0; i < run->message->refused_length_count; i++) {
        run->vector = i;
        fill(run);
        check(
            run,
            run->message->decode(run->node->value, run->node->buffer, run->message->refused_lengths[i]) ==
                ICD_ERROR_LENGTH,
            "refused length", NULL);
        check(
            run, holds_bytes((const uint8_t *)run->node->value, run->node->value_size, FILLER),
            "changed in spite of a refusal", NULL);
    }
    if (least != 0u) {
        fill(run);
        run->message->init(run->node->value);
        check(
            run, run->message->encode(run->node->value, run->node->buffer, least - 1u) == ICD_ERROR_LENGTH,
            "small buffer", NULL);
        check(
            run, holds_bytes(run->node->buffer, run->node->buffer_size, FILLER), "written in spite of a small buffer",
            NULL);
    }
}

static void fresh(run_t *run)
{
    uint16_t i;
    (void)memset(run->node->value, (int)FILLER, run->node->value_size);
    run->message->init(run->node->value);
    for (i = 0; i < run->message->field_count; i++) {
        const icdgen_selftest_field_t *field = &run->message->fields[i];
        if (field->type == ICDGEN_SELFTEST_BYTES) {
            check(
                run, holds_bytes((const uint8_t *)run->node->value + field->offset, field->packed, 0), "fresh value",
                field->name);
        } else {
            check(run, has_raw(field, run->node->value, field->fresh), "fresh value", field->name);
        }
    }
    for (i = 0; i < run->message->constant_count; i++) {
        check(
            run, run->message->constants[i].actual == run->message->constants[i].expected,
            run->message->constants[i].name, NULL);
    }
}

static void message(run_t *run)
{
    const uint8_t *at = run->message->vectors;
    const char *const *expected = run->message->texts;
    uint16_t i;
#ifndef ICDGEN_NO_DOUBLE
    const uint64_t *doubles = run->message->doubles;
#endif
    for (i = 0; i < run->message->vector_count; i++) {
        const uint16_t length = run->message->lengths != NULL ? run->message->lengths[i] : run->message->length;
        const uint16_t made = run->message->tail != NULL ? length : run->message->length;
        run->vector = i;
        fill(run);
        check(run, run->message->decode(run->node->value, at, length) == ICD_OK, "decode refuses", NULL);
        raw_values(run, at + run->message->length);
        encoded(run, at, made);
        assemble(run, at + run->message->length);
        encoded(run, at, made);
        expected = texts(run, expected);
#ifndef ICDGEN_NO_DOUBLE
        doubles = physical_values(run, doubles);
#endif
        at += run->message->vector_size;
    }
    run->vector = 0;
    fresh(run);
    lengths(run);
    for (i = 0; i < run->message->field_count; i++) {
        field_values(run, &run->message->fields[i]);
    }
    run->totals->messages++;
    run->totals->vectors += run->message->vector_count;
}

/* ---- nodes ------------------------------------------------------------------------------------------------------ */

static void dispatcher(run_t *run, const icdgen_selftest_dispatcher_t *one)
{
    uint16_t i;
    (void)memset(run->node->buffer, 0, run->node->buffer_size);
    for (i = 0; i < one->id_count; i++) {
        const uint32_t id = one->ids[i].id;
        const bool known = one->ids[i].length >= 0;
        size_t length = 0;
        run->vector = i;
        check(run, one->length(id, &length) == (known ? ICD_OK : ICD_ERROR_UNKNOWN_ID), "dispatcher", "id");
        check(run, !known || length == (size_t)one->ids[i].length, "dispatcher", "length");
        check(run, one->decode(id, run->node->buffer, one->ids[i].least) == one->ids[i].status, "dispatcher", "decode");
        check(
            run, !known || one->decode(id, run->node->buffer, length + 1u) == ICD_ERROR_LENGTH, "dispatcher",
            "wrong length");
    }
    for (i = 0; i < one->frame_count; i++) {
        const icdgen_selftest_frame_t *row = &one->frames[i];
        const icd_status_t status = one->decode(row->id, row->frame, row->length);
        run->vector = i;
        check(run, status == row->status, "dispatcher", "a frame of a shared id");
        check(
            run,
            status != ICD_OK || row->name == NULL ||
                strcmp(one->name(row->id, row->frame, row->length), row->name) == 0,
            "dispatcher", row->name);
    }
}

void icdgen_selftest(
    const icdgen_selftest_node_t *node,
    icdgen_selftest_totals_t *totals,
    icdgen_selftest_report_t report,
    void *context)
{
    run_t run;
    uint16_t i;
    run.node = node;
    run.message = NULL;
    run.totals = totals;
    run.report = report;
    run.context = context;
    run.vector = 0;
    for (i = 0; i < node->dispatcher_count; i++) {
        dispatcher(&run, &node->dispatchers[i]);
    }
    for (i = 0; i < node->name_count; i++) {
        const icdgen_selftest_name_t *one = &node->names[i];
        const char *name = one->name_of(one->value);
        run.vector = i;
        check(
            &run, one->name == NULL ? name == NULL : name != NULL && strcmp(name, one->name) == 0, "name of a value",
            one->name);
    }
    for (i = 0; i < node->message_count; i++) {
        run.message = node->messages[i];
        message(&run);
    }
}
