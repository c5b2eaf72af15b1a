//! Lobes of a case against its bins: bins that refine around narrow lobes, and what is said of lobes that bins do not resolve.

use asperity_simulate::{CaseBins, Lobe, three_digits};
use asperity_tally::{Side, TallySpec};
use serde::Serialize;

use super::RunConfig;

/// Half width that counts as zero, degrees: rounding of a variance of one leaves its root, 1.5e-8 rad, here rounded up.
const NO_WIDTH: f64 = 1e-6;

impl RunConfig {
    /// Bins of its own that a case of these lobes has; `None` where bins are named, or bins of equal angles resolve the lobes of all
    /// sides that are recorded.
    pub(crate) fn bins_around(&self, lobes: [Option<Lobe>; 2]) -> Option<CaseBins> {
        if self.bins.named().is_some() {
            return None;
        }
        let recorded = lobes.map(|lobe| lobe.filter(|lobe| self.side.includes(lobe.side)));
        CaseBins::around(recorded, self.grid())
    }
}

/// A lobe as summary.json holds it, next to the bin that holds its middle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct BinnedLobe {
    #[serde(flatten)]
    lobe: Lobe,
    /// Widths of that bin, degrees of arc: along the polar angle, and across.
    bin_deg: [f64; 2],
    /// `true` if bins resolve its peak.
    resolved: bool,
}

impl BinnedLobe {
    /// The lobes of the recorded sides; of a level surface, which has none, no one.
    pub(crate) fn of_lobes(lobes: [Option<Lobe>; 2], spec: &TallySpec) -> Vec<Self> {
        let lobes = lobes.into_iter().flatten();
        lobes
            .filter(|lobe| spec.records(lobe.side) && lobe.half_width_deg != [0.0; 2])
            .map(|lobe| Self {
                lobe,
                bin_deg: lobe.bin_deg(&spec.grid()),
                resolved: lobe.is_resolved(&spec.grid()),
            })
            .collect()
    }

    /// The angle of its middle from the normal of `side`, degrees, if it is of that side.
    pub(crate) fn angle_to_normal_deg(&self, side: Side) -> Option<f64> {
        let Lobe { theta_deg, .. } = self.lobe;
        (self.lobe.side == side).then_some(match side {
            Side::Reflected => theta_deg,
            Side::Transmitted => 180.0 - theta_deg,
        })
    }

    /// Warning of a lobe that is narrower than its bin.
    pub(crate) fn warning(&self) -> Option<String> {
        if self.resolved {
            return None;
        }
        let Lobe {
            side,
            theta_deg,
            half_width_deg,
            ..
        } = self.lobe;
        let arc = |widths: [f64; 2]| {
            let [along, across] = widths.map(|width| match width < NO_WIDTH {
                true => "0".to_owned(),
                false => three_digits(width),
            });
            format!("{along} x {across} deg")
        };
        let remedy = match self.lobe.is_mirror_like() {
            true => "no bins resolve it",
            false => "--bins auto resolves it",
        };
        Some(format!(
            "the lobe of {side} light at theta {} deg falls to half within {}, and its bin is {} wide: the mean BSDF of the bin lies below the peak; {remedy}",
            three_digits(theta_deg),
            arc(half_width_deg),
            arc(self.bin_deg),
        ))
    }
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Incidence, Material};
    use asperity_simulate::{CoreSlopes, Light};
    use asperity_synthesis::Psd;

    use super::*;
    use crate::config::VerifyConfig;

    fn lobes(smoothness: f64) -> [Option<Lobe>; 2] {
        let psd = Psd::gaussian(1.0, smoothness).unwrap();
        let light = Light::from_above(Incidence::from_degrees(30.0, 0.0).unwrap());
        let glass = Material::dielectric(1.5).unwrap();
        Lobe::of(&light, &glass, CoreSlopes::of_recipe(&psd.into()))
    }

    /// Light goes straight on through equal indices, to the last digit, and nothing is reflected.
    #[test]
    fn equal_indices_have_no_lobe() {
        let psd = Psd::gaussian(1.0, 2.0).unwrap();
        for theta in [0.0, 30.0, 60.0, 89.0] {
            let light = Light::from_above(Incidence::from_degrees(theta, 0.0).unwrap());
            let none = Material::dielectric(1.0).unwrap();
            let lobes = Lobe::of(&light, &none, CoreSlopes::of_recipe(&psd.clone().into()));
            assert!(BinnedLobe::of_lobes(lobes, &TallySpec::default()).is_empty());
        }
    }

    fn run(text: &str) -> RunConfig {
        VerifyConfig::from_toml(text).unwrap().run
    }

    #[test]
    fn bins_refine_unless_they_are_named_and_only_where_light_is_recorded() {
        let auto = run("");
        assert!(auto.bins_around(lobes(2.0)).is_none());
        assert!(auto.bins_around(lobes(40.0)).is_some());
        assert!(
            run("[run]\nbins = \"18x36\"")
                .bins_around(lobes(40.0))
                .is_none()
        );
        // At s = 6 the lobe of reflected light is wider than bins, that of transmitted light is not.
        assert!(auto.bins_around(lobes(6.0)).is_some());
        assert!(
            run("[run]\nside = \"reflected\"")
                .bins_around(lobes(6.0))
                .is_none()
        );
    }

    #[test]
    fn a_lobe_narrower_than_its_bin_is_told_with_both_widths() {
        let of = |text: &str, smoothness: f64| -> Vec<String> {
            let run = run(text);
            let mut spec = run.ray_settings().unwrap().tally;
            if let Some(bins) = run.bins_around(lobes(smoothness)) {
                spec = spec.with_bins(bins.grid, bins.in_plane_half_width);
            }
            let lobes = BinnedLobe::of_lobes(lobes(smoothness), &spec);
            assert_eq!(lobes.len(), 2);
            lobes.iter().filter_map(BinnedLobe::warning).collect()
        };
        for smoothness in [2.0, 6.0, 7.0, 40.0, 1000.0] {
            assert!(of("", smoothness).is_empty(), "{smoothness}");
        }
        let fixed = "[run]\nbins = \"18x36\"";
        assert!(of(fixed, 2.0).is_empty());
        let [one] = &of(fixed, 7.0)[..] else {
            panic!("one lobe is narrower than its bin");
        };
        // Slopes of sqrt(2) / 7 turn refracted light by 0.3876 of them along, and by 0.3654 across; half is at 1.1774 deviations.
        for part in [
            "transmitted light at theta 161 deg",
            "within 5.28 x 4.98 deg",
            "is 5 x 3.",
            "--bins auto",
        ] {
            assert!(one.contains(part), "{part}: {one}");
        }
        assert_eq!(of(fixed, 40.0).len(), 2);
        assert!(of("", 1e7)[0].contains("no bins resolve it"));
        assert!(of("", 1e12)[0].contains("within 0 x 0 deg"));
    }
}
