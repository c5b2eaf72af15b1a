//! Validity of geometric optics: lengths of a surface against the wavelength.
//!
//! Numbers that must be large. The root mean square phase difference of light from high and low points, per side:
//! `4 pi sigma n_i cos(theta_i) / lambda` of reflected light, the Rayleigh parameter, and
//! `2 pi sigma |n_t cos(theta_t) - n_i cos(theta_i)| / lambda` of transmitted light; a fraction `exp(-phase^2)` of what a Gaussian surface
//! reflects or transmits stays coherent (Beckmann and Spizzichino 1963), and of any other `|mean exp(i phase)|^2` over its heights. `tau / lambda`
//! is the correlation length over the wavelength. The radius of curvature over `lambda / cos^3(theta)` tells whether a facet is level enough to act as a plane.
//!
//! The wavelength is that in the medium above the surface, whose index is one here.

use std::f64::consts::PI;
use std::fmt;

use asperity_optics::{Bottom, Material};
use asperity_simulate::{BottomSurface, Case, SurfaceSource, short};
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
    /// Fraction of the component that stays coherent: `exp(-phase^2)` of a Gaussian surface, and that of the heights of any other.
    pub coherent_fraction: f64,
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
    /// `true` if all of them are at least [`LARGE`] and no component is coherent by more than 1 %; `None` where that holds of those that are
    /// known, and others are not known.
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
        let all = Components::of(lengths, bottom, case, 2.0 * PI / wavelength);
        let recorded = |side| spec.records(side);
        let reflected = recorded(Side::Reflected).then_some(match case.material {
            Material::Lambertian { .. } => Coherence {
                coherent_fraction: 0.0,
                ..all.reflected
            },
            _ => all.reflected,
        });
        let transmitted = all.transmitted.filter(|_| recorded(Side::Transmitted));
        let reflected_by_bottom = all.by_bottom.filter(|_| recorded(Side::Reflected));
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
        let is_doubtful = validity.least() < LARGE || validity.is_coherent();
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
        let SurfaceSource::Random(surfaces) = &case.surface else {
            return None;
        };
        // Heights without a unit need not be drawn
        let is_known = LengthUnit::Nanometre.conversion(case.at.unit).is_some();
        let lengths = is_known.then(|| SurfaceLengths::of_random(surfaces, case.at.unit))?;
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
        let phases = self.components().map(|one| one.phase_parameter);
        phases.fold(f64::INFINITY, f64::min)
    }

    /// Returns `true` if much of a component is coherent.
    fn is_coherent(&self) -> bool {
        self.components().any(|one| one.coherent_fraction > MUCH)
    }

    fn components(&self) -> impl Iterator<Item = Coherence> {
        let all = [self.reflected, self.transmitted, self.reflected_by_bottom];
        all.into_iter().flatten()
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

/// Coherence of light from different points of a surface, by component.
struct Components {
    reflected: Coherence,
    transmitted: Option<Coherence>,
    by_bottom: Option<Coherence>,
}

impl Components {
    /// `k`: wave number in the medium above.
    fn of(top: &SurfaceLengths, bottom: Option<&SurfaceLengths>, case: &Case, k: f64) -> Self {
        let incidence = case.light.incidence;
        let sigma = top.sigma;
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
        let of_top = |per_height: f64| top.coherent_fraction(k * per_height);
        let by_top = |per_height: f64| coherence(k * sigma * per_height.abs(), of_top(per_height));
        let mut found = Self {
            reflected: by_top(2.0 * across),
            transmitted: None,
            by_bottom: None,
        };
        let Some((n_t, inside)) = n_t.and_then(|n| Some((n, beyond(n)?))) else {
            return found;
        };
        let step = inside - across;
        let Some(below) = case.layer else {
            found.transmitted = Some(by_top(step));
            return found;
        };
        let Some(end) = below.layer.end() else {
            found.transmitted = below.layer.transmits().then(|| by_top(step));
            return found;
        };
        // The bottom, and the correlation of its heights with those above where light arrives
        let is_same = bottom.is_none() && below.bottom == BottomSurface::Same;
        let bottom = bottom.or((below.bottom != BottomSurface::Flat).then_some(top));
        let bottom_sigma = bottom.map_or(0.0, |bottom| bottom.sigma);
        let of_bottom =
            |per_height: f64| bottom.map_or(1.0, |bottom| bottom.coherent_fraction(k * per_height));
        let shift = end.thickness * along / inside;
        let correlation = |times: f64| {
            let tau = top.tau.filter(|_| shift > 0.0);
            tau.map_or(1.0, |tau| (-(times * shift / tau).powi(2)).exp())
        };
        let common = if is_same { correlation(1.0) } else { 0.0 };
        let is_gaussian = [Some(top), bottom]
            .iter()
            .flatten()
            .all(|one| one.heights.is_empty());
        let of_both = |square: f64, fraction: f64| {
            let phase = k * square.max(0.0).sqrt();
            // Gaussian heights need no more than their correlation
            coherence(
                phase,
                if is_gaussian {
                    (-phase * phase).exp()
                } else {
                    fraction
                },
            )
        };
        let through = |second: f64| {
            let squares = (sigma * step).powi(2) + (bottom_sigma * second).powi(2);
            of_both(
                squares + 2.0 * common * sigma * step * bottom_sigma * second,
                between(
                    of_top(step) * of_bottom(second),
                    of_top(step + second),
                    common,
                ),
            )
        };
        found.transmitted = match end.bottom {
            Bottom::Open => Some(by_top(step)),
            Bottom::Interface { eta } => beyond(n_t * eta).map(|out| through(out - inside)),
            _ => None,
        };
        let reflects = match end.bottom {
            Bottom::Mirror => true,
            Bottom::Interface { eta } => eta != 1.0,
            _ => false,
        };
        found.by_bottom = reflects.then(|| {
            let twice = (sigma * step).powi(2) * (2.0 + 2.0 * correlation(2.0));
            let by_bottom = (2.0 * inside * bottom_sigma).powi(2);
            let of_twice = between(of_top(step).powi(2), of_top(2.0 * step), correlation(2.0));
            of_both(
                twice + by_bottom - 8.0 * common * sigma * step * inside * bottom_sigma,
                between(
                    of_twice * of_bottom(2.0 * inside),
                    of_top(2.0 * (step - inside)),
                    common,
                ),
            )
        });
        found
    }
}

/// A component of this root mean square phase. No heights are known to a fraction of a wavelength that is so much smaller.
fn coherence(phase: f64, fraction: f64) -> Coherence {
    Coherence {
        phase_parameter: phase,
        coherent_fraction: if phase > BEYOND_DOUBT { 0.0 } else { fraction },
    }
}

/// Coherent fraction of light that meets two heights of this correlation, by those of independent and of equal heights; exact for
/// Gaussian ones.
fn between(independent: f64, equal: f64, correlation: f64) -> f64 {
    independent.powf(1.0 - correlation) * equal.powf(correlation)
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
            Some(false) if self.least() >= LARGE => {
                "geometric optics is doubtful, since more than 1 % of the light is coherent, although all lengths are large against the wavelength"
            }
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
        write!(f, "each should be above {LARGE}")?;
        match self.is_coherent() {
            true => f.write_str(", and no more than 1 % coherent"),
            false => Ok(()),
        }
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
    use std::sync::Arc;

    use asperity_optics::{Incidence, Layer, ParticipatingMedium, PhaseFunction};
    use asperity_simulate::Light;
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
            heights: Arc::default(),
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
        // An amplitude of which hardly any light stays coherent
        let found = of_field(&waves(2.19, LengthUnit::Micrometre), theta, Some(500.0));
        let found = found.unwrap();
        // sigma = 2.19 um / sqrt 2, lambda = 0.5 um
        let sigma = 2.19 / 2_f64.sqrt();
        let rayleigh = 4.0 * PI * sigma * 0.5 / 0.5;
        let reflected = found.reflected.unwrap();
        assert!((reflected.phase_parameter / rayleigh - 1.0).abs() < 1e-12);
        // Second differences of a sine: 2 (1 - cos k) of it
        let curvature = sigma * 2.0 * (1.0 - (TAU / 32.0).cos());
        let radius = 0.125 / (curvature * 0.5);
        let ratio = found.curvature_radius_over_wavelength.unwrap() / radius;
        assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
        assert!(found.holds == Some(true) && !found.wavelength_is_assumed);
        assert!(found.to_string().starts_with("lengths are large"));
    }

    /// V grooves of a height of half a wavelength at normal incidence and of their period, and the same in glass.
    #[test]
    fn heights_that_are_not_gaussian_tell_what_stays_coherent() {
        let sinc = |half: f64| (half.sin() / half).powi(2);
        let ridge = |i: i32| f64::from((i % 256 - 128).abs()) / 128.0;
        let field = |height: f64| {
            let heights = (0..16 * 512).map(|i| height * ridge(i)).collect();
            let field = HeightField::new(heights, [16, 512], [1.0, 1.0]).unwrap();
            SurfaceLengths::of_field(&field.with_unit(LengthUnit::Micrometre))
        };
        let found = |lengths: &SurfaceLengths, bottom, case: &Case| {
            Validity::new(lengths, bottom, case, &spec(), Some(600.0)).unwrap()
        };
        let near = |one: Option<Coherence>, exact: f64| {
            let fraction = one.unwrap().coherent_fraction;
            assert!((fraction - exact).abs() < 1e-4, "{fraction} {exact}");
        };
        let grooves = field(0.15);
        near(
            found(&grooves, None, &case(Material::Mirror, 0.0)).reflected,
            sinc(PI / 2.0),
        );
        // Phases of three and a half turns: 0.8 % of a sinc; of 13 and a half, with large lengths, nothing
        let high = found(&field(1.05), None, &case(Material::Mirror, 0.0));
        near(high.reflected, sinc(3.5 * PI));
        // Glass, at 60 degrees
        let glass = Material::Dielectric { eta: 1.5 };
        let k = TAU / 0.6;
        let step = 1.5_f64.sqrt() - 0.5;
        near(
            found(&grooves, None, &case(glass, PI / 3.0)).transmitted,
            sinc(0.5 * k * step * 0.15),
        );

        // Two faces of independent grooves, and of one shape at normal incidence
        let clear = ParticipatingMedium::from_coefficients(0.0, 0.0, PhaseFunction::Isotropic);
        let end = Bottom::Interface { eta: 1.0 / 1.5 };
        let mut window = case(glass, 0.0);
        let mut with = |bottom, of_file| {
            let layer = Layer::slab(clear.clone().unwrap(), 4.0, end).unwrap();
            window.layer = Some(LayerBelow { layer, bottom });
            found(&grooves, of_file, &window)
        };
        let one = sinc(0.25 * k * 0.15);
        let apart = with(BottomSurface::Independent, None);
        near(apart.transmitted, one * one);
        near(
            apart.reflected_by_bottom,
            sinc(0.5 * k * 0.15) * sinc(1.5 * k * 0.15),
        );
        let same = with(BottomSurface::Same, None);
        near(same.transmitted, 1.0);
        near(same.reflected_by_bottom, sinc(k * 0.15));
        let flat = with(BottomSurface::Flat, None);
        near(flat.transmitted, one);
        let other = field(0.4);
        near(
            with(BottomSurface::Flat, Some(&other)).transmitted,
            one * sinc(0.25 * k * 0.4),
        );
    }

    #[test]
    fn a_coherent_part_makes_large_lengths_doubtful() {
        // A sine of two turns on either side of the mean
        let found = of_field(&waves(1.0, LengthUnit::Micrometre), PI / 3.0, Some(500.0)).unwrap();
        assert!(found.least() > LARGE && found.holds == Some(false));
        let fraction = found.reflected.unwrap().coherent_fraction;
        let exact = libm::j0(4.0 * PI).powi(2);
        assert!((fraction - exact).abs() < 1e-3, "{fraction} {exact}");
        let text = found.to_string();
        assert!(text.contains("although all lengths are large"), "{text}");
        let warned = format!("up to {:.1} % of the reflected light", 100.0 * exact);
        assert!(found.first_lines_at_most().unwrap().contains(&warned));
        // Hills against light: level land at some height is known to no wavelength
        let steps = (0..64 * 64).map(|i| f64::from(i % 64 / 32)).collect();
        let hills = HeightField::new(steps, [64, 64], [1.0, 1.0]).unwrap();
        let hills = of_field(&hills.with_unit(LengthUnit::Metre), 0.0, None).unwrap();
        assert_eq!(hills.reflected.unwrap().coherent_fraction, 0.0);
    }

    #[test]
    fn unknown_lengths_leave_the_verdict_open_unless_a_known_one_fails() {
        let of_sigma = |sigma| {
            let lengths = SurfaceLengths {
                sigma,
                tau: None,
                curvature: None,
                unit: LengthUnit::Metre,
                heights: Arc::default(),
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
        // A sine of amplitude 2^(1/2) sigma
        let exact = libm::j0(2_f64.sqrt() * phase).powi(2);
        assert!((reflected.coherent_fraction - exact).abs() < 1e-3);
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
