//! Validity in words: the first lines of a report, notes and warnings.

use std::fmt;

use asperity_simulate::short;
use asperity_surface::LengthUnit;
use asperity_tally::{Component, Side, TallyResult, TallyStatistics};

use super::coherence::{BEYOND_DOUBT, Coherence};
use super::judgement::{LARGE, MUCH, Validity};

/// Wavelengths that are likely meant, nanometres: from X-rays to microwaves there are others, but a wrong unit is more frequent.
const USUAL_NM: [f64; 2] = [50.0, 50_000.0];

impl Validity {
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

    /// Largest coherent fraction of the light of a side.
    pub(crate) fn most_coherent(&self, statistics: &TallyStatistics) -> f64 {
        let sides = statistics.spec().sides();
        let shares = sides.filter_map(|side| Some(self.coherent(statistics, side)?[1]));
        shares.fold(0.0, f64::max)
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
                "warning: {} {} coherent at {}: a wave leaves in the direction of light on a flat surface, and bins and fluxes hold it in the lobe of the rays",
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

/// Warnings on a wavelength that is given: it is not compared with lengths without a unit, and its own unit may be wrong. `is_named`: whether
/// the indices of the material are looked up by it.
pub(crate) fn wavelength_warnings(
    wavelength_nm: Option<f64>,
    is_named: bool,
    unit: LengthUnit,
) -> Vec<String> {
    let Some(nanometres) = wavelength_nm else {
        return Vec::new();
    };
    let given = format!("--wavelength {} nm", short(nanometres));
    let mut warnings = Vec::new();
    if LengthUnit::Nanometre.conversion(unit).is_none() {
        let what = match is_named {
            true => "geometric optics is not judged: the lengths of the surface have no unit, so that they cannot be compared with the wavelength".to_owned(),
            false => format!("{given} has no effect, since the lengths of the surface have no unit"),
        };
        warnings.push(format!(
            "{what}: give one by --unit, or to a file by --assume-unit"
        ));
    }
    if !(USUAL_NM[0]..=USUAL_NM[1]).contains(&nanometres) {
        warnings.push(format!(
            "{given} is far from visible light, 380 to 750 nm; numbers without a unit are in nm"
        ));
    }
    warnings
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
