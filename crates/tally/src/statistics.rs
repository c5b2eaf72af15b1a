//! Statistics: means and standard errors of tallies over independent batches.

pub(crate) mod batches;
pub(crate) mod few_rays;
pub(crate) mod mirror;
pub(crate) mod sample_groups;
pub(crate) mod surface_counts;

use serde::{Deserialize, Serialize};

use crate::{Component, Entry, Measure, Polarimetry, Side, TallyResult, TallySpec, TallyValues};
use batches::{Estimate, add_batch, standard_error};
use few_rays::is_of_few_rays;

/// Running mean and variance of each entry over equally weighted tallies: ray blocks, or surfaces.
///
/// Batches are added in the order of their index, so that the bytes of the result do not depend on the
/// number of threads.
///
/// # Examples
/// ```
/// use asperity_tally::{Component, Side, TallyResult, TallySpec, TallyStatistics, TallyValues};
///
/// let spec = TallySpec::default();
/// let mut statistics = TallyStatistics::new(spec);
/// for flux in [0.1, 0.3] {
///     let mut batch = TallyValues::zeros(spec);
///     batch[spec.flux_entry(Side::Reflected, Component::Single)] = flux;
///     statistics.push(&batch);
/// }
/// let estimate = statistics.flux(Side::Reflected, Component::Single);
/// assert!((estimate.mean - 0.2).abs() < 1e-12);
/// assert!((estimate.se.unwrap() - 0.1).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "SavedStatistics")]
pub struct TallyStatistics {
    batches: u64,
    means: TallyValues,
    squares: TallyValues,
    /// Co-moments of measures with what they are compared with, in the order of their entries: see [`TallyStatistics::over_flux`].
    products: Vec<f64>,
    /// Co-moments of the fluxes of both sides and of all apertures with each other, row by row; none without apertures.
    aperture_products: Vec<f64>,
    /// Flux entries that have measures, in the order of these.
    #[serde(skip)]
    measured_fluxes: Vec<usize>,
    /// Errors below which none is reported, if any are.
    least_errors: Option<TallyValues>,
}

impl TallyStatistics {
    /// Statistics without a batch yet.
    #[must_use]
    pub fn new(spec: TallySpec) -> Self {
        Self {
            batches: 0,
            ..Self::of_one(TallyValues::zeros(spec))
        }
    }

    /// Statistics of one batch.
    #[must_use]
    pub fn of_one(batch: TallyValues) -> Self {
        let spec = *batch.spec();
        Self {
            batches: 1,
            means: batch,
            squares: TallyValues::zeros(spec),
            products: vec![0.0; spec.offsets().apertures_start() - spec.offsets().measures_start()],
            aperture_products: vec![0.0; correlated(&spec).count().pow(2)],
            measured_fluxes: match spec.polarimetry() {
                Polarimetry::Nothing => Vec::new(),
                _ => spec.offsets().measured_fluxes().collect(),
            },
            least_errors: None,
        }
    }

    /// Analytic means, without any batch, with `errors` that they surely do not exceed.
    ///
    /// # Panics
    /// If the two are of different specs.
    #[must_use]
    pub fn analytic(means: TallyValues, errors: TallyValues) -> Self {
        let spec = *means.spec();
        let squares = TallyValues::zeros(spec);
        Self {
            means,
            squares,
            ..Self::new(spec)
        }
        .with_least_errors(errors)
    }

    /// The spec.
    #[must_use]
    pub const fn spec(&self) -> &TallySpec {
        self.means.spec()
    }

    /// Adds one batch.
    ///
    /// # Panics
    /// If it is of another spec.
    pub fn push(&mut self, batch: &TallyValues) {
        let batch = batch.as_slice();
        assert_eq!(
            batch.len(),
            self.means.as_slice().len(),
            "a batch of another spec"
        );
        self.batches += 1;
        self.add_products(batch);
        let means = self.means.as_mut_slice();
        add_batch(self.batches, means, self.squares.as_mut_slice(), batch);
    }

    /// Adds the batches of `other`, as if they had been pushed: Chan's formula for two sets of batches.
    ///
    /// # Panics
    /// If they are of another spec.
    pub fn append(&mut self, other: &Self) {
        assert_eq!(self.spec(), other.spec(), "batches of another spec");
        if other.batches == 0 {
            return;
        }
        let [before, added] = [self.batches, other.batches].map(|count| count as f64);
        self.batches += other.batches;
        let all = before + added;
        self.add_deviations(other.means.as_slice(), before * added / all);
        let sums = [
            (self.squares.as_mut_slice(), other.squares.as_slice()),
            (&mut self.products, &other.products),
            (&mut self.aperture_products, &other.aperture_products),
        ];
        for (sums, others) in sums {
            sums.iter_mut().zip(others).for_each(|(sum, x)| *sum += x);
        }
        let means = self.means.as_mut_slice().iter_mut();
        let squares = self.squares.as_mut_slice().iter_mut();
        for ((mean, squares), other) in means.zip(squares).zip(other.means.iter()) {
            let off = other - *mean;
            *mean += off * (added / all);
            *squares += off * off * (before * added / all);
        }
    }

    /// Adds a batch to the co-moments of measures and fluxes, before it is added to the means.
    fn add_products(&mut self, batch: &[f64]) {
        self.add_deviations(batch, 1.0 - 1.0 / self.batches as f64);
    }

    /// Adds the products of the deviations of `batch` from the means, times `weight`, to the co-moments of measures and fluxes.
    fn add_deviations(&mut self, batch: &[f64], weight: f64) {
        let means = self.means.as_slice();
        let start = self.spec().offsets().measures_start();
        let measures = self.spec().polarimetry().len().max(1);
        for (position, &flux) in self.measured_fluxes.iter().enumerate() {
            let flux = match self.spec().polarimetry() {
                Polarimetry::Mueller => start + position * measures,
                Polarimetry::Nothing | Polarimetry::Averaging => flux,
            };
            let of_flux = weight * (batch[flux] - means[flux]);
            for number in position * measures..(position + 1) * measures {
                let entry = start + number;
                self.products[number] += of_flux * (batch[entry] - means[entry]);
            }
        }
        let off = |entry: Entry| batch[entry.0] - means[entry.0];
        let entries = correlated(self.means.spec());
        let pairs = entries
            .clone()
            .flat_map(|a| entries.clone().map(move |b| (a, b)));
        for (product, (a, b)) in self.aperture_products.iter_mut().zip(pairs) {
            *product += weight * off(a) * off(b);
        }
    }

    /// A measure over the flux that it is kept with; `None` where that has the relative error of fewer than [`FEW_RAYS`](crate::FEW_RAYS) rays, or
    /// the measure is not kept. Elements of a Mueller matrix are taken over its first one.
    ///
    /// The standard error is that of the ratio of two means, by the scatter of both and what they have in common, and no less than the least of
    /// the measure. The ratio is biased by no more than its relative error times that of the flux, to first order: less than a quarter of its error.
    #[must_use]
    pub fn over_flux(&self, flux: Entry, measure: Measure) -> Option<Estimate> {
        let entry = self.spec().measure_entry(flux, measure)?;
        let first = Measure::Element { row: 0, column: 0 };
        let flux = self.spec().measure_entry(flux, first).unwrap_or(flux);
        let number = entry.0 - self.spec().offsets().measures_start();
        let (below, above) = (self.means[flux], self.means[entry]);
        if below == 0.0 || is_of_few_rays(self.at(flux)) {
            return None;
        }
        let ratio = above / below;
        let square = self.squares[entry] - 2.0 * ratio * self.products[number]
            + ratio * ratio * self.squares[flux];
        let least = self.least_errors.as_ref().map(|errors| errors[entry]);
        let se = standard_error(self.batches, square.max(0.0), least);
        Some(Estimate {
            mean: ratio,
            se: se.map(|se| se / below.abs()),
        })
    }

    /// Covariance of the means of two entries by the scatter of the batches: of the fluxes of the sides and of apertures; `None` of others, without
    /// apertures, and with fewer than two batches.
    #[must_use]
    pub fn covariance(&self, a: Entry, b: Entry) -> Option<f64> {
        let count = correlated(self.spec()).count();
        let place = |entry| correlated(self.spec()).position(|one| one == entry);
        let product = self.aperture_products[place(a)? * count + place(b)?];
        let n = self.batches as f64;
        (self.batches > 1).then(|| product / (n * (n - 1.0)))
    }

    /// Returns statistics that report no standard error below those given: where rare events decide, batches
    /// may not scatter at all, and yet the mean is not exact.
    ///
    /// # Panics
    /// If they are of another spec.
    #[must_use]
    pub fn with_least_errors(self, errors: TallyValues) -> Self {
        let [own, given] = [&self.means, &errors].map(|values| values.as_slice().len());
        assert_eq!(own, given, "errors of another spec");
        Self {
            least_errors: Some(errors),
            ..self
        }
    }

    /// Number of batches.
    #[must_use]
    pub const fn batches(&self) -> u64 {
        self.batches
    }

    /// All means.
    #[must_use]
    pub const fn means(&self) -> &TallyValues {
        &self.means
    }

    /// Squares of the standard errors of all means, by the scatter of the batches alone; not a number
    /// with fewer than two batches.
    #[must_use]
    pub fn error_squares(&self) -> TallyValues {
        let n = self.batches as f64;
        self.squares.map(|s| s / (n * (n - 1.0)))
    }
}

/// Entries whose covariances are kept: the fluxes of both sides and of all apertures, if there are any of these.
fn correlated(spec: &TallySpec) -> impl Iterator<Item = Entry> + Clone + use<> {
    let apertures = spec.aperture_entries();
    let sides = Side::BOTH.map(|side| spec.flux_entry(side, Component::All));
    let sides = sides.into_iter().filter(move |_| !apertures.is_empty());
    sides.chain(apertures.iter())
}

/// Statistics in their written form, perhaps of values that do not go together.
#[derive(Deserialize)]
struct SavedStatistics {
    batches: u64,
    means: TallyValues,
    squares: TallyValues,
    products: Vec<f64>,
    aperture_products: Vec<f64>,
    least_errors: Option<TallyValues>,
}

impl TryFrom<SavedStatistics> for TallyStatistics {
    type Error = String;

    fn try_from(saved: SavedStatistics) -> Result<Self, String> {
        let empty = Self::new(*saved.means.spec());
        let others = [Some(&saved.squares), saved.least_errors.as_ref()];
        let same_spec = |values: &TallyValues| values.spec() == empty.spec();
        if !others.into_iter().flatten().all(same_spec)
            || saved.products.len() != empty.products.len()
            || saved.aperture_products.len() != empty.aperture_products.len()
        {
            return Err("statistics of several tally specs".to_owned());
        }
        Ok(Self {
            batches: saved.batches,
            means: saved.means,
            squares: saved.squares,
            products: saved.products,
            aperture_products: saved.aperture_products,
            least_errors: saved.least_errors,
            ..empty
        })
    }
}

/// Each entry has its mean and its standard error.
impl TallyResult for TallyStatistics {
    type Value = Estimate;

    fn spec(&self) -> &TallySpec {
        self.means.spec()
    }

    fn at(&self, entry: Entry) -> Estimate {
        let least = self.least_errors.as_ref().map(|errors| errors[entry]);
        Estimate {
            mean: self.means[entry],
            se: standard_error(self.batches, self.squares[entry], least),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Aperture, HemisphereGrid, SideEdges, Sides};

    #[test]
    fn a_ratio_has_the_error_of_what_both_do_not_share() {
        let spec = TallySpec::default().with_polarimetry(Polarimetry::Mueller);
        let flux = spec.flux_entry(Side::Reflected, Component::All);
        let [first, m10] = [0, 1].map(|row| Measure::Element { row, column: 0 });
        let entry = |measure| spec.measure_entry(flux, measure).unwrap();
        let fluxes = [0.2, 0.25, 0.3, 0.25];
        let noise = [0.01, -0.02, 0.015, -0.005];
        let mut statistics = TallyStatistics::new(spec);
        for (flux, noise) in fluxes.into_iter().zip(noise) {
            let mut batch = TallyValues::zeros(spec);
            batch[entry(first)] = flux;
            batch[entry(m10)] = 0.5 * flux + noise;
            statistics.push(&batch);
        }
        let ratio = statistics.over_flux(flux, m10).unwrap();
        assert!((ratio.mean - 0.5).abs() < 1e-15);
        // Deviations from a line through zero: their squares over n (n - 1) and the mean.
        let squares: f64 = noise.iter().map(|x| x * x).sum();
        let expected = (squares / 12.0).sqrt() / 0.25;
        assert!((ratio.se.unwrap() - expected).abs() < 1e-15, "{ratio:?}");
        let one = statistics.over_flux(flux, first).unwrap();
        assert_eq!((one.mean, one.se), (1.0, Some(0.0)));

        // The same after saving; nothing of what is not kept, or where nothing has arrived.
        let saved = serde_json::to_value(&statistics).unwrap();
        let restored: TallyStatistics = serde_json::from_value(saved).unwrap();
        assert_eq!(restored.over_flux(flux, m10), Some(ratio));
        assert_eq!(statistics.over_flux(flux, Measure::Averaging), None);
        let transmitted = spec.flux_entry(Side::Transmitted, Component::All);
        assert_eq!(statistics.over_flux(transmitted, m10), None);
    }

    #[test]
    fn covariances_of_apertures_are_those_of_the_textbook() {
        let cones = [0.1, 0.2].map(|half| Aperture::cone(Side::Reflected, 0.3, half));
        let spec = TallySpec::default().with_apertures(cones.into_iter().collect());
        let [a, b] = [0, 1].map(|i| spec.aperture_entries().get(i));
        let all = spec.flux_entry(Side::Reflected, Component::All);
        let mut statistics = TallyStatistics::new(spec);
        let samples = [[1.0, 2.0, 5.0], [2.0, 2.0, 7.0], [6.0, 5.0, 9.0]];
        for sample in samples {
            let mut batch = TallyValues::zeros(spec);
            for (entry, value) in [a, b, all].into_iter().zip(sample) {
                batch[entry] = value;
            }
            statistics.push(&batch);
        }
        // Deviations -2, -1, 3; -1, -1, 2; -2, 0, 2: sums of products over 3 * 2
        for (x, y, products) in [(a, a, 14.0), (a, b, 9.0), (b, a, 9.0), (a, all, 10.0)] {
            let found = statistics.covariance(x, y).unwrap();
            assert!((found - products / 6.0).abs() < 1e-14, "{found}");
        }
        assert_eq!(statistics.covariance(a, TallySpec::BUDGET.lost), None);
        let saved = serde_json::to_value(&statistics).unwrap();
        let restored: TallyStatistics = serde_json::from_value(saved).unwrap();
        assert_eq!(restored.covariance(a, b), statistics.covariance(a, b));
        let empty = TallyStatistics::new(TallySpec::default());
        assert_eq!(empty.covariance(all, all), None);
    }

    #[test]
    fn appended_statistics_are_those_of_all_batches_pushed() {
        let cone = Aperture::cone(Side::Reflected, 0.3, 0.1);
        let spec = TallySpec::default()
            .with_polarimetry(Polarimetry::Mueller)
            .with_apertures([cone].into_iter().collect());
        let flux = spec.flux_entry(Side::Reflected, Component::All);
        let element = |row| Measure::Element { row, column: 0 };
        let measure = |row| spec.measure_entry(flux, element(row)).unwrap();
        let aperture = spec.aperture_entries().get(0);
        let of = |numbers: std::ops::Range<u32>| {
            let mut statistics = TallyStatistics::new(spec);
            for i in numbers.map(f64::from) {
                let mut batch = TallyValues::zeros(spec);
                batch[flux] = 0.3 + 0.01 * i;
                batch[measure(0)] = batch[flux];
                batch[measure(1)] = 0.1 * (1.7 * i).sin();
                batch[aperture] = 0.02 * (0.9 * i).cos();
                statistics.push(&batch);
            }
            statistics
        };
        let whole = of(0..11);
        for first in [0, 1, 4, 11] {
            let mut joined = of(0..first);
            joined.append(&of(first..11));
            assert_eq!(joined.batches(), 11);
            let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{first}: {a} {b}");
            for entry in [flux, measure(1), aperture] {
                let [a, b] = [&joined, &whole].map(|one| one.at(entry));
                close(a.mean, b.mean);
                close(a.se.unwrap(), b.se.unwrap());
            }
            let [a, b] = [&joined, &whole].map(|one| one.over_flux(flux, element(1)).unwrap());
            close(a.se.unwrap(), b.se.unwrap());
            let [a, b] = [&joined, &whole].map(|one| one.covariance(flux, aperture).unwrap());
            close(a, b);
        }
    }

    const LOST: Entry = TallySpec::BUDGET.lost;

    fn batch(lost: f64) -> TallyValues {
        let mut values = TallyValues::zeros(TallySpec::default());
        values[LOST] = lost;
        values
    }

    #[test]
    fn no_error_is_reported_below_the_least() {
        let mut statistics = TallyStatistics::new(TallySpec::default());
        statistics.push(&batch(1.0));
        statistics.push(&batch(1.5));
        assert_eq!(statistics.budget().lost.se, Some(0.25));
        assert_eq!(statistics.error_squares()[LOST], 0.0625);
        let errors = TallyValues::filled(TallySpec::default(), 0.5);
        let budget = statistics.with_least_errors(errors).budget();
        assert_eq!([budget.lost.se, budget.absorbed.se], [Some(0.5); 2]);
        assert_eq!(budget.lost.mean, 1.25);
    }

    #[test]
    fn saved_statistics_are_read_to_the_same_numbers_and_never_with_those_of_another_spec() {
        let edges = [Side::Reflected, Side::Transmitted].map(|side| {
            let start = 90.0 * side.index() as f64;
            let theta = [0.0, 100.0 / 3.0, 90.0].map(|deg| start + deg).to_vec();
            SideEdges::new(side, theta, vec![10.1, 200.0, 370.1]).unwrap()
        });
        let uneven = HemisphereGrid::with_edges(edges).unwrap();
        for spec in [
            TallySpec::default().with_sides(Sides::Reflected),
            TallySpec::new(uneven, 0.1).unwrap().with_medium(),
        ] {
            let mut statistics = TallyStatistics::new(spec);
            for lost in [1.0 / 3.0, 0.1] {
                statistics.push(&TallyValues::filled(spec, lost));
            }
            let statistics = statistics.with_least_errors(TallyValues::filled(spec, 1e-300));
            let mut saved = serde_json::to_value(&statistics).unwrap();
            let read = |saved| serde_json::from_value::<TallyStatistics>(saved);
            let restored = read(saved.clone()).unwrap();
            // Also the bits of every number, since digits read back exactly.
            assert_eq!(format!("{restored:?}"), format!("{statistics:?}"));
            saved["squares"]["spec"]["in_plane_half_width"] = 0.05.into();
            assert!(
                read(saved.clone())
                    .unwrap_err()
                    .to_string()
                    .contains("several")
            );
            saved["means"]["spec"]["grid"] = "2x1".into();
            assert!(
                read(saved)
                    .unwrap_err()
                    .to_string()
                    .contains("of a tally of")
            );
        }
    }

    #[test]
    fn an_analytic_mean_has_its_error_without_a_batch() {
        let errors = TallyValues::filled(TallySpec::default(), 1e-6);
        let statistics = TallyStatistics::analytic(batch(0.5), errors);
        let expected = Estimate {
            mean: 0.5,
            se: Some(1e-6),
        };
        assert_eq!(statistics.at(LOST), expected);
        assert_eq!(statistics.batches(), 0);
    }
}
