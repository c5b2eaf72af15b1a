//! Call: traces the rays of one call on a device.

use asperity_tally::{BinStarts, ControlVariate, Tallies, TallyLayout};
use asperity_tracer::Work;

use crate::device::{Device, DeviceError, Job, Memory};
use crate::job::{Rays, aperture};
use crate::surface::SurfaceOnDevice;
use crate::tables::{COUNTS, JobTable, upload};

/// Paths of one run of a kernel, between which a call may be given up. On a GPU of few f64 units a run takes some tenths of a second, and
/// displays are not blocked for long.
const PATHS_OF_RUN: u64 = 1 << 18;

/// A call that is traced on a device.
pub(crate) struct Call<'a> {
    pub(crate) device: &'a dyn Device,
    pub(crate) surface: &'a SurfaceOnDevice,
    pub(crate) rays: &'a Rays<'a>,
    pub(crate) layout: TallyLayout,
}

/// End of a call.
pub(crate) enum CallEnd {
    Whole(Work),
    GivenUp,
    /// Some branch had no room to wait, or some flux was no number that sums hold: the CPU engine is to trace the call.
    LeftToCpu,
}

impl Call<'_> {
    /// Adds all light to the tallies.
    pub(crate) fn trace(
        &self,
        tallies: &mut Tallies<'_>,
        gives_up: &dyn Fn() -> bool,
    ) -> Result<CallEnd, DeviceError> {
        let device = self.device;
        let sums = device.zeros(COUNTS + 2 * tallies.sums().len())?;
        let tables = self.upload(sums.address(), tallies.control_variate())?;
        let job = Job(tables.address());
        let kernel = self.surface.kernel(self.rays.case.settings);
        let count = self.rays.count();
        for first in (0..count).step_by(PATHS_OF_RUN as usize) {
            if gives_up() {
                return Ok(CallEnd::GivenUp);
            }
            let paths = first..count.min(first + PATHS_OF_RUN);
            device.run(kernel, job, paths)?;
        }
        let words = sums.read()?;
        let Some((&counts, sums)) = words.split_first_chunk::<COUNTS>() else {
            return Err(DeviceError::Driver("no counts of work".to_owned()));
        };
        let [
            segments,
            segments_skipped,
            segments_skipped_nearby,
            branches_not_recorded,
            left_to_cpu,
        ] = counts;
        if left_to_cpu > 0 {
            return Ok(CallEnd::LeftToCpu);
        }
        let of_words = |&[low, high]: &[u64; 2]| i128::from(high as i64) << 64 | i128::from(low);
        tallies.add_sums(sums.as_chunks().0.iter().map(of_words));
        let work = Work {
            rays: count,
            segments,
            segments_skipped,
            segments_skipped_nearby,
            branches_not_recorded,
            ..Work::default()
        };
        Ok(CallEnd::Whole(work))
    }

    /// Copies the job of a call and its tables to the device. `counts`: address of the counts of work, which stand before the sums.
    fn upload(
        &self,
        counts: u64,
        control: Option<&ControlVariate>,
    ) -> Result<Box<dyn Memory>, DeviceError> {
        let of_sides = |get: fn(&BinStarts) -> &[f64]| {
            let sides = self.layout.edges.as_ref();
            sides.map_or_else(Vec::new, |sides| sides.each_ref().map(get).concat())
        };
        let rings = of_sides(|side| &side.rings);
        let sectors = of_sides(|side| &side.sectors);
        let apertures: Vec<_> = self.layout.apertures.iter().map(aperture).collect();
        let fractions = control.map_or_else(Vec::new, |one| one.fractions().rings.concat());
        let arrays = [
            bytemuck::cast_slice(&rings),
            bytemuck::cast_slice(&sectors),
            bytemuck::cast_slice(&apertures),
            bytemuck::cast_slice(&fractions),
        ];
        upload(self.device, arrays, |arrays| {
            let [ring_starts, sector_starts, apertures, fractions] = arrays;
            JobTable {
                surface: self.surface.table.address(),
                ring_starts,
                sector_starts,
                apertures,
                fractions,
                counts,
                sums: counts + size_of::<[u64; COUNTS]>() as u64,
                ..self.rays.job(&self.layout, control)
            }
        })
    }
}
