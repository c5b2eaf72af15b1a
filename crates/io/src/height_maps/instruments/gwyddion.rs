//! Gwyddion (.gwy), its native format since version 2.
//!
//! A tree of named items, little endian: data fields `/N/data` of size `xres`, `yres`, extents `xreal`, `yreal`, units and
//! heights in double precision, row by row from the top; a field `/N/mask` marks points where it is above 0.5, which are
//! taken for missing. Of several fields of heights that is read whose title says height or topography, else the one of
//! the lowest number.

mod items;

use std::collections::BTreeMap;

use self::items::{Item, Items};
use super::bytes::{Bytes, Raster};
use super::measured::{Length, Measured, unit_of_length};
use crate::error::ReadProblem;
use crate::height_maps::channels::note_on_channels;
use crate::height_maps::samples::SampleKind;
use crate::height_maps::unit::PowerOfMetre;

/// Above this a mask marks a point.
const MASKED: f64 = 0.5;

pub(crate) fn measured(file: &Bytes<'_>) -> Result<Measured, ReadProblem> {
    if file.all.starts_with(b"GWYO") {
        return Err(ReadProblem::unsupported(
            "it is of version 1 of Gwyddion; save it with a later one",
        ));
    }
    let channels = channels(file)?;
    let fields: Vec<&Channel> = channels
        .values()
        .filter(|channel| channel.data.is_some())
        .collect();
    let mut lengths = Vec::new();
    for (k, channel) in fields.iter().enumerate() {
        if let Some(field) = &channel.data
            && field.height_unit.is_some()
        {
            lengths.push((k, field));
        }
    }
    let names: Vec<String> = fields.iter().map(|channel| channel.title.clone()).collect();
    let is_titled = |(k, _): &&(usize, &DataField)| {
        let title = names[*k].to_ascii_lowercase();
        ["height", "topo"].iter().any(|word| title.contains(word))
    };
    let Some((chosen, field)) = lengths.iter().find(is_titled).or(lengths.first()) else {
        return Err(ReadProblem::unsupported(format_args!(
            "none of its {} channels holds heights in a unit of length",
            names.len()
        )));
    };
    let mut heights = field.samples(file)?;
    let mut notes: Vec<String> = note_on_channels(*chosen, &names).into_iter().collect();
    if let Some(mask) = &fields[*chosen].mask {
        if mask.shape != field.shape {
            return Err(ReadProblem::malformed(
                "its mask has another size than its heights",
            ));
        }
        let mut marked = 0;
        for (height, mark) in heights.iter_mut().zip(mask.samples(file)?) {
            if mark > MASKED {
                *height = f64::NAN;
                marked += 1;
            }
        }
        notes.push(format!(
            "its mask is of {marked} points, which are taken for missing"
        ));
    }
    let unit = unit_of_length("x and y", &field.lateral_unit)?;
    let [ny, nx] = field.shape.map(|n| n as f64);
    let spacing = [field.extent[0] / nx, field.extent[1] / ny];
    Ok(Measured {
        heights,
        height_unit: field.height_unit.unwrap_or(unit),
        shape: field.shape,
        spacing: Some(spacing.map(|value| Length { value, unit })),
        notes,
    })
}

/// Items under one channel number.
struct Channel {
    title: String,
    data: Option<DataField>,
    mask: Option<DataField>,
}

/// The channels by their numbers.
fn channels(file: &Bytes<'_>) -> Result<BTreeMap<u32, Channel>, ReadProblem> {
    let mut channels: BTreeMap<u32, Channel> = BTreeMap::new();
    let mut items = Items::of_file(file)?;
    while let Some((name, item)) = items.next()? {
        let Some((number, kind)) = name.strip_prefix('/').and_then(|name| name.split_once('/'))
        else {
            continue;
        };
        let Ok(number) = number.parse() else { continue };
        let channel = channels.entry(number).or_insert_with(|| Channel {
            title: format!("channel {number}"),
            data: None,
            mask: None,
        });
        match (kind, item) {
            ("data", Item::Object(inside)) => channel.data = DataField::read(inside)?,
            ("mask", Item::Object(inside)) => channel.mask = DataField::read(inside)?,
            ("data/title", Item::Text(title)) => channel.title = title,
            _ => {}
        }
    }
    Ok(channels)
}

/// A data field.
struct DataField {
    shape: [u64; 2],
    /// Along x and y, over all pixels.
    extent: [f64; 2],
    lateral_unit: String,
    /// `None` if it is no unit of length.
    height_unit: Option<PowerOfMetre>,
    /// Place of its numbers and their count.
    data: (usize, u64),
}

impl DataField {
    /// `None` if the object is not a `GwyDataField`, or states no size.
    fn read(mut items: Items<'_>) -> Result<Option<Self>, ReadProblem> {
        if items.object != "GwyDataField" {
            return Ok(None);
        }
        let mut shape = [0; 2];
        let mut extent = [0.0; 2];
        let [mut lateral_unit, mut height_unit] = [String::new(), String::new()];
        let mut data = None;
        while let Some((name, item)) = items.next()? {
            match (name.as_str(), item) {
                ("xres", Item::Whole(n)) => shape[1] = u64::try_from(n).unwrap_or(0),
                ("yres", Item::Whole(n)) => shape[0] = u64::try_from(n).unwrap_or(0),
                // Gwyddion takes negative extents for positive ones
                ("xreal", Item::Number(x)) => extent[0] = x.abs(),
                ("yreal", Item::Number(y)) => extent[1] = y.abs(),
                ("si_unit_xy", Item::Object(inside)) => lateral_unit = unit(inside)?,
                ("si_unit_z", Item::Object(inside)) => height_unit = unit(inside)?,
                ("data", Item::Numbers(numbers)) => data = Some(numbers),
                _ => {}
            }
        }
        let Some(data) = data else {
            return Err(ReadProblem::malformed("a data field has no numbers"));
        };
        Ok(Some(Self {
            shape,
            extent,
            lateral_unit,
            height_unit: PowerOfMetre::parse(&height_unit),
            data,
        }))
    }

    fn samples(&self, file: &Bytes<'_>) -> Result<Vec<f64>, ReadProblem> {
        let (at, count) = self.data;
        let [ny, nx] = self.shape;
        if ny.checked_mul(nx) != Some(count) {
            return Err(ReadProblem::malformed(format_args!(
                "a data field has {count} numbers, but {nx} x {ny} are needed"
            )));
        }
        file.samples(&Raster {
            shape: self.shape,
            kind: SampleKind::F64,
            at,
        })
    }
}

/// The text of a unit.
fn unit(mut items: Items<'_>) -> Result<String, ReadProblem> {
    let mut unit = String::new();
    while let Some((name, item)) = items.next()? {
        if let ("unitstr", Item::Text(text)) = (name.as_str(), item) {
            unit = text;
        }
    }
    Ok(unit)
}
