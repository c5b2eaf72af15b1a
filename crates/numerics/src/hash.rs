//! Hash of names and of checksums.

use std::borrow::Borrow;

/// FNV-1a of 64 bits, for names of random streams and for checksums against accidental changes. It is not
/// cryptographic.
///
/// ```
/// // The test vectors of Fowler, Noll and Vo.
/// assert_eq!(asperity_numerics::fnv1a(b""), 0xcbf2_9ce4_8422_2325);
/// assert_eq!(asperity_numerics::fnv1a(b"foobar"), 0x8594_4171_f739_67e8);
/// ```
///
/// # Source
/// Fowler, Noll and Vo, The FNV Non-Cryptographic Hash Algorithm, RFC 9923.
#[must_use]
pub fn fnv1a(bytes: impl IntoIterator<Item = impl Borrow<u8>>) -> u64 {
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte.borrow())).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Hash of the bits of numbers, for checksums of many of them against accidental changes. It is not cryptographic.
///
/// Words take turns in four chains of `(h ^ word) * odd` and a rotation, each of which is reversible, so that a change of one number is always noticed.
///
/// ```
/// use asperity_numerics::hash_numbers;
///
/// assert_ne!(hash_numbers([1.0, 2.0]), hash_numbers([2.0, 1.0]));
/// assert_ne!(hash_numbers([0.0]), hash_numbers([0.0, 0.0]));
/// ```
#[must_use]
pub fn hash_numbers(numbers: impl IntoIterator<Item = f64>) -> u64 {
    const ODD: u64 = 0x9e37_79b9_7f4a_7c15;
    let step = |hash: u64, word: u64| (hash ^ word).wrapping_mul(ODD).rotate_left(29);
    let mut chains = [1_u64, 2, 3, 4];
    let mut numbers = numbers.into_iter();
    let mut count = 0;
    'all: loop {
        for chain in &mut chains {
            let Some(number) = numbers.next() else {
                break 'all;
            };
            *chain = step(*chain, number.to_bits());
            count += 1;
        }
    }
    chains.into_iter().fold(step(0, count), step)
}
