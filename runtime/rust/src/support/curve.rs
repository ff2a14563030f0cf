//! Calibration curves, computed in doubles by Horner's rule. Every difference, product and sum is
//! rounded.

use super::Error;

/// From a raw value on, the terms of a polynomial in what is above that, the constant first; without terms, no number.
pub(crate) type Piece = (f64, &'static [f64]);

/// Pieces in the order of their raw values, and which of these physical values lead back to; of a float, none.
#[derive(Debug)]
pub(crate) struct Curve {
    pub(crate) field: &'static str,
    pub(crate) allowed: &'static str,
    pub(crate) min: i32,
    pub(crate) max: i32,
    pub(crate) pieces: &'static [Piece],
}

impl Curve {
    /// Of `field`, which takes what is `allowed`, for raw values from `min` to `max`, between which the physical ones rise or fall all along.
    ///
    /// Both are 0 where no physical value is set, or that of a float.
    pub(crate) const fn new(
        field: &'static str,
        allowed: &'static str,
        (min, max): (i32, i32),
        pieces: &'static [Piece],
    ) -> Self {
        Self {
            field,
            allowed,
            min,
            max,
            pieces,
        }
    }

    const fn refusal(&self) -> Error {
        Error::range(self.field, self.allowed)
    }

    /// The physical value of a number; one that is none has always the same bits.
    pub(crate) fn physical(&self, raw: f64) -> f64 {
        let before = self.pieces.partition_point(|&(start, _)| start <= raw);
        let piece = self.pieces.get(before.saturating_sub(1));
        let (start, terms) = piece.copied().unwrap_or((0.0, &[]));
        let (above, mut powers) = (raw - start, terms.iter().rev());
        let highest = powers.next().copied().unwrap_or(f64::NAN);
        #[allow(clippy::suboptimal_flops)] // one step for two would round once
        let value = powers.fold(highest, |value, term| value * above + term);
        if value.is_nan() || raw.is_nan() {
            f64::NAN
        } else {
            value
        }
    }

    /// The physical value of a whole number, which is rounded to a double before.
    #[allow(clippy::cast_precision_loss)]
    pub(crate) fn whole<T: Into<i128>>(&self, raw: T) -> f64 {
        self.physical(raw.into() as f64)
    }

    /// Whether a physical value leads back to a whole number.
    pub(crate) const fn is_whole(&self) -> bool {
        self.min < self.max
    }

    /// The raw value whose physical one is nearest, of two the even one.
    pub(crate) fn raw<T: TryFrom<i32>>(&self, physical: f64) -> Result<T, Error> {
        let raw = self.nearest(physical).ok_or_else(|| self.refusal())?;
        T::try_from(raw).map_err(|_| self.refusal())
    }

    fn nearest(&self, physical: f64) -> Option<i32> {
        let at = |raw: i32| self.physical(raw.into());
        let (first, last) = (at(self.min), at(self.max));
        let rises = first < last;
        let (least, most) = if rises { (first, last) } else { (last, first) };
        if !(least..=most).contains(&physical) {
            return None;
        }
        let (mut low, mut high) = (self.min, self.max);
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            let value = at(middle);
            if (rises && value <= physical) || (!rises && value >= physical) {
                low = middle;
            } else {
                high = middle;
            }
        }
        let (below, above) = if rises {
            (physical - at(low), at(high) - physical)
        } else {
            (at(low) - physical, physical - at(high))
        };
        Some(if below < above || (below <= above && low % 2 == 0) {
            low
        } else {
            high
        })
    }

    /// The number of a line: `(physical - constant) / slope`.
    pub(crate) fn number(&self, physical: f64) -> Result<f64, Error> {
        let found = match self.pieces {
            [(_, [constant, slope])] if physical.is_finite() => (physical - constant) / slope,
            _ => f64::NAN,
        };
        if found.is_finite() {
            Ok(found)
        } else {
            Err(self.refusal())
        }
    }

    /// The same in single precision.
    #[allow(clippy::cast_possible_truncation)]
    pub(crate) fn single(&self, physical: f64) -> Result<f32, Error> {
        let found = self.number(physical)? as f32;
        if found.is_finite() {
            Ok(found)
        } else {
            Err(self.refusal())
        }
    }
}
