//! Material record: a material with its optical constants and their source.

use asperity_optics::OpticalConstants;

/// A material with its optical constants and where they come from.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialRecord {
    /// Name, such as `Au`; of a file without a name that of the file.
    pub name: String,
    /// Other names.
    pub aliases: Vec<String>,
    /// Record of the refractiveindex.info database, `shelf/book/page`; empty if unknown.
    pub record: String,
    /// Reference as text, its lines separated by line feeds; empty if unknown.
    pub source: String,
    /// First author and year of the reference, such as `Johnson 1972`; empty if unknown.
    pub cite: String,
    /// DOI of the reference; `None` if unknown.
    pub doi: Option<String>,
    /// `n` and `k` against the wavelength.
    pub constants: OpticalConstants,
}
