//! TIFF files made for tests: tags, and strips or tiles of given bytes.

/// Values of a tag, by their field types.
#[derive(Clone, Debug)]
pub(super) enum Values {
    Text(String),
    Short(Vec<u16>),
    Long(Vec<u32>),
    Quotient(u32, u32),
    Double(Vec<f64>),
}

/// One page.
#[derive(Clone, Debug, Default)]
pub(super) struct Page {
    pub(super) tags: Vec<(u16, Values)>,
    /// Strips or tiles; those without bytes are not in the file.
    pub(super) parts: Vec<Vec<u8>>,
    pub(super) is_tiled: bool,
}

impl Page {
    /// A page of `[columns, rows]` in one strip.
    pub(super) fn new([columns, rows]: [u32; 2], bits: u16, format: u16, strip: Vec<u8>) -> Self {
        let tags = vec![
            (256, Values::Long(vec![columns])),
            (257, Values::Long(vec![rows])),
            (258, Values::Short(vec![bits])),
            (262, Values::Short(vec![1])),
            (339, Values::Short(vec![format])),
        ];
        Self {
            tags,
            parts: vec![strip],
            is_tiled: false,
        }
    }

    pub(super) fn with(mut self, tag: u16, values: Values) -> Self {
        self.tags.retain(|(other, _)| *other != tag);
        self.tags.push((tag, values));
        self
    }

    pub(super) fn with_short(self, tag: u16, value: u16) -> Self {
        self.with(tag, Values::Short(vec![value]))
    }

    pub(super) fn with_text(self, tag: u16, text: &str) -> Self {
        self.with(tag, Values::Text(format!("{text}\0")))
    }

    pub(super) fn with_strips(self, rows: u16, parts: Vec<Vec<u8>>) -> Self {
        Self {
            parts,
            ..self.with_short(278, rows)
        }
    }

    pub(super) fn with_tiles(self, [columns, rows]: [u16; 2], parts: Vec<Vec<u8>>) -> Self {
        Self {
            parts,
            is_tiled: true,
            ..self.with_short(322, columns).with_short(323, rows)
        }
    }

    pub(super) fn bytes(&self) -> Vec<u8> {
        Kind::default().file(std::slice::from_ref(self))
    }
}

/// Kind of file.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Kind {
    pub(super) is_big_endian: bool,
    pub(super) is_big_tiff: bool,
}

impl Kind {
    /// The lowest `width` bytes of a number, in the order of the file.
    fn put(self, file: &mut Vec<u8>, number: u64, width: usize) {
        match self.is_big_endian {
            true => file.extend(&number.to_be_bytes()[8 - width..]),
            false => file.extend(&number.to_le_bytes()[..width]),
        }
    }

    fn offset_width(self) -> usize {
        if self.is_big_tiff { 8 } else { 4 }
    }

    pub(super) fn file(self, pages: &[Page]) -> Vec<u8> {
        let mut file = match self.is_big_endian {
            true => b"MM".to_vec(),
            false => b"II".to_vec(),
        };
        let width = self.offset_width();
        match self.is_big_tiff {
            true => [43, 8, 0]
                .map(|number| self.put(&mut file, number, 2))
                .len(),
            false => [42].map(|number| self.put(&mut file, number, 2)).len(),
        };
        // Where the offset of the next directory belongs
        let mut link = file.len();
        self.put(&mut file, 0, width);
        for page in pages {
            let next = self.page(&mut file, page, link);
            link = next;
        }
        file
    }

    /// Appends a page and links it; returns where the offset of the next one belongs.
    fn page(self, file: &mut Vec<u8>, page: &Page, link: usize) -> usize {
        let width = self.offset_width();
        let (mut offsets, mut lengths) = (Vec::new(), Vec::new());
        for part in &page.parts {
            offsets.push(if part.is_empty() {
                0
            } else {
                file.len() as u32
            });
            lengths.push(part.len() as u32);
            file.extend(part);
        }
        let mut tags = page.tags.clone();
        let [offset_tag, length_tag] = if page.is_tiled {
            [324, 325]
        } else {
            [273, 279]
        };
        tags.push((offset_tag, Values::Long(offsets)));
        tags.push((length_tag, Values::Long(lengths)));
        tags.sort_by_key(|(tag, _)| *tag);
        let mut directory = Vec::new();
        self.put(
            &mut directory,
            tags.len() as u64,
            if self.is_big_tiff { 8 } else { 2 },
        );
        for (tag, values) in &tags {
            let mut bytes = Vec::new();
            let (kind, count) = match values {
                Values::Text(text) => {
                    bytes.extend(text.as_bytes());
                    (2, text.len())
                }
                Values::Short(all) => {
                    all.iter()
                        .for_each(|n| self.put(&mut bytes, u64::from(*n), 2));
                    (3, all.len())
                }
                Values::Long(all) => {
                    all.iter()
                        .for_each(|n| self.put(&mut bytes, u64::from(*n), 4));
                    (4, all.len())
                }
                Values::Quotient(above, below) => {
                    self.put(&mut bytes, u64::from(*above), 4);
                    self.put(&mut bytes, u64::from(*below), 4);
                    (5, 1)
                }
                Values::Double(all) => {
                    all.iter()
                        .for_each(|n| self.put(&mut bytes, n.to_bits(), 8));
                    (12, all.len())
                }
            };
            self.put(&mut directory, u64::from(*tag), 2);
            self.put(&mut directory, kind, 2);
            self.put(&mut directory, count as u64, width);
            if bytes.len() <= width {
                bytes.resize(width, 0);
                directory.extend(bytes);
            } else {
                self.put(&mut directory, file.len() as u64, width);
                file.extend(bytes);
            }
        }
        let mut start = Vec::new();
        self.put(&mut start, file.len() as u64, width);
        file[link..link + width].copy_from_slice(&start);
        file.extend(directory);
        let next = file.len();
        self.put(file, 0, width);
        next
    }
}

/// LZW as libtiff writes it.
pub(super) fn lzw(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = weezl::encode::Encoder::with_tiff_size_switch(weezl::BitOrder::Msb, 8);
    encoder.encode(bytes).unwrap()
}

pub(super) fn deflate(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}
