//! CUDA: an NVIDIA GPU. Only the driver is needed; its library is loaded at run time.
#![allow(
    unsafe_code,
    reason = "kernels are launched, whose arguments no compiler checks; `run` says what they are"
)]

use std::ops::Range;
use std::sync::Arc;

use cudarc::driver::sys::CUdevice_attribute::CU_DEVICE_ATTRIBUTE_MULTIPROCESSOR_COUNT;
use cudarc::driver::{
    CudaContext, CudaFunction, CudaSlice, CudaStream, DevicePtr, DriverError, LaunchConfig,
    PushKernelArg, sys,
};
use cudarc::nvrtc::Ptx;

use crate::device::{Device, DeviceError, Job, Kernel, Memory};

/// The kernels in the language that the driver compiles; made by `kernels/compile.py`.
const PTX: &str = include_str!("../kernels/kernels.ptx");

/// Oldest release of CUDA whose drivers take that PTX, as the driver numbers it, and the oldest GPUs that it is for.
const CUDA: i32 = 12_010;
const COMPUTE_CAPABILITY: (i32, i32) = (7, 5);

/// Threads of a block, and blocks at a time per multiprocessor: those of `__launch_bounds__` in `kernels.cu`.
const THREADS: u32 = 128;
const BLOCKS: u32 = 4;

/// An NVIDIA GPU with these kernels. Each thread has a stream of its own, so that copies and kernels of several threads overlap, and waits without
/// keeping a processor busy.
pub struct Cuda {
    context: Arc<CudaContext>,
    /// In the order of [`Kernel::ALL`].
    functions: Vec<CudaFunction>,
    /// Blocks that run at a time; each takes paths until none is left.
    blocks: u32,
}

impl Cuda {
    /// GPU number `ordinal`. The driver compiles the kernels for it, which takes seconds the first time and is remembered.
    ///
    /// # Errors
    /// [`DeviceError`] if there is no driver or no such GPU, or one of them is too old.
    pub fn open(ordinal: usize) -> Result<Self, DeviceError> {
        let count = Self::count()?;
        if ordinal >= count {
            return Err(DeviceError::NoDevice { ordinal, count });
        }
        let context = CudaContext::new(ordinal).map_err(message)?;
        context.set_blocking_synchronize().map_err(message)?;
        let (major, minor) = context.compute_capability().map_err(message)?;
        if (major, minor) < COMPUTE_CAPABILITY {
            return Err(DeviceError::TooOld {
                what: format!("the GPU has compute capability {major}.{minor}"),
                needed: "7.5",
            });
        }
        let module = context.load_module(Ptx::from_src(PTX)).map_err(message)?;
        let functions = Kernel::ALL
            .iter()
            .map(|kernel| module.load_function(kernel.name()))
            .collect::<Result<_, _>>()
            .map_err(message)?;
        let multiprocessors = context.attribute(CU_DEVICE_ATTRIBUTE_MULTIPROCESSOR_COUNT);
        let multiprocessors = multiprocessors.map_err(message)?;
        Ok(Self {
            functions,
            blocks: BLOCKS * u32::try_from(multiprocessors).unwrap_or(1).max(1),
            context,
        })
    }

    /// Name, memory and compute capability.
    ///
    /// # Errors
    /// [`DeviceError`] of the driver.
    pub fn description(&self) -> Result<String, DeviceError> {
        let memory = self.context.total_mem().map_err(message)? as f64 / f64::from(1 << 30);
        let (major, minor) = self.context.compute_capability().map_err(message)?;
        let name = self.name();
        Ok(format!(
            "{name}, {memory:.0} GiB, compute capability {major}.{minor}"
        ))
    }

    /// Number of GPUs that the driver reports.
    ///
    /// # Errors
    /// [`DeviceError`] if there is no driver, it is too old, or reports an error.
    pub fn count() -> Result<usize, DeviceError> {
        // SAFETY: it looks for a library and calls nothing in it but its initialisers.
        if !unsafe { sys::is_culib_present() } {
            return Err(DeviceError::NoDriver);
        }
        let mut release = 0;
        // SAFETY: it writes a number there.
        let answer = unsafe { sys::cuDriverGetVersion(&raw mut release) };
        answer.result().map_err(message)?;
        if release < CUDA {
            let (major, minor) = (release / 1000, release % 1000 / 10);
            return Err(DeviceError::TooOld {
                what: format!("the GPU driver supports CUDA {major}.{minor}"),
                needed: "12.1",
            });
        }
        let count = CudaContext::device_count().map_err(message)?;
        Ok(usize::try_from(count).unwrap_or(0))
    }
}

impl Device for Cuda {
    fn name(&self) -> String {
        self.context
            .name()
            .unwrap_or_else(|_| "a CUDA device".to_owned())
    }

    fn zeros(&self, words: usize) -> Result<Box<dyn Memory>, DeviceError> {
        let stream = self.context.per_thread_stream();
        // CUDA refuses allocations of no bytes
        let slice = stream.alloc_zeros(words.max(1)).map_err(message)?;
        Ok(Box::new(Words { slice, stream }))
    }

    fn run(&self, kernel: Kernel, job: Job, paths: Range<u64>) -> Result<(), DeviceError> {
        let job = job.address();
        let blocks = (paths.end - paths.start).div_ceil(THREADS.into());
        let config = LaunchConfig {
            grid_dim: (
                self.blocks.min(u32::try_from(blocks).unwrap_or(u32::MAX)),
                1,
                1,
            ),
            block_dim: (THREADS, 1, 1),
            shared_mem_bytes: 0,
        };
        let stream = self.context.per_thread_stream();
        let mut launch = stream.launch_builder(&self.functions[kernel as usize]);
        launch.arg(&job).arg(&paths.start).arg(&paths.end);
        // SAFETY: kernels take the address of a job and two numbers. The engine made the job, and keeps its memory until this returns.
        unsafe { launch.launch(config) }.map_err(message)?;
        stream.synchronize().map_err(message)
    }
}

/// Words in the memory of a GPU.
struct Words {
    slice: CudaSlice<u64>,
    /// Stream of the calling thread.
    stream: Arc<CudaStream>,
}

impl Memory for Words {
    fn address(&self) -> u64 {
        self.slice.device_ptr(&self.stream).0
    }

    fn write(&mut self, words: &[u64]) -> Result<(), DeviceError> {
        self.stream
            .memcpy_htod(words, &mut self.slice)
            .map_err(message)?;
        // Copies need not be done when they return
        self.stream.synchronize().map_err(message)
    }

    fn read(&self) -> Result<Vec<u64>, DeviceError> {
        let words = self.stream.clone_dtoh(&self.slice).map_err(message)?;
        self.stream.synchronize().map_err(message)?;
        Ok(words)
    }
}

impl Drop for Words {
    /// Binds the context: memory is freed by whatever thread drops it last, which need not have called the driver before.
    fn drop(&mut self) {
        let context = self.slice.context();
        context.record_err(context.bind_to_thread());
    }
}

/// An error of the driver, with its own message.
fn message(error: DriverError) -> DeviceError {
    if error.0 == sys::CUresult::CUDA_ERROR_OUT_OF_MEMORY {
        return DeviceError::OutOfMemory;
    }
    let words = error
        .error_string()
        .map(|text| text.to_string_lossy().into_owned());
    DeviceError::Driver(words.unwrap_or_else(|_| format!("{error:?}")))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail as their helpers do")]

    use asperity_numerics::fnv1a;

    use super::*;

    #[test]
    fn a_missing_driver_or_device_is_said_in_a_sentence() {
        let Err(error) = Cuda::open(1000) else {
            return;
        };
        assert!(
            matches!(
                error,
                DeviceError::NoDriver
                    | DeviceError::TooOld { .. }
                    | DeviceError::NoDevice { ordinal: 1000, .. }
            ),
            "{error}"
        );
    }

    #[test]
    fn kernels_are_those_of_their_sources() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("kernels");
        let files = std::fs::read_dir(&folder)
            .unwrap()
            .map(|file| file.unwrap().path());
        let mut files: Vec<_> = files
            .filter(|file| file.extension().is_some_and(|of| of == "h"))
            .collect();
        files.sort();
        files.push(folder.join("kernels.cu"));
        let sources = files.iter().flat_map(|file| std::fs::read(file).unwrap());
        let expected = format!("// Sources: {:016x}", fnv1a(sources));
        assert_eq!(
            PTX.lines().next(),
            Some(&*expected),
            "run kernels/compile.py"
        );
    }

    #[test]
    fn kernels_have_their_names_and_no_fused_operations() {
        for kernel in Kernel::ALL {
            assert!(PTX.contains(&format!(".visible .entry {}(", kernel.name())));
        }
        // Without a rounding mode sums and products may be fused
        for fused in ["fma.", "mad.f", "add.f64", "sub.f64", "mul.f64"] {
            assert!(!PTX.contains(fused), "{fused}: run kernels/compile.py");
        }
    }
}
