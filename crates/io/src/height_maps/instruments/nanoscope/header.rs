//! The header: sections of fields.

use crate::error::ReadProblem;
use crate::height_maps::instruments::bytes::{Bytes, decoded};
use crate::height_maps::instruments::fields::Fields;
use crate::text_lines::short;

/// Longest header.
const MAX_HEADER: usize = 1 << 20;

/// Most sections; files have some tens.
const MAX_SECTIONS: usize = 256;

/// A section: `\*name`, then `\field: value` lines.
pub(super) struct Section {
    name: String,
    pub(super) fields: Fields,
}

impl Section {
    fn is_channel(&self) -> bool {
        self.name.ends_with("image list")
    }

    fn is_scan(&self) -> bool {
        matches!(
            self.name.as_str(),
            "ciao scan list" | "afm list" | "stm list" | "nc afm list"
        )
    }

    fn is_scanner(&self) -> bool {
        matches!(self.name.as_str(), "scanner list" | "microscope list")
    }

    /// The name of the channel: `S [Height] "Height"` is `Height`.
    pub(super) fn channel_name(&self) -> String {
        let names = [
            "@2:Image Data",
            "@3:Image Data",
            "@4:Image Data",
            "Image data",
        ];
        let Some(value) = names.iter().find_map(|name| self.fields.get(name)) else {
            return "unnamed".to_owned();
        };
        let inside = |open, close| Some(value.split_once(open)?.1.split_once(close)?.0.trim());
        let name = inside('[', ']').filter(|name| !name.is_empty());
        name.or_else(|| inside('"', '"'))
            .unwrap_or(value)
            .to_owned()
    }
}

/// All sections, and the version of the program that wrote them.
pub(super) struct Header {
    sections: Vec<Section>,
    pub(super) version: u32,
}

impl Header {
    pub(super) fn read(file: &Bytes<'_>) -> Result<Self, ReadProblem> {
        if file.all.starts_with(b"?") {
            return Err(ReadProblem::unsupported(
                "its numbers are text, but a binary file is needed",
            ));
        }
        let text = decoded(&file.all[..file.all.len().min(MAX_HEADER)]);
        let mut sections: Vec<Section> = Vec::new();
        let mut is_whole = false;
        for line in text.split('\n').map(str::trim) {
            // Binary numbers follow the last line
            let Some(line) = line.strip_prefix('\\') else {
                break;
            };
            if let Some(name) = line.strip_prefix('*') {
                let name = name.trim().to_ascii_lowercase();
                if name == "file list end" {
                    is_whole = true;
                    break;
                }
                if sections.len() == MAX_SECTIONS {
                    return Err(ReadProblem::malformed(format_args!(
                        "its header has more than {MAX_SECTIONS} sections"
                    )));
                }
                sections.push(Section {
                    name,
                    fields: Fields::default(),
                });
            } else if let Some(section) = sections.last_mut() {
                let (name, value) = line
                    .split_once(": ")
                    .unwrap_or((line.trim_end_matches(':'), ""));
                section.fields.insert(name, value);
            }
        }
        if !is_whole {
            return Err(ReadProblem::truncated(
                "its header does not end in `\\*File list end`",
            ));
        }
        let version = sections.first().and_then(|list| list.fields.get("Version"));
        let digits = version.unwrap_or_default();
        let version = u32::from_str_radix(digits.trim_start_matches("0x"), 16).map_err(|_| {
            ReadProblem::malformed(format_args!(
                "its version is `{}`, but a hexadecimal number is needed",
                short(digits)
            ))
        })?;
        Ok(Self { sections, version })
    }

    pub(super) fn channels(&self) -> impl Iterator<Item = &Section> {
        self.sections.iter().filter(|section| section.is_channel())
    }

    /// Offset of the end of the last channel, among those that state one.
    pub(super) fn end_of_channels(&self) -> u64 {
        let end = |channel: &Section| {
            let whole = |name| channel.fields.whole(name).ok();
            whole("Data offset")?.checked_add(whole("Data length")?)
        };
        self.channels().filter_map(end).max().unwrap_or(0)
    }

    /// A field of the scan.
    pub(super) fn scan(&self, name: &str) -> Option<&str> {
        self.find(Section::is_scan, name)
    }

    /// A field of the scanner, else of the scan.
    pub(super) fn sensitivity(&self, name: &str) -> Option<&str> {
        self.find(Section::is_scanner, name)
            .or_else(|| self.scan(name))
    }

    fn find(&self, is_of_kind: fn(&Section) -> bool, name: &str) -> Option<&str> {
        let mut sections = self.sections.iter().filter(|section| is_of_kind(section));
        sections.find_map(|section| section.fields.get(name))
    }
}
