#ifndef ICDGEN_SUPPORT_CURVE_H
#define ICDGEN_SUPPORT_CURVE_H

#include "base.h"

#ifndef ICDGEN_NO_DOUBLE

/*
 * Physical values by curves, which are made of pieces: from a raw value on, a polynomial in what is above that.
 * Horner's rule, where every difference, product and sum is a double of its own. That the steps are volatile keeps
 * compilers from making one of two, and from reckoning with more digits in between.
 */
typedef struct {
    double start;
    const double *terms; /* the constant first */
    size_t count;        /* without terms there is no number */
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

/* The last piece that begins at the raw value or below, or else the first one. */
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

/* A value that is no number has always the same bits. */
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

/* The raw value whose physical one is nearest, of two the even one; the physical values rise, or fall, all along. */
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

/* The number of a line: (value - constant) / slope, each step a double of its own. */
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
    const double beyond = 3.4028235677973366e38; /* half way from the largest float to what would follow */
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
