//! Messages: values in, values out.

use crate::line::{hex, list, unhex, Answer, Refusal, Words};
use crate::nodes::NODES;
use icd::{Coded, Enumeration, Error};
use std::fmt::Write;

/// A raw value.
pub trait Value {
    fn show(&self) -> String;
    /// Takes a value; false if it does not fit.
    fn take(&mut self, given: &str) -> bool;
    /// The name of the member, for an enumeration that has it.
    fn name(&self) -> Option<&'static str> {
        None
    }
}

macro_rules! integer {
    ($($type:ty)*) => {$(
        impl Value for $type {
            fn show(&self) -> String {
                self.to_string()
            }

            fn take(&mut self, given: &str) -> bool {
                given.parse().map(|value| *self = value).is_ok()
            }
        }
    )*};
}

integer!(u8 u16 u32 u64 i8 i16 i32 i64);

macro_rules! float {
    ($($type:ty)*) => {$(
        impl Value for $type {
            fn show(&self) -> String {
                self.to_bits().to_string()
            }

            fn take(&mut self, given: &str) -> bool {
                given.parse().map(|bits| *self = <$type>::from_bits(bits)).is_ok()
            }
        }
    )*};
}

float!(f32 f64);

impl Value for bool {
    fn show(&self) -> String {
        u8::from(*self).to_string()
    }

    fn take(&mut self, given: &str) -> bool {
        *self = given == "1";
        *self || given == "0"
    }
}

impl<T: Value + Default> Value for Option<T> {
    fn show(&self) -> String {
        self.as_ref().map_or_else(|| "-".into(), Value::show)
    }

    fn take(&mut self, given: &str) -> bool {
        let mut value = T::default();
        let fits = given.is_empty() || value.take(given);
        *self = if given.is_empty() { None } else { Some(value) };
        fits
    }

    fn name(&self) -> Option<&'static str> {
        self.as_ref().and_then(Value::name)
    }
}

impl<const N: usize> Value for [u8; N] {
    fn show(&self) -> String {
        hex(self)
    }

    fn take(&mut self, given: &str) -> bool {
        unhex(given).try_into().map(|bytes| *self = bytes).is_ok()
    }
}

impl<E> Value for Coded<E>
where
    E: Enumeration,
    E::Raw: Value,
{
    fn show(&self) -> String {
        self.raw().show()
    }

    fn take(&mut self, given: &str) -> bool {
        let mut raw = self.raw();
        let fits = raw.take(given);
        *self = Self::from_raw(raw);
        fits
    }

    fn name(&self) -> Option<&'static str> {
        Coded::name(*self)
    }
}

/// Where a raw value is.
#[allow(dead_code)] // not every ICD has views
pub enum Place<M: 'static> {
    Member(fn(&mut M) -> &mut dyn Value),
    View(fn(&M) -> Box<dyn Value>),
}

impl<M> Field<M> {
    fn show(&self, message: &mut M) -> (String, String) {
        let told = |value: &dyn Value| (value.show(), named(value.name()));
        match self.value {
            Place::Member(member) => told(member(message)),
            Place::View(view) => told(&*view(message)),
        }
    }
}

/// A field of a message.
pub struct Field<M: 'static> {
    pub value: Place<M>,
    pub scale: Option<Scale<M>>,
    pub text: Option<Text<M>>,
    pub special: fn() -> Vec<i128>,
    pub limits: fn() -> Vec<(&'static str, f64)>,
}

/// Getter and setter of a physical value.
pub struct Scale<M> {
    pub get: fn(&M) -> f64,
    pub set: fn(&mut M, f64) -> Result<(), Error>,
}

/// Getter and setter of a text.
pub struct Text<M> {
    pub get: fn(&M) -> Option<&str>,
    pub set: fn(&mut M, &str) -> Result<(), Error>,
}

/// A message.
pub trait Subject: Copy + Default + 'static {
    const TITLE: &'static str;
    const BYTES: usize;
    const FIELDS: &'static [Field<Self>];
    fn ids() -> Vec<u32>;
    fn decode(bytes: &[u8]) -> Result<Self, Error>;
    fn encode(&self) -> Result<Vec<u8>, Error>;
}

/// A node; what there is twice stands by direction.
pub struct Node {
    pub number: Option<u64>,
    pub interface_version: Option<u64>,
    pub routes: [&'static [Route]; 2],
    pub dispatchers: [Option<Dispatcher>; 2],
    /// The names of the members of each enumeration.
    pub enums: &'static [fn(&str) -> Option<&'static str>],
}

/// Name and re-encoding of the message of that id.
pub type Dispatcher = fn(u32, &[u8]) -> Result<(&'static str, Vec<u8>), Error>;

/// An id that leads to a message.
pub struct Route {
    pub id: u32,
    pub title: &'static str,
    pub answer: fn(&str, &mut Words, u32, Option<Dispatcher>) -> Answer,
}

pub fn answer(op: &str, words: &mut Words) -> Answer {
    let node = &NODES[words.number::<usize>()];
    if op == "enum" {
        let name_of = node.enums[words.number::<usize>()];
        return Ok(named(name_of(words.word())));
    }
    if op == "node" {
        let shown = |key: &str, number: Option<u64>| number.map(|one| format!(" {key}={one}"));
        let (number, version) = (node.number, node.interface_version);
        let found = [
            shown("node_type", number),
            shown("interface_version", version),
        ];
        return Ok(found.into_iter().flatten().collect());
    }
    let direction = words.number::<usize>();
    let word = words.word();
    let (id, name) = word
        .split_once(':')
        .map_or((word, None), |(id, name)| (id, Some(unhex(name))));
    let id = id.parse::<u32>().unwrap_or_default();
    let dispatcher = node.dispatchers[direction].ok_or_else(|| Refusal("unknown-id".into()))?;
    let found: Vec<_> = node.routes[direction]
        .iter()
        .filter(|route| route.id == id)
        .filter(|route| {
            name.as_deref()
                .map_or(true, |name| name == route.title.as_bytes())
        })
        .collect();
    match found[..] {
        [route] => (route.answer)(op, words, id, name.map_or(Some(dispatcher), |_| None)),
        [] => {
            dispatcher(id, &words.octets())?;
            Err(Refusal("dispatcher".into()))
        }
        _ => {
            let (title, bytes) = dispatcher(id, &words.octets())?;
            Ok(format!("{} bytes={}", named(Some(title)), hex(&bytes)))
        }
    }
}

/// Answers a request about message `M`, which `dispatcher`, if the id is its own, should decode alike.
pub fn message<M: Subject>(
    op: &str,
    words: &mut Words,
    id: u32,
    dispatcher: Option<Dispatcher>,
) -> Answer {
    match op {
        "decode" => decode::<M>(words, id, dispatcher),
        "encode" => encode::<M>(words),
        "constants" => Ok(constants::<M>()),
        _ => sweep::<M>(words),
    }
}

fn decode<M: Subject>(words: &mut Words, id: u32, dispatcher: Option<Dispatcher>) -> Answer {
    let bytes = words.octets();
    let mut message = M::decode(&bytes)?;
    if let Some(dispatcher) = dispatcher {
        let (title, again) = dispatcher(id, &bytes)?;
        if title != M::TITLE || again != message.encode()? {
            return Err(Refusal("dispatcher".into()));
        }
    }
    described(&mut message)
}

fn encode<M: Subject>(words: &mut Words) -> Answer {
    let mut message = M::default();
    let mut raw = Vec::new();
    for (place, field) in M::FIELDS.iter().enumerate() {
        if matches!(field.value, Place::View(_)) {
            break;
        }
        let (kind, given) = words.word().split_at(1);
        if kind == "r" {
            raw.push((place, field, given));
        }
        match (&field.scale, &field.text) {
            (Some(scale), _) if kind == "p" => (scale.set)(&mut message, double(given))?,
            (_, Some(text)) if kind == "p" => {
                (text.set)(&mut message, &String::from_utf8_lossy(&unhex(given)))?;
            }
            _ => take(field, place, &mut message, given)?,
        }
    }
    for (place, field, given) in raw {
        take(field, place, &mut message, given)?; // a text sets what counts it, too
    }
    described(&mut message)
}

fn double(bits: &str) -> f64 {
    f64::from_bits(bits.parse().unwrap_or_default())
}

fn take<M>(field: &Field<M>, place: usize, message: &mut M, given: &str) -> Result<(), Refusal> {
    let fits = match field.value {
        Place::Member(member) => member(message).take(given),
        Place::View(_) => true,
    };
    fits.then_some(())
        .ok_or_else(|| Refusal(format!("range at={place}")))
}

fn named(name: Option<&str>) -> String {
    name.map_or_else(String::new, |name| {
        format!(" name={}", hex(name.as_bytes()))
    })
}

fn described<M: Subject>(message: &mut M) -> Answer {
    let mut answer = format!(" bytes={}", hex(&message.encode()?));
    for field in M::FIELDS {
        let (raw, name) = field.show(message);
        let _ = write!(answer, " field raw={raw}{name}");
        if let Some(scale) = field.scale.as_ref().filter(|_| raw != "-") {
            let _ = write!(answer, " physical={}", (scale.get)(message).to_bits());
        }
        if let Some(said) = field.text.as_ref().and_then(|text| (text.get)(message)) {
            let _ = write!(answer, " physical={}", hex(said.as_bytes()));
        }
    }
    Ok(answer)
}

fn constants<M: Subject>() -> String {
    let ids = list(M::ids().iter().map(u32::to_string));
    let mut answer = format!("{} length={} ids={ids}", named(Some(M::TITLE)), M::BYTES);
    for field in M::FIELDS {
        let (fresh, _) = field.show(&mut M::default());
        let special = list((field.special)().iter().map(i128::to_string));
        let _ = write!(answer, " field raw={fresh} special={special}");
        for (key, bound) in (field.limits)() {
            let _ = write!(answer, " {key}={}", bound.to_bits());
        }
    }
    answer
}

fn sweep<M: Subject>(words: &mut Words) -> Answer {
    let place = words.number::<usize>();
    let field = &M::FIELDS[place];
    let scale = field.scale.as_ref();
    let scale = scale.ok_or_else(|| Refusal("unknown-field".into()))?;
    let mut answer = String::from(" values=");
    while words.more() {
        let mut message = M::default();
        take(field, place, &mut message, words.word())?;
        message.encode()?;
        let physical = (scale.get)(&message);
        let mut back = M::default();
        let set = (scale.set)(&mut back, physical);
        let back = set.map_or_else(|_| String::new(), |()| field.show(&mut back).0);
        let _ = write!(answer, "{},{back},", physical.to_bits());
    }
    Ok(answer)
}
