//! Values of a configuration: numbers, counts, lists and pairs.

use std::str::FromStr;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

use crate::config::ConfigError;
use crate::number::{
    count_from_number, order_from_count, parse_count, parse_number, parse_seconds,
    seconds_from_number,
};

/// A number, written as one or as a quotient of two in quotes, as in `"1/1.4"`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Number(pub f64);

/// A whole number of one or more, also written as `1e6`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Count(pub u64);

/// A time of more than none in seconds, also written as `"10m"` or `"2h"`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Seconds(pub f64);

/// A value as it stands in the file, before it is checked.
#[derive(Clone, Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number, or a quotient of two in quotes as in \"1/1.4\""
)]
pub enum Written {
    /// A whole number.
    Whole(i64),
    /// A decimal number.
    Decimal(f64),
    /// Text in quotes.
    Text(String),
}

/// One value or several, before they are checked.
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number, a quotient of two in quotes as in \"1/1.4\", or a list of such"
)]
enum WrittenList {
    One(Written),
    Many(Vec<Written>),
}

impl TryFrom<Written> for Number {
    type Error = String;

    fn try_from(written: Written) -> Result<Self, String> {
        match written {
            Written::Whole(value) => Ok(Self(value as f64)),
            Written::Decimal(value) => Ok(Self(value)),
            Written::Text(text) => parse_number(&text).map(Self),
        }
    }
}

impl TryFrom<Written> for Count {
    type Error = String;

    fn try_from(written: Written) -> Result<Self, String> {
        match written {
            Written::Whole(value) => parse_count(&value.to_string()),
            Written::Decimal(value) => {
                count_from_number(value).map_err(|reason| format!("{value} {reason}"))
            }
            Written::Text(text) => parse_count(&text),
        }
        .map(Self)
    }
}

impl<'de> Deserialize<'de> for Seconds {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Written::deserialize(deserializer)? {
            Written::Whole(value) => seconds_from_number(value as f64),
            Written::Decimal(value) => seconds_from_number(value),
            Written::Text(text) => parse_seconds(&text),
        }
        .map(Self)
        .map_err(D::Error::custom)
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Written::deserialize(deserializer)?
            .try_into()
            .map_err(D::Error::custom)
    }
}

/// An order of interaction, written as a count.
pub(crate) fn order<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    let Count(count) = Count::deserialize(deserializer)?;
    order_from_count(count).map_err(D::Error::custom)
}

/// One name in quotes or several.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a name in quotes, or a list of such")]
enum WrittenNames {
    One(String),
    Many(Vec<String>),
}

/// One of several things known by name, or a list of them.
pub(crate) fn names<'de, D, T>(deserializer: D) -> Result<OneOrMany<T>, D::Error>
where
    D: Deserializer<'de>,
    T: FromStr<Err = String>,
{
    match WrittenNames::deserialize(deserializer)? {
        WrittenNames::One(name) => name.parse().map(OneOrMany::One),
        WrittenNames::Many(names) => names
            .iter()
            .map(|name| name.parse())
            .collect::<Result<_, _>>()
            .map(OneOrMany::Many),
    }
    .map_err(D::Error::custom)
}

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Written::deserialize(deserializer)?
            .try_into()
            .map_err(D::Error::custom)
    }
}

/// One value, or a list of values to go through.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OneOrMany<T> {
    /// One value.
    One(T),
    /// A list.
    Many(Vec<T>),
}

impl<'de, T: TryFrom<Written, Error = String>> Deserialize<'de> for OneOrMany<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match WrittenList::deserialize(deserializer)? {
            WrittenList::One(value) => T::try_from(value).map(Self::One),
            WrittenList::Many(values) => values
                .into_iter()
                .map(T::try_from)
                .collect::<Result<_, _>>()
                .map(Self::Many),
        }
        .map_err(D::Error::custom)
    }
}

impl<T: Copy> OneOrMany<T> {
    pub(crate) fn values(&self, name: &'static str) -> Result<Vec<T>, ConfigError> {
        match self {
            Self::One(value) => Ok(vec![*value]),
            Self::Many(values) if values.is_empty() => Err(ConfigError::EmptyList(name)),
            Self::Many(values) => Ok(values.clone()),
        }
    }
}

/// One value for both axes, or `[along x, along y]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum PerAxis<T> {
    /// The same along both axes.
    Both(T),
    /// `[along x, along y]`.
    Each([T; 2]),
}

impl<'de, T: TryFrom<Written, Error = String>> Deserialize<'de> for PerAxis<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match WrittenList::deserialize(deserializer)? {
            WrittenList::One(value) => T::try_from(value).map(Self::Both),
            WrittenList::Many(values) => match <[Written; 2]>::try_from(values) {
                Ok([x, y]) => T::try_from(x).and_then(|x| Ok(Self::Each([x, T::try_from(y)?]))),
                Err(values) => Err(format!(
                    "{} values were given; give one for both axes, or two as [along x, along y]",
                    values.len()
                )),
            },
        }
        .map_err(D::Error::custom)
    }
}

impl<T: Copy> PerAxis<T> {
    /// `[along x, along y]`.
    pub const fn xy(self) -> [T; 2] {
        match self {
            Self::Both(value) => [value; 2],
            Self::Each(values) => values,
        }
    }
}
