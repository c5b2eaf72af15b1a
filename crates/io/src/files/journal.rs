//! Journal: an append-only file of records, each with its length and a checksum.
//!
//! A record is its length, 8 bytes, little endian, the MD5 of length and content, 16 bytes, and the content. What a killed process has
//! written of a record, and whatever follows a damaged one, is dropped.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use md5::{Digest, Md5};

use super::open::open;
use crate::error::{ReadError, ReadProblem, WriteError};

/// Bytes before the content of a record.
const HEAD: usize = 8 + 16;

/// A journal that is open for appending.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    end: u64,
}

/// The intact records of a journal.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct JournalRecords {
    /// Offset in bytes and content of each record.
    pub records: Vec<(u64, Vec<u8>)>,
    /// Offset in bytes of the end of the last one.
    pub end: u64,
    /// Number of bytes after it, which are not a whole record.
    pub dropped: u64,
}

impl Journal {
    /// Opens the journal `path` for appending at the offset `end`, and truncates it there. It is created if there is none.
    ///
    /// # Errors
    /// [`WriteError`] if the operating system refuses.
    pub fn open(path: impl AsRef<Path>, end: u64) -> Result<Self, WriteError> {
        let path = path.as_ref().to_owned();
        let open = || {
            let mut options = File::options();
            let file = options.read(true).write(true).create(true).truncate(false);
            let file = file.open(&path)?;
            file.set_len(end)?;
            Ok(file)
        };
        let file = open().map_err(WriteError::io(&path))?;
        Ok(Self { path, file, end })
    }

    /// Appends records, and returns the offset of each once all of them are on disk.
    ///
    /// # Errors
    /// [`WriteError`] if the operating system refuses, as where the disk is full.
    pub fn append(&mut self, records: &[Vec<u8>]) -> Result<Vec<u64>, WriteError> {
        let mut bytes = Vec::new();
        let mut begins = Vec::new();
        for record in records {
            begins.push(self.end + bytes.len() as u64);
            let length = (record.len() as u64).to_le_bytes();
            bytes.extend(length);
            bytes.extend(checksum(length, record));
            bytes.extend(record);
        }
        let write = || {
            (&self.file).seek(SeekFrom::Start(self.end))?;
            (&self.file).write_all(&bytes)?;
            self.file.sync_data()
        };
        write().map_err(WriteError::io(&self.path))?;
        self.end += bytes.len() as u64;
        Ok(begins)
    }

    /// Content of the record at the offset `begin`.
    ///
    /// # Errors
    /// [`ReadError`] if the operating system refuses, or the record is no longer as it was written.
    pub fn read(&self, begin: u64) -> Result<Vec<u8>, ReadError> {
        let read = || {
            (&self.file).seek(SeekFrom::Start(begin))?;
            next_record(&mut &self.file, self.end - begin)
        };
        let record = read().and_then(|record| record.ok_or(io::ErrorKind::UnexpectedEof.into()));
        record.map_err(ReadError::io(&self.path))
    }
}

/// Reads the records of the journal `path` up to the first that is torn or damaged; none if there is no such file, or it is empty.
///
/// # Errors
/// [`ReadError`] if the operating system refuses.
pub fn read_journal(path: impl AsRef<Path>) -> Result<JournalRecords, ReadError> {
    let path = path.as_ref();
    let (file, length) = match open(path) {
        Err(ReadProblem::NotFound | ReadProblem::Empty) => return Ok(JournalRecords::default()),
        opened => opened.map_err(|problem| problem.at(path))?,
    };
    let mut source = io::BufReader::with_capacity(1 << 16, file);
    let mut found = JournalRecords::default();
    loop {
        let left = length - found.end;
        let record = next_record(&mut source, left).map_err(ReadError::io(path))?;
        let Some(record) = record else {
            found.dropped = left;
            return Ok(found);
        };
        let end = found.end + (HEAD + record.len()) as u64;
        found.records.push((found.end, record));
        found.end = end;
    }
}

/// Next record of a source of at most `left` bytes; `None` if there is none, or it is torn or damaged.
fn next_record(source: &mut impl Read, left: u64) -> io::Result<Option<Vec<u8>>> {
    if left < HEAD as u64 {
        return Ok(None);
    }
    let (mut length, mut expected) = ([0; 8], [0; 16]);
    source.read_exact(&mut length)?;
    source.read_exact(&mut expected)?;
    let bytes = u64::from_le_bytes(length);
    if bytes > left - HEAD as u64 {
        return Ok(None);
    }
    let mut record = vec![0; bytes as usize];
    source.read_exact(&mut record)?;
    Ok((checksum(length, &record) == expected).then_some(record))
}

fn checksum(length: [u8; 8], record: &[u8]) -> [u8; 16] {
    let mut digest = Md5::new();
    digest.update(length);
    digest.update(record);
    digest.finalize().into()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn contents(path: &Path) -> Vec<Vec<u8>> {
        let found = read_journal(path).unwrap();
        found
            .records
            .into_iter()
            .map(|(_, record)| record)
            .collect()
    }

    #[test]
    fn a_tail_torn_at_any_byte_and_a_flipped_bit_cost_the_last_record_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        let records: Vec<Vec<u8>> = vec![b"first".to_vec(), Vec::new(), b"the last".to_vec()];
        let mut journal = Journal::open(&path, 0).unwrap();
        let begins = journal.append(&records).unwrap();
        assert_eq!(journal.read(begins[2]).unwrap(), records[2]);
        let whole = fs::read(&path).unwrap();
        assert_eq!(contents(&path), records);
        let last = begins[2] as usize;
        for length in last..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            let found = read_journal(&path).unwrap();
            assert_eq!(
                (found.end, found.dropped),
                (begins[2], (length - last) as u64)
            );
            assert_eq!(found.records.len(), 2);
            // The next run goes on behind what is whole.
            let mut journal = Journal::open(&path, found.end).unwrap();
            journal.append(&[b"again".to_vec()]).unwrap();
            assert_eq!(contents(&path).last().unwrap(), b"again");
        }
        for bit in 8 * last..8 * whole.len() {
            let mut flipped = whole.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            fs::write(&path, &flipped).unwrap();
            assert_eq!(contents(&path), records[..2], "bit {bit}");
        }
    }

    #[test]
    fn no_journal_has_no_records() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(contents(&folder.path().join("none")), Vec::<Vec<u8>>::new());
    }
}
