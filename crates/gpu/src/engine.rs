//! Engine: traces on a device what kernels support, and hands the rest to the CPU engine.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};

use asperity_tally::{ControlVariate, Tallies, TallySpec};
use asperity_tracer::{
    AcceleratorKind, BatchTracer, BatchedRays, BuildError, CpuEngine, Engine, Illumination,
    PathStream, PreparedSurface, Shape, TracedLayerError, TracedPaths, Work,
};

use crate::call::{Call, CallEnd};
use crate::device::{Device, DeviceError, Kernel};
use crate::job::{Case, Rays};
use crate::surface::SurfaceOnDevice;

/// An engine on a device, with the bytes of [`CpuEngine`].
///
/// It traces height fields of any border, as triangles or smooth; dielectrics, conductors, mirrors and Lambertian facets; any polarisation, with
/// Mueller matrices; stratified starts from above and on the surface, with and without a control variate; bins of any edges, rings, in-plane
/// slices, orders, event paths and apertures. Everything else is traced by [`CpuEngine`], as is what the device has no memory for, and every call
/// after another error of it: see [`GpuEngine::usage`].
///
/// # Examples
/// ```no_run
/// use std::sync::Arc;
///
/// use asperity_gpu::{Cuda, GpuEngine};
/// use asperity_simulate::{Case, Settings, Silent, Simulation};
///
/// # fn traced(cases: &[Case], settings: &Settings) -> Result<(), Box<dyn std::error::Error>> {
/// let engine = GpuEngine::new(Cuda::open(0)?); // the first GPU
/// let simulation = Simulation::new(cases, settings)?.on(Arc::new(engine.clone()));
/// let outcomes = simulation.run(&Silent)?;
/// println!("{:?}", engine.usage());
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct GpuEngine {
    shared: Arc<Shared>,
}

/// State that the surfaces of an engine share.
struct Shared {
    device: Box<dyn Device>,
    /// Number of calls of each kernel that both engines trace, with equal results, before it is trusted.
    compared: u64,
    /// Calls of each kernel whose results were equal.
    equal: [AtomicU64; Kernel::ALL.len()],
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
    /// An engine on a device that is trusted.
    #[must_use]
    pub fn new(device: impl Device + 'static) -> Self {
        Self::compared(device, 0)
    }

    /// An engine on a device of which each kernel is trusted after `calls` calls whose results are those of the CPU engine. Calls before, and after one with
    /// other results, have the results of the CPU engine.
    #[must_use]
    pub fn compared(device: impl Device + 'static, calls: u64) -> Self {
        Self {
            shared: Arc::new(Shared {
                device: Box::new(device),
                compared: calls,
                equal: Default::default(),
                on_device: AtomicU64::new(0),
                on_cpu: AtomicU64::new(0),
                failure: Mutex::new(None),
            }),
        }
    }

    /// Name of the device.
    #[must_use]
    pub fn device_name(&self) -> String {
        self.shared.device.name()
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

impl fmt::Debug for GpuEngine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "GpuEngine({:?})", self.usage())
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
            surface: self.shared.surface(shape),
            shape: shape.clone(),
            shared: self.shared.clone(),
        }))
    }
}

/// A surface on the CPU and on the device.
struct OnGpu {
    cpu: Box<dyn PreparedSurface>,
    /// `None` if kernels do not search it, the device has no room for it, or has failed.
    surface: Option<SurfaceOnDevice>,
    shape: Shape,
    shared: Arc<Shared>,
}

impl Shared {
    /// Copies a surface to the device. Not when it is first needed: threads that wait for each other then may be one, since its bounds are computed by many.
    fn surface(&self, shape: &Shape) -> Option<SurfaceOnDevice> {
        if self.has_failed() {
            return None;
        }
        SurfaceOnDevice::new(&*self.device, shape).unwrap_or_else(|error| {
            self.fail(error);
            None
        })
    }

    /// Records the first error of the device. A lack of memory is none: smaller calls may have room.
    fn fail(&self, error: DeviceError) {
        if error == DeviceError::OutOfMemory {
            return;
        }
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        failure.get_or_insert(error);
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
        let cases = materials.iter().map(|&material| Case {
            material,
            incident,
            settings,
        });
        let is_supported = layers.is_empty() && cases.clone().all(|case| case.is_supported());
        Ok(Box::new(GpuTracer {
            cpu: self.cpu.tracer(case)?,
            surface: self,
            cases: if is_supported {
                cases.collect()
            } else {
                Vec::new()
            },
        }))
    }
}

/// The tracer of a case, or of cases that differ in a conductor.
struct GpuTracer<'a> {
    cpu: Box<dyn BatchTracer + 'a>,
    surface: &'a OnGpu,
    /// One for each material; empty if kernels do not trace them.
    cases: Vec<Case>,
}

/// Reason for which a call has no result of the device.
enum NotTraced {
    /// It was given up.
    GivenUp,
    /// The CPU engine traces it: kernels do not support it, the device has no room for it, or has failed.
    HandedOver,
}

impl GpuTracer<'_> {
    /// Traces rays of one material on the device.
    fn on_device<'c>(
        &self,
        rays: &Rays<'_>,
        spec: TallySpec,
        control: Option<&'c ControlVariate>,
        gives_up: &dyn Fn() -> bool,
    ) -> Result<(Tallies<'c>, Work), NotTraced> {
        let shared = &self.surface.shared;
        if !rays.are_supported() || shared.has_failed() {
            return Err(NotTraced::HandedOver);
        }
        let mut tallies = rays.tallies(spec, control);
        let layout = tallies.layout().ok_or(NotTraced::HandedOver)?;
        let surface = self.surface.surface.as_ref();
        let surface = surface.ok_or(NotTraced::HandedOver)?;
        let call = Call {
            device: &*shared.device,
            surface,
            rays,
            layout,
        };
        match call.trace(&mut tallies, gives_up) {
            Ok(CallEnd::Whole(work)) => Ok((tallies, work)),
            Ok(CallEnd::GivenUp) => Err(NotTraced::GivenUp),
            Ok(CallEnd::LeftToCpu) => Err(NotTraced::HandedOver),
            Err(error) => {
                shared.fail(error);
                Err(NotTraced::HandedOver)
            }
        }
    }
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
        // Several conductors one by one, which have the bytes of all together
        let each = self.cases.iter().zip(controls).map(|(case, control)| {
            let rays = Rays {
                case: *case,
                shape: &self.surface.shape,
                illumination,
                rays,
                stream,
            };
            self.on_device(&rays, spec, *control, gives_up)
        });
        let shared = &self.surface.shared;
        let on_cpu = || {
            self.cpu
                .batches(illumination, rays, spec, controls, stream, gives_up)
        };
        let found = each.collect::<Result<Vec<_>, _>>();
        match (found, &self.surface.surface) {
            (Err(NotTraced::GivenUp), _) => None,
            (Ok(found), Some(surface)) if !found.is_empty() => {
                let kernel = surface.kernel(self.cases[0].settings);
                let equal = &shared.equal[kernel as usize];
                if equal.load(Relaxed) >= shared.compared {
                    shared.on_device.fetch_add(1, Relaxed);
                    return Some(found);
                }
                let expected = on_cpu()?;
                if are_equal(&found, &expected) {
                    equal.fetch_add(1, Relaxed);
                } else {
                    shared.fail(DeviceError::Differs);
                }
                shared.on_cpu.fetch_add(1, Relaxed);
                Some(expected)
            }
            _ => {
                shared.on_cpu.fetch_add(1, Relaxed);
                on_cpu()
            }
        }
    }
}

/// Returns `true` if all sums and counts are equal.
fn are_equal(one: &[(Tallies<'_>, Work)], other: &[(Tallies<'_>, Work)]) -> bool {
    let numbers = |all: &[(Tallies<'_>, Work)]| {
        let each = all
            .iter()
            .map(|(tallies, work)| (tallies.sums().to_vec(), *work));
        each.collect::<Vec<_>>()
    };
    numbers(one) == numbers(other)
}
