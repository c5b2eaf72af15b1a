//! Faces: materials of faces between media, by their indices and the films on them.

use std::f64::consts::PI;

use asperity_optics::{Film, Films, Material};
use asperity_simulate::short;

use crate::config::error::ConfigError;
use crate::config::film_layer::FilmLayer;
use crate::config::named_material::NamedMaterial;

/// Depth in wavelengths at which 1/e of the light is left, below which a medium is opaque.
pub(super) const OPAQUE_DEPTH: f64 = 10.0;

/// The layers of a film between media, the first of which has the index `n_above`; `of`: the index of a material.
pub(super) fn layers_of_film(
    films: &[FilmLayer],
    n_above: f64,
    wavelength_nm: f64,
    of: impl Fn(&NamedMaterial) -> Result<[f64; 2], ConfigError>,
) -> Result<Vec<Film>, ConfigError> {
    let layer = |film: &FilmLayer| {
        let [n, k] = of(&film.material)?;
        Ok(Film {
            eta: n / n_above,
            kappa: k / n_above,
            phase: 2.0 * PI * film.thickness_nm * n_above / wavelength_nm,
        })
    };
    films.iter().map(layer).collect()
}

/// The material of a face: a substrate of relative index `eta + i kappa`, opaque or not, under thin films.
pub(super) fn face(
    films: &[Film],
    [eta, kappa]: [f64; 2],
    is_opaque: bool,
) -> Result<Material, ConfigError> {
    let kappa = if is_opaque { kappa } else { 0.0 };
    Ok(match (films, is_opaque) {
        ([], true) => Material::conductor(eta, kappa)?,
        ([], false) => Material::dielectric(eta)?,
        (films, _) => Material::coated(Films::new(films)?, eta, kappa)?,
    })
}

/// Returns `true` if a medium of this absorption index lets no light through.
pub(super) fn is_opaque(k: f64) -> bool {
    4.0 * PI * k * OPAQUE_DEPTH > 1.0
}

/// Refusal of a record without an absorption index.
pub(super) fn unknown_absorption(named: &NamedMaterial, wavelength_nm: f64) -> ConfigError {
    let given = format!("material {} at {} nm", named.name, short(wavelength_nm));
    let reason = "its record has no absorption index there; give it by --kappa, 0 for a clear one";
    ConfigError::unsuitable(given, reason)
}
