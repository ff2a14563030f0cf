//! Values derived from several fields, computed in doubles. Every step is rounded.

/// Replace any NaN by the NaN with fixed bits, so that results are the same on all targets.
pub(crate) fn quiet(value: f64) -> f64 {
    if value.is_nan() {
        f64::NAN
    } else {
        value
    }
}

/// A whole number, rounded to a double.
#[allow(clippy::cast_precision_loss)]
pub(crate) fn whole<T: Into<i128>>(raw: T) -> f64 {
    raw.into() as f64
}

/// By squaring, from the lowest bit of a whole exponent on; of a negative one the reciprocal.
#[allow(clippy::cast_possible_truncation)]
pub(crate) fn power(base: f64, exponent: f64) -> f64 {
    let whole = exponent as i32;
    let (mut left, mut square, mut result) = (whole.unsigned_abs(), base, 1.0);
    while left > 0 {
        if left % 2 == 1 {
            result *= square;
        }
        square *= square;
        left /= 2;
    }
    if whole < 0 {
        1.0 / result
    } else {
        result
    }
}
