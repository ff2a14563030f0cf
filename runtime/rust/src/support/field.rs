//! Fields as data: position, unit, scale and limits.

use super::{Curve, Error, Message, Scale, Wide};
use core::fmt::{Formatter, Result as Shown};

/// Description of a field.
///
/// ```
/// use icdgen_runtime::{Field, Message};
///
/// /// Returns the column headers of a table.
/// fn heads<M: Message>() -> Vec<String> {
///     let head = |field: &Field| format!("{} ({})", field.name, field.unit);
///     M::FIELDS.iter().map(head).collect()
/// }
/// ```
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Field {
    /// Name in the ICD.
    pub name: &'static str,
    /// First bit in the frame; beyond the frame if the frame length gives the value.
    pub at: usize,
    /// Size in bits; for an array, of each element.
    pub bits: usize,
    /// Number of elements of an array, at most; 1 for other fields.
    pub count: usize,
    /// Unit of the physical value; empty if there is none.
    pub unit: &'static str,
    /// Limits of the physical value, or of the raw value if the field has no scale: `min`, `above`,
    /// `max`, `below`.
    pub limits: &'static [(&'static str, f64)],
    /// Fields of a struct, with positions in the struct; empty for other fields.
    pub fields: &'static [Field],
    is_text: bool,
    scale: Option<Formula>,
}

#[derive(Clone, Copy, Debug)]
enum Formula {
    Usual(&'static Scale),
    Wide(&'static Wide),
    Curve(&'static Curve),
}

/// Return whether a float equals a special value. Unlike with `==`, any NaN equals any other NaN.
/// Both zeros are equal.
#[must_use]
#[allow(clippy::float_cmp)] // special values are exact
pub fn is_special<T: Into<f64>>(value: T, special: T) -> bool {
    let (value, special) = (value.into(), special.into());
    value == special || (value.is_nan() && special.is_nan())
}

impl Field {
    pub(crate) const fn new(name: &'static str, at: usize, bits: usize) -> Self {
        Self {
            name,
            at,
            bits,
            count: 1,
            unit: "",
            limits: &[],
            fields: &[],
            is_text: false,
            scale: None,
        }
    }

    pub(crate) const fn array(mut self, count: usize) -> Self {
        self.count = count;
        self
    }

    pub(crate) const fn fields(mut self, fields: &'static [Self]) -> Self {
        self.fields = fields;
        self
    }

    pub(crate) const fn text(mut self) -> Self {
        self.is_text = true;
        self
    }

    pub(crate) const fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    pub(crate) const fn limits(mut self, limits: &'static [(&'static str, f64)]) -> Self {
        self.limits = limits;
        self
    }

    pub(crate) const fn scale(mut self, scale: &'static Scale) -> Self {
        self.scale = Some(Formula::Usual(scale));
        self
    }

    pub(crate) const fn wide_scale(mut self, scale: &'static Wide) -> Self {
        self.scale = Some(Formula::Wide(scale));
        self
    }

    pub(crate) const fn curve(mut self, curve: &'static Curve) -> Self {
        self.scale = Some(Formula::Curve(curve));
        self
    }

    /// Return whether a value is within the limits. `value` is physical, or raw if the field has no
    /// scale. NaN is never within a limit.
    #[must_use]
    pub fn allows(&self, value: f64) -> bool {
        self.limits.iter().all(|&(kind, limit)| match kind {
            "min" => value >= limit,
            "above" => value > limit,
            "max" => value <= limit,
            _ => value < limit,
        })
    }

    /// Return the physical value of a raw value, correctly rounded unless the field has a
    /// calibration curve; None if the field has no scale.
    #[must_use]
    pub fn physical(&self, raw: i64) -> Option<f64> {
        self.converted(raw.into())
    }

    fn converted(&self, raw: i128) -> Option<f64> {
        Some(match self.scale? {
            Formula::Usual(scale) => scale.physical(raw),
            Formula::Wide(scale) => scale.physical(raw),
            Formula::Curve(curve) => curve.whole(raw),
        })
    }

    fn converted_float(&self, raw: f64) -> Option<f64> {
        match self.scale? {
            Formula::Curve(curve) => Some(curve.physical(raw)),
            _ => None,
        }
    }

    /// Return the raw value nearest to a physical value, ties to even; None if the field has no
    /// scale or is a float.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if the value is out of range or not finite.
    #[must_use]
    pub fn raw(&self, physical: f64) -> Option<Result<i128, Error>> {
        Some(match self.scale? {
            Formula::Usual(scale) => scale.raw(physical),
            Formula::Wide(scale) => scale.raw(physical),
            Formula::Curve(curve) if curve.is_whole() => curve.raw(physical).map(i32::into),
            Formula::Curve(_) => return None,
        })
    }
}

/// The fields of a message, or of a struct, that are yet to be shown.
pub(crate) struct Row {
    rest: core::slice::Iter<'static, Field>,
    mark: &'static str,
}

impl Row {
    pub(crate) fn begin<M: Message>(out: &mut Formatter<'_>) -> Result<Self, core::fmt::Error> {
        out.write_str(M::NAME)?;
        let (rest, mark) = (M::FIELDS.iter(), ": ");
        Ok(Self { rest, mark })
    }

    pub(crate) fn of(fields: &'static [Field], mark: &'static str) -> Self {
        let rest = fields.iter();
        Self { rest, mark }
    }

    pub(crate) fn show(&mut self, out: &mut Formatter<'_>, value: &(impl Value + ?Sized)) -> Shown {
        let mark = core::mem::replace(&mut self.mark, ", ");
        match self.rest.next() {
            Some(field) => {
                write!(out, "{mark}{} ", field.name)?;
                value.show(out, field)?;
                match field.unit {
                    "" => Ok(()),
                    unit => write!(out, " {unit}"),
                }
            }
            None => Ok(()),
        }
    }
}

/// What a member of a message, or of a struct, may be.
pub(crate) trait Value {
    fn show(&self, out: &mut Formatter<'_>, field: &Field) -> Shown;

    /// The text that several of them are; None if they are none.
    fn text(_: &[Self]) -> Option<&str>
    where
        Self: Sized,
    {
        None
    }
}

macro_rules! numbers {
    ($($type:ident $({ $($text:tt)* })?)*) => {$(
        impl Value for $type {
            $($($text)*)?

            fn show(&self, out: &mut Formatter<'_>, field: &Field) -> Shown {
                match field.converted((*self).into()) {
                    Some(value) => write!(out, "{value}"),
                    None => write!(out, "{self}"),
                }
            }
        }
    )*};
}
numbers!(u16 u32 u64 i8 i16 i32 i64);
numbers!(u8 {
    fn text(octets: &[Self]) -> Option<&str> {
        super::text::text(octets)
    }
});

macro_rules! others {
    ($($type:ident)*) => {$(
        impl Value for $type {
            fn show(&self, out: &mut Formatter<'_>, _: &Field) -> Shown {
                write!(out, "{self}")
            }
        }
    )*};
}
others!(bool);

macro_rules! floats {
    ($($type:ident)*) => {$(
        impl Value for $type {
            fn show(&self, out: &mut Formatter<'_>, field: &Field) -> Shown {
                match field.converted_float((*self).into()) {
                    Some(value) => write!(out, "{value}"),
                    None => write!(out, "{self}"),
                }
            }
        }
    )*};
}
floats!(f32 f64);

impl<E: super::Enumeration> Value for super::Coded<E> {
    fn show(&self, out: &mut Formatter<'_>, _: &Field) -> Shown {
        write!(out, "{self}")
    }
}

impl<T: Value> Value for Option<T> {
    fn show(&self, out: &mut Formatter<'_>, field: &Field) -> Shown {
        match self {
            Some(value) => value.show(out, field),
            None => out.write_str("-"),
        }
    }
}

impl<T: Value, const N: usize> Value for [T; N] {
    fn show(&self, out: &mut Formatter<'_>, field: &Field) -> Shown {
        self.as_slice().show(out, field)
    }
}

impl<T: Value> Value for [T] {
    fn show(&self, out: &mut Formatter<'_>, field: &Field) -> Shown {
        if let Some(said) = T::text(self).filter(|_| field.is_text) {
            return write!(out, "{said:?}");
        }
        out.write_str("[")?;
        let mut mark = "";
        for one in self {
            out.write_str(core::mem::replace(&mut mark, ", "))?;
            one.show(out, field)?;
        }
        out.write_str("]")
    }
}
