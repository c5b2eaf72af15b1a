//! NetCDF-3: labelled arrays with units and attributes, in the form with 64-bit offsets (CDF-2).

use std::cell::RefCell;
use std::fmt::Debug;
use std::io::{self, Cursor, Seek, SeekFrom, Write};
use std::rc::Rc;

use netcdf3::{DataSet, FileWriter, Version};

/// Values of a variable.
#[derive(Clone, Debug, PartialEq)]
pub enum NetCdfValues {
    /// Numbers, the last dimension fastest.
    Numbers(Vec<f64>),
    /// One text per element. A dimension for their characters is added.
    Texts(Vec<String>),
}

/// A variable: an array over named dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct NetCdfVariable {
    /// Name.
    pub name: String,
    /// Names of its dimensions; those of a coordinate have its own name alone.
    pub dimensions: Vec<String>,
    /// Values.
    pub values: NetCdfValues,
    /// Attributes: names and texts.
    pub attributes: Vec<(&'static str, String)>,
}

/// A file: dimensions, variables and attributes of the whole.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NetCdf {
    /// Names and lengths of dimensions.
    pub dimensions: Vec<(String, usize)>,
    /// Variables, in the order of the file.
    pub variables: Vec<NetCdfVariable>,
    /// Attributes of the whole: names and texts.
    pub attributes: Vec<(&'static str, String)>,
}

impl NetCdf {
    /// Contents of the file.
    ///
    /// # Errors
    /// A sentence if a name is not allowed or given twice, a dimension is empty, or a variable has not as many values as its dimensions.
    pub fn bytes(&self) -> Result<Vec<u8>, String> {
        let mut set = DataSet::new();
        for (name, length) in &self.dimensions {
            set.add_fixed_dim(name, *length).map_err(in_words)?;
        }
        for (name, text) in &self.attributes {
            set.add_global_attr_string(name, text).map_err(in_words)?;
        }
        let mut texts = Vec::new();
        for variable in &self.variables {
            let mut dimensions = variable.dimensions.clone();
            let name = &variable.name;
            match &variable.values {
                NetCdfValues::Numbers(_) => {
                    set.add_var_f64(name, &dimensions).map_err(in_words)?;
                }
                NetCdfValues::Texts(values) => {
                    let length = values.iter().map(String::len).max().unwrap_or(0).max(1);
                    let characters = format!("{name}_length");
                    set.add_fixed_dim(&characters, length).map_err(in_words)?;
                    dimensions.push(characters);
                    set.add_var_u8(name, &dimensions).map_err(in_words)?;
                    // By which readers in Python make texts of the characters
                    set.add_var_attr_string(name, "_Encoding", "utf-8")
                        .map_err(in_words)?;
                    let padded = values.iter().flat_map(|text| {
                        let bytes = text.bytes().chain(std::iter::repeat(0));
                        bytes.take(length)
                    });
                    texts.push(padded.collect::<Vec<u8>>());
                }
            }
            for (attribute, text) in &variable.attributes {
                set.add_var_attr_string(name, attribute, text)
                    .map_err(in_words)?;
            }
        }
        let bytes = SharedBytes::default();
        let output = Box::new(bytes.clone());
        let mut writer = FileWriter::open_seek_write("", output).map_err(in_words)?;
        writer
            .set_def(&set, Version::Offset64Bit, 0)
            .map_err(in_words)?;
        let mut texts = texts.iter();
        for variable in &self.variables {
            let name = &variable.name;
            match &variable.values {
                NetCdfValues::Numbers(values) => writer.write_var_f64(name, values),
                NetCdfValues::Texts(_) => {
                    writer.write_var_u8(name, texts.next().map_or(&[], Vec::as_slice))
                }
            }
            .map_err(in_words)?;
        }
        writer.close().map_err(in_words)?;
        let bytes = bytes.0.borrow();
        Ok(bytes.get_ref().clone())
    }
}

fn in_words(error: impl Debug) -> String {
    format!("{error:?}")
}

/// Bytes that a writer fills, which takes its output for itself.
#[derive(Clone, Default)]
struct SharedBytes(Rc<RefCell<Cursor<Vec<u8>>>>);

impl Write for SharedBytes {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for SharedBytes {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.borrow_mut().seek(to)
    }
}
