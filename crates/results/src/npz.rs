//! NPZ: the file of results, a zip of NPY arrays and JSON that `numpy.load` opens.

use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};

use npyz::{NpyFile, WriterBuilder};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use crate::pack::{Array, Packed};

/// Name of the member with what depends on the machine.
const MACHINE: &str = "machine.json";

/// Members that depend on the machine: written or left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Machines {
    /// It is.
    Named,
    /// It is not, so that equal results have equal bytes.
    LeftOut,
}

/// Writes members one after the other. The bytes depend on the members alone.
pub(crate) struct NpzWriter {
    archive: ZipWriter<Cursor<Vec<u8>>>,
    machine: Map<String, Value>,
}

impl NpzWriter {
    pub(crate) fn new() -> Self {
        Self {
            archive: ZipWriter::new(Cursor::new(Vec::new())),
            machine: Map::new(),
        }
    }

    /// Adds a value as `name.json`, with its arrays.
    pub(crate) fn add(&mut self, name: &str, value: &impl Serialize) -> Result<(), String> {
        let packed = Packed::new(name, value)?;
        self.machine.extend(packed.machine);
        self.add_bytes(&format!("{name}.json"), packed.json.to_string().as_bytes())?;
        for (name, array) in &packed.arrays {
            self.add_bytes(&format!("{name}.npy"), &npy(array)?)?;
        }
        Ok(())
    }

    /// Adds a member as it is.
    pub(crate) fn add_bytes(&mut self, name: &str, bytes: &[u8]) -> Result<(), String> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(zip::DateTime::default())
            .unix_permissions(0o644)
            .large_file(bytes.len() >= u32::MAX as usize);
        let started = self.archive.start_file(name, options);
        started.map_err(|error| error.to_string())?;
        let written = self.archive.write_all(bytes);
        written.map_err(|error| error.to_string())
    }

    /// The whole file.
    pub(crate) fn finish(mut self, machines: Machines) -> Result<Vec<u8>, String> {
        if machines == Machines::Named {
            let machine = Value::Object(std::mem::take(&mut self.machine));
            self.add_bytes(MACHINE, machine.to_string().as_bytes())?;
        }
        let bytes = self.archive.finish().map_err(|error| error.to_string())?;
        Ok(bytes.into_inner())
    }
}

/// Reads members in any order. Every error says that the file is damaged.
pub(crate) struct NpzReader {
    archive: ZipArchive<Cursor<Vec<u8>>>,
    machine: Map<String, Value>,
}

impl NpzReader {
    pub(crate) fn new(bytes: Vec<u8>) -> Result<Self, String> {
        let archive = ZipArchive::new(Cursor::new(bytes))
            .map_err(|error| format!("no archive of results: {error}"))?;
        let mut reader = Self {
            archive,
            machine: Map::new(),
        };
        if reader.has(MACHINE) {
            let bytes = reader.bytes(MACHINE)?;
            reader.machine = serde_json::from_slice(&bytes).map_err(|error| error.to_string())?;
        }
        Ok(reader)
    }

    pub(crate) fn has(&self, name: &str) -> bool {
        self.archive.index_for_name(name).is_some()
    }

    /// A member as it is, whose checksum is right.
    pub(crate) fn bytes(&mut self, name: &str) -> Result<Vec<u8>, String> {
        let mut bytes = Vec::new();
        let member = self.archive.by_name(name);
        let mut member = member.map_err(|error| format!("{name}: {error}"))?;
        let read = member.read_to_end(&mut bytes);
        read.map_err(|error| format!("{name}: {error}"))?;
        Ok(bytes)
    }

    /// The JSON of a value, without its arrays.
    pub(crate) fn json(&mut self, name: &str) -> Result<Value, String> {
        let bytes = self.bytes(&format!("{name}.json"))?;
        serde_json::from_slice(&bytes).map_err(|error| format!("{name}: {error}"))
    }

    /// A value with its arrays.
    pub(crate) fn value<T: DeserializeOwned>(&mut self, name: &str) -> Result<T, String> {
        let json = self.json(name)?;
        let machine = std::mem::take(&mut self.machine);
        let mut known = BTreeMap::new();
        let mut array = |of: &str| match known.get(of) {
            Some(array) => Ok(Array::clone(array)),
            None => {
                let array = from_npy(&self.bytes(&format!("{of}.npy"))?)?;
                known.insert(of.to_owned(), array.clone());
                Ok(array)
            }
        };
        let value = Packed::joined(name, json, &mut array, &machine);
        self.machine = machine;
        value.map_err(|error| format!("{name}: {error}"))
    }
}

fn npy(array: &Array) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let writer = npyz::WriteOptions::<f64>::new().default_dtype();
    let writer = writer.shape(&array.shape).writer(&mut bytes).begin_nd();
    let write = || -> std::io::Result<()> {
        let mut writer = writer?;
        writer.extend(array.numbers.iter().copied())?;
        writer.finish()
    };
    write().map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Reads an array as [`npy`] writes them: version 1, whose header is short, and no more numbers than the bytes hold.
fn from_npy(bytes: &[u8]) -> Result<Array, String> {
    const VERSION: usize = 6;
    if bytes.get(VERSION) != Some(&1) {
        return Err("an array is of another version of NPY".to_owned());
    }
    let read = || -> std::io::Result<Option<Array>> {
        let file = NpyFile::new(bytes)?;
        let shape = file.shape().to_vec();
        let most = (bytes.len() / size_of::<f64>()) as u64;
        let claims = shape.iter().scan(1_u64, |count, side| {
            *count = count.saturating_mul(*side);
            Some((*count).max(*side))
        });
        if claims.max().is_some_and(|claim| claim > most) {
            return Ok(None);
        }
        let numbers = file.into_vec()?;
        Ok(Some(Array { shape, numbers }))
    };
    let array = read().map_err(|error| error.to_string())?;
    array.ok_or_else(|| "an array claims more numbers than there are".to_owned())
}
