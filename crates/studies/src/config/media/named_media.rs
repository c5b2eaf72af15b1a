//! Named media: names and indices of the media on both sides of a surface, at one wavelength.

/// Named media at one wavelength.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NamedMedia {
    /// Their names, as in `silicon under SiO2 100 nm in water`.
    pub(crate) words: String,
    /// Wavelength in vacuum, nanometres.
    pub(crate) wavelength_nm: f64,
    /// Refractive index of the medium above.
    pub(crate) index_above: f64,
    /// Absorption coefficient of the medium below, 1 / nm.
    pub(crate) absorption: f64,
    /// `true` if the medium below absorbs along the path of light.
    pub(crate) has_body: bool,
    /// Absorption index of media whose records have none.
    pub(super) kappa: Option<f64>,
}
