#ifndef ICDGEN_SUPPORT_DERIVED_H
#define ICDGEN_SUPPORT_DERIVED_H

#include "curve.h"

#ifndef ICDGEN_NO_DOUBLE

/*
 * Values that are derived from several fields: each step is a double of its own. That steps are volatile keeps
 * compilers from making one of two, and from reckoning with more digits in between.
 */

/* A value that is no number has always the same bits. */
static inline double icdgen_quiet(double value)
{
    double result = value;
    if (icdgen_is_nan(value)) {
        const uint64_t bits = UINT64_C(0x7FF8000000000000);
        (void)memcpy(&result, &bits, sizeof result);
    }
    return result;
}

/* By squaring, from the lowest bit of a whole exponent on; of a negative one the reciprocal. */
static inline double icdgen_power(double base, double exponent)
{
    const int32_t whole = ICDGEN_I32(exponent);
    volatile double square = base;
    volatile double result = 1.0;
    for (int32_t left = whole < 0 ? -whole : whole; left > 0; left /= 2) {
        if (left % 2 != 0) {
            result = result * square;
        }
        square = square * square;
    }
    if (whole < 0) {
        result = 1.0 / result;
    }
    return result;
}

#endif /* ICDGEN_NO_DOUBLE */

#endif /* ICDGEN_SUPPORT_DERIVED_H */
