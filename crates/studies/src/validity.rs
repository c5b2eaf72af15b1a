//! Validity of geometric optics: lengths of a surface against the wavelength.
//!
//! Numbers that must be large. The root mean square phase difference of light from high and low points, per side:
//! `4 pi sigma n_i cos(theta_i) / lambda` of reflected light, the Rayleigh parameter, and
//! `2 pi sigma |n_t cos(theta_t) - n_i cos(theta_i)| / lambda` of transmitted light; a fraction `exp(-phase^2)` of what a Gaussian surface
//! reflects or transmits stays coherent (Beckmann and Spizzichino 1963). `tau / lambda` is the correlation length over the wavelength. The
//! radius of curvature over `lambda / cos^3(theta)` tells whether a facet is level enough to act as a plane.
//!
//! The wavelength is that in the medium above the surface, whose index is one here.

use std::f64::consts::PI;
use std::fmt;

use asperity_optics::{Bottom, Material};
use asperity_simulate::{BottomSurface, Case, short};
use asperity_surface::LengthUnit;
use asperity_tally::{Component, Side, TallyResult, TallySpec, TallyStatistics};
use asperity_tracer::HalfSpace;
use serde::Serialize;

use crate::surface_lengths::SurfaceLengths;

/// The wavelength unless one is given, in nanometres: the middle of visible light.
pub const DEFAULT_WAVELENGTH_NM: f64 = 550.0;

/// Least value of each number. A phase of 3 leaves 1.2e-4 of the light coherent.
pub const LARGE: f64 = 3.0;

/// Value from which on numbers say nothing more, as those of terrain in light.
const BEYOND_DOUBT: f64 = 1e4;

/// Coherent fraction of the light of a side from which on a report begins with it.
const MUCH: f64 = 0.01;

/// Wavelengths that are likely meant, nanometres: from X-rays to microwaves there are others, but a wrong unit is more frequent.
const USUAL_NM: [f64; 2] = [50.0, 50_000.0];

/// Phase of a component of the light, and as much of it as stays coherent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Coherence {
    /// Root mean square phase difference of light from different points, radians.
    pub phase_parameter: f64,
    /// Fraction `exp(-phase^2)` of the component that stays coherent, of a Gaussian surface.
    pub coherent_fraction: f64,
}

impl Coherence {
    fn of(phase: f64) -> Self {
        Self {
            phase_parameter: phase,
            coherent_fraction: (-phase * phase).exp(),
        }
    }
}

/// Lengths of a surface against the wavelength, for one direction of the light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Validity {
    /// Wavelength of the light, nanometres.
    pub wavelength_nm: f64,
    /// `true` if it is assumed, none being given.
    pub wavelength_is_assumed: bool,
    /// Light that the surface reflects, none of it coherent if facets are Lambertian; `None` where the side is not recorded. Its phase is the
    /// Rayleigh parameter, `4 pi sigma n_i cos(theta) / lambda`.
    pub reflected: Option<Coherence>,
    /// Light that is transmitted, through a layer without being scattered inside; `None` where there is none or the side is not recorded.
    pub transmitted: Option<Coherence>,
    /// Light that the bottom of a layer reflects and that leaves without being scattered inside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reflected_by_bottom: Option<Coherence>,
    /// The shorter correlation length over the wavelength; `None` where the surface has none.
    pub tau_over_wavelength: Option<f64>,
    /// `R cos^3(theta) / lambda`, R being one over the root mean square second derivative along the more curved axis;
    /// `None` for a surface without curvature, or where it is not known.
    pub curvature_radius_over_wavelength: Option<f64>,
    /// `true` if all of them are at least [`LARGE`]; `None` where those that are known are, and others are not known.
    pub holds: Option<bool>,
}

impl Validity {
    /// For the light of a case on a surface of these lengths, whose layer ends on a surface of the lengths `bottom` if that is one of its own;
    /// `None` if their unit is not known, or the surface is flat. `wavelength_nm`: [`DEFAULT_WAVELENGTH_NM`] without one.
    #[must_use]
    pub fn new(
        lengths: &SurfaceLengths,
        bottom: Option<&SurfaceLengths>,
        case: &Case,
        spec: &TallySpec,
        wavelength_nm: Option<f64>,
    ) -> Option<Self> {
        let nanometres = wavelength_nm.unwrap_or(DEFAULT_WAVELENGTH_NM);
        let wavelength = LengthUnit::Nanometre.conversion(lengths.unit)?(nanometres);
        if lengths.sigma == 0.0 {
            return None;
        }
        let differences = PathDifferences::of(lengths, bottom, case);
        let phase = |difference: f64| Coherence::of(2.0 * PI / wavelength * difference);
        let recorded = |side| spec.records(side);
        let reflected = recorded(Side::Reflected).then(|| match case.material {
            Material::Lambertian { .. } => Coherence {
                coherent_fraction: 0.0,
                ..phase(differences.reflected)
            },
            _ => phase(differences.reflected),
        });
        let transmitted = differences
            .transmitted
            .filter(|_| recorded(Side::Transmitted));
        let by_bottom = differences.by_bottom.filter(|_| recorded(Side::Reflected));
        let [transmitted, reflected_by_bottom] =
            [transmitted, by_bottom].map(|difference| difference.map(phase));
        let cos = case.light.incidence.theta().cos();
        let tau = lengths.tau.map(|tau| tau / wavelength);
        let curvature = lengths.curvature.filter(|curvature| *curvature > 0.0);
        let radius = curvature.map(|curvature| cos.powi(3) / (curvature * wavelength));
        let mut validity = Self {
            wavelength_nm: nanometres,
            wavelength_is_assumed: wavelength_nm.is_none(),
            reflected,
            transmitted,
            reflected_by_bottom,
            tau_over_wavelength: tau,
            curvature_radius_over_wavelength: radius,
            holds: None,
        };
        let is_doubtful = validity.least() < LARGE;
        // A surface without curvature has no radius to fall short.
        let is_complete = tau.is_some() && lengths.curvature.is_some();
        validity.holds = (is_doubtful || is_complete).then_some(!is_doubtful);
        Some(validity)
    }

    /// For the light of a case on random surfaces; `None` on given ones, and as of [`Self::new`].
    pub(crate) fn of_random(
        case: &Case,
        spec: &TallySpec,
        wavelength_nm: Option<f64>,
    ) -> Option<Self> {
        let lengths = SurfaceLengths::of_recipe(case.surface.recipe()?, case.at.unit);
        Self::new(&lengths, None, case, spec, wavelength_nm)
    }

    /// The least of all numbers that are known.
    fn least(&self) -> f64 {
        let lengths = [
            self.tau_over_wavelength,
            self.curvature_radius_over_wavelength,
        ];
        lengths
            .into_iter()
            .flatten()
            .fold(self.least_phase(), f64::min)
    }

    /// The least phase of a side.
    pub(crate) fn least_phase(&self) -> f64 {
        let all = [self.reflected, self.transmitted, self.reflected_by_bottom];
        let phases = all.into_iter().flatten().map(|one| one.phase_parameter);
        phases.fold(f64::INFINITY, f64::min)
    }

    /// The note of a report; `None` where nothing is in doubt and no wavelength was given.
    pub(crate) fn note(&self) -> Option<String> {
        let is_plain = self.least() > BEYOND_DOUBT && self.wavelength_is_assumed;
        (!is_plain).then(|| self.to_string())
    }

    /// The light of a side that is coherent, as a flux, and over that of the side; of what rays found.
    fn coherent(&self, statistics: &TallyStatistics, side: Side) -> Option<[f64; 2]> {
        let flux = |component| statistics.flux(side, component).mean;
        let single = flux(Component::Single);
        let unscattered = match statistics.spec().has_medium() {
            true => flux(Component::Unscattered),
            false => single,
        };
        let of = |coherence: Option<Coherence>, flux: f64| {
            coherence.map_or(0.0, |one| one.coherent_fraction * flux.max(0.0))
        };
        let coherent = match side {
            Side::Reflected => {
                of(self.reflected, single) + of(self.reflected_by_bottom, unscattered - single)
            }
            Side::Transmitted => of(self.transmitted, unscattered),
        };
        let all = flux(Component::All);
        (all > 0.0).then(|| [coherent, coherent / all])
    }

    /// The first lines of a report: light that is coherent, per side, where that is more than a hundredth.
    pub(crate) fn first_lines(&self, statistics: &TallyStatistics) -> Option<String> {
        let recorded = statistics.spec().sides();
        let found = recorded.filter_map(|side| Some((side, self.coherent(statistics, side)?)));
        let much: Vec<String> = found
            .filter(|(_, [_, share])| *share > MUCH)
            .map(|(side, [flux, share])| {
                format!(
                    "{:.1} % of the {side} light (a flux of {})",
                    100.0 * share,
                    short(three(flux))
                )
            })
            .collect();
        self.warning(&much)
    }

    /// The first lines of a report that has no fluxes by component: the largest fraction of the light of each side that may be coherent.
    pub(crate) fn first_lines_at_most(&self) -> Option<String> {
        let sides = [
            (Side::Reflected, self.reflected),
            (Side::Transmitted, self.transmitted),
        ];
        let fractions = sides
            .into_iter()
            .filter_map(|(side, one)| Some((side, one?.coherent_fraction)));
        let much = fractions.filter(|(_, fraction)| *fraction > MUCH);
        let much: Vec<String> = much
            .map(|(side, fraction)| format!("up to {:.1} % of the {side} light", 100.0 * fraction))
            .collect();
        self.warning(&much)
    }

    fn warning(&self, much: &[String]) -> Option<String> {
        (!much.is_empty()).then(|| {
            format!(
                "warning: {} {} coherent at {}: a wave leaves in the direction of light on a flat surface, and all numbers here hold it in the lobe of the rays",
                much.join(" and "),
                if much.len() > 1 { "are" } else { "is" },
                self.wavelength()
            )
        })
    }

    fn wavelength(&self) -> String {
        let assumed = match self.wavelength_is_assumed {
            true => ", assumed without --wavelength",
            false => "",
        };
        format!("{} nm{assumed}", short(self.wavelength_nm))
    }
}

/// The first of the warnings of several named cases, and the number of others; `cases` is what they are called.
pub(crate) fn first_warning(
    mut warnings: impl Iterator<Item = (String, String)>,
    cases: &str,
) -> Option<String> {
    let (name, line) = warnings.next()?;
    let others = match warnings.count() {
        0 => String::new(),
        others => format!("; the same, with other fractions, in {others} other {cases}"),
    };
    let line = line.trim_start_matches("warning: ");
    Some(format!("warning: {name}: {line}{others}"))
}

/// The note on the one of several named cases where lengths are shortest against the wavelength, and the number of others that are doubtful.
pub(crate) fn note_of_several(known: &[(String, Validity)], cases: &str) -> Option<String> {
    let is_doubtful = |validity: &Validity| validity.holds == Some(false);
    let doubtful = known.iter().filter(|(_, one)| is_doubtful(one)).count();
    let (name, validity) = known.iter().min_by(|(_, a), (_, b)| {
        let by_parameter = a.least_phase().total_cmp(&b.least_phase());
        is_doubtful(b).cmp(&is_doubtful(a)).then(by_parameter)
    })?;
    let others = match doubtful.saturating_sub(1) {
        0 => String::new(),
        more => format!("; {more} other {cases} are doubtful"),
    };
    Some(format!("{name}: {}{others}", validity.note()?))
}

/// A number to three digits.
fn three(number: f64) -> f64 {
    format!("{number:.2e}").parse().unwrap_or(number)
}

/// Warnings on a wavelength that is given: it has no effect on lengths without a unit, and its own unit may be wrong.
pub(crate) fn wavelength_warnings(wavelength_nm: Option<f64>, unit: LengthUnit) -> Vec<String> {
    let Some(nanometres) = wavelength_nm else {
        return Vec::new();
    };
    let given = format!("--wavelength {} nm", short(nanometres));
    let mut warnings = Vec::new();
    if LengthUnit::Nanometre.conversion(unit).is_none() {
        warnings.push(format!(
            "{given} has no effect, since the lengths of the surface have no unit: give one by --unit, or to a file by --assume-unit"
        ));
    }
    if !(USUAL_NM[0]..=USUAL_NM[1]).contains(&nanometres) {
        warnings.push(format!(
            "{given} is far from visible light, 380 to 750 nm; numbers without a unit are in nm"
        ));
    }
    warnings
}

/// Root mean square differences of optical paths between points of a surface, in lengths.
struct PathDifferences {
    reflected: f64,
    transmitted: Option<f64>,
    by_bottom: Option<f64>,
}

impl PathDifferences {
    fn of(lengths: &SurfaceLengths, bottom: Option<&SurfaceLengths>, case: &Case) -> Self {
        let incidence = case.light.incidence;
        let sigma = lengths.sigma;
        let index = match case.material {
            // Equal indices deflect nothing
            Material::Dielectric { eta } if eta != 1.0 || case.layer.is_some() => Some(eta),
            _ => None,
        };
        let (n_i, n_t) = match (case.light.from, case.material) {
            (HalfSpace::Above, _) => (1.0, index),
            (HalfSpace::Below, Material::Dielectric { eta }) => (eta, index.map(|_| 1.0)),
            (HalfSpace::Below, _) => (1.0, None),
        };
        let along = n_i * incidence.theta().sin();
        let across = n_i * incidence.theta().cos();
        // n cos(theta) beyond; `None` where all light is reflected
        let beyond = |n: f64| (n > along).then(|| (n * n - along * along).sqrt());
        let mut differences = Self {
            reflected: 2.0 * sigma * across,
            transmitted: None,
            by_bottom: None,
        };
        let Some((n_t, inside)) = n_t.and_then(|n| Some((n, beyond(n)?))) else {
            return differences;
        };
        let step = inside - across;
        let Some(below) = case.layer else {
            differences.transmitted = Some(sigma * step.abs());
            return differences;
        };
        let Some(end) = below.layer.end() else {
            differences.transmitted = below.layer.transmits().then(|| sigma * step.abs());
            return differences;
        };
        // Heights of the bottom, and their correlation with those above where light arrives
        let bottom_sigma = match (bottom, below.bottom) {
            (Some(bottom), _) => bottom.sigma,
            (None, BottomSurface::Flat) => 0.0,
            (None, _) => sigma,
        };
        let is_same = bottom.is_none() && below.bottom == BottomSurface::Same;
        let shift = end.thickness * along / inside;
        let correlation = |times: f64| {
            let tau = lengths.tau.filter(|_| shift > 0.0);
            tau.map_or(1.0, |tau| (-(times * shift / tau).powi(2)).exp())
        };
        let common = if is_same { correlation(1.0) } else { 0.0 };
        let root = |square: f64| square.max(0.0).sqrt();
        let through = |second: f64| {
            let squares = (sigma * step).powi(2) + (bottom_sigma * second).powi(2);
            root(squares + 2.0 * common * sigma * step * bottom_sigma * second)
        };
        differences.transmitted = match end.bottom {
            Bottom::Open => Some(sigma * step.abs()),
            Bottom::Interface { eta } => beyond(n_t * eta).map(|out| through(out - inside)),
            _ => None,
        };
        let reflects = match end.bottom {
            Bottom::Mirror => true,
            Bottom::Interface { eta } => eta != 1.0,
            _ => false,
        };
        differences.by_bottom = reflects.then(|| {
            let top = (sigma * step).powi(2) * (2.0 + 2.0 * correlation(2.0));
            let of_bottom = (2.0 * inside * bottom_sigma).powi(2);
            root(top + of_bottom - 8.0 * common * sigma * step * inside * bottom_sigma)
        });
        differences
    }
}

impl Validity {
    /// The verdict where correlation length or curvature is not known.
    const fn of_known_lengths(&self) -> &'static str {
        match (
            self.tau_over_wavelength,
            self.curvature_radius_over_wavelength,
        ) {
            (None, None) => {
                "the height is large against the wavelength; its height alone is judged, since correlation length and curvature of the surface are not known"
            }
            (None, Some(_)) => {
                "height and radius of curvature are large against the wavelength; the correlation length is not known, so it is not judged"
            }
            (Some(_), _) => {
                "height and correlation length are large against the wavelength; the curvature is not known, so it is not judged"
            }
        }
    }
}

impl fmt::Display for Validity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = match self.holds {
            Some(true) => "lengths are large against the wavelength",
            None => self.of_known_lengths(),
            Some(false) => {
                "geometric optics is doubtful, since not all lengths are large against the wavelength"
            }
        };
        write!(f, "{verdict} ({})", self.wavelength())?;
        if self.least() > BEYOND_DOUBT {
            return Ok(());
        }
        f.write_str(": ")?;
        if let Some(one) = self.reflected {
            let phase = short(one.phase_parameter);
            write!(f, "4 pi sigma cos(theta) / lambda = {phase}")?;
            write_coherent(f, one.coherent_fraction, "reflected light")?;
            f.write_str("; ")?;
        }
        if let Some(one) = self.transmitted {
            write!(
                f,
                "2 pi sigma |n_t cos(theta_t) - n_i cos(theta_i)| / lambda = {}",
                short(one.phase_parameter)
            )?;
            write_coherent(f, one.coherent_fraction, "transmitted light")?;
            f.write_str("; ")?;
        }
        if let Some(one) = self.reflected_by_bottom {
            write!(
                f,
                "the phase of light from the bottom varies by {}",
                short(one.phase_parameter)
            )?;
            write_coherent(f, one.coherent_fraction, "it")?;
            f.write_str("; ")?;
        }
        if let Some(tau) = self.tau_over_wavelength {
            write!(f, "tau / lambda = {}; ", short(tau))?;
        }
        if let Some(radius) = self.curvature_radius_over_wavelength {
            write!(f, "R cos^3(theta) / lambda = {}; ", short(radius))?;
        }
        write!(f, "each should be above {LARGE}")
    }
}

/// Writes the coherent fraction of some light, unless it is small.
fn write_coherent(f: &mut fmt::Formatter<'_>, fraction: f64, light: &str) -> fmt::Result {
    if fraction <= 1e-4 {
        return Ok(());
    }
    write!(
        f,
        ", which leaves {:.2} % of {light} coherent",
        100.0 * fraction
    )
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use asperity_optics::{Incidence, Layer, ParticipatingMedium, PhaseFunction};
    use asperity_simulate::{Light, SurfaceSource};
    use asperity_surface::HeightField;
    use asperity_tally::HemisphereGrid;
    use asperity_tracer::LayerBelow;

    use super::*;

    fn case(material: Material, theta: f64) -> Case {
        let field = waves(1.0, LengthUnit::Arbitrary);
        let surface = SurfaceSource::height_field(field);
        let light = Light::from_above(Incidence::from_degrees(theta.to_degrees(), 0.0).unwrap());
        Case::new(surface, material, light)
    }

    fn spec() -> TallySpec {
        TallySpec::new(HemisphereGrid::default(), TallySpec::DEFAULT_HALF_WIDTH).unwrap()
    }

    fn of_field(field: &HeightField, theta: f64, wavelength_nm: Option<f64>) -> Option<Validity> {
        let lengths = SurfaceLengths::of_field(field);
        Validity::new(
            &lengths,
            None,
            &case(Material::Mirror, theta),
            &spec(),
            wavelength_nm,
        )
    }

    /// A surface of this height in micrometres, with the lengths of gentle bumps, and light of 550 nm.
    fn of_case(sigma: f64, case: &Case) -> Validity {
        let lengths = SurfaceLengths {
            sigma,
            tau: Some(50.0),
            curvature: Some(1e-4),
            unit: LengthUnit::Micrometre,
        };
        Validity::new(&lengths, None, case, &spec(), None).unwrap()
    }

    #[test]
    fn each_side_has_its_own_phase() {
        let glass = Material::Dielectric { eta: 1.5 };
        let found = of_case(0.135, &case(glass, 0.0));
        // Heights of 0.135 um: 3.08 rad of reflected light, and half an index step of transmitted light
        let transmitted = found.transmitted.unwrap();
        let phase = 2.0 * PI * 0.135 * 0.5 / 0.55;
        assert!((transmitted.phase_parameter - phase).abs() < 1e-12);
        assert!((transmitted.coherent_fraction - (-phase * phase).exp()).abs() < 1e-12);
        let reflected = found.reflected.unwrap();
        assert!((reflected.phase_parameter - 4.0 * PI * 0.135 / 0.55).abs() < 1e-12);
        assert_eq!(found.holds, Some(false));
        let text = found.to_string();
        assert!(text.contains("% of transmitted light coherent"), "{text}");
        // Opaque surfaces are judged by reflected light
        let mirror = of_case(0.135, &case(Material::Mirror, 0.0));
        assert_eq!((mirror.holds, mirror.transmitted), (Some(true), None));
        // At 60 degrees: n_t cos(theta_t) = sqrt(1.5^2 - 3/4)
        let found = of_case(0.3, &case(glass, PI / 3.0)).transmitted.unwrap();
        let phase = 2.0 * PI * 0.3 * (1.5_f64.sqrt() - 0.5) / 0.55;
        assert!((found.phase_parameter / phase - 1.0).abs() < 1e-12);
        // Total reflection leaves no side to judge
        let out = Material::Dielectric { eta: 1.0 / 1.5 };
        assert_eq!(of_case(0.3, &case(out, 1.0)).transmitted, None);
        // From below the incident medium is that of the index
        let mut below = case(glass, 0.0);
        below.light.from = HalfSpace::Below;
        let found = of_case(0.135, &below);
        let reflected = found.reflected.unwrap();
        assert!((reflected.phase_parameter - 1.5 * 4.0 * PI * 0.135 / 0.55).abs() < 1e-12);
        assert!(
            (found.transmitted.unwrap().phase_parameter - transmitted.phase_parameter).abs()
                < 1e-12
        );
    }

    #[test]
    fn the_bottom_of_a_layer_adds_to_the_phase_of_what_passes_it() {
        let clear = ParticipatingMedium::from_coefficients(0.0, 0.0, PhaseFunction::Isotropic);
        let window = |bottom: BottomSurface| {
            let end = Bottom::Interface { eta: 1.0 / 1.5 };
            let layer = Layer::slab(clear.clone().unwrap(), 4.0, end).unwrap();
            let mut case = case(Material::Dielectric { eta: 1.5 }, 0.0);
            case.layer = Some(LayerBelow { layer, bottom });
            of_case(0.2, &case)
        };
        let k = 2.0 * PI * 0.2 / 0.55;
        let transmitted = |found: Validity| found.transmitted.unwrap().phase_parameter / k;
        let by_bottom = |found: Validity| found.reflected_by_bottom.unwrap().phase_parameter / k;
        let flat = window(BottomSurface::Flat);
        assert!((transmitted(flat) - 0.5).abs() < 1e-12 && (by_bottom(flat) - 1.0).abs() < 1e-12);
        // Faces of one shape shift no phase between points, and reflect as the shape itself
        let same = window(BottomSurface::Same);
        assert!(transmitted(same) < 1e-7 && (by_bottom(same) - 2.0).abs() < 1e-12);
        let independent = window(BottomSurface::Independent);
        assert!((transmitted(independent) - 0.5_f64.sqrt()).abs() < 1e-12);
        assert!((by_bottom(independent) - 10_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn wavelengths_without_effect_or_of_another_unit_are_told() {
        let found = |nanometres, unit| wavelength_warnings(Some(nanometres), unit).join(" ");
        assert!(found(633.0, LengthUnit::Arbitrary).contains("has no effect"));
        assert!(found(633_000.0, LengthUnit::Micrometre).contains("far from visible light"));
        assert_eq!(found(633.0, LengthUnit::Metre), "");
        assert!(wavelength_warnings(None, LengthUnit::Arbitrary).is_empty());
    }

    /// Waves of amplitude `a` and period 32 along x, spacing 1.
    fn waves(a: f64, unit: LengthUnit) -> HeightField {
        let heights = (0..64 * 64).map(|k| a * (TAU * f64::from(k % 64) / 32.0).sin());
        let field = HeightField::new(heights.collect(), [64, 64], [1.0, 1.0]).unwrap();
        field.with_unit(unit)
    }

    #[test]
    fn numbers_follow_from_lengths_and_angle() {
        let theta = 60_f64.to_radians();
        let found = of_field(&waves(2.0, LengthUnit::Micrometre), theta, Some(500.0));
        let found = found.unwrap();
        // sigma = sqrt 2 um, lambda = 0.5 um
        let rayleigh = 4.0 * PI * 2_f64.sqrt() * 0.5 / 0.5;
        let reflected = found.reflected.unwrap();
        assert!((reflected.phase_parameter / rayleigh - 1.0).abs() < 1e-12);
        // Second differences of a sine: 2 (1 - cos k) of it
        let curvature = 2_f64.sqrt() * 2.0 * (1.0 - (TAU / 32.0).cos());
        let radius = 0.125 / (curvature * 0.5);
        let ratio = found.curvature_radius_over_wavelength.unwrap() / radius;
        assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
        assert!(found.holds == Some(true) && !found.wavelength_is_assumed);
        assert!(found.to_string().starts_with("lengths are large"));
    }

    #[test]
    fn unknown_lengths_leave_the_verdict_open_unless_a_known_one_fails() {
        let of_sigma = |sigma| {
            let lengths = SurfaceLengths {
                sigma,
                tau: None,
                curvature: None,
                unit: LengthUnit::Metre,
            };
            Validity::new(&lengths, None, &case(Material::Mirror, 0.0), &spec(), None).unwrap()
        };
        let high = of_sigma(37.365_127_3);
        assert_eq!(high.holds, None);
        let text = high.to_string();
        assert!(text.contains("its height alone is judged"), "{text}");
        assert!(!text.contains("lengths are large"), "{text}");
        // Hills against light: no number says anything, and nobody has asked
        assert!(!text.contains("lambda") && high.note().is_none(), "{text}");
        let shallow = of_sigma(1e-9);
        assert_eq!(shallow.holds, Some(false));
        assert!(shallow.to_string().contains("doubtful"));
    }

    #[test]
    fn shallow_surfaces_are_doubtful_and_unknown_units_are_not_judged() {
        let shallow = of_field(&waves(0.02, LengthUnit::Micrometre), 0.0, None).unwrap();
        assert!(shallow.holds == Some(false) && shallow.wavelength_is_assumed);
        let reflected = shallow.reflected.unwrap();
        let phase = reflected.phase_parameter;
        assert_eq!(reflected.coherent_fraction, (-phase * phase).exp());
        let text = shallow.to_string();
        assert!(
            text.contains("doubtful") && text.contains("550 nm, assumed"),
            "{text}"
        );
        assert!(text.contains("% of reflected light coherent"), "{text}");
        assert_eq!(
            of_field(&waves(1.0, LengthUnit::Arbitrary), 0.0, None),
            None
        );
        assert_eq!(of_field(&waves(0.0, LengthUnit::Metre), 0.0, None), None);
        // The same lengths in another unit
        let metres = HeightField::new(
            waves(0.02, LengthUnit::Metre)
                .heights()
                .iter()
                .map(|h| h * 1e-6)
                .collect(),
            [64, 64],
            [1e-6, 1e-6],
        );
        let metres = metres.unwrap().with_unit(LengthUnit::Metre);
        let same = of_field(&metres, 0.0, None).unwrap();
        let same = same.reflected.unwrap().phase_parameter;
        assert!((same / phase - 1.0).abs() < 1e-12);
    }
}
