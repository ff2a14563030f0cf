#ifndef ICDGEN_SUPPORT_CURVE_H
#define ICDGEN_SUPPORT_CURVE_H

#include "base.h"

#ifndef ICDGEN_NO_DOUBLE

/*
 * Calibration curves, made of pieces. Each piece begins at a raw value and is a polynomial in the difference from that
 * value, computed by Horner's rule. Every difference, product and sum is rounded to a double. The intermediate results
 * are volatile, so that compilers neither fuse two operations nor compute with excess precision.
 */
typedef struct {
    double start;
    const double *terms; /* coefficients; the constant term first */
    size_t count;        /* 0: the curve is not defined for this piece (NaN) */
} icdgen_piece_t;

static inline bool icdgen_is_finite(double value)
{
    uint64_t bits;
    (void)memcpy(&bits, &value, sizeof bits);
    return (ICDGEN_U32(bits >> 52) & 0x7FFu) != 0x7FFu;
}

static inline bool icdgen_is_nan(double value)
{
    uint64_t bits;
    (void)memcpy(&bits, &value, sizeof bits);
    return (bits & UINT64_C(0x7FFFFFFFFFFFFFFF)) > UINT64_C(0x7FF0000000000000);
}

/* Return the last piece that begins at or below the raw value, or the first piece if there is none. */
static inline const icdgen_piece_t *icdgen_piece(double raw, const icdgen_piece_t *pieces, size_t count)
{
    size_t first = 0u;
    size_t end = count;
    while (end - first > 1u) {
        const size_t middle = first + (end - first) / 2u;
        if (pieces[middle].start <= raw) {
            first = middle;
        } else {
            end = middle;
        }
    }
    return &pieces[first];
}

/* Replace any NaN by the NaN with fixed bits, so that results are the same on all targets. */
static inline double icdgen_curve(double raw, const icdgen_piece_t *pieces, size_t count)
{
    const icdgen_piece_t *piece = icdgen_piece(raw, pieces, count);
    double result = 0.0;
    bool is_number = piece->count > 0u && !icdgen_is_nan(raw);
    if (is_number) {
        const volatile double difference = raw - piece->start;
        const double above = difference;
        volatile double value = piece->terms[piece->count - 1u];
        for (size_t power = piece->count - 1u; power > 0u; --power) {
            value = value * above;
            value = value + piece->terms[power - 1u];
        }
        result = value;
        is_number = !icdgen_is_nan(result);
    }
    if (!is_number) {
        const uint64_t bits = UINT64_C(0x7FF8000000000000);
        (void)memcpy(&result, &bits, sizeof result);
    }
    return result;
}

/* Return the raw value with the nearest physical value, ties to even. The physical values must be monotonic. */
static inline icd_status_t icdgen_curve_nearest(
    int32_t *raw, double value, const icdgen_piece_t *pieces, size_t count, int32_t low, int32_t high)
{
    const double first = icdgen_curve(ICDGEN_CAST(double, low), pieces, count);
    const double last = icdgen_curve(ICDGEN_CAST(double, high), pieces, count);
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
        const double here = icdgen_curve(ICDGEN_CAST(double, middle), pieces, count);
        if (rises ? here <= value : here >= value) {
            left = middle;
        } else {
            right = middle;
        }
    }
    const double under = icdgen_curve(ICDGEN_CAST(double, left), pieces, count);
    const double over = icdgen_curve(ICDGEN_CAST(double, right), pieces, count);
    const volatile double below = rises ? value - under : under - value;
    const volatile double above = rises ? over - value : value - over;
    const double to_left = below;
    const double to_right = above;
    *raw = to_left < to_right || (to_left <= to_right && left % 2 == 0) ? left : right;
    return ICD_OK;
}

static inline icd_status_t icdgen_set_curve_i16(
    int16_t *raw, double value, const icdgen_piece_t *pieces, size_t count, int16_t low, int16_t high)
{
    int32_t nearest = *raw;
    const icd_status_t status = icdgen_curve_nearest(&nearest, value, pieces, count, low, high);
    *raw = ICDGEN_I16(nearest);
    return status;
}

static inline icd_status_t icdgen_set_curve_u16(
    uint16_t *raw, double value, const icdgen_piece_t *pieces, size_t count, uint16_t low, uint16_t high)
{
    int32_t nearest = ICDGEN_I32(*raw);
    const icd_status_t status = icdgen_curve_nearest(&nearest, value, pieces, count, ICDGEN_I32(low), ICDGEN_I32(high));
    *raw = ICDGEN_U16(nearest);
    return status;
}

static inline icd_status_t icdgen_set_curve_i8(
    int8_t *raw, double value, const icdgen_piece_t *pieces, size_t count, int8_t low, int8_t high)
{
    int32_t nearest = *raw;
    const icd_status_t status = icdgen_curve_nearest(&nearest, value, pieces, count, low, high);
    *raw = ICDGEN_I8(nearest);
    return status;
}

static inline icd_status_t icdgen_set_curve_u8(
    uint8_t *raw, double value, const icdgen_piece_t *pieces, size_t count, uint8_t low, uint8_t high)
{
    int32_t nearest = ICDGEN_I32(*raw);
    const icd_status_t status = icdgen_curve_nearest(&nearest, value, pieces, count, ICDGEN_I32(low), ICDGEN_I32(high));
    *raw = ICDGEN_U8(nearest);
    return status;
}

/* Invert a line: (value - constant) / slope, each step rounded to a double. */
static inline icd_status_t icdgen_set_curve_f64(double *raw, double value, const icdgen_piece_t *line)
{
    volatile double inverse = value - line->terms[0];
    inverse = inverse / line->terms[1];
    const double result = inverse;
    if (!icdgen_is_finite(value) || !icdgen_is_finite(result)) {
        return ICD_ERROR_RANGE;
    }
    *raw = result;
    return ICD_OK;
}

static inline icd_status_t icdgen_set_curve_f32(float *raw, double value, const icdgen_piece_t *line)
{
    const double beyond = 3.4028235677973366e38; /* halfway between the largest float and the next power of two */
    double wide = 0.0;
    const icd_status_t status = icdgen_set_curve_f64(&wide, value, line);
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
