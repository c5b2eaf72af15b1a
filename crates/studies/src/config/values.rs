//! Values of a configuration: numbers, counts, lists and pairs.

use std::str::FromStr;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::config::error::ConfigError;

/// A number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Number(pub f64);

/// A whole number of one or more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Count(pub u64);

/// A time above zero, in seconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Seconds(pub f64);

impl Seconds {
    /// Returns the duration; `None` if it is longer than any clock can tell.
    #[must_use]
    pub fn duration(self) -> Option<Duration> {
        Duration::try_from_secs_f64(self.0).ok()
    }
}

/// A value, or `auto`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum OrAuto<T> {
    /// Chosen by the program.
    Auto(Auto),
    /// A value.
    Named(T),
}

/// The name `auto`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Auto {
    /// The only one.
    Auto,
}

impl<T: Copy> OrAuto<T> {
    /// The value; `None` where the program chooses.
    pub(crate) const fn named(self) -> Option<T> {
        match self {
            Self::Auto(_) => None,
            Self::Named(value) => Some(value),
        }
    }
}

/// `auto`, or the text of a value.
impl<T: FromStr> FromStr for OrAuto<T> {
    type Err = T::Err;

    fn from_str(text: &str) -> Result<Self, T::Err> {
        match text {
            "auto" => Ok(Self::Auto(Auto::Auto)),
            value => value.parse().map(Self::Named),
        }
    }
}

/// One value, or a list of values that are expanded into cases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum OneOrMany<T> {
    /// One value.
    One(T),
    /// A list.
    Many(Vec<T>),
}

impl<T> OneOrMany<T> {
    /// As many values, by a function of each.
    pub(crate) fn map<U>(self, of: impl Fn(T) -> U) -> OneOrMany<U> {
        match self {
            Self::One(value) => OneOrMany::One(of(value)),
            Self::Many(values) => OneOrMany::Many(values.into_iter().map(of).collect()),
        }
    }

    /// All values, none of an empty list.
    pub fn as_slice(&self) -> &[T] {
        match self {
            Self::One(value) => std::slice::from_ref(value),
            Self::Many(values) => values,
        }
    }
}

impl<T: Copy> OneOrMany<T> {
    /// The value, of a configuration without lists; `name` is that of the setting.
    ///
    /// # Errors
    /// [`ConfigError`] if there are none or several.
    pub fn one(&self, name: &'static str) -> Result<T, ConfigError> {
        match self.values(name)?[..] {
            [value] => Ok(value),
            ref values => Err(ConfigError::unsuitable(
                format!("{} values of {name}", values.len()),
                "must be one value",
            )),
        }
    }

    /// The first value, for what does not depend on which it is; `None` of an empty list, which is refused elsewhere.
    pub(crate) fn first(&self) -> Option<T> {
        self.as_slice().first().copied()
    }

    /// All values; `name` is that of the setting.
    ///
    /// # Errors
    /// [`ConfigError::Unsuitable`] for a list without values.
    pub fn values(&self, name: &'static str) -> Result<Vec<T>, ConfigError> {
        match self.as_slice() {
            [] => Err(ConfigError::unsuitable(
                format!("{name} = []"),
                "must be one value or several",
            )),
            values => Ok(values.to_vec()),
        }
    }
}

/// One value for both axes, or `[along x, along y]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum PerAxis<T> {
    /// One value along both axes.
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
