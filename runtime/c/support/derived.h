#ifndef ICDGEN_SUPPORT_DERIVED_H
#define ICDGEN_SUPPORT_DERIVED_H

#include "curve.h"

#ifndef ICDGEN_NO_DOUBLE

/*
 * Values derived from several fields. Every step is rounded to a double. The intermediate results are volatile, so that
 * compilers neither fuse two operations nor compute with excess precision.
 */

/* Replace any NaN by the NaN with fixed bits, so that results are the same on all targets. */
static inline double icdgen_quiet(double value)
{
    double result = value;
    if (icdgen_is_nan(value)) {
        const uint64_t bits = UINT64_C(0x7FF8000000000000);
        (void)memcpy(&result, &bits, sizeof result);
    }
    return result;
}

/*
 * Compute an integer power by repeated squaring, lowest bit of the exponent first. A negative exponent gives the
 * reciprocal.
 */
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
