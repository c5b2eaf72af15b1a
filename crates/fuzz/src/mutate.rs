//! Mutations: changes of bytes that parsers tend to miss.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Most bytes of an input.
const MAX_BYTES: usize = 1 << 17;

/// Numbers near the limits of what counts, offsets and types hold.
const INTEGERS: [u64; 14] = [
    0,
    1,
    2,
    0x7f,
    0x80,
    0xff,
    0x7fff,
    0xffff,
    0x1_0000,
    0x7fff_ffff,
    0xffff_ffff,
    0x1_0000_0001,
    i64::MAX as u64,
    u64::MAX,
];

/// Words that texts of all formats give a meaning to.
const WORDS: &str = "nan NaN inf -inf -1 0 1e999 -1e-320 1e308 65536 2147483648 4294967296 9007199254740993 18446744073709551615 \
    99999999999999999999 null true {} [] [[[[[[[[ {\"$array\":\"header\"} {\"$float\":\"NaN\"} \"\" ' \\ / .. ../x # ; , : = \t \u{feff} \u{e9} \
    <a> </a> <!-- &#0; &a; <![CDATA[ - --- !!map & * | > ? % @ [surface] [[light]] \r \n \0";

/// Damages `bytes` in up to eight places; `others` are inputs to take parts of.
pub(crate) fn mutate(rng: &mut ChaCha8Rng, bytes: &mut Vec<u8>, others: &[Vec<u8>]) {
    for _ in 0..1 << rng.random_range(0..4) {
        step(rng, bytes, others);
    }
    bytes.truncate(MAX_BYTES);
}

fn step(rng: &mut ChaCha8Rng, bytes: &mut Vec<u8>, others: &[Vec<u8>]) {
    // Headers are short.
    let among = if rng.random_range(0..3) > 0 {
        usize::MAX
    } else {
        64
    };
    let at = rng.random_range(0..=bytes.len().min(among));
    let range = at..bytes.len().min(at + (1 << rng.random_range(0..8)));
    match rng.random_range(0..11) {
        0 | 1 if at < bytes.len() => bytes[at] ^= 1 << rng.random_range(0..8),
        2 if at < bytes.len() => bytes[at] = rng.random(),
        3 | 4 => put_integer(rng, &mut bytes[at..]),
        5 => {
            let word = word(rng);
            put(rng, bytes, at, &word);
        }
        // A number in text
        6 => {
            let is_number = |byte: &u8| byte.is_ascii_digit() || b"+-.".contains(byte);
            if let Some(begin) = bytes[at..].iter().position(is_number) {
                let begin = at + begin;
                let end = bytes[begin..].iter().position(|byte| !is_number(byte));
                let end = end.map_or(bytes.len(), |length| begin + length);
                bytes.splice(begin..end, word(rng));
            }
        }
        7 => drop(bytes.drain(range)),
        8 => {
            let part = bytes[range].to_vec();
            let times = 1 << rng.random_range(0..6);
            let place = rng.random_range(0..=bytes.len());
            bytes.splice(place..place, part.repeat(times));
        }
        9 => {
            let other = &others[rng.random_range(0..others.len())];
            let from = rng.random_range(0..=other.len());
            let to = other.len().min(from + (1 << rng.random_range(0..12)));
            put(rng, bytes, at, &other[from..to]);
        }
        _ if rng.random_range(0..8) == 0 => bytes.truncate(at),
        _ => bytes[range].fill([0, 0xff, b' ', b'9'][rng.random_range(0..4)]),
    }
}

/// Inserts a part, or puts it over what is there.
fn put(rng: &mut ChaCha8Rng, bytes: &mut Vec<u8>, at: usize, part: &[u8]) {
    let end = match rng.random() {
        true => at,
        false => bytes.len().min(at + part.len()),
    };
    bytes.splice(at..end, part.iter().copied());
}

/// Overwrites a number of 1 to 8 bytes in either order, by one of [`INTEGERS`] or by one near to its own.
fn put_integer(rng: &mut ChaCha8Rng, bytes: &mut [u8]) {
    let width = 1 << rng.random_range(0..4);
    let (Some(place), is_little) = (bytes.get_mut(..width), rng.random::<bool>()) else {
        return;
    };
    let mut number = [0; 8];
    number[..width].copy_from_slice(place);
    if !is_little {
        number[..width].reverse();
    }
    let near = u64::from_le_bytes(number).wrapping_add_signed(rng.random_range(-2..=2));
    let number = match rng.random_range(0..4) {
        0 => near,
        _ => INTEGERS[rng.random_range(0..INTEGERS.len())],
    };
    place.copy_from_slice(&number.to_le_bytes()[..width]);
    if !is_little {
        place.reverse();
    }
}

fn word(rng: &mut ChaCha8Rng) -> Vec<u8> {
    // A number of CBOR
    if rng.random_range(0..16) == 0 {
        let integer = INTEGERS[rng.random_range(0..INTEGERS.len())];
        return [&[0x1b], &integer.to_be_bytes()[..]].concat();
    }
    let words: Vec<&str> = WORDS.split(' ').collect();
    words[rng.random_range(0..words.len())].as_bytes().to_vec()
}
