//! Tensor file: named arrays in the container of the `.bsdf` and `.pbsdf` files of Mitsuba 3 and pbrt-v4.
//!
//! Little endian: `tensor_file` and a zero, the version 1.0, the number of fields as u32; for each field the length of its name as u16, the
//! name, the number of dimensions as u16, the type as u8, the offset of its data as u64, and the lengths of its dimensions as u64; then the data,
//! the last dimension fastest, each field at a multiple of 8 bytes.

/// Values of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Tensor {
    /// Bytes: one dimension.
    Bytes(Vec<u8>),
    /// Unsigned 16-bit numbers: one dimension.
    Shorts(Vec<u16>),
    /// Single-precision numbers, and the lengths of their dimensions.
    Numbers(Vec<usize>, Vec<f32>),
}

impl Tensor {
    fn lengths(&self) -> Vec<usize> {
        match self {
            Self::Bytes(bytes) => vec![bytes.len()],
            Self::Shorts(shorts) => vec![shorts.len()],
            Self::Numbers(lengths, _) => lengths.clone(),
        }
    }

    /// Code of the type.
    const fn code(&self) -> u8 {
        match self {
            Self::Bytes(_) => 1,
            Self::Shorts(_) => 3,
            Self::Numbers(..) => 10,
        }
    }

    fn data(&self) -> Vec<u8> {
        match self {
            Self::Bytes(bytes) => bytes.clone(),
            Self::Shorts(shorts) => shorts.iter().flat_map(|x| x.to_le_bytes()).collect(),
            Self::Numbers(_, numbers) => numbers.iter().flat_map(|x| x.to_le_bytes()).collect(),
        }
    }
}

const MAGIC: &[u8] = b"tensor_file\0\x01\x00";

/// Contents of a tensor file of named fields.
///
/// # Panics
/// If a field has not as many numbers as its dimensions, or a name has more than 65,535 bytes.
#[must_use]
pub fn tensor_file(fields: &[(&str, Tensor)]) -> Vec<u8> {
    let head = |(name, tensor): &(&str, Tensor)| 2 + name.len() + 11 + 8 * tensor.lengths().len();
    let start = MAGIC.len() + 4 + fields.iter().map(head).sum::<usize>();
    let mut bytes = [MAGIC, &(fields.len() as u32).to_le_bytes()].concat();
    let mut data = Vec::new();
    for (name, tensor) in fields {
        let lengths = tensor.lengths();
        if let Tensor::Numbers(_, numbers) = tensor {
            assert_eq!(lengths.iter().product::<usize>(), numbers.len(), "{name}");
        }
        data.resize((start + data.len()).next_multiple_of(8) - start, 0);
        let length = u16::try_from(name.len()).expect("a name has at most 65,535 bytes");
        bytes.extend(length.to_le_bytes());
        bytes.extend(name.as_bytes());
        bytes.extend((lengths.len() as u16).to_le_bytes());
        bytes.push(tensor.code());
        bytes.extend(((start + data.len()) as u64).to_le_bytes());
        bytes.extend(lengths.iter().flat_map(|&n| (n as u64).to_le_bytes()));
        data.extend(tensor.data());
    }
    bytes.extend(data);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_lie_where_the_head_says() {
        let fields = [
            ("description", Tensor::Bytes(b"abc".to_vec())),
            ("theta_i", Tensor::Numbers(vec![2, 1], vec![0.5, 1.5])),
        ];
        let bytes = tensor_file(&fields);
        assert_eq!(&bytes[..14], b"tensor_file\0\x01\x00");
        assert_eq!(&bytes[14..18], [2, 0, 0, 0]);
        // Length of the name, name, dimensions, type, offset, lengths
        assert_eq!(&bytes[18..31], b"\x0b\x00description");
        assert_eq!(&bytes[31..34], [1, 0, 1]);
        let number =
            |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("8 bytes")) as usize;
        let (first, length) = (number(34), number(42));
        assert_eq!((first % 8, length), (0, 3));
        assert_eq!(&bytes[first..first + 3], b"abc");
        assert_eq!(&bytes[50..59], b"\x07\x00theta_i");
        assert_eq!(&bytes[59..62], [2, 0, 10]);
        let second = number(62);
        assert_eq!([number(70), number(78)], [2, 1]);
        assert_eq!(second % 8, 0);
        assert_eq!(bytes[second..], [0, 0, 0, 0x3f, 0, 0, 0xc0, 0x3f]);
    }
}
