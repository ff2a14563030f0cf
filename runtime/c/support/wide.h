#ifndef ICDGEN_SUPPORT_WIDE_H
#define ICDGEN_SUPPORT_WIDE_H

#include "base.h"
#include "bits.h"

#ifndef ICDGEN_NO_DOUBLE

/* A 256-bit integer in two's complement, least significant word first. */
typedef struct {
    uint32_t part[8];
} icdgen_big_t;

/* physical = (raw * factor + offset) / divisor: factor and divisor up to 2^180, the offset up to 2^240. */
typedef struct {
    icdgen_big_t factor;
    icdgen_big_t offset;
    icdgen_big_t divisor;
} icdgen_scale_t;

static inline icdgen_big_t icdgen_big(uint64_t value, bool negative)
{
    icdgen_big_t big;
    big.part[0] = ICDGEN_U32(value & UINT64_C(0xFFFFFFFF));
    big.part[1] = ICDGEN_U32(value >> 32);
    for (unsigned i = 2; i < 8u; ++i) {
        big.part[i] = negative ? UINT32_MAX : 0u;
    }
    return big;
}

static inline bool icdgen_big_is_negative(const icdgen_big_t *value)
{
    return value->part[7] >> 31 != 0u;
}

static inline bool icdgen_big_is_zero(const icdgen_big_t *value)
{
    uint32_t any = 0;
    for (unsigned i = 0; i < 8u; ++i) {
        any |= value->part[i];
    }
    return any == 0u;
}

static inline icdgen_big_t icdgen_big_sum(const icdgen_big_t *left, const icdgen_big_t *right)
{
    icdgen_big_t sum = *left;
    uint64_t carry = 0;
    for (unsigned i = 0; i < 8u; ++i) {
        carry += ICDGEN_U64(sum.part[i]) + right->part[i];
        sum.part[i] = ICDGEN_U32(carry & UINT64_C(0xFFFFFFFF));
        carry >>= 32;
    }
    return sum;
}

static inline icdgen_big_t icdgen_big_difference(const icdgen_big_t *left, const icdgen_big_t *right)
{
    icdgen_big_t difference = *left;
    uint64_t carry = 1;
    for (unsigned i = 0; i < 8u; ++i) {
        carry += ICDGEN_U64(difference.part[i]) + (right->part[i] ^ UINT32_MAX);
        difference.part[i] = ICDGEN_U32(carry & UINT64_C(0xFFFFFFFF));
        carry >>= 32;
    }
    return difference;
}

static inline icdgen_big_t icdgen_big_product(const icdgen_big_t *left, const icdgen_big_t *right)
{
    icdgen_big_t product = icdgen_big(0, false);
    for (unsigned i = 0; i < 8u; ++i) {
        uint64_t carry = 0;
        for (unsigned j = 0; i + j < 8u; ++j) {
            carry += ICDGEN_U64(left->part[i]) * right->part[j] + product.part[i + j];
            product.part[i + j] = ICDGEN_U32(carry & UINT64_C(0xFFFFFFFF));
            carry >>= 32;
        }
    }
    return product;
}

static inline icdgen_big_t icdgen_big_magnitude(const icdgen_big_t *value)
{
    const icdgen_big_t zero = icdgen_big(0, false);
    return icdgen_big_is_negative(value) ? icdgen_big_difference(&zero, value) : *value;
}

/* Return the number of significant bits of a non-negative number. */
static inline int32_t icdgen_big_length(const icdgen_big_t *value)
{
    int32_t length = 256;
    while (length > 0) {
        const uint32_t top = ICDGEN_U32(length - 1);
        if ((value->part[top / 32u] >> (top % 32u) & 1u) != 0u) {
            break;
        }
        --length;
    }
    return length;
}

static inline void icdgen_big_shift(icdgen_big_t *value, int32_t places)
{
    for (; places > 0; --places) {
        *value = icdgen_big_sum(value, value);
    }
}

/*
 * Compare a value times a power of two with another value: -1, 0 or 1 for below, equal or above. Both have fewer than
 * 255 bits.
 */
static inline int icdgen_big_compare(const icdgen_big_t *left, int32_t power, const icdgen_big_t *right)
{
    const bool negative = icdgen_big_is_negative(left);
    const bool left_is_zero = icdgen_big_is_zero(left);
    const bool right_is_zero = icdgen_big_is_zero(right);
    if (negative != icdgen_big_is_negative(right) || left_is_zero || right_is_zero) {
        const bool equal = left_is_zero && right_is_zero;
        const bool below = negative || (left_is_zero && !icdgen_big_is_negative(right));
        return equal ? 0 : below ? -1 : 1;
    }
    const int farther = negative ? -1 : 1;
    icdgen_big_t a = icdgen_big_magnitude(left);
    icdgen_big_t b = icdgen_big_magnitude(right);
    const int32_t longer = icdgen_big_length(&a) + power - icdgen_big_length(&b);
    if (longer != 0) {
        return longer > 0 ? farther : -farther;
    }
    icdgen_big_shift(&a, power);
    icdgen_big_shift(&b, -power);
    const icdgen_big_t rest = icdgen_big_difference(&a, &b);
    if (icdgen_big_is_zero(&rest)) {
        return 0;
    }
    return icdgen_big_is_negative(&rest) ? -farther : farther;
}

/* Return (raw * factor + offset) / divisor, rounded once to the nearest double, ties to even. */
static inline double icdgen_wide_physical(uint64_t raw, bool is_negative, const icdgen_scale_t *scale)
{
    const icdgen_big_t whole = icdgen_big(raw, is_negative);
    const icdgen_big_t product = icdgen_big_product(&whole, &scale->factor);
    const icdgen_big_t value = icdgen_big_sum(&product, &scale->offset);
    uint64_t bits = 0;
    if (!icdgen_big_is_zero(&value)) {
        icdgen_big_t rest = icdgen_big_magnitude(&value);
        icdgen_big_t divisor = scale->divisor;
        int32_t exponent = icdgen_big_length(&rest) - icdgen_big_length(&divisor);
        icdgen_big_shift(&divisor, exponent);
        icdgen_big_shift(&rest, -exponent);
        icdgen_big_t more = icdgen_big_difference(&rest, &divisor);
        if (icdgen_big_is_negative(&more)) {
            icdgen_big_shift(&rest, 1);
            --exponent;
        }
        /* 53 binary digits of the quotient and one for rounding; the first digit is 1. */
        for (unsigned digit = 0; digit < 54u; ++digit) {
            more = icdgen_big_difference(&rest, &divisor);
            bits <<= 1;
            if (!icdgen_big_is_negative(&more)) {
                bits |= 1u;
                rest = more;
            }
            icdgen_big_shift(&rest, 1);
        }
        const bool up = (bits & 1u) != 0u && ((bits & 2u) != 0u || !icdgen_big_is_zero(&rest));
        /* The leading digit adds 1 to the exponent; so does the carry of rounding up. */
        bits = (bits >> 1) + (up ? 1u : 0u) + (ICDGEN_U64(exponent + 1022) << 52);
        bits |= ICDGEN_U64(icdgen_big_is_negative(&value) ? 1u : 0u) << 63;
    }
    double result;
    (void)memcpy(&result, &bits, sizeof result);
    return result;
}

static inline double icdgen_wide_physical_u64(uint64_t raw, const icdgen_scale_t *scale)
{
    return icdgen_wide_physical(raw, false, scale);
}

static inline double icdgen_wide_physical_i64(int64_t raw, const icdgen_scale_t *scale)
{
    return icdgen_wide_physical(ICDGEN_U64(raw), raw < 0, scale);
}

/* A double as an integer (twice its significand times the divisor) times a power of two. */
typedef struct {
    icdgen_big_t twice;
    int32_t power;
} icdgen_wide_value_t;

/* Return whether a raw value is too small: the next one is nearer, or is even and equally near. */
static inline bool icdgen_wide_exceeds(
    const icdgen_wide_value_t *value, uint64_t raw, bool is_negative, const icdgen_scale_t *scale)
{
    const icdgen_big_t whole = icdgen_big(raw, is_negative);
    const icdgen_big_t product = icdgen_big_product(&whole, &scale->factor);
    icdgen_big_t middle = icdgen_big_sum(&product, &scale->offset);
    middle = icdgen_big_sum(&middle, &middle);
    middle = icdgen_big_sum(&middle, &scale->factor);
    const int beyond = icdgen_big_compare(&value->twice, value->power, &middle);
    const bool is_beyond = icdgen_big_is_negative(&scale->factor) ? beyond < 0 : beyond > 0;
    return is_beyond || (beyond == 0 && (raw & 1u) != 0u);
}

/* Return the bits of the raw value nearest to a physical value, ties to even. ``low`` is at most 0. */
static inline icd_status_t icdgen_wide_nearest(
    uint64_t *raw, double physical, const icdgen_scale_t *scale, int64_t low, uint64_t high)
{
    uint64_t bits;
    (void)memcpy(&bits, &physical, sizeof bits);
    const uint32_t exponent = ICDGEN_U32(bits >> 52) & 0x7FFu;
    if (exponent == 0x7FFu) {
        return ICD_ERROR_RANGE;
    }
    const uint64_t fraction = bits & UINT64_C(0xFFFFFFFFFFFFF);
    const uint64_t digits = (exponent == 0u ? fraction : fraction | (UINT64_C(1) << 52)) << 1;
    const bool is_minus = bits >> 63 != 0u && digits != 0u;
    const icdgen_big_t significand = icdgen_big(is_minus ? UINT64_C(0) - digits : digits, is_minus);
    icdgen_wide_value_t value;
    value.twice = icdgen_big_product(&significand, &scale->divisor);
    value.power = ICDGEN_I32(exponent == 0u ? 1u : exponent) - 1075;

    const uint64_t first = ICDGEN_U64(low);
    if (icdgen_wide_exceeds(&value, high, false, scale) || !icdgen_wide_exceeds(&value, first - 1u, true, scale)) {
        return ICD_ERROR_RANGE;
    }
    uint64_t least = 0;
    uint64_t most = high - first;
    while (least < most) {
        const uint64_t middle = least + (most - least) / 2u;
        if (icdgen_wide_exceeds(&value, first + middle, low < 0 && middle < UINT64_C(0) - first, scale)) {
            least = middle + 1u;
        } else {
            most = middle;
        }
    }
    *raw = first + least;
    return ICD_OK;
}

static inline icd_status_t icdgen_wide_set_i64(
    int64_t *raw, double value, const icdgen_scale_t *scale, int64_t low, int64_t high)
{
    uint64_t nearest = 0;
    const icd_status_t status = icdgen_wide_nearest(&nearest, value, scale, low, ICDGEN_U64(high));
    if (status == ICD_OK) {
        *raw = icdgen_i64(nearest);
    }
    return status;
}

static inline icd_status_t icdgen_wide_set_u64(uint64_t *raw, double value, const icdgen_scale_t *scale, uint64_t high)
{
    return icdgen_wide_nearest(raw, value, scale, 0, high);
}

static inline icd_status_t icdgen_wide_set_i32(
    int32_t *raw, double value, const icdgen_scale_t *scale, int32_t low, int32_t high)
{
    int64_t nearest = *raw;
    const icd_status_t status = icdgen_wide_set_i64(&nearest, value, scale, low, high);
    *raw = ICDGEN_I32(nearest);
    return status;
}

static inline icd_status_t icdgen_wide_set_u32(uint32_t *raw, double value, const icdgen_scale_t *scale, uint32_t high)
{
    uint64_t nearest = *raw;
    const icd_status_t status = icdgen_wide_set_u64(&nearest, value, scale, high);
    *raw = ICDGEN_U32(nearest);
    return status;
}

static inline icd_status_t icdgen_wide_set_i16(
    int16_t *raw, double value, const icdgen_scale_t *scale, int16_t low, int16_t high)
{
    int64_t nearest = *raw;
    const icd_status_t status = icdgen_wide_set_i64(&nearest, value, scale, low, high);
    *raw = ICDGEN_I16(nearest);
    return status;
}

static inline icd_status_t icdgen_wide_set_u16(uint16_t *raw, double value, const icdgen_scale_t *scale, uint16_t high)
{
    uint64_t nearest = *raw;
    const icd_status_t status = icdgen_wide_set_u64(&nearest, value, scale, high);
    *raw = ICDGEN_U16(nearest);
    return status;
}

static inline icd_status_t icdgen_wide_set_i8(
    int8_t *raw, double value, const icdgen_scale_t *scale, int8_t low, int8_t high)
{
    int64_t nearest = *raw;
    const icd_status_t status = icdgen_wide_set_i64(&nearest, value, scale, low, high);
    *raw = ICDGEN_I8(nearest);
    return status;
}

static inline icd_status_t icdgen_wide_set_u8(uint8_t *raw, double value, const icdgen_scale_t *scale, uint8_t high)
{
    uint64_t nearest = *raw;
    const icd_status_t status = icdgen_wide_set_u64(&nearest, value, scale, high);
    *raw = ICDGEN_U8(nearest);
    return status;
}

#endif /* ICDGEN_NO_DOUBLE */

#endif /* ICDGEN_SUPPORT_WIDE_H */
