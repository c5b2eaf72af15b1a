//! Aperture light: what falls into an aperture, as a part of the light of its side, with errors.
//!
//! Scatter that the part and the whole have in common cancels, and a control variate of the whole counts.

use asperity_simulate::{CaseApertures, Outcome};
use asperity_tally::{
    Aperture, Component, Entry, Estimate, TallyResult, TallyStatistics, is_of_few_rays,
};

use crate::validity::CoherentLight;

/// Entry of an aperture, if it is kept.
pub(super) fn entry(statistics: &TallyStatistics, aperture: Aperture) -> Option<Entry> {
    let spec = statistics.spec();
    let number = spec.apertures().position(aperture)?;
    Some(spec.aperture_entries().get(number))
}

/// Light in an aperture, next to that which it is a part of.
#[derive(Clone, Copy)]
pub(super) struct Parts<'a> {
    statistics: &'a TallyStatistics,
    /// Flux of the side.
    total: Entry,
    /// The same, as apertures count it, or that of a wider aperture.
    all: Entry,
    part: Entry,
}

impl<'a> Parts<'a> {
    /// Light in an aperture of a result; `None` if none of its side was found, or nothing was traced.
    pub(super) fn of(
        outcome: &'a Outcome,
        apertures: &CaseApertures,
        aperture: Aperture,
    ) -> Option<Self> {
        let statistics = &outcome.statistics;
        let side = aperture.side;
        let all = entry(statistics, apertures.all[side.index()])?;
        let is_known = outcome.deviation_bound.is_none() && statistics.at(all).mean > 0.0;
        Some(Self {
            statistics,
            total: statistics.spec().flux_entry(side, Component::All),
            all,
            part: entry(statistics, aperture)?,
        })
        .filter(|_| is_known)
    }

    /// The same as a part of the light in a wider aperture; `None` if that has none.
    pub(super) fn within(self, wider: Entry) -> Option<Self> {
        let has_light = self.mean(wider) > 0.0;
        has_light.then_some(Self {
            total: wider,
            all: wider,
            ..self
        })
    }

    fn mean(&self, entry: Entry) -> f64 {
        self.statistics.at(entry).mean
    }

    fn fraction(&self) -> f64 {
        self.mean(self.part) / self.mean(self.all)
    }

    /// Standard error of a sum of entries with these weights.
    fn error(&self, weights: &[(Entry, f64)]) -> Option<f64> {
        let mut square = 0.0;
        for &(a, weight) in weights {
            for &(b, other) in weights {
                square += weight * other * self.statistics.covariance(a, b)?;
            }
        }
        Some(square.max(0.0).sqrt())
    }

    /// Flux into the aperture: its part of all light, times that, with the error of a product of means to first order.
    pub(super) fn flux(&self) -> Estimate {
        let fraction = self.fraction();
        let scale = self.mean(self.total) / self.mean(self.all);
        let of_total = self.mean(self.part) / self.mean(self.total);
        let weights = [
            (self.part, 1.0),
            (self.all, -fraction),
            (self.total, of_total),
        ];
        // Few rays have at least the error of one more.
        let own = self.statistics.at(self.part);
        let least = own.se.filter(|_| is_of_few_rays(own)).unwrap_or(0.0);
        Estimate {
            mean: fraction * self.mean(self.total),
            se: self.error(&weights).map(|se| scale * se.max(least)),
        }
    }

    /// Fraction of the light that is not in the aperture, which coherent light is in.
    pub(super) fn outside(&self, coherent: Option<CoherentLight>) -> Estimate {
        let (rest, added) = coherent.map_or((1.0, 0.0), |one| (1.0 - one.fraction, one.flux));
        let [part, all, total] = [self.part, self.all, self.total].map(|entry| self.mean(entry));
        let fraction = part / all;
        let scattered = rest * total;
        let light = added + scattered;
        let of_total = (1.0 - fraction) * all * added / (total * light);
        let weights = [
            (self.part, -1.0),
            (self.all, fraction),
            (self.total, of_total),
        ];
        let scale = scattered / light / all;
        Estimate {
            mean: scale * (all - part),
            se: self.error(&weights).map(|se| scale * se),
        }
    }
}

impl CoherentLight {
    /// A flux by rays, scaled by what is not coherent, with this light added.
    pub(super) fn with_rays(self, rays: Estimate) -> Estimate {
        let rest = 1.0 - self.fraction;
        Estimate {
            mean: self.flux + rest * rays.mean,
            se: rays.se.map(|se| rest * se),
        }
    }
}

#[cfg(test)]
mod tests {
    use asperity_tally::{Side, TallySpec, TallyValues};

    use super::*;

    /// Batches whose light varies, a quarter of it in a cone: what both have in common cancels, and coherent light is in the cone.
    #[test]
    fn errors_of_parts_are_of_what_the_light_does_not_share() {
        let cone = Aperture::cone(Side::Reflected, 0.3, 0.1);
        let apertures = [Aperture::whole(Side::Reflected), cone];
        let spec = TallySpec::default().with_apertures(apertures.into_iter().collect());
        let [all, part] = [0, 1].map(|i| spec.aperture_entries().get(i));
        let total = spec.flux_entry(Side::Reflected, Component::All);
        let statistics = |noise: [f64; 4]| {
            let mut statistics = TallyStatistics::new(spec);
            for (flux, noise) in [0.5, 0.7, 0.4, 0.8].into_iter().zip(noise) {
                let mut batch = TallyValues::zeros(spec);
                batch[all] = flux;
                batch[part] = 0.25 * flux + noise;
                batch[total] = 0.6;
                statistics.push(&batch);
            }
            statistics
        };
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        let exact = statistics([0.0; 4]);
        let parts = |statistics| Parts {
            statistics,
            total,
            all,
            part,
        };
        let outside = parts(&exact).outside(None);
        assert!(near(outside.mean, 0.75) && near(outside.se.unwrap(), 0.0));
        let flux = parts(&exact).flux();
        assert!(near(flux.mean, 0.15) && near(flux.se.unwrap(), 0.0));

        let noise = [0.01, -0.02, 0.015, -0.005];
        let noisy = statistics(noise);
        let squares: f64 = noise.iter().map(|one| one * one).sum();
        let se = (squares / 12.0).sqrt() / 0.6;
        assert!(near(parts(&noisy).outside(None).se.unwrap(), se));
        assert!(near(parts(&noisy).flux().se.unwrap(), 0.6 * se));
        // Half of the light of a flat sample, which is 0.6 too
        let coherent = CoherentLight {
            fraction: 0.5,
            flux: 0.3,
        };
        let outside = parts(&noisy).outside(Some(coherent));
        assert!(near(outside.mean, 0.375) && near(outside.se.unwrap(), 0.5 * se));
        let together = coherent.with_rays(parts(&noisy).flux());
        assert!(near(together.mean, 0.3 + 0.5 * 0.15));
    }
}
