//! Date and time packed into bits.

use super::link::{Link, TimeForm, TimePart};
use super::Error;

/// A date and time. It may be invalid: see [`DosTime::is_valid`].
///
/// ```
/// use icdgen_runtime::wire::DosTime;
///
/// let time = DosTime { year: 2024, month: 2, day: 29, ..DosTime::default() };
/// assert!(time.is_valid());
/// assert!(!DosTime { year: 2023, ..time }.is_valid());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DosTime {
    /// The year.
    pub year: u32,
    /// The month, from 1 on.
    pub month: u32,
    /// The day of the month, from 1 on.
    pub day: u32,
    /// The hour.
    pub hour: u32,
    /// The minute.
    pub minute: u32,
    /// The second.
    pub second: u32,
}

impl DosTime {
    /// Unpack a time without checking it.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD does not describe this part of the protocol.
    pub fn unpack(link: &Link, value: u32) -> Result<Self, Error> {
        let form = form(link)?;
        Ok(Self {
            year: unpacked(&form.year, value),
            month: unpacked(&form.month, value),
            day: unpacked(&form.day, value),
            hour: unpacked(&form.hour, value),
            minute: unpacked(&form.minute, value),
            second: unpacked(&form.second, value),
        })
    }

    /// Pack the time, rounded down to the resolution of the format.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] with the first part that is invalid or does not fit, [`Error::Unsupported`]
    /// if the ICD does not describe packed time.
    pub fn pack(&self, link: &Link) -> Result<u32, Error> {
        let form = form(link)?;
        if let Some(field) = self.wrong() {
            return Err(Error::range(field));
        }
        let parts = [
            ("year", &form.year, self.year),
            ("month", &form.month, self.month),
            ("day", &form.day, self.day),
            ("hour", &form.hour, self.hour),
            ("minute", &form.minute, self.minute),
            ("second", &form.second, self.second),
        ];
        let mut packed = 0;
        for (field, part, value) in parts {
            packed |= pack(part, value).ok_or_else(|| Error::range(field))?;
        }
        Ok(packed)
    }

    /// Return whether date and time are valid.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.wrong().is_none()
    }

    /// Return the first invalid part.
    fn wrong(&self) -> Option<&'static str> {
        if !(1..=12).contains(&self.month) {
            Some("month")
        } else if !(1..=self.days()).contains(&self.day) {
            Some("day")
        } else if self.hour > 23 {
            Some("hour")
        } else if self.minute > 59 {
            Some("minute")
        } else if self.second > 59 {
            Some("second")
        } else {
            None
        }
    }

    /// Days of the month.
    const fn days(&self) -> u32 {
        let leap = (self.year % 4 == 0 && self.year % 100 != 0) || self.year % 400 == 0;
        match self.month {
            2 if leap => 29,
            2 => 28,
            4 | 6 | 9 | 11 => 30,
            _ => 31,
        }
    }
}

fn form(link: &Link) -> Result<&TimeForm, Error> {
    link.time.as_ref().ok_or(Error::Unsupported)
}

const fn mask(part: &TimePart) -> u32 {
    u32::MAX.wrapping_shr(32_u32.wrapping_sub(part.bits))
}

const fn unpacked(part: &TimePart, value: u32) -> u32 {
    let raw = value.wrapping_shr(part.at) & mask(part);
    raw.wrapping_mul(part.factor).wrapping_add(part.offset)
}

fn pack(part: &TimePart, value: u32) -> Option<u32> {
    let raw = value.checked_sub(part.offset)?.checked_div(part.factor)?;
    (raw <= mask(part)).then(|| raw.wrapping_shl(part.at))
}
