//! Arrays of rows of bytes, of any length, for serde, which itself ends at 32.

use super::array;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

#[derive(Clone, Copy)]
struct Row<const SIZE: usize>([u8; SIZE]);

impl<const SIZE: usize> Default for Row<SIZE> {
    fn default() -> Self {
        Self([0; SIZE])
    }
}

impl<const SIZE: usize> Serialize for Row<SIZE> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        array::serialize(&self.0, serializer)
    }
}

impl<'de, const SIZE: usize> Deserialize<'de> for Row<SIZE> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        array::deserialize(deserializer).map(Self)
    }
}

pub(crate) fn serialize<S: Serializer, const SIZE: usize, const N: usize>(
    rows: &[[u8; SIZE]; N],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    array::serialize(&rows.map(Row), serializer)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>, const SIZE: usize, const N: usize>(
    deserializer: D,
) -> Result<[[u8; SIZE]; N], D::Error> {
    let rows: [Row<SIZE>; N] = array::deserialize(deserializer)?;
    Ok(rows.map(|row| row.0))
}
