#ifndef ICDGEN_SUPPORT_FIELD_H
#define ICDGEN_SUPPORT_FIELD_H

#include "base.h"

/** Kind of a limit: value >= limit, > limit, <= limit or < limit. */
typedef enum { ICD_LIMIT_MIN, ICD_LIMIT_ABOVE, ICD_LIMIT_MAX, ICD_LIMIT_BELOW } icd_limit_kind_t;

/** A limit of the physical value, or of the raw value if the field has no scale. */
typedef struct {
    icd_limit_kind_t kind;
    double value;
} icd_limit_t;

/** Description of a field, as data for generic code such as displays. */
typedef struct icd_field {
    const char *name; /**< Name in the ICD. */
    const char *unit; /**< Unit of the physical value; empty if there is none. */
    uint32_t at;      /**< First bit in the frame or struct; beyond the frame if the frame length gives the value. */
    uint32_t bits;    /**< Size in bits; for an array, of each element. */
    uint32_t count;   /**< Number of elements of an array, at most; 1 for other fields. */
    const icd_limit_t *limits;
    size_t limit_count;
    const struct icd_field *(*fields)(size_t *count); /**< Returns the fields of a struct; NULL for other fields. */
} icd_field_t;

#ifndef ICDGEN_NO_DOUBLE

/**
 * Return whether a value is within the limits of its field. `value` is physical, or raw if the field has no scale. NaN
 * is never within a limit.
 */
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
