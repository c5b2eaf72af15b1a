//! Device: where kernels run, and its memory.

use std::ops::Range;

/// Reason for which a device does not do its work.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// There is no driver.
    #[error("no CUDA driver is installed")]
    NoDriver,
    /// The driver knows no such GPU.
    #[error("there is no GPU number {ordinal}; the driver reports {count}")]
    NoDevice {
        /// Number of the requested GPU, from 0.
        ordinal: usize,
        /// Number of GPUs on this machine.
        count: usize,
    },
    /// The driver or the GPU is too old.
    #[error("{what}, but the kernels need {needed} or later")]
    TooOld {
        /// Subject of the message, with its version.
        what: String,
        /// Oldest release that serves.
        needed: &'static str,
    },
    /// The first results of the device are not those of the CPU engine.
    #[error("the GPU computes other results than the CPU")]
    Differs,
    /// There is not enough memory for a surface or a call.
    #[error("the GPU has not enough free memory")]
    OutOfMemory,
    /// The driver reports another error.
    #[error("the GPU driver reports: {0}")]
    Driver(String),
}

/// Entry point of the kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// Paths over triangles.
    Facets,
    /// Paths over cells of a spline.
    Smooth,
    /// Paths over triangles whose exits have measures of polarised light.
    MeasuredFacets,
    /// Such paths over cells of a spline.
    MeasuredSmooth,
}

impl Kernel {
    /// All kernels.
    pub const ALL: [Self; 4] = [
        Self::Facets,
        Self::Smooth,
        Self::MeasuredFacets,
        Self::MeasuredSmooth,
    ];

    /// Name of the function, whose arguments are the address of a job, the first path and the end of paths.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Facets => "trace_facets",
            Self::Smooth => "trace_smooth",
            Self::MeasuredFacets => "measure_facets",
            Self::MeasuredSmooth => "measure_smooth",
        }
    }
}

/// Address of a job in the memory of a device, which a [`GpuEngine`](crate::GpuEngine) makes and keeps until [`Device::run`] returns.
#[derive(Clone, Copy, Debug)]
pub struct Job(pub(crate) u64);

impl Job {
    /// Address that kernels use.
    #[must_use]
    pub const fn address(self) -> u64 {
        self.0
    }
}

/// A device that runs kernels. Called from any thread.
pub trait Device: Send + Sync {
    /// Name for messages.
    fn name(&self) -> String;

    /// Allocates `words` words of zero. Other threads may use them only after this one has written to them.
    ///
    /// # Errors
    /// [`DeviceError`], for instance if there is not enough memory.
    fn zeros(&self, words: usize) -> Result<Box<dyn Memory>, DeviceError>;

    /// Runs a kernel over some paths of a job, and waits for its end.
    ///
    /// # Errors
    /// [`DeviceError`] if it fails.
    fn run(&self, kernel: Kernel, job: Job, paths: Range<u64>) -> Result<(), DeviceError>;
}

/// Words in the memory of a device, freed when dropped.
pub trait Memory: Send + Sync {
    /// Address that kernels use.
    fn address(&self) -> u64;

    /// Copies `words` to its beginning.
    ///
    /// # Errors
    /// [`DeviceError`] if the device is lost.
    fn write(&mut self, words: &[u64]) -> Result<(), DeviceError>;

    /// Copies the words back.
    ///
    /// # Errors
    /// [`DeviceError`] if the device is lost.
    fn read(&self) -> Result<Vec<u64>, DeviceError>;
}
