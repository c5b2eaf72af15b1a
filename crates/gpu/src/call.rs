//! Call: traces the rays of one call on a device.

use asperity_tally::{Tallies, TallyLayout, VisibleFractions};
use asperity_tracer::Work;

use crate::device::{Device, DeviceError, Job};
use crate::job::{Rays, aperture};
use crate::surface::SurfaceOnDevice;
use crate::tables::COUNTS;

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
        let mut kept = Vec::new();
        let mut upload = |words: &[u64]| -> Result<u64, DeviceError> {
            let memory = device.upload(words)?;
            let address = memory.address();
            kept.push(memory);
            Ok(address)
        };
        let sums = device.zeros(2 * tallies.sums().len())?;
        let counts = device.zeros(COUNTS)?;
        let mut job = self.rays.job(&self.layout, tallies.control_variate());
        if let Some([reflected, transmitted]) = &self.layout.edges {
            let rings = [&*reflected.rings, &transmitted.rings].concat();
            let sectors = [&*reflected.sectors, &transmitted.sectors].concat();
            job.ring_starts = upload(bytemuck::cast_slice(&rings))?;
            job.sector_starts = upload(bytemuck::cast_slice(&sectors))?;
        }
        let apertures: Vec<_> = self.layout.apertures.iter().map(aperture).collect();
        job.apertures = upload(bytemuck::cast_slice(&apertures))?;
        if let Some(control) = tallies.control_variate() {
            let VisibleFractions { rings, .. } = control.fractions();
            job.fractions = upload(bytemuck::cast_slice(&rings.concat()))?;
        }
        job.surface = self.surface.table.address();
        (job.sums, job.counts) = (sums.address(), counts.address());
        let job = Job(upload(bytemuck::cast_slice(&[job]))?);
        let count = self.rays.count();
        for first in (0..count).step_by(PATHS_OF_RUN as usize) {
            if gives_up() {
                return Ok(CallEnd::GivenUp);
            }
            let paths = first..count.min(first + PATHS_OF_RUN);
            device.run(self.surface.kernel, job, paths)?;
        }
        let counts = counts.read()?;
        let &[
            segments,
            segments_skipped,
            segments_skipped_nearby,
            branches_not_recorded,
            left_to_cpu,
        ] = counts.as_slice()
        else {
            return Err(DeviceError::Driver(format!(
                "{} counts of work",
                counts.len()
            )));
        };
        if left_to_cpu > 0 {
            return Ok(CallEnd::LeftToCpu);
        }
        let sums = sums.read()?;
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
}
