//! Values of a configuration: numbers, counts, lists and pairs.

use serde::{Deserialize, Deserializer, Serialize};

use crate::config::ConfigError;
use crate::number::{count_from_number, parse_count, parse_number};

/// A number, written as one or as a quotient of two in quotes, as in `"1/1.4"`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Number(pub f64);

/// A whole number of one or more, also written as `1e6`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Count(pub u64);

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number, or a quotient of two in quotes as in \"1/1.4\""
)]
enum Written {
    Whole(i64),
    Decimal(f64),
    Text(String),
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Written::deserialize(deserializer)? {
            Written::Whole(value) => Ok(Self(value as f64)),
            Written::Decimal(value) => Ok(Self(value)),
            Written::Text(text) => parse_number(&text)
                .map(Self)
                .map_err(serde::de::Error::custom),
        }
    }
}

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let count = match Written::deserialize(deserializer)? {
            Written::Whole(value) => u64::try_from(value)
                .ok()
                .filter(|&n| n > 0)
                .ok_or_else(|| format!("{value} is no count; it must be 1 or more")),
            Written::Decimal(value) => {
                count_from_number(value).map_err(|reason| format!("{value} {reason}"))
            }
            Written::Text(text) => parse_count(&text),
        };
        count.map(Self).map_err(serde::de::Error::custom)
    }
}

/// One value, or a list of values to go through.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected one value or a list of values")]
pub enum OneOrMany<T> {
    /// One value.
    One(T),
    /// A list.
    Many(Vec<T>),
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected one value, or two as [along x, along y]"
)]
pub enum PerAxis<T> {
    /// The same along both axes.
    Both(T),
    /// `[along x, along y]`.
    Each([T; 2]),
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
