//! Registry of models: the one list of their names.
//!
//! A new model is one file in this folder, and one line in [`REGISTRY`].

use asperity_optics::Material;

use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::models::heitz::Heitz;
use crate::models::heitz_polarised::HeitzPolarised;
use crate::models::model::{BsdfModel, Constructor, ModelEntry, ModelError, ScatteringModel};
use crate::models::neumann::CookTorranceNeumann;
use crate::models::oren_nayar::OrenNayar;
use crate::models::smith::Smith;
use crate::models::smith_slopes::SmithSlopes;
use crate::models::v_cavity::VCavity;
use crate::models::xu_sun::XuSun;
use crate::models::xu_sun_mc::XuSunMonteCarlo;

/// All models, in the order in which they are listed.
const REGISTRY: &[ModelEntry] = &[
    XuSun::ENTRY,
    XuSunMonteCarlo::ENTRY,
    XuSunMonteCarlo::ENTRY_SMITH,
    Smith::ENTRY_CORRELATED,
    Smith::ENTRY_SEPARABLE,
    Smith::ENTRY_GGX,
    Smith::ENTRY_GGX_SEPARABLE,
    SmithSlopes::ENTRY,
    Heitz::ENTRY,
    Heitz::ENTRY_GGX,
    HeitzPolarised::ENTRY,
    VCavity::ENTRY,
    CookTorranceNeumann::ENTRY_GROOVES,
    CookTorranceNeumann::ENTRY_SMITH,
    OrenNayar::ENTRY,
];

/// The names that [`create_model`] accepts.
pub const MODEL_NAMES: &[&str] = &names::<{ REGISTRY.len() }>(false);

/// The names of the models that have a density at every direction, which [`closed_form`] accepts.
pub const CLOSED_FORMS: &[&str] = &names::<{ closed_form_count() }>(true);

const fn is_closed_form(entry: &ModelEntry) -> bool {
    matches!(entry.constructor, Constructor::ClosedForm(_))
}

const fn closed_form_count() -> usize {
    let (mut i, mut count) = (0, 0);
    while i < REGISTRY.len() {
        count += is_closed_form(&REGISTRY[i]) as usize;
        i += 1;
    }
    count
}

const fn names<const N: usize>(closed_forms_alone: bool) -> [&'static str; N] {
    let mut names = [""; N];
    let (mut i, mut n) = (0, 0);
    while i < REGISTRY.len() {
        if !closed_forms_alone || is_closed_form(&REGISTRY[i]) {
            names[n] = REGISTRY[i].info.name;
            n += 1;
        }
        i += 1;
    }
    names
}

/// Creates the model of the given name for a surface of these `slopes` and `material`. Models of Gaussian slopes take their
/// covariance.
///
/// # Errors
/// [`ModelError::Unknown`] for a name that is not in [`MODEL_NAMES`]; otherwise as the model's own
/// constructor.
///
/// # Examples
/// ```
/// use asperity_analysis::{MODEL_NAMES, SlopeCovariance, create_model};
/// use asperity_optics::{Material, from_spherical};
///
/// assert!(MODEL_NAMES.contains(&"smith"));
/// let slopes = SlopeCovariance::isotropic(2.0)?;
/// let model = create_model("smith", slopes, Material::dielectric(1.5)?)?;
/// println!("{}: {}", model.name(), model.valid_range());
///
/// // Evaluate the BSDF, in 1/sr, at a pair of directions: near the mirror direction, and transmitted.
/// let bsdf = model.density().ok_or("no closed form")?;
/// let wi = from_spherical(0.5, 0.0);
/// let reflected = from_spherical(0.6, 3.1);
/// let transmitted = from_spherical(2.8, 3.1);
/// assert!(bsdf.bsdf(wi, reflected) > 0.0 && bsdf.bsdf(wi, transmitted) > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn create_model(
    name: &str,
    slopes: impl Into<SlopeDistribution>,
    material: Material,
) -> Result<Box<dyn ScatteringModel>, ModelError> {
    match constructor(name) {
        Some(Constructor::ClosedForm(create)) => Ok(create(&slopes.into(), material)?),
        Some(Constructor::RandomWalk(create)) => create(&slopes.into(), material),
        None => Err(unknown(name, MODEL_NAMES)),
    }
}

/// Creates the model of the given name, if it has a density at every direction.
///
/// # Errors
/// [`ModelError::Unknown`] for a name that is not in [`CLOSED_FORMS`]; otherwise as the model's own
/// constructor.
pub fn closed_form(
    name: &str,
    slopes: impl Into<SlopeDistribution>,
    material: Material,
) -> Result<Box<dyn BsdfModel>, ModelError> {
    match constructor(name) {
        Some(Constructor::ClosedForm(create)) => create(&slopes.into(), material),
        _ => Err(unknown(name, CLOSED_FORMS)),
    }
}

fn constructor(name: &str) -> Option<Constructor> {
    let entry = REGISTRY.iter().find(|entry| entry.info.name == name)?;
    Some(entry.constructor)
}

fn unknown(name: &str, known: &'static [&'static str]) -> ModelError {
    ModelError::Unknown {
        name: name.to_owned(),
        known,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SlopeCovariance;

    fn refusal(name: &str, smoothness: f64, material: Material) -> String {
        let slopes = match SlopeCovariance::isotropic(smoothness) {
            Ok(slopes) => slopes,
            Err(error) => return error.to_string(),
        };
        match create_model(name, slopes, material) {
            Ok(model) => panic!("{} was accepted", model.name()),
            Err(error) => error.to_string(),
        }
    }

    /// A material that the model is for.
    fn suited(name: &str) -> Material {
        match name {
            OrenNayar::NAME => Material::Lambertian { reflectance: 0.8 },
            _ => Material::Mirror,
        }
    }

    #[test]
    fn every_name_creates_the_model_of_that_name() {
        for &name in MODEL_NAMES {
            let slopes = SlopeCovariance::isotropic(2.0).unwrap();
            let model = create_model(name, slopes, suited(name)).unwrap();
            assert_eq!(model.name(), name);
            assert!(!model.description().is_empty() && !model.valid_range().is_empty());
            assert!(model.density().is_some() || model.random_walk().is_some());
        }
    }

    #[test]
    fn unknown_names_are_refused_with_the_list() {
        assert_eq!(
            refusal("phong", 2.0, Material::Mirror),
            format!(
                "unknown model `phong`; the models are {}",
                MODEL_NAMES.join(", ")
            )
        );
    }

    #[test]
    fn invalid_surfaces_and_materials_are_refused() {
        for &name in MODEL_NAMES {
            for s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
                assert!(refusal(name, s, Material::Mirror).contains("smoothness"));
            }
            let white = Material::Lambertian { reflectance: 1.2 };
            if name == OrenNayar::NAME {
                assert!(refusal(name, 2.0, Material::Mirror).contains("Lambertian facets"));
                assert!(refusal(name, 2.0, white).contains("reflectance"));
                continue;
            }
            assert!(refusal(name, 2.0, white).contains("take oren-nayar"));
            assert!(refusal(name, 2.0, Material::Dielectric { eta: 1.0 }).contains("delta"));
            assert!(refusal(name, 2.0, Material::Dielectric { eta: -1.0 }).contains("eta is -1"));
            let conductor = Material::Conductor {
                eta: 0.2,
                kappa: f64::NAN,
            };
            assert!(refusal(name, 2.0, conductor).contains("kappa"));
        }
    }

    #[test]
    fn closed_forms_are_the_models_without_a_random_walk() {
        let slopes = SlopeCovariance::isotropic(2.0).unwrap();
        let without_walk: Vec<&str> = MODEL_NAMES
            .iter()
            .copied()
            .filter(|name| {
                let model = create_model(name, slopes, suited(name)).unwrap();
                model.random_walk().is_none()
            })
            .collect();
        assert_eq!(without_walk, CLOSED_FORMS);
    }

    #[test]
    fn names_are_distinct() {
        let names: std::collections::BTreeSet<_> = MODEL_NAMES.iter().collect();
        assert_eq!(names.len(), MODEL_NAMES.len());
    }
}
