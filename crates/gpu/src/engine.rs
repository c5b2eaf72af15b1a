//! Engine: traces on a device what kernels support, and hands the rest to the CPU engine.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use asperity_tally::{ControlVariate, Tallies, TallyLayout, TallySpec, VisibleFractions};
use asperity_tracer::{
    AcceleratorKind, BatchTracer, BatchedRays, BuildError, CpuEngine, Engine, Illumination,
    PathStream, PreparedSurface, Shape, TracedLayerError, TracedPaths, Work,
};

use crate::device::{Device, DeviceError};
use crate::job::{Case, Rays, aperture};
use crate::surface::SurfaceOnDevice;
use crate::tables::COUNTS;

/// Paths of one run of a kernel, after which a call may be given up: some tenths of a second at most.
const PATHS_OF_RUN: u64 = 1 << 22;

/// An engine on a device, with the bytes of [`CpuEngine`].
///
/// It traces periodic height fields, as triangles or smooth; dielectrics, conductors and mirrors; averaged and tracked polarisation; stratified
/// starts from above and on the surface, with and without a control variate; bins of any edges, rings, in-plane slices, orders, event paths
/// and apertures. Everything else is traced by [`CpuEngine`], as is every call after an error of the device: see [`GpuEngine::usage`].
#[derive(Clone)]
pub struct GpuEngine {
    shared: Arc<Shared>,
}

/// What the surfaces of an engine share.
struct Shared {
    device: Box<dyn Device>,
    on_device: AtomicU64,
    on_cpu: AtomicU64,
    failure: Mutex<Option<DeviceError>>,
}

/// Calls of [`BatchTracer::batches`] by where they were traced.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Usage {
    /// Calls traced on the device.
    pub on_device: u64,
    /// Calls handed to the CPU engine.
    pub on_cpu: u64,
    /// The error after which all calls are.
    pub failure: Option<DeviceError>,
}

impl GpuEngine {
    /// An engine on a device.
    #[must_use]
    pub fn new(device: impl Device + 'static) -> Self {
        Self {
            shared: Arc::new(Shared {
                device: Box::new(device),
                on_device: AtomicU64::new(0),
                on_cpu: AtomicU64::new(0),
                failure: Mutex::new(None),
            }),
        }
    }

    /// Use of the device so far.
    #[must_use]
    pub fn usage(&self) -> Usage {
        let Shared {
            on_device,
            on_cpu,
            failure,
            ..
        } = &*self.shared;
        Usage {
            on_device: on_device.load(Relaxed),
            on_cpu: on_cpu.load(Relaxed),
            failure: failure
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .clone(),
        }
    }
}

impl Engine for GpuEngine {
    fn prepare(
        &self,
        shape: &Shape,
        accelerator: AcceleratorKind,
    ) -> Result<Box<dyn PreparedSurface>, BuildError> {
        Ok(Box::new(OnGpu {
            cpu: CpuEngine.prepare(shape, accelerator)?,
            shape: shape.clone(),
            shared: self.shared.clone(),
            surface: OnceLock::new(),
        }))
    }
}

/// A surface on the CPU, and on the device once it is traced there.
struct OnGpu {
    cpu: Box<dyn PreparedSurface>,
    shape: Shape,
    shared: Arc<Shared>,
    surface: OnceLock<Option<SurfaceOnDevice>>,
}

impl OnGpu {
    /// The surface on the device; `None` if kernels do not search it, or the device has failed.
    fn surface(&self) -> Option<&SurfaceOnDevice> {
        let copied = || {
            let found = SurfaceOnDevice::new(&*self.shared.device, &self.shape);
            found.unwrap_or_else(|error| self.shared.fail(error))
        };
        self.surface.get_or_init(copied).as_ref()
    }
}

impl Shared {
    /// Notes the first error of the device.
    fn fail<T>(&self, error: DeviceError) -> Option<T> {
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        failure.get_or_insert(error);
        None
    }

    fn has_failed(&self) -> bool {
        self.failure
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .is_some()
    }
}

impl PreparedSurface for OnGpu {
    fn accelerator(&self) -> AcceleratorKind {
        self.cpu.accelerator()
    }

    fn instructions(&self) -> Option<String> {
        self.cpu.instructions()
    }

    fn tracer(
        &self,
        case: &TracedPaths<'_>,
    ) -> Result<Box<dyn BatchTracer + '_>, TracedLayerError> {
        let TracedPaths {
            materials,
            incident,
            settings,
            layers,
            ..
        } = *case;
        let of_device = match materials {
            &[material] if layers.is_empty() => Some(Case {
                material,
                incident,
                settings,
            }),
            _ => None,
        };
        Ok(Box::new(GpuTracer {
            cpu: self.cpu.tracer(case)?,
            surface: self,
            case: of_device.filter(Case::is_supported),
        }))
    }
}

/// The tracer of a case.
struct GpuTracer<'a> {
    cpu: Box<dyn BatchTracer + 'a>,
    surface: &'a OnGpu,
    /// `None` if kernels do not trace it.
    case: Option<Case>,
}

impl BatchTracer for GpuTracer<'_> {
    fn batches<'c>(
        &self,
        illumination: &Illumination,
        rays: &BatchedRays,
        spec: TallySpec,
        controls: &[Option<&'c ControlVariate>],
        stream: PathStream,
        gives_up: &dyn Fn() -> bool,
    ) -> Option<Vec<(Tallies<'c>, Work)>> {
        let shared = &self.surface.shared;
        if let Some(case) = self.case
            && let &[control] = controls
            && let rays = (Rays {
                case,
                shape: &self.surface.shape,
                illumination,
                rays,
                stream,
            })
            && rays.are_supported()
            && !shared.has_failed()
            && let mut tallies = rays.tallies(spec, control)
            && let Some(layout) = tallies.layout()
            && let Some(surface) = self.surface.surface()
        {
            let call = Call {
                shared,
                surface,
                rays,
                layout,
            };
            match call.trace(&mut tallies, gives_up) {
                Ok(Traced::Whole(work)) => {
                    shared.on_device.fetch_add(1, Relaxed);
                    return Some(vec![(tallies, work)]);
                }
                Ok(Traced::GivenUp) => return None,
                Ok(Traced::WithoutRoom) => {}
                Err(error) => shared.fail(error).unwrap_or_default(),
            }
        }
        shared.on_cpu.fetch_add(1, Relaxed);
        self.cpu
            .batches(illumination, rays, spec, controls, stream, gives_up)
    }
}

/// A call that is traced on the device.
struct Call<'a> {
    shared: &'a Shared,
    surface: &'a SurfaceOnDevice,
    rays: Rays<'a>,
    layout: TallyLayout,
}

/// End of a call.
enum Traced {
    Whole(Work),
    GivenUp,
    /// Some path split so often that a branch had no room to wait.
    WithoutRoom,
}

impl Call<'_> {
    fn trace(
        &self,
        tallies: &mut Tallies<'_>,
        gives_up: &dyn Fn() -> bool,
    ) -> Result<Traced, DeviceError> {
        let device = &*self.shared.device;
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
        let job = upload(bytemuck::cast_slice(&[job]))?;
        let count = self.rays.count();
        for first in (0..count).step_by(PATHS_OF_RUN as usize) {
            if gives_up() {
                return Ok(Traced::GivenUp);
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
            without_room,
        ] = counts.as_slice()
        else {
            return Err(DeviceError::Driver(format!(
                "{} counts of work",
                counts.len()
            )));
        };
        if without_room > 0 {
            return Ok(Traced::WithoutRoom);
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
        Ok(Traced::Whole(work))
    }
}
