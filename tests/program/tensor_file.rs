//! Tensor files of measured materials, as their readers take them.

use std::collections::BTreeMap;

/// Fields of a tensor file: lengths of their dimensions, and numbers.
pub(crate) struct TensorFile(BTreeMap<String, (Vec<usize>, Vec<f64>)>);

impl TensorFile {
    pub(crate) fn read(bytes: &[u8]) -> Self {
        let number = |at: usize, size: usize| {
            let digits = bytes[at..at + size].iter().rev();
            digits.fold(0_u64, |sum, byte| 256 * sum + u64::from(*byte)) as usize
        };
        assert_eq!(&bytes[..14], b"tensor_file\0\x01\x00");
        let mut at = 18;
        let mut fields = BTreeMap::new();
        for _ in 0..number(14, 4) {
            let end = at + 2 + number(at, 2);
            let name = String::from_utf8(bytes[at + 2..end].to_vec()).unwrap();
            let (dimensions, code, start) = (number(end, 2), bytes[end + 2], number(end + 3, 8));
            at = end + 11 + 8 * dimensions;
            let lengths: Vec<usize> = (0..dimensions)
                .map(|i| number(end + 11 + 8 * i, 8))
                .collect();
            let count = lengths.iter().product();
            let value = |i: usize| match code {
                10 => f32::from_bits(number(start + 4 * i, 4) as u32).into(),
                3 => number(start + 2 * i, 2) as f64,
                _ => f64::from(bytes[start + i]),
            };
            fields.insert(name, (lengths, (0..count).map(value).collect()));
        }
        Self(fields)
    }

    pub(crate) fn lengths(&self, name: &str) -> &[usize] {
        &self.0[name].0
    }

    pub(crate) fn numbers(&self, name: &str) -> &[f64] {
        &self.0[name].1
    }
}
