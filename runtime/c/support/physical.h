#ifndef ICDGEN_SUPPORT_PHYSICAL_H
#define ICDGEN_SUPPORT_PHYSICAL_H

#include "base.h"
#include "bits.h"

/* Return the integer nearest to a quotient, ties to even. The divisor is positive. */
static inline int32_t icdgen_nearest32(int32_t value, int32_t divisor)
{
    int32_t quotient = value / divisor;
    int32_t rest = value % divisor;
    if (rest < 0) {
        rest += divisor;
        --quotient;
    }
    const bool odd = quotient % 2 != 0;
    return quotient + (rest > divisor - rest || (rest == divisor - rest && odd) ? 1 : 0);
}

static inline int64_t icdgen_nearest64(int64_t value, int64_t divisor)
{
    int64_t quotient = value / divisor;
    int64_t rest = value % divisor;
    if (rest < 0) {
        rest += divisor;
        --quotient;
    }
    const bool odd = quotient % 2 != 0;
    return quotient + (rest > divisor - rest || (rest == divisor - rest && odd) ? 1 : 0);
}

#ifndef ICDGEN_NO_DOUBLE

/*
 * Physical values: (raw * factor + offset) / divisor. Factor and divisor have up to 33 bits; the divisor is positive.
 * The computation uses 128-bit integers and the bits of a double, so that neither the rounding mode of the processor
 * nor floating-point optimizations of the compiler change a result.
 */
typedef struct {
    uint64_t high;
    uint64_t low;
    bool negative;
} icdgen_int128_t;

static inline uint64_t icdgen_magnitude(int64_t value)
{
    return value < 0 ? UINT64_C(0) - ICDGEN_U64(value) : ICDGEN_U64(value);
}

static inline icdgen_int128_t icdgen_product(uint64_t left, uint64_t right, bool negative)
{
    const uint64_t half = UINT64_C(0xFFFFFFFF);
    const uint64_t low = (left & half) * (right & half);
    const uint64_t middle = (left >> 32) * (right & half) + (low >> 32);
    const uint64_t other = (left & half) * (right >> 32) + (middle & half);
    icdgen_int128_t product;
    product.high = (left >> 32) * (right >> 32) + (middle >> 32) + (other >> 32);
    product.low = (other << 32) | (low & half);
    product.negative = negative;
    return product;
}

static inline icdgen_int128_t icdgen_sum(icdgen_int128_t left, uint64_t right, bool negative)
{
    icdgen_int128_t sum = left;
    if (left.negative == negative) {
        sum.low = left.low + right;
        sum.high = left.high + (sum.low < right ? 1u : 0u);
    } else if (left.high != 0u || left.low >= right) {
        sum.low = left.low - right;
        sum.high = left.high - (left.low < right ? 1u : 0u);
    } else {
        sum.low = right - left.low;
        sum.negative = negative;
    }
    return sum;
}

/* Divide the magnitude and return the remainder. */
static inline uint64_t icdgen_divide(icdgen_int128_t *value, uint64_t divisor)
{
    uint64_t rest = 0;
    if (value->high == 0u) {
        rest = value->low % divisor;
        value->low /= divisor;
        return rest;
    }
    for (unsigned bit = 0; bit < 128u; ++bit) {
        rest = (rest << 1) | (value->high >> 63);
        value->high = (value->high << 1) | (value->low >> 63);
        value->low <<= 1;
        if (rest >= divisor) {
            rest -= divisor;
            value->low |= 1u;
        }
    }
    return rest;
}

/* Return the quotient as a correctly rounded double. */
static inline double icdgen_rounded(icdgen_int128_t value, uint64_t divisor)
{
    uint64_t bits = 0;
    uint64_t rest = icdgen_divide(&value, divisor);
    if (value.high != 0u || value.low != 0u || rest != 0u) {
        uint32_t exponent = 1023u + 63u;
        bool more = false;
        while (value.high != 0u) {
            more = more || (value.low & 1u) != 0u;
            value.low = (value.low >> 1) | (value.high << 63);
            value.high >>= 1;
            ++exponent;
        }
        while (value.low >> 63 == 0u) {
            rest <<= 1;
            value.low <<= 1;
            if (rest >= divisor) {
                rest -= divisor;
                value.low |= 1u;
            }
            --exponent;
        }
        more = more || rest != 0u;
        bits = value.low >> 11;
        const uint64_t below = value.low & 0x7FFu;
        const uint64_t half = 0x400u;
        if (below > half || (below == half && (more || (bits & 1u) != 0u))) {
            ++bits;
        }
        bits += ICDGEN_U64(exponent - 1u) << 52;
        bits |= ICDGEN_U64(value.negative) << 63;
    }
    double result;
    (void)memcpy(&result, &bits, sizeof result);
    return result;
}

static inline double icdgen_physical_i64(int64_t raw, int64_t factor, int64_t offset, int64_t divisor)
{
    const icdgen_int128_t product =
        icdgen_product(icdgen_magnitude(raw), icdgen_magnitude(factor), (raw < 0) != (factor < 0));
    return icdgen_rounded(icdgen_sum(product, icdgen_magnitude(offset), offset < 0), ICDGEN_U64(divisor));
}

static inline double icdgen_physical_u64(uint64_t raw, int64_t factor, int64_t offset, int64_t divisor)
{
    const icdgen_int128_t product = icdgen_product(raw, icdgen_magnitude(factor), factor < 0);
    return icdgen_rounded(icdgen_sum(product, icdgen_magnitude(offset), offset < 0), ICDGEN_U64(divisor));
}

/*
 * Return the quotient of two numbers that are exact as doubles. This is a single division if the compiler guarantees to
 * round it once and correctly.
 */
ICDGEN_INLINE double icdgen_quotient(int64_t value, int64_t divisor)
{
#if defined(__FLT_EVAL_METHOD__) && !defined(__FAST_MATH__) && !defined(__RECIPROCAL_MATH__)
#if __FLT_EVAL_METHOD__ == 0 || __FLT_EVAL_METHOD__ == 1
#define ICDGEN_DIVISION_IS_EXACT 1
#endif
#endif
#ifdef ICDGEN_DIVISION_IS_EXACT
    return ICDGEN_CAST(double, value) / ICDGEN_CAST(double, divisor);
#else
    return icdgen_physical_i64(value, 1, 0, divisor);
#endif
}

/*
 * The inverse: magnitude and sign of the nearest raw value, ties to even. The double is used as the exact number that
 * it represents, so 0.005 is above one half of 0.01.
 */
static inline icd_status_t icdgen_nearest(
    double value, int64_t factor, int64_t offset, int64_t divisor, bool *negative, uint64_t *magnitude)
{
    uint64_t bits;
    (void)memcpy(&bits, &value, sizeof bits);
    const uint32_t exponent = ICDGEN_U32(bits >> 52) & 0x7FFu;
    if (exponent == 0x7FFu) {
        return ICD_ERROR_RANGE;
    }
    const uint64_t fraction = bits & UINT64_C(0xFFFFFFFFFFFFF);
    const uint64_t significand = exponent == 0u ? fraction : fraction | (UINT64_C(1) << 52);

    /*
     * |value| * divisor = whole + fraction. The fraction is reduced to its first bit and a flag for any further bits.
     */
    icdgen_int128_t whole = icdgen_product(significand, ICDGEN_U64(divisor), false);
    bool half = false;
    bool more = false;
    for (uint32_t power = exponent; power > 1075u; --power) {
        if (whole.high >> 62 != 0u) {
            return ICD_ERROR_RANGE;
        }
        whole.high = (whole.high << 1) | (whole.low >> 63);
        whole.low <<= 1;
    }
    for (uint32_t power = exponent == 0u ? 1u : exponent; power < 1075u; ++power) {
        if ((whole.high | whole.low) == 0u && !half) {
            break;
        }
        more = more || half;
        half = (whole.low & 1u) != 0u;
        whole.low = (whole.low >> 1) | (whole.high << 63);
        whole.high >>= 1;
    }

    /* A negative value or factor negates the computation; the result is negated back at the end. */
    const bool turned = (bits >> 63 != 0u) != (factor < 0);
    const bool minus = bits >> 63 != 0u;
    const uint64_t step = icdgen_magnitude(factor);
    whole = icdgen_sum(whole, icdgen_magnitude(offset), minus ? offset < 0 : offset > 0);
    uint64_t rest = icdgen_divide(&whole, step);
    if (whole.high != 0u) {
        return ICD_ERROR_RANGE;
    }

    /* Floor of the quotient, the remainder, and the distance to the next step, without the fraction. */
    const bool below = whole.negative && rest != 0u;
    if (below) {
        rest = step - rest;
    }
    const uint64_t missing = step - rest;
    bool up = rest > missing;
    bool tie = false;
    if (rest == missing) {
        up = half || more;
        tie = !up;
    } else if (rest + 1u == missing) {
        up = half && more;
        tie = half && !more;
    } else {
        /* the fraction does not change the result */
    }
    const bool odd = ((whole.low & 1u) != 0u) != below;
    up = up || (tie && odd);

    const bool away = whole.negative ? below && !up : up;
    const bool back = whole.negative && !below && up;
    if (away && whole.low == UINT64_MAX) {
        return ICD_ERROR_RANGE;
    }
    *magnitude = whole.low + (away ? 1u : 0u) - (back ? 1u : 0u);
    *negative = whole.negative != turned;
    return ICD_OK;
}

static inline icd_status_t icdgen_set_i64(
    int64_t *raw, double value, int64_t factor, int64_t offset, int64_t divisor, int64_t low, int64_t high)
{
    bool negative = false;
    uint64_t magnitude = 0;
    const icd_status_t status = icdgen_nearest(value, factor, offset, divisor, &negative, &magnitude);
    if (status != ICD_OK) {
        return status;
    }
    if (magnitude > ICDGEN_U64(INT64_MAX) + (negative ? 1u : 0u)) {
        return ICD_ERROR_RANGE;
    }
    const int64_t nearest = icdgen_i64(negative ? UINT64_C(0) - magnitude : magnitude);
    if (nearest < low || nearest > high) {
        return ICD_ERROR_RANGE;
    }
    *raw = nearest;
    return ICD_OK;
}

static inline icd_status_t icdgen_set_u64(
    uint64_t *raw, double value, int64_t factor, int64_t offset, int64_t divisor, uint64_t high)
{
    bool negative = false;
    uint64_t magnitude = 0;
    const icd_status_t status = icdgen_nearest(value, factor, offset, divisor, &negative, &magnitude);
    if (status != ICD_OK) {
        return status;
    }
    if (magnitude > high || (negative && magnitude != 0u)) {
        return ICD_ERROR_RANGE;
    }
    *raw = magnitude;
    return ICD_OK;
}

static inline icd_status_t icdgen_set_i32(
    int32_t *raw, double value, int64_t factor, int64_t offset, int64_t divisor, int32_t low, int32_t high)
{
    int64_t nearest = *raw;
    const icd_status_t status = icdgen_set_i64(&nearest, value, factor, offset, divisor, low, high);
    *raw = ICDGEN_I32(nearest);
    return status;
}

static inline icd_status_t icdgen_set_u32(
    uint32_t *raw, double value, int64_t factor, int64_t offset, int64_t divisor, uint32_t high)
{
    uint64_t nearest = *raw;
    const icd_status_t status = icdgen_set_u64(&nearest, value, factor, offset, divisor, high);
    *raw = ICDGEN_U32(nearest);
    return status;
}

static inline icd_status_t icdgen_set_i16(
    int16_t *raw, double value, int64_t factor, int64_t offset, int64_t divisor, int16_t low, int16_t high)
{
    int64_t nearest = *raw;
    const icd_status_t status = icdgen_set_i64(&nearest, value, factor, offset, divisor, low, high);
    *raw = ICDGEN_I16(nearest);
    return status;
}

static inline icd_status_t icdgen_set_u16(
    uint16_t *raw, double value, int64_t factor, int64_t offset, int64_t divisor, uint16_t high)
{
    uint64_t nearest = *raw;
    const icd_status_t status = icdgen_set_u64(&nearest, value, factor, offset, divisor, high);
    *raw = ICDGEN_U16(nearest);
    return status;
}

static inline icd_status_t icdgen_set_i8(
    int8_t *raw, double value, int64_t factor, int64_t offset, int64_t divisor, int8_t low, int8_t high)
{
    int64_t nearest = *raw;
    const icd_status_t status = icdgen_set_i64(&nearest, value, factor, offset, divisor, low, high);
    *raw = ICDGEN_I8(nearest);
    return status;
}

static inline icd_status_t icdgen_set_u8(
    uint8_t *raw, double value, int64_t factor, int64_t offset, int64_t divisor, uint8_t high)
{
    uint64_t nearest = *raw;
    const icd_status_t status = icdgen_set_u64(&nearest, value, factor, offset, divisor, high);
    *raw = ICDGEN_U8(nearest);
    return status;
}

#endif /* ICDGEN_NO_DOUBLE */

#endif /* ICDGEN_SUPPORT_PHYSICAL_H */
