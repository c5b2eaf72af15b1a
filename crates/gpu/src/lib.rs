//! A GPU engine: light paths on a device, with the bytes of [`asperity_tracer::CpuEngine`].
//!
//! [`GpuEngine`] implements the seam of `asperity-tracer`. One thread follows one path from its start to the end of all its branches. Its
//! kernels, CUDA C++ in `kernels/`, take only sums, products, quotients, square roots and integers, in the order in which the Rust engine
//! computes them, and add fluxes as integers. So results are equal to the last bit, counts of work included. What a device does not trace yet
//! is traced by the CPU engine, see [`GpuEngine`].
//!
//! | file | what |
//! |---|---|
//! | `engine`, `call` | the engine: which calls run on the device, and how one does |
//! | `device` | where kernels run, and its memory |
//! | `cuda` | an NVIDIA GPU, through its driver |
//! | `surface`, `job`, `tables` | what kernels read: a surface, and the rays, light, material and bins of a call |
//!
//! # Tested without a GPU
//! The kernels also compile as plain C++. The tests of this crate compile them with the system's compiler, run them on the CPU, and require the same sums as
//! the CPU engine.

mod call;
mod cuda;
mod device;
mod engine;
mod job;
mod surface;
mod tables;

pub use cuda::Cuda;
pub use device::{Device, DeviceError, Job, Kernel, Memory};
pub use engine::{GpuEngine, Usage};
pub use tables::{COUNTS, TABLE_SIZES};
