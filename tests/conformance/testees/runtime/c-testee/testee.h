/* What the testee knows of each node: how to reach the generated code of every message and field. */

#ifndef TESTEE_H
#define TESTEE_H

#include <icdgen.h>

typedef enum { TESTEE_UNSIGNED, TESTEE_SIGNED, TESTEE_BOOL, TESTEE_BYTES } testee_type_t; /* floats: their bits */

typedef struct {
    const char *key; /* min, max, above or below */
    double value;
} testee_limit_t;

typedef struct {
    testee_type_t type;
    size_t offset;                                    /* of the member in the struct; not of a view */
    void (*view)(const void *message, void *value);   /* reads a view, else NULL */
    bool (*has)(const void *message);                 /* whether a field is there; NULL if it always is */
    size_t size;                                      /* of the member, in bytes */
    bool is_float;
    const char *(*name_of)(uint64_t value, bool is_negative); /* of an enum field, else NULL */
    double (*get)(const void *message);               /* of a scaled field, else NULL */
    icd_status_t (*set)(void *message, double value); /* of a scaled field that is no view, else NULL */
    icd_status_t (*get_text)(const void *message, char *text, size_t capacity); /* of a text field, else NULL */
    icd_status_t (*set_text)(void *message, const char *text);
    const int64_t *special;                           /* raw values with a meaning of their own, as bits */
    size_t special_count;
    uint64_t (*special_of)(size_t index); /* of floats, whose special values are not constant expressions */
    const testee_limit_t *limits;
    size_t limit_count;
} testee_field_t;

typedef struct {
    const unsigned *ids; /* the id, or the set id and the get id */
    size_t id_count;
    size_t length;
    const testee_field_t *fields;
    size_t field_count;
    void (*init)(void *message);
    icd_status_t (*decode)(void *message, const uint8_t *buffer, size_t length);
    const char *(*misfit)(const void *message); /* NULL if every value of every member fits */
    size_t (*frame_size)(const void *message);  /* NULL unless frames differ in length */
} testee_message_t;

/* A message that is reached under an id; `which` of its direction, where messages share ids. */
typedef struct {
    uint32_t id;
    unsigned which;
    const testee_message_t *message;
} testee_route_t;

/* A dispatcher. The message lies at `offset` of the dispatcher's value. */
typedef struct {
    size_t size;
    size_t offset;
    const testee_route_t *routes;
    size_t route_count;
    void (*select)(void *any, uint32_t id, unsigned which);
    unsigned (*which)(const void *any); /* NULL if the id tells the message */
    icd_status_t (*decode)(void *any, uint32_t id, const uint8_t *buffer, size_t length);
    icd_status_t (*encode)(const void *any, uint8_t *buffer, size_t capacity);
    icd_status_t (*length)(uint32_t id, unsigned which, size_t *length);
    icd_status_t (*frame_size)(const void *any, size_t *size); /* NULL if no frames differ in length */
    const char *(*name)(uint32_t id, unsigned which);
} testee_dispatcher_t;

typedef const char *testee_enum_t(uint64_t value, bool is_negative); /* the name of a member, or NULL */

typedef struct {
    const testee_dispatcher_t *telecommand; /* NULL if the node has none */
    const testee_dispatcher_t *telemetry;
    testee_enum_t *const *enums;
    int64_t node_type; /* -1 if the ICD has none */
    int64_t interface_version;
} testee_node_t;

extern const testee_node_t *const testee_nodes[];
extern const size_t testee_node_count;

/* What can be asked: the lists of the parts that the ICDs have, each ended by a name of NULL. */
typedef struct {
    const char *name;
    void (*answer)(void);
} testee_op_t;

extern const testee_op_t testee_message_ops[];
extern const testee_op_t *const testee_ops[]; /* ended by NULL */

#endif
