//! Engine: where a document has its light traced.

use std::sync::Arc;

use asperity_gpu::{Cuda, DeviceError, GpuEngine, Usage};
use asperity_tracer::{CpuEngine, Engine};
use serde_json::Value;

use crate::error::StudyError;
use crate::settings::Document;
use crate::shards::is_plan_only;

/// Groups of rays by each kernel that the CPU traces too, before a GPU is trusted.
const COMPARED: u64 = 2;

/// The engine of a run, which results do not depend on.
#[derive(Debug)]
pub enum ChosenEngine {
    /// The CPU alone; the reason, where a GPU was looked for.
    Cpu(Option<DeviceError>),
    /// A GPU, and the CPU for what it does not trace.
    Gpu(GpuEngine),
}

impl ChosenEngine {
    /// Opens the engine that a document chooses.
    ///
    /// # Errors
    /// [`StudyError::NoGpu`] if a GPU is requested and none is usable.
    pub fn open(document: &Document) -> Result<Self, StudyError> {
        let choice = document.value("results.engine");
        let choice = choice.as_ref().and_then(Value::as_str);
        // A plan is made on the CPU, where runs are prepared for other machines
        if is_plan_only(document) || !matches!(choice, Some("auto" | "gpu")) {
            return Ok(Self::Cpu(None));
        }
        match Cuda::open(0) {
            Ok(gpu) => Ok(Self::Gpu(GpuEngine::compared(gpu, COMPARED))),
            Err(error) if choice == Some("auto") => Ok(Self::Cpu(Some(error))),
            Err(error) => Err(StudyError::NoGpu(error)),
        }
    }

    /// The engine, for a container of results.
    #[must_use]
    pub fn engine(&self) -> Arc<dyn Engine> {
        match self {
            Self::Cpu(_) => Arc::new(CpuEngine),
            Self::Gpu(engine) => Arc::new(engine.clone()),
        }
    }

    /// Line that says where light was traced; `None` if nothing else than the CPU was requested.
    #[must_use]
    pub fn work(&self) -> Option<String> {
        match self {
            Self::Cpu(reason) => {
                let reason = reason.as_ref()?;
                Some(format!("engine: the CPU, since {reason}"))
            }
            Self::Gpu(engine) => {
                let Usage {
                    on_device, on_cpu, ..
                } = engine.usage();
                let gpu = engine.device_name();
                Some(format!(
                    "engine: {gpu} traced {on_device} groups of rays, the CPU {on_cpu}"
                ))
            }
        }
    }

    /// Note for the user on a GPU that failed, or traced nothing.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        let Self::Gpu(engine) = self else { return None };
        let gpu = engine.device_name();
        match engine.usage() {
            Usage {
                failure: Some(failure),
                ..
            } => Some(format!(
                "{gpu} failed, and the CPU traced the rest: {failure}"
            )),
            Usage {
                on_device: 0,
                on_cpu: 1..,
                ..
            } => Some(format!(
                "{gpu} traced nothing: it does not support such a run, has no memory for it, or the run is short"
            )),
            _ => None,
        }
    }
}

/// GPUs of this machine, a line each: the usable ones, and the reason why another is not.
#[must_use]
pub fn gpu_list() -> Vec<String> {
    let described = |ordinal| match Cuda::open(ordinal).and_then(|gpu| gpu.description()) {
        Ok(gpu) => format!("GPU {ordinal}: {gpu}, ready"),
        Err(error) => format!("GPU {ordinal}: not usable, {error}"),
    };
    match Cuda::count() {
        Ok(0) => vec!["GPU: none; the driver reports no GPU".to_owned()],
        Ok(count) => (0..count).map(described).collect(),
        Err(error) => vec![format!("GPU: none; {error}")],
    }
}
