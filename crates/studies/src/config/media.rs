//! Media: named materials above and below the surface, with thin films between them.
//!
//! Indices are relative to the medium above, which is clear, and of index one unless it is named. The medium below is
//! - opaque where light does not get farther than [`OPAQUE_DEPTH`](faces::OPAQUE_DEPTH) wavelengths: a conductor, whose index is complex;
//! - clear where light gets farther than [`CLEAR_NM`] at all other wavelengths of a run: a dielectric;
//! - a dielectric above a body that absorbs along the path of light, otherwise. The index of its interface is then real, which changes its
//!   reflectance by about `(k / n)^2`, but by more near the critical angle of light from a medium of higher index.

mod faces;
mod named_media;
mod resolved;
mod stack;

use std::f64::consts::PI;

use asperity_simulate::short;
use serde::{Deserialize, Serialize};

use self::faces::{face, is_opaque, layers_of_film, unknown_absorption};
pub(crate) use self::named_media::NamedMedia;
pub(crate) use self::resolved::Resolved;
use crate::config::error::ConfigError;
use crate::config::film_layer::FilmLayer;
use crate::config::medium::MediumConfig;
use crate::config::named_material::NamedMaterial;
use crate::config::values::{Number, OneOrMany};

/// Depth in nanometres at which 1/e of the light is left, beyond which a medium without end is clear: 1 mm.
const CLEAR_NM: f64 = 1e6;

/// Absorption index beyond which no light comes through the medium above.
const MAX_KAPPA_ABOVE: f64 = 1e-4;

/// Named media on both sides of the surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Media {
    /// The medium below.
    #[serde(rename = "kind")]
    below: NamedMaterial,
    /// The medium above; of index one unless it is named.
    #[serde(skip_serializing_if = "Option::is_none")]
    above: Option<NamedMaterial>,
    /// Absorption index of media whose records have none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) kappa: Option<OneOrMany<Number>>,
    /// Thin films between the media, from above: `MATERIAL:THICKNESS`.
    #[serde(skip_serializing_if = "Option::is_none")]
    film: Option<OneOrMany<FilmLayer>>,
    /// Decision for all wavelengths of a run whether the medium below absorbs along the path of light; each by itself without one.
    #[serde(skip)]
    has_body: Option<bool>,
}

impl Media {
    /// The media at a wavelength, nanometres.
    ///
    /// # Errors
    /// [`ConfigError`] without a wavelength, or if a record has no index there, the medium above absorbs, an absorption index is not known and
    /// not given, or a film is invalid.
    pub(super) fn resolved(&self, wavelength_nm: Option<f64>) -> Result<Resolved, ConfigError> {
        let wavelength_nm = wavelength_nm.ok_or_else(|| {
            let subject = format!("material {}", self.below.name);
            ConfigError::missing(&subject, "--wavelength, by which its index is looked up")
        })?;
        let given = self.given_kappa()?;
        let of = |named: &NamedMaterial| {
            let index = named.index(wavelength_nm)?;
            let k = index.k.or(given);
            k.map(|k| [index.n, k])
                .ok_or_else(|| unknown_absorption(named, wavelength_nm))
        };
        let above = match &self.above {
            None => 1.0,
            Some(named) => clear_index(named, of(named)?, wavelength_nm)?,
        };
        let films = layers_of_film(self.films(), above, wavelength_nm, of)?;
        let [n, k] = of(&self.below)?;
        let (eta, kappa) = (n / above, k / above);
        let is_opaque = is_opaque(k);
        let has_body = self.has_body.unwrap_or_else(|| is_body(k, wavelength_nm));
        let material = face(&films, [eta, kappa], is_opaque)?;
        Ok(Resolved {
            material,
            named: Some(NamedMedia {
                words: self.words(given),
                wavelength_nm,
                index_above: above,
                absorption: 4.0 * PI * k / wavelength_nm,
                has_body: k > 0.0 && !is_opaque && has_body,
                kappa: given,
            }),
        })
    }

    /// Decides for all wavelengths of a run, nanometres, whether the medium below absorbs along the path of light. `medium`: the layers.
    ///
    /// # Errors
    /// [`ConfigError`] if an absorption index is given where all records have one, or a record has no index.
    pub(super) fn prepare(
        &mut self,
        wavelengths: &[Number],
        medium: Option<&MediumConfig>,
    ) -> Result<(), ConfigError> {
        self.check_kappa(wavelengths, medium)?;
        let given = self.kappa.iter().flat_map(OneOrMany::as_slice);
        let given = given.fold(0.0, |most: f64, kappa| most.max(kappa.0));
        let mut has_body = false;
        for wavelength in wavelengths {
            let k = self.below.index(wavelength.0)?.k.unwrap_or(given);
            has_body |= is_body(k, wavelength.0);
        }
        self.has_body = Some(has_body);
        Ok(())
    }

    fn check_kappa(
        &self,
        wavelengths: &[Number],
        medium: Option<&MediumConfig>,
    ) -> Result<(), ConfigError> {
        let Some(first) = self.kappa.as_ref().and_then(OneOrMany::first) else {
            return Ok(());
        };
        let films = self.films().iter().map(|film| &film.material);
        let all = std::iter::once(&self.below).chain(&self.above).chain(films);
        let all = all.chain(medium.into_iter().flat_map(MediumConfig::materials));
        for named in all {
            for wavelength in wavelengths {
                if named.index(wavelength.0)?.k.is_none() {
                    return Ok(());
                }
            }
        }
        let reason =
            "the absorption index of a named material is that of its record; leave out kappa";
        Err(ConfigError::unsuitable(
            format!("kappa {}", short(first.0)),
            reason,
        ))
    }

    fn given_kappa(&self) -> Result<Option<f64>, ConfigError> {
        let given = self.kappa.as_ref().map(|kappa| kappa.one("kappa"));
        Ok(given.transpose()?.map(|kappa| kappa.0))
    }

    /// The media in words, as in `silicon under SiO2 100 nm in water`.
    fn words(&self, kappa: Option<f64>) -> String {
        let mut words = self.below.label();
        for (number, film) in self.films().iter().enumerate() {
            words += if number == 0 { " under " } else { ", " };
            words += &film.label();
        }
        if let Some(above) = &self.above {
            words += &format!(" in {}", above.label());
        }
        if let Some(kappa) = kappa {
            words += &format!(" with k {}", short(kappa));
        }
        words
    }

    /// The layers of the thin film, from above.
    fn films(&self) -> &[FilmLayer] {
        self.film.as_ref().map_or(&[], OneOrMany::as_slice)
    }
}

/// Returns `true` if light is absorbed in a medium within a depth that may matter, and not at once.
fn is_body(k: f64, wavelength_nm: f64) -> bool {
    !is_opaque(k) && 4.0 * PI * k / wavelength_nm * CLEAR_NM > 1.0
}

/// The refractive index of the medium above, of `[n, k]`.
fn clear_index(
    named: &NamedMaterial,
    [n, k]: [f64; 2],
    wavelength_nm: f64,
) -> Result<f64, ConfigError> {
    if k <= MAX_KAPPA_ABOVE {
        return Ok(n);
    }
    let [k, wavelength] = [k, wavelength_nm].map(short);
    let reason = format!(
        "no light comes through a medium that absorbs, and its k is {k} at {wavelength} nm"
    );
    Err(ConfigError::unsuitable(
        format!("above {}", named.name),
        reason,
    ))
}

#[cfg(test)]
mod tests {
    use asperity_optics::Material;
    use asperity_simulate::Case;

    use super::*;
    use crate::config::VerifyConfig;

    const SURFACE: &str = "[surface]\nsigma = 1\ntau = 8\nunit = \"um\"\n";

    fn cases(surface: &str, material: &str, wavelength: &str) -> Result<Vec<Case>, String> {
        let text = format!(
            "{surface}[material]\n{material}\n[light]\nwavelength = {wavelength}\n[compare]\nmodels = []"
        );
        let config = VerifyConfig::from_toml(&text).map_err(|error| error.to_string())?;
        let plan = config.plan().map_err(|error| error.to_string())?;
        Ok(plan.cases)
    }

    fn case(material: &str, wavelength: f64) -> Case {
        let found = cases(SURFACE, material, &wavelength.to_string());
        found.unwrap().swap_remove(0)
    }

    /// P. B. Johnson and R. W. Christy, Phys. Rev. B 6, 4370 (1972), linear between their points.
    #[test]
    fn metals_are_conductors_of_their_index_at_each_wavelength() {
        let gold = cases(SURFACE, "kind = \"gold\"", "[550, 633]").unwrap();
        let Material::Conductor { eta, kappa } = gold[0].material else {
            panic!("{:?}", gold[0].material);
        };
        assert!((eta - 0.424_149).abs() < 1e-5 && (kappa - 2.472_051).abs() < 1e-5);
        assert_eq!(gold[1].at.wavelength_nm(), Some(633.0));
        assert_eq!(gold[0].surface, gold[1].surface);
        let name = gold[0].folder();
        assert!(name.contains("wavelength550") && gold[0].label().contains("lambda = 550 nm"));
        let in_water = case("kind = \"gold\"\nabove = \"water\"", 550.0);
        let Material::Conductor { eta: wet, .. } = in_water.material else {
            panic!("{:?}", in_water.material);
        };
        assert!((eta / wet - 1.333).abs() < 1e-3);
    }

    #[test]
    fn bodies_absorb_by_depth_between_clear_and_opaque() {
        let silicon = |nm| case("kind = \"silicon\"", nm);
        assert!(matches!(
            silicon(400.0).material,
            Material::Conductor { .. }
        ));
        let red = silicon(800.0);
        let layer = red.layers[0];
        assert!(matches!(red.material, Material::Dielectric { eta } if (3.6..3.8).contains(&eta)));
        // 1 / 11.8 um
        let absorption = layer.medium().extinction() * (1.0 - layer.medium().albedo());
        assert!((0.06..0.11).contains(&absorption), "{absorption}");
        assert!(case("kind = \"water\"", 550.0).layers.is_empty());
        // 50 um at 2 um: the body is one at all wavelengths, or at none
        let both = cases(SURFACE, "kind = \"water\"", "[550, 2000]").unwrap();
        assert!(both.iter().all(|case| !case.layers.is_empty()));
        let slab = case("kind = \"water\"\n[medium]\nthickness = \"2mm\"", 700.0);
        assert!(slab.layers[0].medium().extinction() > 0.0);
    }

    /// A film whose index is that of the medium above changes nothing.
    #[test]
    fn films_are_relative_to_the_medium_above() {
        let reflected = |material: &str| case(material, 550.0).material.fresnel(0.8).reflected;
        let bare = reflected("kind = \"gold\"\nabove = \"water\"");
        let water = "1.333+0i:300nm";
        let coated = reflected(&format!(
            "kind = \"gold\"\nabove = \"water\"\nfilm = \"{water}\""
        ));
        assert!((bare - coated).abs() < 1e-3, "{bare} {coated}");
        let in_air = reflected(&format!("kind = \"gold\"\nfilm = \"{water}\""));
        assert!((bare - in_air).abs() > 0.01);
        let stack = case(
            "kind = \"silicon\"\nfilm = [\"SiO2:100nm\", \"Si3N4:60nm\", \"SiO2:100nm\"]\nkappa = 0",
            400.0,
        );
        let Material::Coated { films, .. } = stack.material else {
            panic!("{:?}", stack.material);
        };
        assert_eq!(films.layers().len(), 3);
        assert_eq!(films.layers()[0], films.layers()[2]);
        assert!((films.layers()[0].phase - 2.0 * PI * 100.0 / 400.0).abs() < 1e-12);
    }

    #[test]
    fn refusals_say_what_is_missing() {
        for (surface, material, wavelength, words) in [
            (SURFACE, "kind = \"gold\"", "50", "range"),
            (
                SURFACE,
                "kind = \"gold\"\nkappa = 3",
                "550",
                "leave out kappa",
            ),
            (
                SURFACE,
                "kind = \"SiO2\"",
                "550",
                "give it by --kappa, 0 for a clear one",
            ),
            (
                SURFACE,
                "kind = \"gold\"\nabove = \"silver\"",
                "550",
                "no light comes through",
            ),
            (SURFACE, "kind = \"goldd\"", "550", "did you mean gold?"),
            (
                SURFACE,
                "kind = \"mirror\"\nfilm = \"SiO2:100nm\"",
                "550",
                "NAME or INDEX",
            ),
            (SURFACE, "kind = \"mirror\"", "[550, 600]", "a named one"),
            ("", "kind = \"silicon\"", "800", "have no unit"),
        ] {
            let said = cases(surface, material, wavelength).unwrap_err();
            assert!(said.contains(words), "{material}: {said}");
        }
    }
}
