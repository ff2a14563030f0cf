#ifndef ICDGEN_SUPPORT_CURVE_H
#define ICDGEN_SUPPORT_CURVE_H

#include "base.h"

#ifndef ICDGEN_NO_DOUBLE

/*
 * Physical values by polynomials: Horner's rule, where every product and every sum is a double of its own. That the
 * steps are volatile keeps compilers from making one of two, and from reckoning with more digits in between.
 */
static inline bool icdgen_is_finite(double value)
{
    uint64_t bits;
    (void)memcpy(&bits, &value, sizeof bits);
    return (ICDGEN_U32(bits >> 52) & 0x7FFu) != 0x7FFu;
}

/* The highest power stands last. A value that is no number has always the same bits. */
static inline double icdgen_curve(double raw, const double *coefficients, size_t count)
{
    volatile double value = coefficients[count - 1u];
    for (size_t power = count - 1u; power > 0u; --power) {
        value = value * raw;
        value = value + coefficients[power - 1u];
    }
    double result = value;
    uint64_t bits;
    (void)memcpy(&bits, &result, sizeof bits);
    if ((bits & UINT64_C(0x7FFFFFFFFFFFFFFF)) > UINT64_C(0x7FF0000000000000)) {
        bits = UINT64_C(0x7FF8000000000000);
        (void)memcpy(&result, &bits, sizeof result);
    }
    return result;
}

/* The raw value whose physical one is nearest, of two the even one; the physical values rise, or fall, all along. */
static inline icd_status_t icdgen_curve_nearest(
    int32_t *raw, double value, const double *coefficients, size_t count, int32_t low, int32_t high)
{
    const double first = icdgen_curve(ICDGEN_CAST(double, low), coefficients, count);
    const double last = icdgen_curve(ICDGEN_CAST(double, high), coefficients, count);
    const bool rises = first < last;
    const bool is_below = rises ? value < first : value > first;
    const bool is_above = rises ? value > last : value < last;
    if (!icdgen_is_finite(value) || is_below || is_above) {
        return ICD_ERROR_RANGE;
    }
    int32_t left = low;
    int32_t right = high;
    while (right - left > 1) {
        const int32_t middle = left + (right - left) / 2;
        const double here = icdgen_curve(ICDGEN_CAST(double, middle), coefficients, count);
        if (rises ? here <= value : here >= value) {
            left = middle;
        } else {
            right = middle;
        }
    }
    const double under = icdgen_curve(ICDGEN_CAST(double, left), coefficients, count);
    const double over = icdgen_curve(ICDGEN_CAST(double, right), coefficients, count);
    const volatile double below = rises ? value - under : under - value;
    const volatile double above = rises ? over - value : value - over;
    const double to_left = below;
    const double to_right = above;
    *raw = to_left < to_right || (to_left <= to_right && left % 2 == 0) ? left : right;
    return ICD_OK;
}

static inline icd_status_t icdgen_set_curve_i16(
    int16_t *raw, double value, const double *coefficients, size_t count, int16_t low, int16_t high)
{
    int32_t nearest = *raw;
    const icd_status_t status = icdgen_curve_nearest(&nearest, value, coefficients, count, low, high);
    *raw = ICDGEN_I16(nearest);
    return status;
}

static inline icd_status_t icdgen_set_curve_u16(
    uint16_t *raw, double value, const double *coefficients, size_t count, uint16_t high)
{
    int32_t nearest = ICDGEN_I32(*raw);
    const icd_status_t status = icdgen_curve_nearest(&nearest, value, coefficients, count, 0, ICDGEN_I32(high));
    *raw = ICDGEN_U16(nearest);
    return status;
}

static inline icd_status_t icdgen_set_curve_i8(
    int8_t *raw, double value, const double *coefficients, size_t count, int8_t low, int8_t high)
{
    int32_t nearest = *raw;
    const icd_status_t status = icdgen_curve_nearest(&nearest, value, coefficients, count, low, high);
    *raw = ICDGEN_I8(nearest);
    return status;
}

static inline icd_status_t icdgen_set_curve_u8(
    uint8_t *raw, double value, const double *coefficients, size_t count, uint8_t high)
{
    int32_t nearest = ICDGEN_I32(*raw);
    const icd_status_t status = icdgen_curve_nearest(&nearest, value, coefficients, count, 0, ICDGEN_I32(high));
    *raw = ICDGEN_U8(nearest);
    return status;
}

/* The number of a line: (value - constant) / slope, each step a double of its own. */
static inline icd_status_t icdgen_set_curve_f64(double *raw, double value, const double *coefficients)
{
    volatile double inverse = value - coefficients[0];
    inverse = inverse / coefficients[1];
    const double result = inverse;
    if (!icdgen_is_finite(value) || !icdgen_is_finite(result)) {
        return ICD_ERROR_RANGE;
    }
    *raw = result;
    return ICD_OK;
}

static inline icd_status_t icdgen_set_curve_f32(float *raw, double value, const double *coefficients)
{
    const double beyond = 3.4028235677973366e38; /* half way from the largest float to what would follow */
    double wide = 0.0;
    const icd_status_t status = icdgen_set_curve_f64(&wide, value, coefficients);
    if (status != ICD_OK) {
        return status;
    }
    if (wide >= beyond || wide <= -beyond) {
        return ICD_ERROR_RANGE;
    }
    *raw = ICDGEN_CAST(float, wide);
    return ICD_OK;
}

#endif /* ICDGEN_NO_DOUBLE */

#endif /* ICDGEN_SUPPORT_CURVE_H */
