//! Damaged files for the tests of readers, and the form of their error messages.

use crate::error::ReadError;

/// One sentence that names the file.
pub(crate) fn assert_sentence(error: &ReadError) {
    let text = error.to_string();
    assert!(text.contains("in memory."), "{text}");
    assert!(!text.contains('\n') && !text.ends_with('.'), "{text}");
}

/// Changed copies of a text, each with the words of its refusal. A row of `cases` is `old => new => words`, in which `\n` is the end of a line.
pub(crate) fn changes<'a>(
    text: &'a str,
    cases: &'a str,
) -> impl Iterator<Item = (String, &'a str)> {
    cases.trim().lines().map(move |row| {
        let columns: Vec<&str> = row.trim().split(" => ").collect();
        let &[old, new, words] = columns.as_slice() else {
            panic!("{row}");
        };
        let [old, new] = [old, new].map(|part| part.replace("\\n", "\n"));
        assert!(text.contains(&old), "{old}");
        (text.replace(&old, &new), words)
    })
}

/// SplitMix64 (Steele, Lea and Flood 2014): enough to damage files, the same ones each time.
struct Damage(u64);

impl Damage {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
}

/// `original` with up to four changes, the same ones for the same seed.
pub(crate) fn damaged(original: &[u8], seed: u64) -> Vec<u8> {
    let mut damage = Damage(seed);
    let mut bytes = original.to_vec();
    for _ in 0..=damage.below(4) {
        let i = damage.below(bytes.len());
        match damage.below(6) {
            0 => bytes[i] ^= 1 << damage.below(8),
            1 => bytes[i] = damage.next() as u8,
            2 => bytes[i] = [0, 0xff, 0x7f, 0x80, b'9', b'-'][damage.below(6)],
            3 => bytes.insert(i, damage.next() as u8),
            4 if bytes.len() > 1 => _ = bytes.remove(i),
            _ => {
                let j = (i + 4).min(bytes.len());
                bytes[i..j].fill([0, 0xff, 0x7f][damage.below(3)]);
            }
        }
    }
    bytes
}
