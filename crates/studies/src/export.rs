//! Export: results of `gonio`, `trace` or `verify` as a file that other programs open.
//!
//! Each format is a file of this folder: from the directions of a measurement to the bytes of a file, with what the format cannot hold and the
//! light that the file has next to the light that was measured.

mod axes;
mod contents;
mod directions;
mod error;
mod fit;
mod half_vectors;
mod interpolation;
mod klems;
mod measurement;
mod moved_lobes;
mod netcdf;
mod pbsdf;
mod planned;
mod ranges;
mod rgl;
mod specular_table;
mod ssdd;
mod tensor_tree;
mod window_element;
mod zemax;

use std::path::{Path, PathBuf};

use asperity_io::{NetCdf, WriteError, check_ending, is_same_file, shown_path, write_bytes};
use asperity_simulate::Case;
use asperity_tally::{Side, TallySpec};
use serde::Deserialize;
use serde_json::{Value, json};

use self::contents::{Agreement, Contents, farthest, table};
pub use self::error::ExportError;
use self::measurement::Measurement;
use self::planned::{Planned, check_light};
use self::rgl::Channels;
use crate::output::{Head, note_lines};

/// Configuration of `asperity export`.
#[derive(Clone, Debug, Deserialize)]
pub struct ExportConfig {
    export: Selection,
}

/// Results, and the format in which they are written.
#[derive(Clone, Debug, Deserialize)]
struct Selection {
    results: Option<PathBuf>,
    format: ExportFormat,
    side: Option<Side>,
}

/// Format of other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum ExportFormat {
    /// NetCDF-3, as xarray reads.
    Netcdf,
    /// XML of Radiance, WINDOW and EnergyPlus with matrices of the full Klems basis.
    Klems,
    /// XML of Radiance with trees of cells.
    TensorTree,
    /// Tensor file of measured materials of Mitsuba and pbrt, by wavelength.
    Rgl,
    /// Tensor file of measured materials of Mitsuba, in linear sRGB.
    RglRgb,
    /// Tensor file of polarised measured materials of Mitsuba.
    Pbsdf,
    /// Tabular BSDF of OpticStudio.
    Zemax,
    /// Parameters of scattering laws as JSON.
    Fit,
    /// Surface scattering distribution data of libbsdf.
    Ssdd,
}

impl ExportFormat {
    const fn name(self) -> &'static str {
        match self {
            Self::Netcdf => "netcdf",
            Self::Klems => "klems",
            Self::TensorTree => "tensor-tree",
            Self::Rgl => "rgl",
            Self::RglRgb => "rgl-rgb",
            Self::Pbsdf => "pbsdf",
            Self::Zemax => "zemax",
            Self::Fit => "fit",
            Self::Ssdd => "ssdd",
        }
    }

    /// The subject of sentences on what the format needs.
    const fn in_words(self) -> &'static str {
        match self {
            Self::Netcdf => "a NetCDF file",
            Self::Klems => "a Klems file",
            Self::TensorTree => "a tensor tree",
            Self::Rgl | Self::RglRgb => "a .bsdf file",
            Self::Pbsdf => "a .pbsdf file",
            Self::Zemax => "a Zemax file",
            Self::Fit => "a fit",
            Self::Ssdd => "an SSDD file",
        }
    }

    /// Checks that the format can hold such cases, as far as is known before they are traced.
    fn check(self, cases: &[Planned]) -> Result<(), String> {
        match self {
            Self::Netcdf => Ok(()),
            Self::Klems => klems::check(cases),
            Self::TensorTree => tensor_tree::check(cases),
            Self::Rgl | Self::RglRgb => rgl::check(cases),
            Self::Pbsdf => pbsdf::check(cases),
            Self::Zemax => zemax::check(cases),
            Self::Fit => check_light(cases),
            Self::Ssdd => ssdd::check(cases),
        }
    }

    const fn ending(self) -> &'static str {
        match self {
            Self::Netcdf => "nc",
            Self::Klems | Self::TensorTree => "xml",
            Self::Rgl | Self::RglRgb | Self::Zemax => "bsdf",
            Self::Pbsdf => "pbsdf",
            Self::Fit => "json",
            Self::Ssdd => "ssdd",
        }
    }
}

/// Checks that the format of `gonio --for` can hold results of such cases, each with what is recorded of it.
///
/// # Errors
/// A sentence.
pub(crate) fn check_planned<'a>(
    format: &Value,
    cases: impl Iterator<Item = (&'a Case, TallySpec)>,
) -> Result<(), String> {
    let Ok(format) = ExportFormat::deserialize(format) else {
        return Ok(());
    };
    let cases: Vec<Planned> = cases.map(|(case, spec)| Planned { case, spec }).collect();
    let checked = format.check(&cases);
    checked.map_err(|reason| format!("{} {reason}", format.in_words()))
}

/// Results of a folder or file as labelled arrays, those of a NetCDF file, with fluxes by order of scattering and Mueller matrices.
///
/// # Errors
/// [`ExportError`] if the results cannot be read.
pub fn labelled_results(path: &Path) -> Result<NetCdf, ExportError> {
    Ok(netcdf::labelled(&Measurement::read(path)?))
}

/// A file that is ready to be written.
pub struct Exported {
    format: ExportFormat,
    contents: Contents,
    cases: usize,
    /// Directions of the run, finished or not.
    planned: usize,
}

impl ExportConfig {
    /// Reads the results and makes the file, which is to be written to `output`.
    ///
    /// # Errors
    /// [`ExportError`] if the results cannot be read, or the format cannot hold such results.
    pub fn export(&self, output: &Path) -> Result<Exported, ExportError> {
        let Selection {
            results,
            format,
            side,
        } = &self.export;
        let ending = [format.ending()];
        check_ending(output, "files of this format", &ending)?;
        let path = results.as_ref().ok_or(ExportError::NoResults)?;
        if [path.clone(), path.join("results.npz")]
            .iter()
            .any(|input| is_same_file(input, output))
        {
            return Err(ExportError::Input(output.to_owned()));
        }
        let measurement = Measurement::read(path)?;
        let unfit = |reason| ExportError::Unfit {
            format: format.in_words(),
            reason,
        };
        let outcomes = measurement.cases.iter().map(|case| &case.outcome);
        let cases: Vec<Planned> = outcomes.map(Planned::from).collect();
        format.check(&cases).map_err(unfit)?;
        let contents = match format {
            ExportFormat::Netcdf => netcdf::contents(&measurement),
            ExportFormat::Klems => klems::contents(&measurement),
            ExportFormat::TensorTree => tensor_tree::contents(&measurement),
            ExportFormat::Rgl => rgl::contents(&measurement, Channels::Spectra),
            ExportFormat::RglRgb => rgl::contents(&measurement, Channels::Rgb),
            ExportFormat::Pbsdf => pbsdf::contents(&measurement),
            ExportFormat::Zemax => zemax::contents(&measurement, *side),
            ExportFormat::Fit => fit::contents(&measurement),
            ExportFormat::Ssdd => ssdd::contents(&measurement),
        };
        let contents = contents.map_err(unfit)?;
        Ok(Exported {
            format: *format,
            contents,
            cases: measurement.cases.len(),
            planned: measurement.planned,
        })
    }
}

impl Exported {
    /// Writes the file.
    ///
    /// # Errors
    /// [`WriteError`] if it cannot be written.
    pub fn write(&self, output: &Path) -> Result<(), WriteError> {
        write_bytes(output, &self.contents.bytes)
    }

    /// Text on the file that was written.
    #[must_use]
    pub fn text(&self, output: &Path) -> String {
        let Contents {
            agreement, notes, ..
        } = &self.contents;
        format!(
            "{}: {}, {} of {} directions; largest difference between flux in the file and measured flux:\n{}{}",
            shown_path(output),
            self.format.name(),
            self.cases,
            self.planned,
            table(agreement.iter().all(Agreement::is_from_above)).text(farthest(agreement)),
            note_lines(notes)
        )
    }

    /// Summary of the file as JSON.
    #[must_use]
    pub fn summary(&self) -> Value {
        let Contents {
            agreement, notes, ..
        } = &self.contents;
        let mut summary = json!({
            "format": self.format.name(),
            "directions": self.cases,
            "planned": self.planned,
            "agreement": table(false).json(agreement),
            "notes": notes,
        });
        Head::of("export").insert_into(&mut summary);
        summary
    }
}
