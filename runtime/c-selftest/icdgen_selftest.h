#ifndef ICDGEN_SELFTEST_H
#define ICDGEN_SELFTEST_H

/**
 * @file
 * Holds the generated C code to the golden vectors, on the machine that it is to run on. Needs no file system, no
 * memory from the heap, no standard output, and, where ICDGEN_NO_DOUBLE is defined, no floating-point arithmetic.
 *
 *     icdgen_selftest_totals_t totals = {0, 0, 0, 0};
 *     size_t i;
 *     for (i = 0; i < icdgen_selftest_node_count; i++) {
 *         icdgen_selftest(icdgen_selftest_nodes[i], &totals, report, NULL);
 *     }
 *     return totals.failures == 0u;
 */

#include <icdgen.h>

/** What was done. */
typedef struct {
    uint32_t messages;
    uint32_t vectors;
    uint32_t checks;
    uint32_t failures;
} icdgen_selftest_totals_t;

/** A failure: the message (or the node, or an enumeration), what went wrong, and the number of the vector. */
typedef struct {
    const char *node;
    const char *message;
    const char *what;
    const char *field; /**< NULL if it is about the whole message */
    uint32_t vector;
} icdgen_selftest_failure_t;

/** Is told of each failure; `context` is what icdgen_selftest() was given. */
typedef void (*icdgen_selftest_report_t)(void *context, const icdgen_selftest_failure_t *failure);

typedef enum {
    ICDGEN_SELFTEST_UNSIGNED,
    ICDGEN_SELFTEST_SIGNED,
    ICDGEN_SELFTEST_BOOL,
    ICDGEN_SELFTEST_BYTES,
    ICDGEN_SELFTEST_DERIVED /* a view of doubles, and nothing without floating-point arithmetic */
} icdgen_selftest_type_t;

/** A double to be set as a physical value, and the raw value that it gives. */
typedef struct {
    uint64_t value; /* its bits */
    uint64_t raw;
    bool refused;
} icdgen_selftest_setting_t;

/** A raw value and its exact physical value in thousandths or millionths. */
typedef struct {
    uint64_t raw;
    int64_t whole;
} icdgen_selftest_whole_t;

/** A text to be set, and the bytes that it gives; NULL where it is refused. */
typedef struct {
    const char *text;
    const uint8_t *bytes;
} icdgen_selftest_text_t;

/** A field: the member of the struct, and `packed` bytes of each vector, least significant first. */
typedef struct {
    const char *name;
    uint32_t offset;
    uint16_t size;
    uint16_t packed;
    icdgen_selftest_type_t type;
    void (*view)(const void *message, void *value); /* reads a view, which is no member; NULL if it is one */
    uint64_t fresh;                                 /* raw value of a fresh message */
    const uint64_t *unfit;                          /* raw values that the member can hold, but not the field */
    uint16_t unfit_count;
    int64_t (*get_whole)(const void *message); /* NULL if it has no integer accessor */
    icd_status_t (*set_whole)(void *message, int64_t value);
    const icdgen_selftest_whole_t *wholes;
    uint16_t whole_count;
    icd_status_t (*get_text)(const void *message, char *text, size_t capacity); /* NULL if it is no text */
    icd_status_t (*set_text)(void *message, const char *text);
    const icdgen_selftest_text_t *texts;
    uint16_t text_count;
#ifndef ICDGEN_NO_DOUBLE
    double (*get)(const void *message); /* NULL if it is not scaled */
    icd_status_t (*set)(void *message, double value);
    const icdgen_selftest_setting_t *settings;
    uint16_t setting_count;
#endif
} icdgen_selftest_field_t;

/** A constant of the generated code and what it must be. */
typedef struct {
    const char *name;
    uint32_t actual;
    uint32_t expected;
} icdgen_selftest_constant_t;

/** What there is of a message whose frames differ in length. */
typedef struct {
    uint16_t least;                      /* bytes of the shortest frame */
    uint16_t counter;                    /* which field has the number of elements */
    uint32_t high;                       /* the largest count */
    size_t (*size)(const void *message); /* bytes of the frame that it makes */
    const uint8_t *refused_frames;       /* that have more or fewer elements than they say, `length` bytes each */
    const uint16_t *refused_frame_lengths;
    uint16_t refused_frame_count;
} icdgen_selftest_tail_t;

/** A message. Each vector is `length` bytes of a frame, then the packed raw values. */
typedef struct {
    const char *name;
    uint16_t length;
    uint16_t vector_count;
    uint16_t vector_size;
    uint16_t field_count;
    const uint8_t *vectors;
    const uint8_t *kept; /* the bits of a frame that fields cover */
    const icdgen_selftest_field_t *fields;
    const uint16_t *lengths; /* of the frame of each vector, the rest of its bytes is 0; NULL where they are `length` */
    const uint16_t *refused_lengths;
    uint16_t refused_length_count;
    uint16_t constant_count;
    const icdgen_selftest_constant_t *constants;
    const char *const *texts; /* of each vector, those of the text fields; NULL where the bytes are not ASCII */
#ifndef ICDGEN_NO_DOUBLE
    const uint64_t *doubles; /* of each vector, those of the scaled fields */
#endif
    void (*init)(void *message);
    icd_status_t (*decode)(void *message, const uint8_t *buffer, size_t length);
    icd_status_t (*encode)(const void *message, uint8_t *buffer, size_t capacity);
    const icdgen_selftest_tail_t *tail; /* NULL where all frames have one length */
} icdgen_selftest_message_t;

/** An id and the length of the message that has it, -1 where the id is unknown. */
typedef struct {
    uint32_t id;
    int32_t length;
    uint16_t least;      /* of its frames */
    icd_status_t status; /* of so many zeros */
} icdgen_selftest_id_t;

/** A frame that came under an id which several messages have: what the dispatcher answers, and the name of the message. */
typedef struct {
    uint32_t id;
    uint16_t length;
    const uint8_t *frame;
    icd_status_t status;
    const char *name; /* NULL if it is none of them */
} icdgen_selftest_frame_t;

/** The dispatcher of a direction, and the ids that it is asked for. */
typedef struct {
    const icdgen_selftest_id_t *ids;
    uint16_t id_count;
    icd_status_t (*length)(uint32_t id, size_t *length);
    icd_status_t (*decode)(uint32_t id, const uint8_t *buffer, size_t length);
    const icdgen_selftest_frame_t *frames;
    uint16_t frame_count;
    const char *(*name)(uint32_t id, const uint8_t *buffer, size_t length); /* NULL if there are no such frames */
} icdgen_selftest_dispatcher_t;

/** A value of an enumeration and its name; NULL if it has none. */
typedef struct {
    const char *(*name_of)(uint64_t value);
    uint64_t value;
    const char *name;
} icdgen_selftest_name_t;

/** All vectors of a node. */
typedef struct {
    const char *name;
    const icdgen_selftest_message_t *const *messages;
    uint16_t message_count;
    uint16_t dispatcher_count;
    const icdgen_selftest_dispatcher_t *dispatchers;
    const icdgen_selftest_name_t *names;
    uint16_t name_count;
    void *value; /* room for any message */
    uint32_t value_size;
    uint8_t *buffer; /* room for any frame and ICDGEN_SELFTEST_MARGIN more bytes; for any text too */
    uint32_t buffer_size;
} icdgen_selftest_node_t;

#define ICDGEN_SELFTEST_MARGIN 8u

/** Every node. */
extern const icdgen_selftest_node_t *const icdgen_selftest_nodes[];
extern const size_t icdgen_selftest_node_count;

/** Runs all vectors of a node and adds to the totals. `report` may be NULL. */
void icdgen_selftest(
    const icdgen_selftest_node_t *node,
    icdgen_selftest_totals_t *totals,
    icdgen_selftest_report_t report,
    void *context);

#endif
