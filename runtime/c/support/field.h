#ifndef ICDGEN_SUPPORT_FIELD_H
#define ICDGEN_SUPPORT_FIELD_H

#include "base.h"

/** In which way a limit holds. */
typedef enum { ICD_LIMIT_MIN, ICD_LIMIT_ABOVE, ICD_LIMIT_MAX, ICD_LIMIT_BELOW } icd_limit_kind_t;

/** A limit of the physical value (of the raw value where there is no scale). */
typedef struct {
    icd_limit_kind_t kind;
    double value;
} icd_limit_t;

/** What the ICD says of a field. */
typedef struct icd_field {
    const char *name; /**< What the ICD calls it. */
    const char *unit; /**< Of the physical value; empty without one. */
    uint32_t at;   /**< Its first bit in the frame, or struct; behind the longest, if only a frame's length tells it. */
    uint32_t bits; /**< How many bits it has; of an array, each element. */
    uint32_t count; /**< How many elements an array has, or can have; 1 if it is none. */
    const icd_limit_t *limits;
    size_t limit_count;
    const struct icd_field *(*fields)(size_t *count); /**< What a struct is made of; NULL of what is none. */
} icd_field_t;

#ifndef ICDGEN_NO_DOUBLE

/** Whether a physical value (a raw one where there is no scale) keeps the limits of its field; NaN keeps none. */
static inline bool icd_allows(const icd_field_t *field, double value)
{
    bool holds = true;
    for (size_t i = 0; i < field->limit_count; i++) {
        const double limit = field->limits[i].value;
        switch (field->limits[i].kind) {
        case ICD_LIMIT_MIN:
            holds = holds && (value >= limit);
            break;
        case ICD_LIMIT_ABOVE:
            holds = holds && (value > limit);
            break;
        case ICD_LIMIT_MAX:
            holds = holds && (value <= limit);
            break;
        case ICD_LIMIT_BELOW:
        default:
            holds = holds && (value < limit);
            break;
        }
    }
    return holds;
}

#endif /* ICDGEN_NO_DOUBLE */

#endif /* ICDGEN_SUPPORT_FIELD_H */
