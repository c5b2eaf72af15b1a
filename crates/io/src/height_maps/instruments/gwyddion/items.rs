//! Items of an object: name, a letter for the type, value. Objects inside are read by who asks for them.

use crate::error::ReadProblem;
use crate::height_maps::instruments::bytes::Bytes;

/// A value, as far as readers of heights need it.
pub(super) enum Item<'a> {
    Whole(i32),
    Number(f64),
    Text(String),
    /// Place of the first and count of numbers in double precision.
    Numbers((usize, u64)),
    Object(Items<'a>),
    Other,
}

/// The items of an object, one after the other.
pub(super) struct Items<'a> {
    file: Bytes<'a>,
    /// Name of the object's type.
    pub(super) object: String,
    at: usize,
    end: usize,
}

impl<'a> Items<'a> {
    /// The items of the container that the file is.
    pub(super) fn of_file(file: &Bytes<'a>) -> Result<Self, ReadProblem> {
        let mut all = Self {
            file: *file,
            object: String::new(),
            at: 4,
            end: file.all.len(),
        };
        let container = all.take_object()?;
        if container.object != "GwyContainer" {
            return Err(ReadProblem::malformed("it holds no GwyContainer"));
        }
        Ok(container)
    }

    /// The next item and its name.
    pub(super) fn next(&mut self) -> Result<Option<(String, Item<'a>)>, ReadProblem> {
        if self.at >= self.end {
            return Ok(None);
        }
        let name = self.take_text()?;
        let at = self.take(1)?;
        let letter = self.file.u8(at)?;
        let item = match letter {
            b'b' | b'c' => self.skip(1)?,
            b'i' => {
                let at = self.take(4)?;
                Item::Whole(self.file.i32(at)?)
            }
            b'q' => self.skip(8)?,
            b'd' => {
                let at = self.take(8)?;
                Item::Number(self.file.f64(at)?)
            }
            b's' => Item::Text(self.take_text()?),
            b'o' => Item::Object(self.take_object()?),
            b'C' | b'I' | b'Q' => {
                let width = [(b'C', 1), (b'I', 4)].iter().find(|(l, _)| *l == letter);
                let width = width.map_or(8, |(_, width)| *width);
                let count = self.take_count()?;
                self.skip(count.saturating_mul(width))?
            }
            b'D' => {
                let count = self.take_count()?;
                let at = self.take(count.saturating_mul(8))?;
                Item::Numbers((at, count as u64))
            }
            b'S' => {
                for _ in 0..self.take_count()? {
                    self.take_text()?;
                }
                Item::Other
            }
            b'O' => {
                for _ in 0..self.take_count()? {
                    self.take_object()?;
                }
                Item::Other
            }
            other => {
                return Err(ReadProblem::malformed(format_args!(
                    "an item is of the unknown type `{}`",
                    char::from(other).escape_default()
                )));
            }
        };
        Ok(Some((name, item)))
    }

    /// Moves on by `count` bytes; returns where they begin.
    fn take(&mut self, count: usize) -> Result<usize, ReadProblem> {
        let at = self.at;
        self.file.part(at, count)?;
        self.at += count;
        if self.at > self.end {
            return Err(ReadProblem::malformed(
                "an item is longer than the object that holds it",
            ));
        }
        Ok(at)
    }

    fn skip(&mut self, count: usize) -> Result<Item<'a>, ReadProblem> {
        self.take(count)?;
        Ok(Item::Other)
    }

    fn take_count(&mut self) -> Result<usize, ReadProblem> {
        let at = self.take(4)?;
        Ok(self.file.u32(at)? as usize)
    }

    /// A text up to its NUL byte.
    fn take_text(&mut self) -> Result<String, ReadProblem> {
        let rest = self.file.all.get(self.at..self.end).unwrap_or_default();
        let length = rest
            .iter()
            .position(|byte| *byte == 0)
            .ok_or_else(|| ReadProblem::truncated("a text does not end in a NUL byte"))?;
        self.at += length + 1;
        Ok(String::from_utf8_lossy(&rest[..length]).into_owned())
    }

    fn take_object(&mut self) -> Result<Items<'a>, ReadProblem> {
        let object = self.take_text()?;
        let count = self.take_count()?;
        let at = self.take(count)?;
        Ok(Items {
            file: self.file,
            object,
            at,
            end: at + count,
        })
    }
}
