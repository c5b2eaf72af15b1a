//! Media: named materials above and below the surface, with thin films between them.
//!
//! Indices are relative to the medium above, which is clear, and of index one unless it is named. The medium below is
//! - opaque where light does not get farther than [`OPAQUE_DEPTH`] wavelengths: a conductor, whose index is complex;
//! - clear where light gets farther than [`CLEAR_NM`], unless it has a thickness: a dielectric;
//! - a dielectric above a body that absorbs along the path of light, otherwise. The index of its interface is then real, which changes its
//!   reflectance by less than `(k / n)^2`, 1e-4 at the most.

use std::f64::consts::PI;
use std::sync::Arc;

use asperity_io::{MaterialRecord, material, names_file};
use asperity_numerics::fnv1a;
use asperity_optics::{
    ComplexIndex, Film, Films, Layer, Material, ParticipatingMedium, PhaseFunction,
};
use asperity_simulate::{Coordinate, Coordinates, short};
use asperity_surface::LengthUnit;
use asperity_tracer::HalfSpace;
use serde::{Deserialize, Serialize, Serializer};

use super::medium::MediumConfig;
use super::memo::Memo;
use crate::config::error::ConfigError;
use crate::config::values::{Number, OneOrMany};
use crate::settings::film_text::{FilmMaterial, FilmText};

/// Depth in wavelengths at which 1/e of the light is left, below which a medium is opaque.
const OPAQUE_DEPTH: f64 = 10.0;

/// Depth in nanometres at which 1/e of the light is left, beyond which a medium without end is clear: 0.1 m.
const CLEAR_NM: f64 = 1e8;

/// Medium that is clear, though its record has no absorption index.
const AIR: &str = "air";

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
}

/// Material of a surface at one wavelength.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Resolved {
    /// Material of the interface, for light from above.
    pub(crate) material: Material,
    /// Named media, in words, and their wavelength, nanometres.
    pub(crate) named: Option<(String, f64)>,
    /// Absorption coefficient of the body below, 1 / nm.
    absorption: f64,
}

impl Resolved {
    /// A material that is given by numbers.
    pub(super) const fn of(material: Material) -> Self {
        Self {
            material,
            named: None,
            absorption: 0.0,
        }
    }

    /// Material for light from the half space `from`, with indices relative to the medium there.
    ///
    /// # Errors
    /// [`ConfigError`] if light is to come from a named medium that absorbs it.
    pub(crate) fn lit(self, from: HalfSpace) -> Result<Self, ConfigError> {
        let Some((name, _)) = self.named.as_ref().filter(|_| from == HalfSpace::Below) else {
            return Ok(self);
        };
        if self.material.transmitting_index().is_none() || self.has_body() {
            let given = format!("light from below, through {name}");
            return Err(ConfigError::unsuitable(
                given,
                "needs a medium below that does not absorb",
            ));
        }
        Ok(Self {
            material: self.material.reversed(),
            ..self
        })
    }

    /// Returns `true` if the body below absorbs along the path of light.
    pub(crate) fn has_body(&self) -> bool {
        self.absorption * CLEAR_NM >= 1.0
    }

    /// Coordinates `at` with the names of the media and the wavelength.
    pub(crate) fn coordinates(&self, mut at: Coordinates) -> Coordinates {
        if let Some((name, wavelength)) = &self.named {
            at.material = Some(name.clone());
            at.others.push(Coordinate::wavelength(*wavelength));
        }
        at
    }

    /// The layer below the surface, whose lengths are in `unit`: a medium that is configured, a body that absorbs, or both.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range, the material transmits no light, or the body absorbs over lengths without a unit.
    pub(crate) fn layer(
        &self,
        medium: Option<&MediumConfig>,
        unit: LengthUnit,
    ) -> Result<Option<Layer>, ConfigError> {
        let is_clear = !self.has_body();
        let absorption = match LengthUnit::Nanometre.conversion(unit) {
            Some(nm) => self.absorption / nm(1.0),
            None if is_clear => 0.0,
            None => {
                let (name, wavelength) = self.named.clone().unwrap_or_default();
                let given = format!("{name} at {} nm", short(wavelength));
                let reason = "absorbs over a length, but the lengths of the surface have no unit: give one by --unit, or to a file by --assume-unit";
                return Err(ConfigError::unsuitable(given, reason));
            }
        };
        match medium {
            Some(medium) => medium.layer(self.material, absorption).map(Some),
            None if is_clear => Ok(None),
            None => {
                let isotropic = PhaseFunction::Isotropic;
                let body = ParticipatingMedium::from_coefficients(absorption, 0.0, isotropic)?;
                Ok(Some(Layer::half_space(body)))
            }
        }
    }
}

impl Media {
    /// The media at a wavelength, nanometres.
    ///
    /// # Errors
    /// [`ConfigError`] without a wavelength, or if a record has no index there, the medium above absorbs, the absorption index is given
    /// but known, or a film is invalid.
    pub(super) fn resolved(&self, wavelength_nm: Option<f64>) -> Result<Resolved, ConfigError> {
        let wavelength = wavelength_nm.ok_or_else(|| {
            let subject = format!("material {}", self.below.name);
            ConfigError::missing(&subject, "--wavelength, by which its index is looked up")
        })?;
        let above = match &self.above {
            None => 1.0,
            Some(named) => named.clear_index(wavelength)?,
        };
        let given = self.kappa.as_ref().map(|kappa| kappa.one("kappa"));
        let given = given.transpose()?.map(|kappa| kappa.0);
        let mut below = self.below.index(wavelength)?;
        if self.below.name == AIR {
            below.k = Some(0.0);
        }
        let mut is_needed = below.k.is_none();
        let mut films = Vec::new();
        for film in self.films() {
            let index = film.index(wavelength)?;
            is_needed |= index.k.is_none();
            films.push(Film {
                eta: index.n / above,
                kappa: index.k.or(given).unwrap_or_default() / above,
                phase: 2.0 * PI * film.thickness * above / wavelength,
            });
        }
        match given {
            Some(kappa) if !is_needed => {
                let reason = "the absorption index of a named material is that of its record; leave out kappa";
                return Err(ConfigError::unsuitable(
                    format!("kappa {}", short(kappa)),
                    reason,
                ));
            }
            None if is_needed => return Err(self.unknown_absorption(wavelength)),
            _ => {}
        }
        let k = below.k.or(given).unwrap_or_default();
        let (eta, kappa) = (below.n / above, k / above);
        let absorption = 4.0 * PI * k / wavelength;
        let is_opaque = absorption * OPAQUE_DEPTH * wavelength > 1.0;
        let material = match (films.as_slice(), is_opaque) {
            ([], true) => Material::conductor(eta, kappa)?,
            ([], false) => Material::dielectric(eta)?,
            (films, true) => Material::coated(Films::new(films)?, eta, kappa)?,
            (films, false) => Material::coated(Films::new(films)?, eta, 0.0)?,
        };
        Ok(Resolved {
            material,
            named: Some((self.words(), wavelength)),
            absorption: if is_opaque { 0.0 } else { absorption },
        })
    }

    /// Refusal of records without an absorption index.
    fn unknown_absorption(&self, wavelength: f64) -> ConfigError {
        let given = format!("material {} at {} nm", self.below.name, short(wavelength));
        let reason = "the record of the material or of a film has no absorption index; give it by --kappa, 0 for a clear one";
        ConfigError::unsuitable(given, reason)
    }

    /// The media in words, as in `silicon under SiO2 100 nm in water`.
    fn words(&self) -> String {
        let mut words = self.below.label();
        for (number, film) in self.films().iter().enumerate() {
            words += if number == 0 { " under " } else { ", " };
            words += &film.label();
        }
        if let Some(above) = &self.above {
            words += &format!(" in {}", above.label());
        }
        words
    }

    /// The layers of the thin film, from above.
    fn films(&self) -> &[FilmLayer] {
        self.film.as_ref().map_or(&[], OneOrMany::as_slice)
    }
}

/// A material by its name, or by the name of a file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(from = "String")]
struct NamedMaterial {
    name: String,
    record: Memo<(), Arc<MaterialRecord>>,
}

impl From<String> for NamedMaterial {
    fn from(name: String) -> Self {
        Self {
            name,
            record: Memo::default(),
        }
    }
}

/// By its name, with the content of a file, so that results of another are told apart.
impl Serialize for NamedMaterial {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.record() {
            Ok(record) if names_file(&self.name) => {
                let content = fnv1a(format!("{:?}", record.constants).into_bytes());
                serializer.collect_str(&format_args!("{} ({content:016x})", self.name))
            }
            _ => serializer.serialize_str(&self.name),
        }
    }
}

impl NamedMaterial {
    /// Its record, read once for all copies.
    fn record(&self) -> Result<Arc<MaterialRecord>, ConfigError> {
        let read = |&(): &()| match material(&self.name) {
            Ok(record) => Ok(Arc::new(record)),
            Err(error) => Err(ConfigError::Record(error.to_string())),
        };
        self.record.measured((), read)
    }

    /// Its name; of a file that of its record, without the folder.
    fn label(&self) -> String {
        match self.record() {
            Ok(record) if names_file(&self.name) => record.name.clone(),
            _ => self.name.clone(),
        }
    }

    /// Its index at a wavelength.
    fn index(&self, wavelength_nm: f64) -> Result<ComplexIndex, ConfigError> {
        let record = self.record()?;
        let found = record.constants.at(wavelength_nm * 1e-3);
        found.map_err(|error| ConfigError::unsuitable(self.name.clone(), error.to_string()))
    }

    /// Its index as the medium that light comes through: it is clear unless its record says otherwise.
    fn clear_index(&self, wavelength_nm: f64) -> Result<f64, ConfigError> {
        match self.index(wavelength_nm)? {
            ComplexIndex { k: Some(k), .. } if k > MAX_KAPPA_ABOVE => {
                let given = format!("above {}", self.name);
                let reason = format!(
                    "no light comes through a medium that absorbs, and its k is {} at {} nm",
                    short(k),
                    short(wavelength_nm)
                );
                Err(ConfigError::unsuitable(given, reason))
            }
            index => Ok(index.n),
        }
    }
}

/// One layer of a thin film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String")]
struct FilmLayer {
    /// Thickness, nanometres.
    thickness: f64,
    material: FilmOf,
}

/// Material of a layer of a thin film.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
enum FilmOf {
    Named(NamedMaterial),
    Index { n: f64, k: f64 },
}

impl TryFrom<String> for FilmLayer {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let layer =
            FilmText::parse(&text).ok_or_else(|| format!("{text} is no layer of a film"))?;
        let material = match layer.material {
            FilmMaterial::Named(name) => FilmOf::Named(name.into()),
            FilmMaterial::Index { n, k } => FilmOf::Index { n, k },
        };
        Ok(Self {
            thickness: layer.thickness_nm,
            material,
        })
    }
}

impl FilmLayer {
    /// The layer in words, as in `SiO2 100 nm`.
    fn label(&self) -> String {
        let material = match &self.material {
            FilmOf::Named(named) => named.label(),
            FilmOf::Index { n, k: 0.0 } => format!("n = {}", short(*n)),
            FilmOf::Index { n, k } => format!("n = {} + {}i", short(*n), short(*k)),
        };
        format!("{material} {} nm", short(self.thickness))
    }

    /// Its index at a wavelength.
    fn index(&self, wavelength_nm: f64) -> Result<ComplexIndex, ConfigError> {
        match &self.material {
            FilmOf::Named(named) => named.index(wavelength_nm),
            &FilmOf::Index { n, k } => Ok(ComplexIndex { n, k: Some(k) }),
        }
    }
}

#[cfg(test)]
mod tests {
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
        let layer = red.layer.unwrap().layer;
        assert!(matches!(red.material, Material::Dielectric { eta } if (3.6..3.8).contains(&eta)));
        // 1 / 11.8 um
        let absorption = layer.medium().extinction() * (1.0 - layer.medium().albedo());
        assert!((0.06..0.11).contains(&absorption), "{absorption}");
        assert!(case("kind = \"water\"", 550.0).layer.is_none());
        let slab = case("kind = \"water\"\n[medium]\nthickness = \"2mm\"", 700.0);
        assert!(slab.layer.unwrap().layer.medium().extinction() > 0.0);
    }

    /// Film whose index matches the medium above: it reflects nothing by itself.
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
                "a named material",
            ),
            (SURFACE, "kind = \"mirror\"", "[550, 600]", "a named one"),
            ("", "kind = \"silicon\"", "800", "have no unit"),
        ] {
            let said = cases(surface, material, wavelength).unwrap_err();
            assert!(said.contains(words), "{material}: {said}");
        }
    }
}
