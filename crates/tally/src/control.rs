//! What is known of light before any of it is traced: the control of an estimate.

use crate::{Event, EventPath, Layout, OrderClass, Share, Side};

/// Mean fluxes of *unshadowed single scattering*: every facet that faces the light is lit and sends its
/// light away undisturbed, those included that reflect downwards or refract upwards, which are left out.
///
/// Flux fractions, not yet weighted by any share; they may add to more than one.
#[derive(Clone, Debug, PartialEq)]
pub struct UnshadowedFluxes {
    /// Into the bins of the grid, in its order.
    pub bins: Vec<f64>,
    /// Into the theta bins of each side, from +z.
    pub rings: [Vec<f64>; 2],
    /// Into the in-plane bins of each side.
    pub in_plane: [Vec<f64>; 2],
    /// Absorbed at the first interaction.
    pub absorbed: f64,
}

/// The shares of unshadowed single scattering that are expected to be visible: the factors with which
/// it is subtracted from what is traced, and with which its mean is added again.
///
/// Any shares leave the mean of an estimate as it is; the true ones make its variance least.
#[derive(Clone, Debug, PartialEq)]
pub struct VisibleShares {
    /// Lit *and* seen, by side and ring of polar angle.
    pub rings: [Vec<f64>; 2],
    /// Lit.
    pub absorbed: f64,
}

/// Unshadowed single scattering as a control variate: subtracted ray by ray, added as a mean.
///
/// Each entry of a record that light of order one can reach has an expectation here, zero elsewhere. An
/// entry lies in one ring, or is a sum of rings, so that one share a ring serves all of them and sums
/// stay sums.
#[derive(Clone, Debug)]
pub struct Control {
    shares: VisibleShares,
    /// By the layout.
    expected: Vec<f64>,
    shadow_probability: f64,
}

impl Control {
    /// The control of records of `layout`: `fluxes`, each weighted with its share.
    ///
    /// What goes to a side that is not asked for is booked there, as light that is traced is.
    ///
    /// # Panics
    /// If there are not as many shares or fluxes as the layout has places for.
    #[must_use]
    pub fn new(layout: Layout, shares: VisibleShares, fluxes: &UnshadowedFluxes) -> Self {
        let grid = layout.grid();
        let n_theta = grid.n_theta();
        let mut expected = vec![0.0; layout.len()];
        expected[Layout::ABSORBED] = shares.absorbed * fluxes.absorbed;
        for side in Side::BOTH {
            let shares = &shares.rings[side.index()];
            let rings = &fluxes.rings[side.index()];
            let in_plane = &fluxes.in_plane[side.index()];
            assert_eq!(
                [shares.len(), rings.len(), in_plane.len()],
                [n_theta, n_theta, layout.in_plane_len()],
                "rings of another layout"
            );
            let of_side: f64 = shares.iter().zip(rings).map(|(s, flux)| s * flux).sum();
            if !layout.asks(side) {
                expected[Layout::NOT_ASKED] += of_side;
                expected[Layout::TRUNCATED] += of_side;
                continue;
            }
            for entry in first_order_totals(&layout, side) {
                expected[entry] = of_side;
            }
            for (ring, share) in shares.iter().enumerate() {
                for class in [OrderClass::First, OrderClass::All] {
                    expected[layout.rings(side, class)][ring] = share * rings[ring];
                    for i in layout.in_plane_over(side, ring) {
                        expected[layout.in_plane(side, class)][i] = share * in_plane[i];
                    }
                }
                let first = (side.index() * n_theta + ring) * grid.n_phi();
                let bins = first..first + grid.n_phi();
                for share_of_bin in [Share::Single, Share::Total] {
                    let entries = &mut expected[layout.bins(share_of_bin)][bins.clone()];
                    for (entry, flux) in entries.iter_mut().zip(&fluxes.bins[bins.clone()]) {
                        *entry = share * flux;
                    }
                }
            }
        }
        Self {
            shares,
            expected,
            shadow_probability: 1.0,
        }
    }

    /// The same control with all shares, and so all that is added, times `factor`.
    #[must_use]
    pub fn weakened(mut self, factor: f64) -> Self {
        let rings = self.shares.rings.iter_mut().flatten();
        rings
            .chain([&mut self.shares.absorbed])
            .chain(&mut self.expected)
            .for_each(|value| *value *= factor);
        self
    }

    /// The same control, which looks for facets in the shadow of the one that light meets with
    /// `probability` alone, and then counts them so many times more.
    ///
    /// # Panics
    /// Unless `0 < probability <= 1`.
    #[must_use]
    pub fn looking_into_shadow(self, probability: f64) -> Self {
        assert!(
            probability > 0.0 && probability <= 1.0,
            "{probability} is no probability to look with"
        );
        Self {
            shadow_probability: probability,
            ..self
        }
    }

    /// The probability of looking for facets in the shadow of the one that light meets.
    #[must_use]
    pub const fn shadow_probability(&self) -> f64 {
        self.shadow_probability
    }

    /// The share of light that leaves on `side` within `ring` of polar angle, counted from +z.
    #[must_use]
    pub fn share(&self, side: Side, ring: usize) -> f64 {
        self.shares.rings[side.index()][ring]
    }

    /// The share of light that is absorbed.
    #[must_use]
    pub const fn absorbed_share(&self) -> f64 {
        self.shares.absorbed
    }

    /// The shares of unshadowed single scattering that are subtracted.
    #[must_use]
    pub const fn shares(&self) -> &VisibleShares {
        &self.shares
    }

    /// What is taken off completed records, on average, where the fluxes of what is traced are `fluxes`
    /// in place of those that are expected: by how much these move the control, less what
    /// [`Control::complete`] spreads so that the budget closes. The parts of the budget add to zero.
    ///
    /// # Panics
    /// If there are not as many fluxes as `layout` has places for.
    #[must_use]
    pub fn removed(&self, layout: Layout, fluxes: &UnshadowedFluxes) -> Vec<f64> {
        let mut removed = Self::new(layout, self.shares.clone(), fluxes).expected;
        let known = budget(&self.expected);
        let scale = if known == 0.0 {
            0.0
        } else {
            budget(&removed) / known
        };
        for (value, expected) in removed.iter_mut().zip(&self.expected) {
            *value -= scale * expected;
        }
        removed
    }

    /// What is added to a record, by its layout.
    #[must_use]
    pub fn expected(&self) -> &[f64] {
        &self.expected
    }

    /// Errors that no estimate of `rays` rays under this control should fall below, by the layout: in
    /// each entry that the control knows of, one ray that carries what light carries to that side on
    /// average, and in a part of the budget no more than in all others together. Where no ray was seen to
    /// deviate from the control, the next one might.
    #[must_use]
    pub fn least_errors(&self, layout: &Layout, rays: u64) -> Vec<f64> {
        let budget = Layout::REFLECTED..=Layout::LOST;
        let known: f64 = self.expected[budget.clone()].iter().sum();
        let mut least = vec![0.0; layout.len()];
        for part in budget.clone() {
            // Light carries its share of what it began with.
            let one_ray = self.expected[part] / known / rays as f64;
            for entry in entries_of(layout, part) {
                if self.expected[entry] != 0.0 {
                    least[entry] = one_ray;
                }
            }
        }
        // Since the budget closes, no part of it is less certain than all others together.
        let parts: Vec<f64> = least[budget.clone()].to_vec();
        let all: f64 = parts.iter().sum();
        for (part, own) in budget.zip(parts) {
            least[part] = own.min(all - own);
        }
        least
    }

    /// Adds its mean to a record from which the control has been subtracted ray by ray.
    ///
    /// The five parts of the budget add to one on average, not in every record. What is missing, or too
    /// much, is zero on average, and is spread over all entries as the control itself is, so that the
    /// budget closes and parts still add to their sums.
    pub fn complete(&self, record: &mut [f64]) {
        let known = budget(&self.expected);
        if known == 0.0 {
            return;
        }
        let missing = 1.0 - (budget(record) + known);
        let scale = 1.0 + missing / known;
        for (value, expected) in record.iter_mut().zip(&self.expected) {
            *value += scale * expected;
        }
    }
}

/// The five parts of the budget together.
fn budget(values: &[f64]) -> f64 {
    values[Layout::REFLECTED..=Layout::LOST].iter().sum()
}

/// Entries that hold all light of `side` that is scattered once, alone or among others.
fn first_order_totals(layout: &Layout, side: Side) -> [usize; 3] {
    let event = match side {
        Side::Reflected => Event::Reflection,
        Side::Transmitted => Event::Transmission,
    };
    [
        side.index(),
        layout.order(side, 1),
        layout.path(side, EventPath::default().then(event)),
    ]
}

/// Entries of light of all orders or the first that ends as `part` of the budget says.
fn entries_of(layout: &Layout, part: usize) -> Vec<usize> {
    let side = match part {
        Layout::REFLECTED => Side::Reflected,
        Layout::TRANSMITTED => Side::Transmitted,
        Layout::TRUNCATED => return vec![part, Layout::NOT_ASKED],
        _ => return vec![part],
    };
    let grid = layout.grid();
    let first = side.index() * grid.bins_per_side();
    let mut entries = first_order_totals(layout, side).to_vec();
    for class in [OrderClass::First, OrderClass::All] {
        entries.extend(layout.rings(side, class));
        entries.extend(layout.in_plane(side, class));
    }
    for share in [Share::Single, Share::Total] {
        let start = layout.bins(share).start + first;
        entries.extend(start..start + grid.bins_per_side());
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{HemisphereGrid, Sides};

    fn layout() -> Layout {
        Layout::new(HemisphereGrid::new(2, 3).unwrap(), 0.2).unwrap()
    }

    /// A tenth of the light is reflected, half is transmitted, a fifth absorbed, before shares.
    fn control(layout: Layout) -> Control {
        let fluxes = UnshadowedFluxes {
            bins: [vec![0.1 / 6.0; 6], vec![0.5 / 6.0; 6]].concat(),
            rings: [vec![0.05; 2], vec![0.25; 2]],
            in_plane: [vec![0.001; 4], vec![0.005; 4]],
            absorbed: 0.2,
        };
        let shares = VisibleShares {
            rings: [vec![0.5, 0.0], vec![1.0, 0.8]],
            absorbed: 0.9,
        };
        Control::new(layout, shares, &fluxes)
    }

    #[test]
    fn expectations_are_weighted_and_add_up() {
        let control = control(layout());
        let expected = control.expected();
        let near = |i: usize, value: f64| (expected[i] - value).abs() < 1e-15;
        assert!(near(Layout::REFLECTED, 0.025));
        assert!(near(Layout::TRANSMITTED, 0.45));
        assert!(near(Layout::ABSORBED, 0.18));
        for side in Side::BOTH {
            let of_side = expected[side.index()];
            for range in [
                layout().rings(side, OrderClass::First),
                layout().rings(side, OrderClass::All),
            ] {
                assert!((expected[range].iter().sum::<f64>() - of_side).abs() < 1e-15);
            }
            assert!(near(layout().order(side, 1), of_side));
            assert!(near(layout().order(side, 2), 0.0));
            assert!(near(layout().multiple(side), 0.0));
        }
        let multiple = layout().bins(Share::Multiple);
        assert!(expected[multiple].iter().all(|&flux| flux == 0.0));
        // In-plane bins count from the side's own normal, rings from +z.
        let in_plane = &expected[layout().in_plane(Side::Transmitted, OrderClass::All)];
        assert_eq!(in_plane, [0.005, 0.004, 0.004, 0.005]);
    }

    #[test]
    fn what_is_not_asked_for_is_booked_as_such() {
        let one = control(layout().with_sides(Sides::Reflected));
        assert!((one.expected()[Layout::NOT_ASKED] - 0.45).abs() < 1e-15);
        assert!((one.expected()[Layout::TRUNCATED] - 0.45).abs() < 1e-15);
        assert_eq!(one.expected()[Layout::TRANSMITTED], 0.0);
    }

    #[test]
    fn a_completed_record_closes_its_budget_and_keeps_its_sums() {
        let control = control(layout());
        let mut record = vec![0.0; layout().len()];
        // Of what is subtracted ray by ray, this is left.
        record[Layout::REFLECTED] = 0.07;
        record[layout().order(Side::Reflected, 1)] = 0.07;
        control.complete(&mut record);
        let budget: f64 = record[..=Layout::LOST].iter().sum();
        assert!((budget - 1.0).abs() < 1e-15);
        let rings = &record[layout().rings(Side::Transmitted, OrderClass::First)];
        let sum = rings.iter().sum::<f64>();
        assert!((sum - record[Layout::TRANSMITTED]).abs() < 1e-15);
        assert_eq!(
            record[Layout::REFLECTED],
            record[layout().order(Side::Reflected, 1)]
        );
    }

    #[test]
    fn least_errors_are_those_of_one_ray_of_the_side() {
        let least = control(layout()).least_errors(&layout(), 1000);
        let known = 0.025 + 0.45 + 0.18;
        let bins = layout().bins(Share::Total);
        assert!((least[bins.start] - 1e-3 * 0.025 / known).abs() < 1e-18);
        // A ring of share zero is not controlled.
        assert_eq!(least[bins.start + 3], 0.0);
        let order_1 = layout().order(Side::Transmitted, 1);
        assert!((least[order_1] - 1e-3 * 0.45 / known).abs() < 1e-18);
        // What is not transmitted is reflected or absorbed.
        assert!((least[Layout::TRANSMITTED] - 1e-3 * 0.205 / known).abs() < 1e-18);
        assert_eq!(least[Layout::LOST], 0.0);
    }

    #[test]
    fn a_weaker_control_expects_less_of_everything() {
        let full = control(layout());
        let half = control(layout()).weakened(0.5);
        for (a, b) in full.expected().iter().zip(half.expected()) {
            assert_eq!(0.5 * a, *b);
        }
        assert_eq!(half.share(Side::Transmitted, 0), 0.5);
        assert_eq!(half.absorbed_share(), 0.45);
    }
}
