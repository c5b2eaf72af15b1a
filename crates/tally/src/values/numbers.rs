//! Numbers: the written form of a list of numbers, which is bytes in formats that nobody reads.

use std::borrow::Cow;
use std::fmt;

use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Bytes of a number.
const BYTES: usize = size_of::<f64>();

/// A list of numbers: a sequence in formats that people read, and little-endian bytes in others, which is many times faster.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers<'a>(pub Cow<'a, [f64]>);

impl Serialize for Numbers<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() {
            return self.0.serialize(serializer);
        }
        let mut bytes = Vec::with_capacity(BYTES * self.0.len());
        self.0
            .iter()
            .for_each(|number| bytes.extend(number.to_le_bytes()));
        serializer.serialize_bytes(&bytes)
    }
}

impl<'de> Deserialize<'de> for Numbers<'static> {
    /// Reads either form.
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        if source.is_human_readable() {
            return Vec::deserialize(source).map(|numbers| Self(numbers.into()));
        }
        source
            .deserialize_any(AnyForm)
            .map(|numbers| Self(numbers.into()))
    }
}

struct AnyForm;

impl<'de> Visitor<'de> for AnyForm {
    type Value = Vec<f64>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("numbers, or their bytes")
    }

    fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Vec<f64>, E> {
        let (numbers, rest) = bytes.as_chunks::<BYTES>();
        match rest.is_empty() {
            true => Ok(numbers
                .iter()
                .map(|bytes| f64::from_le_bytes(*bytes))
                .collect()),
            false => Err(E::invalid_length(bytes.len(), &self)),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<f64>, A::Error> {
        let mut numbers = Vec::new();
        while let Some(number) = list.next_element()? {
            numbers.push(number);
        }
        Ok(numbers)
    }
}
