//! Pack: any value as JSON, with long arrays and what depends on the machine aside, and back again.

use std::collections::BTreeMap;

use ciborium::Value as Plain;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

/// Fewest numbers of an array that is written aside: fewer are shorter as text.
const FEWEST: usize = 32;

/// Key of the member that stands for an array.
const ARRAY: &str = "$array";

/// Key of the member that stands for a number that is not finite.
const FLOAT: &str = "$float";

/// Key of members that depend on the machine.
const MACHINE: &str = "machine";

/// A rectangular array of numbers, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Array {
    pub(crate) shape: Vec<u64>,
    pub(crate) numbers: Vec<f64>,
}

/// A value in parts.
#[derive(Debug, Default)]
pub(crate) struct Packed {
    pub(crate) json: Value,
    /// By name: that of the value and the path within it.
    pub(crate) arrays: BTreeMap<String, Array>,
    /// Members that depend on the machine, by the same names.
    pub(crate) machine: Map<String, Value>,
    /// The first value that no form of JSON stands for.
    lost: Option<String>,
}

impl Packed {
    /// Divides `value`, whose parts are named `name/...`.
    pub(crate) fn new(name: &str, value: &impl Serialize) -> Result<Self, String> {
        let plain = Plain::serialized(value).map_err(|error| error.to_string())?;
        let mut packed = Self::default();
        packed.json = packed.divided(name, plain);
        match packed.lost.take() {
            Some(name) => Err(format!("{name} has no form in JSON")),
            None => Ok(packed),
        }
    }

    fn divided(&mut self, name: &str, value: Plain) -> Value {
        match value {
            Plain::Map(members) => {
                let mut object = Map::new();
                for (key, value) in members {
                    let Some(key) = key.as_text() else {
                        return self.lose(name);
                    };
                    let name = format!("{name}/{key}");
                    let value = self.divided(&name, value);
                    if key == MACHINE {
                        self.machine.insert(name, value);
                    } else {
                        object.insert(key.to_owned(), value);
                    }
                }
                Value::Object(object)
            }
            Plain::Bytes(_) => match Array::of_rows(&[value]) {
                Some(Array { numbers, .. }) => {
                    let shape = vec![numbers.len() as u64];
                    self.set_aside(name, Array { shape, numbers }, false)
                }
                None => self.lose(name),
            },
            Plain::Array(values) => match Array::of_rows(&values)
                .map(|array| (array, false))
                .or_else(|| Array::of(&values))
            {
                Some((array, is_missing)) => self.set_aside(name, array, is_missing),
                None => {
                    let values = values.into_iter().enumerate();
                    let values =
                        values.map(|(i, value)| self.divided(&format!("{name}/{i}"), value));
                    Value::Array(values.collect())
                }
            },
            Plain::Float(number) if number.is_finite() => json!(number),
            Plain::Float(number) => json!({ FLOAT: number.to_string() }),
            Plain::Integer(number) => {
                let number = i128::from(number);
                match (u64::try_from(number), i64::try_from(number)) {
                    (Ok(number), _) => json!(number),
                    (_, Ok(number)) => json!(number),
                    _ => self.lose(name),
                }
            }
            Plain::Text(text) => Value::String(text),
            Plain::Bool(value) => Value::Bool(value),
            Plain::Null => Value::Null,
            _ => self.lose(name),
        }
    }

    fn lose(&mut self, name: &str) -> Value {
        self.lost.get_or_insert_with(|| name.to_owned());
        Value::Null
    }

    /// Writes an array aside, and what stands for it.
    fn set_aside(&mut self, name: &str, array: Array, is_missing: bool) -> Value {
        // Edges of bins are the same in all tallies of a case.
        let mut known = self.arrays.iter();
        let known = known.find_map(|(name, known)| (*known == array).then_some(name));
        let own = known.cloned().unwrap_or_else(|| name.to_owned());
        let mut reference = Map::from_iter([(ARRAY.to_owned(), json!(own))]);
        if is_missing {
            reference.insert("missing".to_owned(), json!("NaN"));
        }
        self.arrays.insert(own, array);
        Value::Object(reference)
    }

    /// The value, of which the arrays are looked up by name.
    pub(crate) fn joined<T: DeserializeOwned>(
        name: &str,
        json: Value,
        array: &mut dyn FnMut(&str) -> Result<Array, String>,
        machine: &Map<String, Value>,
    ) -> Result<T, String> {
        let plain = join(name, json, array, machine)?;
        plain.deserialized().map_err(|error| error.to_string())
    }
}

fn join(
    name: &str,
    value: Value,
    array: &mut dyn FnMut(&str) -> Result<Array, String>,
    machine: &Map<String, Value>,
) -> Result<Plain, String> {
    Ok(match value {
        Value::Object(object) => {
            if let Some(of) = object.get(ARRAY).and_then(Value::as_str) {
                return Ok(array(of)?.plain(object.contains_key("missing")));
            }
            if let Some(text) = object.get(FLOAT).and_then(Value::as_str) {
                let number = text.parse::<f64>();
                return number.map(Plain::Float).map_err(|error| error.to_string());
            }
            let mut members = Vec::new();
            for (key, value) in object {
                let value = join(&format!("{name}/{key}"), value, array, machine)?;
                members.push((Plain::Text(key), value));
            }
            let own = format!("{name}/{MACHINE}");
            if let Some(value) = machine.get(&own) {
                let value = join(&own, value.clone(), array, machine)?;
                members.push((Plain::Text(MACHINE.to_owned()), value));
            }
            Plain::Map(members)
        }
        Value::Array(values) => {
            let values = values.into_iter().enumerate();
            let values =
                values.map(|(i, value)| join(&format!("{name}/{i}"), value, array, machine));
            Plain::Array(values.collect::<Result<_, _>>()?)
        }
        Value::Number(number) => match (number.as_u64(), number.as_i64(), number.as_f64()) {
            (Some(number), ..) => Plain::Integer(number.into()),
            (_, Some(number), _) => Plain::Integer(number.into()),
            (.., number) => Plain::Float(number.unwrap_or(f64::NAN)),
        },
        Value::String(text) => Plain::Text(text),
        Value::Bool(value) => Plain::Bool(value),
        Value::Null => Plain::Null,
    })
}

impl Array {
    /// The array of the rows whose bytes these are; `None` unless there are rows, equally long ones.
    fn of_rows(rows: &[Plain]) -> Option<Self> {
        let row = rows.first()?.as_bytes()?.len();
        let mut numbers = Vec::new();
        for bytes in rows {
            let bytes = bytes.as_bytes().filter(|bytes| bytes.len() == row)?;
            let (of_row, rest) = bytes.as_chunks();
            if !rest.is_empty() {
                return None;
            }
            // All NaNs have one form.
            let number = |bytes| Some(f64::from_le_bytes(bytes)).filter(|x| !x.is_nan());
            numbers.extend(
                of_row
                    .iter()
                    .map(|bytes| number(*bytes).unwrap_or(f64::NAN)),
            );
        }
        let row = (row / size_of::<f64>()) as u64;
        let shape = vec![rows.len() as u64, row];
        Some(Self { shape, numbers })
    }

    /// The array that values make, and whether its NaNs stand for values that are not there. `None` unless they are many numbers of equally
    /// long rows, of which either some are NaN or some are missing.
    fn of(values: &[Plain]) -> Option<(Self, bool)> {
        let row = values.first()?.as_array().map(Vec::len);
        let mut numbers = Vec::with_capacity(values.len());
        let [mut has_nan, mut is_missing] = [false; 2];
        let mut push = |value: &Plain| match value {
            Plain::Float(number) => {
                has_nan |= number.is_nan();
                // All NaNs have one form.
                numbers.push(if number.is_nan() { f64::NAN } else { *number });
                Some(())
            }
            Plain::Null => {
                is_missing = true;
                numbers.push(f64::NAN);
                Some(())
            }
            _ => None,
        };
        let shape = match row {
            None => {
                values.iter().try_for_each(&mut push)?;
                vec![values.len() as u64]
            }
            Some(row) => {
                for value in values {
                    let of_row = value.as_array().filter(|of_row| of_row.len() == row)?;
                    of_row.iter().try_for_each(&mut push)?;
                }
                vec![values.len() as u64, row as u64]
            }
        };
        let is_worth = numbers.len() >= FEWEST && !(has_nan && is_missing);
        is_worth.then_some((Self { shape, numbers }, is_missing))
    }

    fn plain(self, is_missing: bool) -> Plain {
        let number = |number: f64| match is_missing && number.is_nan() {
            true => Plain::Null,
            false => Plain::Float(number),
        };
        let numbers = self.numbers.into_iter().map(number);
        match self.shape.as_slice() {
            [rows, row] => {
                let numbers: Vec<Plain> = numbers.collect();
                let rows = (0..*rows as usize).map(|i| {
                    let row = *row as usize;
                    Plain::Array(numbers[i * row..(i + 1) * row].to_vec())
                });
                Plain::Array(rows.collect())
            }
            _ => Plain::Array(numbers.collect()),
        }
    }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Serialize, Deserialize)]
    struct Thing {
        long: Vec<f64>,
        rows: Vec<Vec<f64>>,
        missing: Vec<Option<f64>>,
        both: Vec<Option<f64>>,
        short: Vec<f64>,
        single: [f64; 3],
        maybe: Option<f64>,
        counts: Vec<u64>,
        text: String,
        machine: Option<f64>,
    }

    #[test]
    fn every_number_comes_back_with_its_bits_and_nan_is_not_missing() {
        let mut long: Vec<f64> = (0..40).map(|i| 1.0 / f64::from(i)).collect();
        long[7] = f64::NAN;
        long[8] = -0.0;
        let mut missing: Vec<Option<f64>> = (0..40).map(|i| Some(f64::from(i).sqrt())).collect();
        missing[3] = None;
        let mut both = missing.clone();
        both[4] = Some(f64::NAN);
        let thing = Thing {
            rows: vec![long.clone(), vec![0.1; 40]],
            long,
            missing,
            both,
            short: vec![1.0, f64::INFINITY],
            single: [f64::NAN, f64::NEG_INFINITY, 1e-310],
            maybe: None,
            counts: vec![u64::MAX; 40],
            text: "one".to_owned(),
            machine: Some(1.5),
        };
        let packed = Packed::new("thing", &thing).unwrap();
        let names: Vec<&String> = packed.arrays.keys().collect();
        assert_eq!(names, ["thing/long", "thing/missing", "thing/rows"]);
        assert_eq!(packed.arrays["thing/rows"].shape, [2, 40]);
        assert!(packed.json.get("machine").is_none());
        let text = packed.json.to_string();
        let json: Value = serde_json::from_str(&text).unwrap();
        let mut array = |name: &str| Ok(packed.arrays[name].clone());
        let back: Thing = Packed::joined("thing", json, &mut array, &packed.machine).unwrap();
        assert_eq!(format!("{back:?}"), format!("{thing:?}"));
    }

    #[test]
    fn equal_arrays_are_written_once() {
        let twice = BTreeMap::from([("a", vec![0.5; 50]), ("b", vec![0.5; 50])]);
        let packed = Packed::new("x", &twice).unwrap();
        assert_eq!(packed.arrays.len(), 1);
        assert_eq!(packed.json["b"][ARRAY], "x/a");
    }
}
