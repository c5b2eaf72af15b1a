use super::*;
use crate::{
    ApertureShape, Apertures, ComponentFilter, Event, EventPath, ExitColumns, HemisphereGrid,
    Polarimetry, Sides, Tallies, TallyResult, UnshadowedFluxes, VisibleFractions,
};
use asperity_optics::from_spherical;

fn exit(side: Side, theta_deg: f64, phi_deg: f64, order: u32) -> Exit {
    let mut path = EventPath::default();
    for _ in 1..order {
        path = path.then(Event::Reflection);
    }
    path = path.then(match side {
        Side::Reflected => Event::Reflection,
        Side::Transmitted => Event::Transmission,
    });
    let wo = from_spherical(f64::to_radians(theta_deg), f64::to_radians(phi_deg));
    Exit {
        side,
        wo,
        flux: 0.5,
        path,
        scatterings: order % 4,
    }
}

/// Rays that reached the bins of both sides.
fn grid_hits(spec: &TallySpec, component: Component) -> crate::Entries {
    let start = spec.hit_entries(Side::Reflected, component).start;
    crate::Entries::new(start, spec.grid().len())
}

#[test]
fn every_view_of_an_exit_agrees() {
    let spec = TallySpec::default();
    let mut tally = Tally::new(spec, Azimuth::From(0.0));
    tally.add_exit(&exit(Side::Reflected, 32.0, 1.0, 1));
    tally.add_exit(&exit(Side::Transmitted, 143.0, 2.0, 2));
    let values = tally.into_fractions(2);
    let [reflected, transmitted] = Side::BOTH;
    assert_eq!(values.budget().reflected, 0.25);
    assert_eq!(values.budget().transmitted, 0.25);
    assert_eq!(values.order(transmitted, 2), 0.25);
    assert_eq!(values.rings(reflected, Component::Single).get(6), 0.25);
    assert_eq!(values.rings(transmitted, Component::All).get(10), 0.25);
    let bins: f64 = values[spec.grid_entries(Component::All)].iter().sum();
    assert_eq!(bins, 0.5);
    let hits: f64 = values[grid_hits(&spec, Component::Multiple)].iter().sum();
    assert_eq!(hits, 0.5);
    // 143 deg from +z is 37 deg from -z.
    let in_plane = values.in_plane(transmitted, Component::Order(2));
    assert_eq!(in_plane.get(18 + 7), 0.25);
    let in_plane = values.in_plane(reflected, Component::Single);
    assert_eq!(in_plane.get(18 + 6), 0.25);
}

#[test]
fn in_plane_profile_knows_forward_from_backward_and_leaves_out_the_rest() {
    let spec = TallySpec::new(HemisphereGrid::default(), 5_f64.to_radians()).unwrap();
    // Light from azimuth 100 deg travels towards 280 deg.
    let mut tally = Tally::new(spec, Azimuth::From(280_f64.to_radians()));
    tally.add_exit(&exit(Side::Reflected, 12.0, 283.0, 1));
    tally.add_exit(&exit(Side::Reflected, 12.0, 97.0, 1));
    tally.add_exit(&exit(Side::Reflected, 12.0, 280.0 - 6.0, 1));
    tally.add_exit(&exit(Side::Reflected, 12.0, 10.0, 1));
    let values = tally.into_fractions(1);
    let profile = &values[spec.in_plane_entries(Side::Reflected, Component::All)];
    assert_eq!(profile[18 + 2], 0.5);
    assert_eq!(profile[18 - 3], 0.5);
    assert_eq!(profile.iter().sum::<f64>(), 1.0);
}

/// Exits that lie evenly about the vertical at many polar angles, with fluxes and orders of all
/// kinds.
fn even_exits(n_phi: u32) -> Vec<Exit> {
    let mut exits = Vec::new();
    for i in 0..60 {
        let theta = 3.0 * f64::from(i) + 1.3;
        let side = if theta < 90.0 {
            Side::Reflected
        } else {
            Side::Transmitted
        };
        for k in 0..n_phi {
            let phi = 360.0 * (f64::from(k) + 0.5) / f64::from(n_phi);
            let mut exit = exit(side, theta, phi, 1 + i % 5);
            exit.flux = 0.1 + f64::from(i % 7);
            exits.push(exit);
        }
    }
    exits
}

#[test]
fn free_azimuth_spreads_what_is_even_as_it_was_found() {
    // 1440 directions per ring: the sectors of 10 deg and the in-plane slices hold whole numbers of them.
    let spec = TallySpec::default().with_medium();
    let mut found = Tally::new(spec, Azimuth::From(0.0));
    let mut free = Tally::new(spec, Azimuth::Free);
    for exit in even_exits(1440) {
        found.add_exit(&exit);
        free.add_exit(&exit);
    }
    let [found, free] = [found, free].map(|record| record.into_fractions(1000));
    for (i, (found, free)) in found.iter().zip(free.iter()).enumerate() {
        assert!((found - free).abs() <= 1e-12 * found, "{i}: {found} {free}");
    }
}

#[test]
fn free_azimuth_is_exactly_even_and_adds_up() {
    for half_width_deg in [0.01, 5.0, 90.0] {
        let grid = HemisphereGrid::new(18, 7).unwrap();
        let spec = TallySpec::new(grid, f64::to_radians(half_width_deg)).unwrap();
        let mut tally = Tally::new(spec, Azimuth::Free);
        // All at one azimuth, which is ignored.
        even_exits(1).iter().for_each(|exit| tally.add_exit(exit));
        let values = tally.into_fractions(60);
        let bins = Component::BINS.map(|c| spec.grid_entries(c));
        let hits = Component::SURFACE.map(|c| grid_hits(&spec, c));
        for entries in bins.into_iter().chain(hits) {
            for ring in values[entries].chunks_exact(grid.n_phi()) {
                assert!(ring.iter().all(|value| *value == ring[0]));
            }
        }
        for side in Side::BOTH {
            for class in Component::RINGS {
                let profile = &values[spec.in_plane_entries(side, class)];
                assert!(profile.iter().eq(profile.iter().rev()));
                let of_rings: f64 = values[spec.ring_entries(side, class)].iter().sum();
                let of_profile: f64 = profile.iter().sum();
                let fraction = half_width_deg / 90.0;
                assert!((of_profile - fraction * of_rings).abs() < 1e-12);
            }
            let bins: f64 = values.bins(side, Component::All).iter().sum();
            assert!((bins - values.flux(side, Component::All)).abs() < 1e-12);
        }
        let rays: f64 = [Component::Single, Component::Multiple]
            .iter()
            .flat_map(|&component| &values[grid_hits(&spec, component)])
            .sum();
        assert!((rays - 1.0).abs() < 1e-12);
    }
}

#[test]
fn components_of_the_medium_add_to_all_light() {
    let spec = TallySpec::default().with_medium();
    for azimuth in [Azimuth::From(0.3), Azimuth::Free] {
        let mut tally = Tally::new(spec, azimuth);
        even_exits(70).iter().for_each(|exit| tally.add_exit(exit));
        let values = tally.into_fractions(10);
        let same = |entries: [crate::Entries; 3], all: Vec<f64>| {
            assert_eq!(entries[0].len(), all.len());
            assert!(all.iter().any(|x| *x > 0.0));
            for (i, all) in all.iter().enumerate() {
                let sum: f64 = entries.iter().map(|e| values[e.get(i)]).sum();
                // Up to 4200 terms, added in another order.
                assert!((sum - all).abs() <= 1e-12 * all.abs());
            }
        };
        let of = Component::MEDIUM;
        for side in Side::BOTH {
            let all = Component::All;
            same(
                of.map(|c| spec.bin_entries(side, c)),
                values.bins(side, all).iter().collect(),
            );
            let bins = 0..spec.bin_filter(side).len();
            same(
                of.map(|c| spec.hit_entries(side, c)),
                bins.map(|i| values.hits(side, all, i)).collect(),
            );
            same(
                of.map(|c| spec.ring_entries(side, c)),
                values.rings(side, all).iter().collect(),
            );
            same(
                of.map(|c| spec.in_plane_entries(side, c)),
                values.in_plane(side, all).iter().collect(),
            );
            let sum: f64 = of.map(|c| values.flux(side, c)).iter().sum();
            assert!((sum - values.flux(side, all)).abs() <= 1e-12 * sum);
        }
    }
}

/// A component that no other file knows: light that was transmitted an even number of times, but at
/// least once.
static BACK_AND_FORTH: ComponentFilter = ComponentFilter {
    name: "back_and_forth",
    label: "back and forth through the surface",
    description: "light that was transmitted an even number of times, but at least once",
    accepts: |exit| exit.path.code() != 0 && exit.path.code().count_ones() % 2 == 0,
};

#[test]
fn a_component_is_added_in_one_place() {
    const ADDED: Component = Component::Custom(&BACK_AND_FORTH);
    let spec = TallySpec::default().with_components(&[ADDED]);
    let exit = |events: &[Event], theta_deg: f64| Exit {
        side: Side::Reflected,
        wo: from_spherical(f64::to_radians(theta_deg), 0.1),
        flux: 0.5,
        path: events
            .iter()
            .fold(EventPath::default(), |path, &event| path.then(event)),
        scatterings: 0,
    };
    let (r, t) = (Event::Reflection, Event::Transmission);
    for azimuth in [Azimuth::From(0.0), Azimuth::Free] {
        let mut tally = Tally::new(spec, azimuth);
        tally.add_exit(&exit(&[r], 12.0));
        tally.add_exit(&exit(&[t, r, t], 12.0));
        let values = tally.into_fractions(1);
        let side = Side::Reflected;
        assert_eq!(values.flux(side, Component::All), 1.0);
        assert_eq!(values.flux(side, ADDED), 0.5);
        assert_eq!(values.rings(side, ADDED).get(2), 0.5);
        assert!((values.bins(side, ADDED).iter().sum::<f64>() - 0.5).abs() < 1e-15);
        let hits = (0..spec.bin_filter(side).len()).map(|i| values.hits(side, ADDED, i));
        assert!((hits.sum::<f64>() - 1.0).abs() < 1e-12);
        let in_plane = values.in_plane(side, ADDED);
        assert_eq!(
            in_plane.get(20),
            0.5 * values.in_plane(side, Component::All).get(20)
        );
        // It names its columns and legends.
        assert_eq!(spec.components()[0].name(), "back_and_forth");
    }
}

#[test]
fn losses_go_into_the_budget() {
    let mut tally = Tally::new(TallySpec::default(), Azimuth::From(0.0));
    tally.add_loss(Loss::Absorbed, 0.25);
    tally.add_loss(Loss::LeftPatch, 0.5);
    tally.add_loss(Loss::Truncated, -0.125);
    tally.add_loss(Loss::Lost, 0.25);
    tally.add_loss(Loss::NotRecorded, 0.125);
    let values = tally.into_fractions(1);
    let budget = values.budget();
    assert_eq!(budget.parts(), [0.0, 0.0, 0.25, 0.5, 0.25]);
    assert_eq!([budget.left_patch, budget.not_recorded], [0.5, 0.125]);
}

#[test]
fn a_side_that_is_not_recorded_fills_no_bin() {
    for sides in [Sides::Reflected, Sides::Transmitted] {
        let spec = TallySpec::default().with_sides(sides);
        let exits = [
            exit(Side::Reflected, 32.0, 1.0, 1),
            exit(Side::Transmitted, 143.0, 2.0, 2),
            exit(Side::Reflected, 12.0, 170.0, 3),
        ];
        let mut all = Tally::new(spec.with_sides(Sides::Both), Azimuth::From(0.0));
        let mut recorded = Tally::new(spec, Azimuth::From(0.0));
        let mut alone = Tally::new(spec.with_sides(Sides::Both), Azimuth::From(0.0));
        let mut elsewhere = 0.0;
        for exit in &exits {
            all.add_exit(exit);
            recorded.add_exit(exit);
            if spec.records(exit.side) {
                alone.add_exit(exit);
            } else {
                elsewhere += exit.flux;
            }
        }
        let [all, recorded, mut alone] = [all, recorded, alone].map(|r| r.into_fractions(1));
        alone[TallySpec::BUDGET.truncated] = elsewhere;
        alone[TallySpec::BUDGET.not_recorded] = elsewhere;
        assert!(recorded.iter().eq(alone.iter()));
        let budget = |values: &TallyValues| values.budget().total();
        assert_eq!(budget(&recorded), budget(&all));
    }
}

/// All light of a side, a cone on each side, and a receptor where the centre is off the vertical.
fn apertures(theta: f64) -> Apertures {
    let shape = ApertureShape::Receptor {
        in_plane: [0.4, 0.9],
        across: [0.8, 1.1],
    };
    let [reflected, transmitted] = Side::BOTH;
    let cone = Aperture::cone(reflected, theta, 0.5);
    let always = [
        Aperture::whole(transmitted),
        cone,
        Aperture::cone(transmitted, std::f64::consts::PI - theta, 0.7),
    ];
    let receptor = (theta > 0.0).then_some(Aperture { shape, ..cone });
    always.into_iter().chain(receptor).collect()
}

/// Apertures take light by its angles to their centres and by the offsets from these, visible light in full under a control variate too, and no
/// light that is masked.
#[test]
fn apertures_take_all_visible_light_with_its_weight() {
    let forward = 0.3;
    let spec = full_spec().with_apertures(apertures(0.9));
    let fractions = VisibleFractions {
        rings: [vec![0.8; 6], vec![0.6; 6]],
        absorbed: 0.5,
    };
    let mut fluxes = UnshadowedFluxes::zeros(&spec);
    fluxes.rings = [vec![0.1; 6], vec![0.05; 6]];
    let control_variate = ControlVariate::new(spec, fractions, &fluxes);
    let exits = uneven_exits(4000);
    let near = |exit: &Exit, theta: f64, angle: f64| {
        exit.wo.angle_between(from_spherical(theta, forward)) <= angle
    };
    let part = |offset: f64, source: f64, receptor: f64| {
        let ends = [offset - 0.5 * source, offset + 0.5 * source];
        let [from, to] = ends.map(|end| end.clamp(-0.5 * receptor, 0.5 * receptor));
        (to - from) / source
    };
    let weights = |exit: &Exit| {
        let is_reflected = exit.side == Side::Reflected;
        let turned = glam::DQuat::from_rotation_z(-forward) * exit.wo;
        let [polar, aside] = [turned.x.atan2(turned.z), turned.y.asin()];
        let receptor = part(polar - 0.9, 0.4, 0.9) * part(aside, 0.8, 1.1);
        let theta = std::f64::consts::PI - 0.9;
        [
            f64::from(!is_reflected),
            f64::from(is_reflected && near(exit, 0.9, 0.5)),
            f64::from(!is_reflected && near(exit, theta, 0.7)),
            if is_reflected { receptor } else { 0.0 },
        ]
    };
    let mut expected = [0.0; 4];
    for exit in &exits {
        for (sum, weight) in expected.iter_mut().zip(weights(exit)) {
            *sum += weight * exit.flux;
        }
    }
    let one = Tally::new(spec, Azimuth::From(forward));
    for control_variate in [None, Some(&control_variate)] {
        let empty = one.clone().with_control_variate(control_variate);
        let mut tallies = Tallies::new(empty, 1);
        let mut columns = ExitColumns::new(Polarimetry::Mueller);
        for exit in &exits {
            columns.push(exit, 0);
            columns.push_masked(exit, 0);
        }
        tallies.locate(&mut columns);
        tallies.add_located(&mut columns);
        let mut values = tallies.into_fractions(1).remove(0);
        if let Some(one) = control_variate {
            one.complete(&mut values);
        }
        let found: Vec<f64> = values.apertures().collect();
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }
}

/// Many exits of several batches at once are counted as one after the other: in directions over both hemispheres, on edges of bins and of
/// the slice, vertical and grazing.
#[test]
fn located_exits_count_as_single_ones() {
    let grid = HemisphereGrid::new(7, 12).unwrap();
    let n_theta = grid.n_theta();
    let bins = TallySpec::new(grid, 0.2).unwrap().with_medium();
    let fractions = crate::VisibleFractions {
        rings: [0.3, 0.6].map(|f| (0..n_theta).map(|ring| f * ring as f64 / 7.0).collect()),
        absorbed: 0.5,
    };
    let fluxes = crate::UnshadowedFluxes {
        bins: vec![0.1; grid.len()],
        rings: [vec![0.1; n_theta], vec![0.1; n_theta]],
        in_plane: Side::BOTH.map(|side| vec![0.1; bins.in_plane_filter(side).len()]),
        absorbed: 0.1,
    };
    let exits: Vec<(Exit, bool)> = (0..6000_u32)
        .map(|i| {
            let x = f64::from(i);
            let (u, v) = ((x * 0.618_034).fract(), (x * 0.414_214).fract());
            let theta = if i % 5 == 0 {
                (14.0 * u).round() / 14.0
            } else {
                u
            } * 180.0;
            let phi = if i % 7 == 0 {
                (36.0 * v).round() * 10.0
            } else {
                v * 360.0
            };
            let side = if theta <= 90.0 {
                Side::Reflected
            } else {
                Side::Transmitted
            };
            let exit = Exit {
                flux: 0.1 + v,
                ..exit(side, theta, phi, 1 + i % 4)
            };
            (exit, i % 6 == 0)
        })
        .collect();
    for (azimuth, theta) in [(Azimuth::From(0.3), 0.9), (Azimuth::Free, 0.0)] {
        let spec = bins.with_apertures(apertures(theta));
        let control_variate = ControlVariate::new(spec, fractions.clone(), &fluxes);
        for control_variate in [None, Some(&control_variate)] {
            let empty = Tally::new(spec, azimuth).with_control_variate(control_variate);
            let mut single = vec![empty.clone(); 3];
            let mut located = crate::Tallies::new(empty, 3);
            let mut columns = ExitColumns::default();
            for (i, (exit, is_masked)) in exits.iter().enumerate() {
                let batch = i as u32 % 13 % 3;
                let single = &mut single[batch as usize];
                if *is_masked {
                    let at = single.direction(exit);
                    let weight = single.masked_weight(exit, at.ring);
                    single.book(exit, weight * exit.flux, &at);
                    columns.push_masked(exit, batch);
                } else {
                    single.add_exit(exit);
                    columns.push(exit, batch);
                }
                if i % 1000 == 700 {
                    located.locate(&mut columns);
                    located.add_located(&mut columns);
                }
            }
            located.locate(&mut columns);
            located.add_located(&mut columns);
            let single = single.into_iter().map(|tally| tally.into_fractions(10));
            assert_eq!(single.collect::<Vec<_>>(), located.into_fractions(10));
        }
    }
}

/// Exits of many magnitudes, on either side, of all orders.
fn uneven_exits(count: u32) -> Vec<Exit> {
    let exits = (0..count).map(|i| {
        let part = |step: f64| (f64::from(i) * step).fract();
        let [theta, phi] = [180.0 * part(0.618_034), 360.0 * part(0.754_878)];
        let side = if theta < 90.0 {
            Side::Reflected
        } else {
            Side::Transmitted
        };
        Exit {
            flux: part(0.569_840) * 10_f64.powi(-(i as i32 % 13)),
            ..exit(side, theta, phi, 1 + i % 9)
        }
    });
    exits.collect()
}

fn full_spec() -> TallySpec {
    let spec = TallySpec::new(HemisphereGrid::new(6, 8).unwrap(), 0.2).unwrap();
    spec.with_medium().with_polarimetry(Polarimetry::Mueller)
}

/// Tallies of two batches after exits and losses, under a control variate or not.
fn tallies<'c>(exits: &[Exit], control_variate: Option<&'c ControlVariate>) -> Tallies<'c> {
    let tally = Tally::new(full_spec(), Azimuth::From(0.3)).with_control_variate(control_variate);
    let mut tallies = Tallies::new(tally, 2);
    let mut columns = ExitColumns::new(Polarimetry::Mueller);
    for exit in exits {
        let batch = u32::from(exit.wo.x > 0.0);
        let measures = [0; 16].map(|_: u8| exit.wo.y);
        match exit.path.order() {
            7 => tallies.of(batch).add_loss(Loss::Truncated, -exit.flux),
            8 => columns.push_masked(exit, batch),
            _ => columns.push_measured(exit, batch, &measures),
        }
    }
    tallies.locate(&mut columns);
    tallies.add_located(&mut columns);
    tallies
}

#[test]
fn neither_order_nor_division_changes_a_bit() {
    let exits = uneven_exits(2000);
    let spec = full_spec();
    let fractions = VisibleFractions {
        rings: Side::BOTH.map(|_| (0..6).map(|ring| 0.15 * f64::from(ring)).collect()),
        absorbed: 0.3,
    };
    let controlled = ControlVariate::new(spec, fractions, &UnshadowedFluxes::zeros(&spec));
    for control_variate in [None, Some(&controlled)] {
        let expected = tallies(&exits, control_variate).into_fractions(7);
        let permuted: Vec<Exit> = (0..2000).map(|i| exits[i * 617 % 2000]).collect();
        for (exits, size) in [
            (&exits, 2000),
            (&permuted, 2000),
            (&permuted, 1),
            (&exits, 37),
        ] {
            let parts = exits
                .chunks(size)
                .map(|part| tallies(part, control_variate));
            // The last part comes first.
            let sum = parts.rev().reduce(|mut sum, part| {
                sum += &part;
                sum
            });
            let found = sum.unwrap().into_fractions(7);
            for (found, expected) in found.iter().zip(&expected) {
                let mut pairs = found.iter().zip(expected);
                assert!(pairs.all(|(a, b)| a.to_bits() == b.to_bits()), "{size}");
            }
        }
    }
}

/// The largest sum that a tally holds: of `2^51` contributions of the largest weight.
#[test]
fn sums_hold_their_bound() {
    for weight in [1.0, 12_345.6, 2_f64.powi(40)] {
        let mut tally =
            Tally::new(TallySpec::default(), Azimuth::From(0.0)).with_largest_weight(weight);
        tally.add_exit(&Exit {
            flux: weight,
            ..exit(Side::Reflected, 32.0, 1.0, 1)
        });
        tally.add_loss(Loss::Truncated, -weight);
        for _ in 0..51 {
            let same = tally.clone();
            tally += &same;
        }
        let values = tally.into_fractions(1 << 51);
        assert_eq!(values.flux(Side::Reflected, Component::All), weight);
        assert_eq!(values.budget().truncated, -weight);
        let hits = &values[grid_hits(&TallySpec::default(), Component::Single)];
        assert_eq!(hits.iter().sum::<f64>(), 1.0);
    }
}

#[test]
fn fluxes_are_rounded_to_less_than_the_promised_part_of_the_largest_weight() {
    for weight in [1.0, 8193.0] {
        for i in 0..1000 {
            let flux = weight * (f64::from(i) * 0.618_034).fract() * 10_f64.powi(-(i % 25));
            let mut tally =
                Tally::new(TallySpec::default(), Azimuth::From(0.0)).with_largest_weight(weight);
            tally.add_loss(Loss::Absorbed, flux);
            let error = (tally.into_fractions(1).budget().absorbed - flux).abs();
            assert!(error <= weight * 2_f64.powi(-74), "{flux}: {error}");
        }
    }
}

/// Flux of paths from above that diffuse facets of the reflectance .001 have scattered n times.
#[test]
fn weak_orders_are_not_rounded_away() {
    for (order, tolerance) in [(4, 1e-10), (6, 1e-4), (7, 0.1)] {
        let mut tally = Tally::new(TallySpec::default(), Azimuth::From(0.0));
        let flux = 0.001_f64.powi(order as i32);
        tally.add_exit(&Exit {
            flux,
            ..exit(Side::Reflected, 32.0, 1.0, order)
        });
        let found = tally
            .into_fractions(1)
            .order(Side::Reflected, order as usize);
        assert!((found / flux - 1.0).abs() < tolerance, "{order}: {found}");
    }
}

#[test]
#[should_panic(expected = "a flux of NaN")]
fn a_flux_that_is_no_number_is_no_zero() {
    let mut tally = Tally::new(TallySpec::default(), Azimuth::Free);
    tally.add_loss(Loss::Absorbed, f64::NAN);
}
