//! Host: the kernels as plain C++, compiled by the compiler of the system and run on the CPU.

#![allow(
    unsafe_code,
    reason = "functions of a shared library are called, whose arguments no compiler checks"
)]

use std::ops::Range;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use asperity_gpu::{Device, DeviceError, Job, Kernel, Memory, TABLE_SIZES};
use libloading::Library;

/// Entry point of a kernel: a job, the first path and the end of paths.
type EntryPoint = unsafe extern "C" fn(u64, u64, u64);

/// The kernels as a shared library.
#[derive(Clone)]
pub(crate) struct Host {
    kernels: [EntryPoint; Kernel::ALL.len()],
}

impl Host {
    /// The kernels as they are; `None`, after a line that says so, where there is no compiler.
    pub(crate) fn get() -> Option<Self> {
        static HOST: OnceLock<Option<Host>> = OnceLock::new();
        HOST.get_or_init(|| Self::with_change(None)).clone()
    }

    /// The kernels after a change of their source: a file, a text in it, and what takes its place.
    pub(crate) fn with_change(change: Option<[&str; 3]>) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let kernels = Path::new(env!("CARGO_MANIFEST_DIR")).join("kernels");
        for file in std::fs::read_dir(kernels).unwrap() {
            let file = file.unwrap();
            let mut text = std::fs::read_to_string(file.path()).unwrap();
            if let Some([name, from, to]) = change
                && file.file_name() == name
            {
                assert!(text.contains(from), "{name} has no `{from}`");
                text = text.replace(from, to);
            }
            std::fs::write(folder.path().join(file.file_name()), text).unwrap();
        }
        let library = compile(folder.path())?;
        // SAFETY: the library has no initialisers.
        let library = unsafe { Library::new(library) }.unwrap();
        // SAFETY: the function takes the address of three words.
        let sizes: libloading::Symbol<'_, unsafe extern "C" fn(u64)> =
            unsafe { library.get(b"table_sizes\0") }.unwrap();
        let found = HostMemory::zeros(TABLE_SIZES.len());
        // SAFETY: as above.
        unsafe { sizes(found.address()) };
        assert_eq!(found.read().unwrap(), TABLE_SIZES);
        let kernels = Kernel::ALL.map(|kernel| {
            // SAFETY: all kernels take three words.
            let symbol = unsafe { library.get::<EntryPoint>(kernel.name()) };
            *symbol.unwrap()
        });
        // It stays for as long as the tests run, as its functions do.
        std::mem::forget(library);
        Some(Self { kernels })
    }
}

/// Compiles the kernels in a folder to a shared library there.
fn compile(folder: &Path) -> Option<std::path::PathBuf> {
    let target = format!(
        "{}-unknown-{}-gnu",
        std::env::consts::ARCH,
        std::env::consts::OS
    );
    let mut build = cc::Build::new();
    build.cpp(true).opt_level(2).target(&target).host(&target);
    build.cargo_metadata(false).cargo_warnings(false);
    let compiler = build
        .try_get_compiler()
        .ok()
        .filter(|tool| tool.is_like_gnu() || tool.is_like_clang());
    let library = folder.join("kernels.so");
    let run = |compiler: cc::Tool| {
        Command::new(compiler.path())
            .args([
                "-x",
                "c++",
                "-std=c++17",
                "-O2",
                "-ffp-contract=off",
                "-shared",
                "-fPIC",
            ])
            .arg(folder.join("kernels.cu"))
            .arg("-o")
            .arg(&library)
            .output()
            .ok()
    };
    let Some(output) = compiler.and_then(run) else {
        println!("skipped: there is no C++ compiler here");
        return None;
    };
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{messages}");
    Some(library)
}

impl Device for Host {
    fn name(&self) -> String {
        "the kernels as plain C++".to_owned()
    }

    fn zeros(&self, words: usize) -> Result<Box<dyn Memory>, DeviceError> {
        Ok(Box::new(HostMemory::zeros(words)))
    }

    /// Some paths at a time, the last ones first: the order is of no consequence.
    fn run(&self, kernel: Kernel, job: Job, paths: Range<u64>) -> Result<(), DeviceError> {
        const PATHS: usize = 100;
        let first_of_parts: Vec<u64> = paths.clone().step_by(PATHS).collect();
        for first in first_of_parts.into_iter().rev() {
            let end = paths.end.min(first + PATHS as u64);
            // SAFETY: the engine gives the address of a job, whose memory lives until the call returns.
            unsafe { self.kernels[kernel as usize](job.address(), first, end) };
        }
        Ok(())
    }
}

/// Words of the heap, at least one.
pub(crate) struct HostMemory(Box<[AtomicU64]>);

impl HostMemory {
    pub(crate) fn zeros(words: usize) -> Self {
        Self((0..words.max(1)).map(|_| AtomicU64::new(0)).collect())
    }
}

impl Memory for HostMemory {
    fn address(&self) -> u64 {
        self.0.as_ptr() as u64
    }

    fn write(&mut self, words: &[u64]) -> Result<(), DeviceError> {
        for (into, word) in self.0.iter().zip(words) {
            into.store(*word, Relaxed);
        }
        Ok(())
    }

    fn read(&self) -> Result<Vec<u64>, DeviceError> {
        Ok(self.0.iter().map(|word| word.load(Relaxed)).collect())
    }
}
