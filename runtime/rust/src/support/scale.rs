//! Scales, computed with 128-bit integers.

use super::Error;

/// What a field's raw value may be, and its physical value: `(raw * factor + offset) / divisor`.
#[derive(Debug)]
pub(crate) struct Scale {
    pub(crate) field: &'static str,
    pub(crate) allowed: &'static str,
    pub(crate) min: i128,
    pub(crate) max: i128,
    pub(crate) factor: i128,
    pub(crate) offset: i128,
    pub(crate) divisor: i128,
}

impl Scale {
    /// Of `field`, which takes what is `allowed`: raw values from `min` to `max`, with factor, offset and divisor.
    pub(crate) const fn new(
        field: &'static str,
        allowed: &'static str,
        (min, max): (i128, i128),
        (factor, offset, divisor): (i128, i128, i128),
    ) -> Self {
        Self {
            field,
            allowed,
            min,
            max,
            factor,
            offset,
            divisor,
        }
    }

    const fn refusal(&self) -> Error {
        Error::range(self.field, self.allowed)
    }

    /// The raw value, if the field can hold it.
    #[inline]
    pub(crate) fn fit<T: Copy + Into<i128>>(&self, raw: T) -> Result<T, Error> {
        if (self.min..=self.max).contains(&raw.into()) {
            Ok(raw)
        } else {
            Err(self.refusal())
        }
    }

    /// The double nearest to the physical value, ties to even.
    pub(crate) fn physical<T: Into<i128>>(&self, raw: T) -> f64 {
        self.rounded(raw.into(), Rounding::ToEven)
    }

    /// The single nearest to the physical value, ties to even.
    pub(crate) fn single<T: Into<i128>>(&self, raw: T) -> f32 {
        narrowed(self.rounded(raw.into(), Rounding::ToOdd))
    }

    fn rounded(&self, raw: i128, rounding: Rounding) -> f64 {
        let value = raw * self.factor + self.offset;
        let size = quotient(value.unsigned_abs(), self.divisor.unsigned_abs(), rounding);
        if value < 0 {
            -size
        } else {
            size
        }
    }

    /// The raw value nearest to `(value - offset) / factor`, ties to even.
    pub(crate) fn whole<T: TryFrom<i64> + Copy + Into<i128>>(
        &self,
        value: i64,
        factor: i64,
        offset: i64,
    ) -> Result<T, Error> {
        let raw = nearest_whole(value, factor, offset).and_then(|raw| T::try_from(raw).ok());
        self.fit(raw.ok_or_else(|| self.refusal())?)
    }

    /// The raw value nearest to a physical one, ties to even.
    pub(crate) fn raw<T: TryFrom<i128>>(&self, physical: f64) -> Result<T, Error> {
        let raw = self.nearest(physical).ok_or_else(|| self.refusal())?;
        T::try_from(self.fit(raw)?).map_err(|_| self.refusal())
    }

    /// The whole number nearest to `(physical * divisor - offset) / factor`, unless it is out of all bounds.
    fn nearest(&self, physical: f64) -> Option<i128> {
        let (mantissa, exponent) = parts(physical)?;
        let sign = self.factor.signum();
        let product = mantissa * self.divisor * sign;
        // whole + rest is the product scaled by the exponent; rest is 0, or 1 below, 2 at, 3 above one half.
        let (whole, rest) = if exponent >= 0 {
            let power = 1_i128.checked_shl(exponent.unsigned_abs())?;
            (product.checked_mul(power)?, 0)
        } else {
            halved(product, exponent.unsigned_abs())
        };
        let whole = whole.checked_sub(self.offset * sign)?;
        let factor = self.factor.abs();
        let raw = whole.checked_div_euclid(factor)?;
        let remainder = whole.checked_rem_euclid(factor)?;
        let beyond_half = 2 * (2 * remainder - factor) + rest;
        let up = beyond_half > 0 || (beyond_half == 0 && raw & 1 == 1);
        Some(raw + i128::from(up))
    }
}

/// How a quotient becomes a double.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Rounding {
    /// To the nearest one, ties to even.
    ToEven,
    /// To the one below, or to the one with an odd mantissa; then a narrower float rounds as if from the quotient.
    ToOdd,
}

/// A double that was rounded to odd, rounded to the nearest single.
#[allow(clippy::cast_possible_truncation)]
pub(super) fn narrowed(value: f64) -> f32 {
    value as f32
}

fn nearest_whole(value: i64, factor: i64, offset: i64) -> Option<i64> {
    let (over, size) = (value.checked_sub(offset)?, factor.checked_abs()?);
    let (whole, rest) = (
        over.checked_div_euclid(size)?,
        over.checked_rem_euclid(size)?,
    );
    let left = size - rest;
    let up = rest > left || (rest == left && whole & 1 == 1);
    let raw = whole + i64::from(up);
    if factor < 0 {
        raw.checked_neg()
    } else {
        Some(raw)
    }
}

/// Mantissa and exponent: the value is `mantissa * 2^exponent`. None if it is not finite.
pub(super) fn parts(value: f64) -> Option<(i128, i32)> {
    let bits = value.to_bits();
    let [first, second, ..] = bits.to_be_bytes();
    let exponent = i32::from(u16::from_be_bytes([first & 0x7f, second]) >> 4);
    let fraction = i128::from(bits & 0x000f_ffff_ffff_ffff);
    let (mantissa, exponent) = match exponent {
        0x7ff => return None,
        0 => (fraction, -1074),
        _ => (fraction | 0x0010_0000_0000_0000, exponent - 1075),
    };
    Some((if first < 0x80 { mantissa } else { -mantissa }, exponent))
}

/// `value / 2^places` rounded down, and the rest: 0 if none, or 1 below, 2 at, 3 above one half.
fn halved(value: i128, places: u32) -> (i128, i128) {
    // Beyond 120 places only the sign of such a value still counts.
    let (value, places) = if places > 120 {
        (value.signum(), 120)
    } else {
        (value, places)
    };
    let rest = value & ((1 << places) - 1);
    let half = 1 << (places - 1);
    let kind = match rest.cmp(&half) {
        _ if rest == 0 => 0,
        core::cmp::Ordering::Less => 1,
        core::cmp::Ordering::Equal => 2,
        core::cmp::Ordering::Greater => 3,
    };
    (value >> places, kind)
}

/// The double of `value / divisor`.
fn quotient(value: u128, divisor: u128, rounding: Rounding) -> f64 {
    if value == 0 {
        return 0.0;
    }
    let shift = value.leading_zeros();
    let scaled = value << shift;
    let quotient = scaled.checked_div(divisor).unwrap_or(0);
    let inexact = scaled.checked_rem(divisor).unwrap_or(0) != 0;
    let surplus = 75_u32.saturating_sub(quotient.leading_zeros()); // bits beyond the 53 of a double
    let rest = quotient & ((1 << surplus) - 1);
    let half = (1 << surplus) >> 1;
    let mantissa = quotient >> surplus;
    let mantissa = u64::try_from(mantissa).unwrap_or(0);
    let mantissa = match rounding {
        Rounding::ToEven => {
            let up = rest > half || (rest == half && (inexact || mantissa & 1 == 1));
            mantissa + u64::from(up)
        }
        Rounding::ToOdd => mantissa | u64::from(rest != 0 || inexact),
    };
    // The mantissa's leading one adds 1 to the exponent; so does the carry of rounding up.
    f64::from_bits((u64::from(surplus + 1074 - shift) << 52) + mantissa)
}

/// The value of a field that must be there.
pub(crate) fn there<T>(field: &'static str, value: Option<T>) -> Result<T, Error> {
    value.ok_or_else(|| Error::range(field, "a value where its condition holds"))
}
