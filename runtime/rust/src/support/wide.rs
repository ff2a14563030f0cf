//! Scales with many digits, computed with 256-bit integers.

use core::cmp::Ordering;

use super::scale::{narrowed, Rounding};
use super::Error;

/// A whole number in two's complement, the least significant part first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Big(pub(crate) [u64; 4]);

impl Big {
    const ZERO: Self = Self([0; 4]);

    fn from_whole(value: i128) -> Self {
        let [low, high] = halves(value);
        let sign = if value < 0 { u64::MAX } else { 0 };
        Self([low, high, sign, sign])
    }

    fn is_negative(self) -> bool {
        let [.., top] = self.0;
        top >> 63 != 0
    }

    fn is_zero(self) -> bool {
        self.0.iter().all(|&part| part == 0)
    }

    fn add(self, right: Self) -> Self {
        let mut sum = self;
        let mut carry = false;
        for (part, more) in sum.0.iter_mut().zip(right.0) {
            let (half, first) = part.overflowing_add(more);
            let (whole, second) = half.overflowing_add(u64::from(carry));
            *part = whole;
            carry = first || second;
        }
        sum
    }

    fn negated(self) -> Self {
        Self(self.0.map(|part| !part)).add(Self::from_whole(1))
    }

    fn sub(self, right: Self) -> Self {
        self.add(right.negated())
    }

    fn magnitude(self) -> Self {
        if self.is_negative() {
            self.negated()
        } else {
            self
        }
    }

    /// The product; bits beyond 256 are lost.
    fn mul(self, right: Self) -> Self {
        let mut product = [0; 4];
        for (place, &factor) in self.0.iter().enumerate() {
            let mut carry = 0;
            for (part, &other) in product.iter_mut().skip(place).zip(right.0.iter()) {
                let sum = u128::from(factor) * u128::from(other) + u128::from(*part) + carry;
                *part = low_half(sum);
                carry = sum >> 64;
            }
        }
        Self(product)
    }

    /// How many bits a number that is not negative has without leading zeros.
    fn length(self) -> i32 {
        let mut length = 256;
        for part in self.0.iter().rev() {
            length -= part.leading_zeros();
            if *part != 0 {
                break;
            }
        }
        i32::try_from(length).unwrap_or(0)
    }

    fn doubled(self, times: i32) -> Self {
        let mut shifted = self;
        for _ in 0..times {
            shifted = shifted.add(shifted);
        }
        shifted
    }

    /// -1, 0 or 1
    fn signum(self) -> i32 {
        if self.is_negative() {
            -1
        } else {
            i32::from(!self.is_zero())
        }
    }

    /// How `self * 2^power` and another one compare; neither has 255 bits.
    fn compare(self, power: i32, other: Self) -> Ordering {
        let signs = self.signum().cmp(&other.signum());
        if signs != Ordering::Equal || self.is_zero() {
            return signs;
        }
        let (left, right) = (self.magnitude(), other.magnitude());
        let sizes = (left.length() + power).cmp(&right.length()).then_with(|| {
            let rest = left.doubled(power).sub(right.doubled(-power));
            rest.signum().cmp(&0)
        });
        if self.is_negative() {
            sizes.reverse()
        } else {
            sizes
        }
    }
}

fn low_half(value: u128) -> u64 {
    u64::try_from(value & u128::from(u64::MAX)).unwrap_or(0)
}

fn halves(value: i128) -> [u64; 2] {
    let bits = u128::from_le_bytes(value.to_le_bytes());
    [low_half(bits), low_half(bits >> 64)]
}

/// What a field's raw value may be, and its physical value: `(raw * factor + offset) / divisor`, where factor and divisor
/// go up to 2^180 and the offset up to 2^240.
#[derive(Debug)]
pub(crate) struct Wide {
    pub(crate) field: &'static str,
    pub(crate) allowed: &'static str,
    pub(crate) min: i128,
    pub(crate) max: i128,
    pub(crate) factor: Big,
    pub(crate) offset: Big,
    pub(crate) divisor: Big,
}

impl Wide {
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

    /// The numerator of the physical value.
    fn over(&self, raw: i128) -> Big {
        Big::from_whole(raw).mul(self.factor).add(self.offset)
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
        let value = self.over(raw);
        if value.is_zero() {
            return 0.0;
        }
        let over = value.magnitude();
        let mut exponent = over.length() - self.divisor.length();
        let divisor = self.divisor.doubled(exponent);
        let mut rest = over.doubled(-exponent);
        if rest.compare(0, divisor) == Ordering::Less {
            rest = rest.doubled(1);
            exponent -= 1;
        }
        // 53 digits of the quotient and one for rounding; the first is 1.
        let mut digits = 0_u64;
        for _ in 0..54 {
            let more = rest.sub(divisor);
            digits <<= 1;
            if !more.is_negative() {
                digits |= 1;
                rest = more;
            }
            rest = rest.doubled(1);
        }
        let last = digits & 1 == 1;
        let mantissa = match rounding {
            Rounding::ToEven => {
                (digits >> 1) + u64::from(last && (digits & 2 != 0 || !rest.is_zero()))
            }
            Rounding::ToOdd => (digits >> 1) | u64::from(last || !rest.is_zero()),
        };
        let exponent = u64::try_from(exponent + 1022).unwrap_or(0);
        // The leading digit adds 1 to the exponent; so does the carry of rounding up.
        let size = f64::from_bits(mantissa + (exponent << 52));
        if value.is_negative() {
            -size
        } else {
            size
        }
    }

    /// The raw value nearest to a physical one, ties to even.
    pub(crate) fn raw<T: TryFrom<i128>>(&self, physical: f64) -> Result<T, Error> {
        let raw = self.nearest(physical).ok_or_else(|| self.refusal())?;
        T::try_from(raw).map_err(|_| self.refusal())
    }

    fn nearest(&self, physical: f64) -> Option<i128> {
        let (mantissa, power) = super::scale::parts(physical)?;
        let twice = Big::from_whole(2 * mantissa).mul(self.divisor);
        // Whether the next raw value is nearer, or even and as near.
        let exceeds = |raw: i128| {
            let over = self.over(raw);
            let middle = over.add(over).add(self.factor);
            let beyond = twice.compare(power, middle);
            let is_odd = raw & 1 == 1;
            match beyond {
                Ordering::Equal => is_odd,
                Ordering::Less => self.factor.is_negative(),
                Ordering::Greater => !self.factor.is_negative(),
            }
        };
        let (mut least, mut most) = (self.min, self.max);
        if exceeds(most) || !exceeds(least - 1) {
            return None;
        }
        while least < most {
            let middle = least + ((most - least) >> 1);
            if exceeds(middle) {
                least = middle + 1;
            } else {
                most = middle;
            }
        }
        Some(least)
    }
}
