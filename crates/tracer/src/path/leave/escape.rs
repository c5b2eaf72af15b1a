//! Escape: finds the segments that leave without a search, and adds light that leaves for good to the tally.

use asperity_tally::{EventPath, Exit, ExitColumns, Loss, Side, Tallies};
use glam::{DVec2, DVec3};

use crate::geometry::{CullingClass, Geometry};
use crate::interaction::stack::Interface;
use crate::path::state::batch::Batch;
use crate::path::state::conductors::Conductors;
use crate::path::state::path_state::{Departure, RayKind, Region};
use crate::path::state::segments::{Segments, gather_column};
use crate::path::state::work::Work;
use crate::path::tracer::Tracer;
use crate::periodic::begin;
use crate::random::PathStream;
use crate::settings::Polarisation;
use crate::vector::Stage;

/// Finds the culling classes of all segments before they are searched.
pub(crate) struct FindCullingClasses<'a, G: Geometry> {
    pub(crate) geometry: &'a G,
    pub(crate) segments: &'a Segments,
    pub(crate) classes: &'a mut Vec<CullingClass>,
}

impl<G: Geometry> Stage for FindCullingClasses<'_, G> {
    #[inline(always)]
    fn run(self) {
        self.classes
            .resize(self.segments.len, CullingClass::Unknown);
        let rays = self.segments.rays(self.geometry.aspect());
        self.geometry.culling_classes(rays, self.classes);
    }
}

/// Sorts rays that carry flux by their culling classes, and counts those that escape: numbers of rays that are `searched`, that have
/// `escaped`, and that begin `elsewhere`.
pub(crate) fn sort_by_culling_class(
    classes: &[CullingClass],
    flux: &[f64],
    [searched, escaped, elsewhere]: [&mut Vec<u32>; 3],
    work: &mut Work,
) {
    // Without branches, since classes come as they like
    searched.resize(classes.len(), 0);
    escaped.resize(classes.len(), 0);
    elsewhere.clear();
    let [mut searched_count, mut escaped_count] = [0; 2];
    let mut above = 0;
    for (i, (&class, &flux)) in classes.iter().zip(flux).enumerate() {
        let is_alive = flux > 0.0;
        let is_above = class == CullingClass::AboveHorizon;
        let escapes = (class == CullingClass::SteeperThanAll) | is_above;
        searched[searched_count] = i as u32;
        searched_count += usize::from(is_alive & (class == CullingClass::Unknown));
        escaped[escaped_count] = i as u32;
        escaped_count += usize::from(is_alive & escapes);
        above += u64::from(is_alive & is_above);
        if is_alive & (class == CullingClass::Elsewhere) {
            elsewhere.push(i as u32);
        }
    }
    searched.truncate(searched_count);
    escaped.truncate(escaped_count);
    work.segments_skipped += escaped_count as u64;
    work.segments_skipped_nearby += above;
}

/// Adds segments that leave to the exits, by their numbers.
struct Leave<'a> {
    segments: &'a Segments,
    which: &'a [u32],
    /// Sign of the half space of the light.
    incident: f64,
    exits: &'a mut ExitColumns,
}

impl Stage for Leave<'_> {
    #[inline(always)]
    fn run(self) {
        let Self {
            segments,
            which,
            incident,
            exits,
        } = self;
        let rows = exits.add_rows(which.len());
        let [wx, wy, wz] = rows.wo;
        let [dx, dy, dz] = &segments.direction;
        gather_column(wx, dx, which);
        gather_column(wy, dy, which);
        gather_column(wz, dz, which);
        gather_column(rows.flux, &segments.flux, which);
        gather_column(rows.scatterings, &segments.scatterings, which);
        if segments.kept.slot {
            gather_column(rows.batch, &segments.slot, which);
        } else {
            gather_column(rows.batch, &segments.ray, which);
            for batch in rows.batch {
                *batch = PathStream::batch_of(*batch);
            }
        }
        let mut measures = rows.measures;
        measure(&mut measures, segments, which);
        for (k, &i) in which.iter().enumerate() {
            let i = i as usize;
            rows.path[k] = EventPath::from_code(segments.order[i], segments.events[i]);
            rows.side[k] = if segments.side[i] == incident {
                Side::Reflected
            } else {
                Side::Transmitted
            };
            // As in the world; the incident side is +z, and the azimuth is counted from that of the light
            let mirrored = segments.mirrored[i];
            wx[k] = if mirrored & 1 == 0 { wx[k] } else { -wx[k] };
            wy[k] = if mirrored & 2 == 0 { wy[k] } else { -wy[k] };
            wz[k] *= incident;
        }
        if segments.kept.turn {
            let [cosines, sines] = &segments.turn;
            for (k, &i) in which.iter().enumerate() {
                let turn = DVec2::new(cosines[i as usize], sines[i as usize]);
                let level = DVec2::new(wx[k], wy[k]);
                if level == DVec2::ZERO {
                    turn_measures(&mut measures, k, segments, i as usize, wz[k]);
                }
                let level = turn.rotate(level);
                (wx[k], wy[k]) = (level.x, level.y);
            }
        }
    }
}

/// Takes the measures of polarised light.
#[inline(always)]
fn measure(rows: &mut [&mut [f64]], segments: &Segments, which: &[u32]) {
    match (segments.kept.polarisation, rows) {
        (Polarisation::Both, [difference]) => {
            gather_column(difference, &segments.light[3], which);
            for averaged in difference.iter_mut() {
                *averaged = 1.0 - *averaged;
            }
        }
        (Polarisation::Mueller, [flux, elements @ ..]) => {
            flux.fill(1.0);
            for (row, column) in elements.iter_mut().zip(&segments.light) {
                gather_column(row, column, which);
            }
        }
        _ => {}
    }
}

/// Turns the measures of segment `i`, which leaves along the vertical direction `z` as exit number `k`, with the azimuth of its
/// light.
#[cold]
fn turn_measures(rows: &mut [&mut [f64]], k: usize, segments: &Segments, i: usize, z: f64) {
    let state = segments.state(i);
    let light = state.light_that_leaves(DVec3::Z * z, segments.kept.polarisation);
    for (row, measure) in rows
        .iter_mut()
        .zip(light.measures(segments.kept.polarisation))
    {
        row[k] = measure;
    }
}

/// Finds the bins of all exits.
struct Locate<'a, 't> {
    tallies: &'a Tallies<'t>,
    exits: &'a mut ExitColumns,
}

impl Stage for Locate<'_, '_> {
    #[inline(always)]
    fn run(self) {
        self.tallies.locate(self.exits);
    }
}

impl<G: Geometry> Tracer<'_, G> {
    /// Tallies the segments that leave without a search, and has the others searched.
    pub(crate) fn escape(&self, batch: &mut Batch<'_, G::Facet>) {
        batch.instructions.run(FindCullingClasses {
            geometry: self.geometry,
            segments: &batch.segments,
            classes: &mut batch.classes,
        });
        if !Side::BOTH
            .into_iter()
            .all(|side| batch.tallies.records(side))
        {
            self.end_unrecorded(batch);
        }
        sort_by_culling_class(
            &batch.classes,
            &batch.segments.flux,
            [
                &mut batch.searched,
                &mut batch.escaped,
                &mut batch.elsewhere,
            ],
            &mut batch.work,
        );
        self.leave(batch, Work::of_skipped);
        for k in 0..batch.elsewhere.len() {
            self.begin_elsewhere(batch.elsewhere[k] as usize, batch);
        }
    }

    /// Adds the segments that have escaped to the exits. `counted`: the work that has been counted for each, by its culling class.
    pub(crate) fn leave(
        &self,
        batch: &mut Batch<'_, G::Facet>,
        counted: impl Fn(CullingClass) -> Work,
    ) {
        if batch.conductors.is_some() {
            for k in 0..batch.escaped.len() {
                let i = batch.escaped[k] as usize;
                let class = batch.classes.get(i).copied();
                let counted = counted(class.unwrap_or(CullingClass::Unknown));
                let departure = self.departure(batch, i);
                if let Some(conductors) = &mut batch.conductors {
                    let slot = self.row_at_exit(&departure, conductors);
                    batch.segments.slot[i] = slot;
                    conductors.end(slot, counted);
                }
            }
        }
        batch.instructions.run(Leave {
            segments: &batch.segments,
            which: &batch.escaped,
            incident: self.incident.sign(),
            exits: &mut batch.exits,
        });
        batch.escaped.clear();
    }

    /// Ends the segments that can only end on a side that is not recorded.
    ///
    /// A path that has reached the highest order has no interaction left: it escapes on the side of its half
    /// space, or is truncated. If that side is not recorded, its flux is tallied as such at once. A path of lower
    /// order is always traced, since it may come back. One of the highest order draws no more random numbers, so the
    /// tally of a side does not depend on whether the other is recorded.
    fn end_unrecorded(&self, batch: &mut Batch<'_, G::Facet>) {
        for i in 0..batch.segments.len {
            let segments = &batch.segments;
            let is_last = segments.order[i] >= self.settings.max_order && segments.flux[i] > 0.0;
            let side = self.side_of(Region::top(segments.half_space(i)));
            if is_last && !batch.tallies.records(side) {
                let departure = self.departure(batch, i);
                let state = &departure.state;
                batch.add_loss(state, Loss::NotRecorded, state.flux);
                self.tally_masked(&departure, batch);
                batch.work += Work::NOT_RECORDED;
                batch.end_path(&departure.state, Work::NOT_RECORDED);
                batch.segments.flux[i] = 0.0;
            }
        }
    }

    /// Moves a segment that begins elsewhere into the tile, or ends it.
    #[inline(never)]
    fn begin_elsewhere(&self, i: usize, batch: &mut Batch<'_, G::Facet>) {
        let mut heading = batch.segments.heading(i);
        match begin(self.geometry, &mut heading, batch.segments.half_space(i)) {
            None => {
                batch.segments.set_heading(i, &heading);
                batch.searched.push(i as u32);
            }
            Some(end) => {
                let departure = self.departure(batch, i);
                self.end(end, &departure, &RayKind::Path, batch);
            }
        }
    }

    /// Adds all exits to the tally.
    pub(crate) fn tally_exits(&self, batch: &mut Batch<'_, G::Facet>) {
        batch.instructions.run(Locate {
            tallies: &batch.tallies,
            exits: &mut batch.exits,
        });
        match &mut batch.conductors {
            Some(conductors) => conductors.tally(&mut batch.exits),
            None => batch.tallies.add_located(&mut batch.exits),
        }
    }

    /// The row of a path of several conductors that leaves for good, with the measures of the tally.
    fn row_at_exit(&self, departure: &Departure, conductors: &mut Conductors<'_>) -> u32 {
        let mut state = departure.state;
        if state.events.order() == 0 {
            state.slot = conductors.begin(state.ray, state.flux, &state.light);
        }
        conductors.set_measures(&state, self.upright(departure.direction));
        state.slot
    }

    /// A direction in the world, with +z on the incident side.
    fn upright(&self, direction: DVec3) -> DVec3 {
        direction * DVec3::new(1.0, 1.0, self.incident.sign())
    }

    /// Adds light that departs to the exits.
    pub(crate) fn push_exit(&self, departure: &Departure, batch: &mut Batch<'_, G::Facet>) {
        let polarisation = self.settings.polarisation;
        let wo = self.upright(departure.direction);
        let light = departure.state.light_that_leaves(wo, polarisation);
        let measures = light.measures(polarisation);
        let mut number = batch.number_of(&departure.state);
        if let Some(conductors) = &mut batch.conductors {
            number = self.row_at_exit(departure, conductors);
            if departure.state.events.order() == 0 {
                conductors.end(number, Work::NONE);
            }
        }
        batch
            .exits
            .push_measured(&self.exit(departure), number, &measures);
    }

    /// The exit of a path that departs.
    #[inline(always)]
    pub(crate) fn exit(&self, departure: &Departure) -> Exit {
        let Departure {
            region,
            direction,
            ref state,
        } = *departure;
        // The incident side is +z, and the azimuth is counted from that of the light.
        let wo = direction * DVec3::new(1.0, 1.0, self.incident.sign());
        let level = state.turn.rotate(wo.truncate());
        Exit {
            side: self.side_of(region),
            wo: level.extend(wo.z),
            flux: state.flux,
            path: state.events,
            scatterings: state.scatterings,
        }
    }

    /// The side on which light counts that escapes from a region.
    #[inline(always)]
    pub(crate) fn side_of(&self, region: Region) -> Side {
        if region.interface == Interface::TOP && region.half_space == self.incident {
            Side::Reflected
        } else {
            Side::Transmitted
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_that_carry_flux_are_sorted_by_their_culling_classes_and_counted() {
        use CullingClass::{AboveHorizon, Elsewhere, SteeperThanAll, Unknown};
        let classes = [
            Unknown,
            AboveHorizon,
            SteeperThanAll,
            Elsewhere,
            AboveHorizon,
            Unknown,
            Unknown,
            Elsewhere,
        ];
        let flux = [1.0, 1.0, 1.0, 1.0, 0.5, 0.0, 1.0, 0.0];
        // Earlier entries are removed.
        let [mut searched, mut escaped, mut elsewhere] = [vec![7; 20], vec![7; 20], vec![7; 20]];
        let mut work = Work::default();
        let into = [&mut searched, &mut escaped, &mut elsewhere];
        sort_by_culling_class(&classes, &flux, into, &mut work);
        assert_eq!(
            (searched, escaped, elsewhere),
            (vec![0, 6], vec![1, 2, 4], vec![3])
        );
        assert_eq!(
            (work.segments_skipped, work.segments_skipped_nearby),
            (3, 2)
        );
    }
}
