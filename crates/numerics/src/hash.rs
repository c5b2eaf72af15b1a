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
