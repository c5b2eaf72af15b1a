//! A hash for names and checksums.

/// FNV-1a of 64 bits: names of random streams are few and need not be kept from anybody, and a checksum is
/// to notice what was changed by accident.
///
/// ```
/// // The test vectors of Fowler, Noll and Vo.
/// assert_eq!(asperity_analysis::fnv1a(b""), 0xcbf2_9ce4_8422_2325);
/// assert_eq!(asperity_analysis::fnv1a(b"foobar"), 0x8594_4171_f739_67e8);
/// ```
///
/// # Source
/// Fowler, Noll and Vo, The FNV Non-Cryptographic Hash Algorithm, RFC 9923.
#[must_use]
pub fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
