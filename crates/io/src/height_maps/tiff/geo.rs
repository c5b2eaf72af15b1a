//! Tags of GeoTIFF 1.1 and of GDAL: spacing, units, missing points and scale of heights of a grid.
//!
//! Place and direction on the map are ignored, as is the vertical datum. A grid in degrees is refused, since its
//! spacing is no length.

use std::io::{Read, Seek};

use ::tiff::TiffResult;
use ::tiff::decoder::Decoder;
use ::tiff::decoder::ifd::Value;
use ::tiff::tags::Tag;
use asperity_surface::LengthUnit;

use super::metadata::HeightScale;
use crate::error::ReadProblem;

/// The tag of GDAL with metadata as XML.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

/// Keys of the directory of GeoTIFF.
const MODEL_TYPE: u16 = 1024;
const LINEAR_UNIT: u16 = 3076;
const VERTICAL_UNIT: u16 = 4099;

/// Values of [`MODEL_TYPE`] other than 1, a projected grid.
const GEOGRAPHIC: u16 = 2;
const GEOCENTRIC: u16 = 3;

/// Largest cosine between the axes of a grid that counts as rectangular.
const MAX_SHEAR: f64 = 1e-6;

/// Grid of a GeoTIFF file; `None` for what the file does not state.
pub(super) struct Georeference {
    /// `[dx, dy]`, in metres if `is_metric`.
    spacing: Option<[f64; 2]>,
    is_metric: bool,
    /// Metres in one unit of the heights.
    metres_per_height: Option<f64>,
    states_vertical_unit: bool,
    states_linear_unit: bool,
    nodata: Option<f64>,
    scale: HeightScale,
}

impl Georeference {
    pub(super) fn read<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<Self, ReadProblem> {
        let spacing = spacing(decoder)?;
        let keys = GeoKeys::read(decoder)?;
        match keys.value(MODEL_TYPE) {
            Some(GEOGRAPHIC) => {
                return Err(ReadProblem::unsupported(
                    "its grid is in degrees; bring it to a grid in metres first (gdalwarp -t_srs)",
                ));
            }
            Some(GEOCENTRIC) => {
                return Err(ReadProblem::unsupported(
                    "its coordinates are geocentric, but a projected grid is needed",
                ));
            }
            _ => {}
        }
        let unit_of = |key| {
            let code = keys.value(key);
            let metres = code.map(|code| {
                metres_in(code).ok_or_else(|| {
                    let known =
                        "9001 (metre), 9002 (foot), 9003 (US survey foot) and 9036 (kilometre)";
                    let what =
                        format!("its unit of length has the EPSG code {code}; read are {known}");
                    ReadProblem::unsupported(what)
                })
            });
            metres.transpose()
        };
        let linear = unit_of(LINEAR_UNIT)?;
        let vertical = unit_of(VERTICAL_UNIT)?;
        let is_metric = keys.value(MODEL_TYPE).is_some() && spacing.is_some();
        let metres = linear.unwrap_or(1.0);
        Ok(Self {
            spacing: spacing.map(|both| both.map(|d| if is_metric { d * metres } else { d })),
            is_metric,
            metres_per_height: is_metric.then_some(vertical.unwrap_or(1.0)),
            states_vertical_unit: vertical.is_some(),
            states_linear_unit: linear.is_some(),
            nodata: nodata(decoder)?,
            scale: match text(decoder, GDAL_METADATA)? {
                Some(xml) => HeightScale::parse(&xml)?,
                None => HeightScale::default(),
            },
        })
    }

    pub(super) fn spacing(&self) -> Option<[f64; 2]> {
        self.spacing
    }

    pub(super) fn unit(&self) -> LengthUnit {
        match self.is_metric {
            true => LengthUnit::Metre,
            false => LengthUnit::Arbitrary,
        }
    }

    /// Marks missing points by NaN and brings heights to the unit of the grid; `is_single` if the samples have
    /// single precision, to which the number for missing points is rounded then.
    pub(super) fn apply(&self, heights: &mut [f64], is_single: bool) {
        let nodata = self.nodata.map(|number| match is_single {
            true => f64::from(number as f32),
            false => number,
        });
        let metres = self.metres_per_height.unwrap_or(1.0);
        for height in heights {
            *height = match nodata == Some(*height) {
                true => f64::NAN,
                false => self.scale.of(*height) * metres,
            };
        }
    }

    /// Notes on units that are assumed because the file does not state them.
    pub(super) fn notes(&self) -> Vec<String> {
        let mut missing = Vec::new();
        if self.is_metric && !self.states_linear_unit {
            missing.push("its grid");
        }
        if self.is_metric && !self.states_vertical_unit {
            missing.push("its heights");
        }
        match missing.is_empty() {
            true => Vec::new(),
            false => vec![format!(
                "the file states no unit for {}; metres are assumed",
                missing.join(" and ")
            )],
        }
    }
}

/// Metres in the unit with an EPSG code.
fn metres_in(code: u16) -> Option<f64> {
    match code {
        9001 => Some(1.0),
        9002 => Some(0.3048),
        9003 => Some(1200.0 / 3937.0),
        9036 => Some(1000.0),
        _ => None,
    }
}

/// `[dx, dy]` from the scale of pixels, or from the matrix that brings pixels to the map.
fn spacing<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<Option<[f64; 2]>, ReadProblem> {
    if let Some(scale) = numbers(decoder, Tag::ModelPixelScaleTag)? {
        let [dx, dy, ..] = scale[..] else {
            return Err(ReadProblem::malformed("its scale of pixels lacks numbers"));
        };
        return Ok(Some([dx.abs(), dy.abs()]));
    }
    let Some(matrix) = numbers(decoder, Tag::ModelTransformationTag)? else {
        return Ok(None);
    };
    let [x_column, x_row, _, _, y_column, y_row, ..] = matrix[..] else {
        return Err(ReadProblem::malformed("its transformation lacks numbers"));
    };
    let [dx, dy] = [x_column.hypot(y_column), x_row.hypot(y_row)];
    let shear = (x_column * x_row + y_column * y_row).abs();
    if shear > MAX_SHEAR * dx * dy {
        return Err(ReadProblem::unsupported(
            "the axes of its grid are not at right angles",
        ));
    }
    Ok(Some([dx, dy]))
}

/// The number that marks missing points.
fn nodata<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<Option<f64>, ReadProblem> {
    let text = text(decoder, Tag::GdalNodata)?;
    let text = text
        .as_deref()
        .map(str::trim)
        .filter(|text| !text.is_empty());
    let parsed = text.map(|text| {
        let number = text.parse::<f64>();
        number
            .map_err(|_| ReadProblem::malformed(format_args!("GDAL_NODATA is `{text}`, no number")))
    });
    parsed.transpose()
}

/// Text of a tag, without the NUL bytes at its end.
fn text<R: Read + Seek>(decoder: &mut Decoder<R>, tag: Tag) -> TiffResult<Option<String>> {
    let value = decoder.find_tag(tag)?;
    let text = value.map(Value::into_string).transpose()?;
    Ok(text.map(|text| text.trim_end_matches('\0').to_owned()))
}

fn numbers<R: Read + Seek>(decoder: &mut Decoder<R>, tag: Tag) -> TiffResult<Option<Vec<f64>>> {
    decoder.find_tag(tag)?.map(Value::into_f64_vec).transpose()
}

/// The directory of keys: four numbers each, of which a location of 0 says that the fourth is the value.
struct GeoKeys(Vec<u16>);

impl GeoKeys {
    fn read<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<Self, ReadProblem> {
        let value = decoder.find_tag(Tag::GeoKeyDirectoryTag);
        let keys = value.and_then(|value| value.map(Value::into_u16_vec).transpose());
        Ok(Self(keys?.unwrap_or_default()))
    }

    fn value(&self, key: u16) -> Option<u16> {
        let (entries, _) = self.0.as_chunks::<4>();
        // The first entry is the version
        let mut entries = entries.iter().skip(1);
        entries
            .find_map(|[id, location, _, value]| (*id == key && *location == 0).then_some(*value))
    }
}
