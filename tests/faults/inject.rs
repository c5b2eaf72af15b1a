//! Faults of a run: signals, a full disk, and a limit of memory.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// What happens to a run.
pub(crate) enum Fault {
    /// Nothing.
    None,
    /// A signal, after a time.
    Signal(&'static str, Duration),
    /// A disk of so many bytes.
    Disk(u64),
    /// Address space of so many KiB.
    Memory(u64),
}

/// The end of a run.
pub(crate) struct Ended {
    /// Exit code; `None` of a process that a signal ended.
    pub(crate) code: Option<i32>,
    /// Standard error.
    pub(crate) said: String,
}

impl Ended {
    pub(crate) fn is_complete(&self) -> bool {
        self.code == Some(0)
    }
}

impl Fault {
    /// Returns `true` if the process may have no chance to remove its temporary files: reading a folder takes memory too.
    pub(crate) fn may_leave_temporary_files(&self) -> bool {
        matches!(self, Self::Signal("SIGKILL", _) | Self::Memory(_))
    }

    /// Returns `true` if a run may end so: 1 with a reason, 3 with the results so far, 130 without, and by the signal before that is handled.
    pub(crate) fn allows(&self, code: Option<i32>, said: &str) -> bool {
        let is_said = !said.contains("panicked") && !said.is_empty();
        match (self, code) {
            (_, Some(0)) => true,
            (Self::Signal("SIGKILL", _), None) => true,
            (Self::Signal(..), None) => said.is_empty(),
            (Self::Signal(..), Some(1 | 3)) => is_said,
            (Self::Signal(..), Some(130)) => !said.contains("panicked"),
            (Self::Disk(_) | Self::Memory(_), Some(1)) => is_said && said.lines().count() == 1,
            _ => false,
        }
    }
}

/// The program with the arguments of a line, in a folder.
pub(crate) fn program(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_asperity"));
    command.current_dir(folder).args(line.split_whitespace());
    command.arg("--quiet").env_remove("RUST_BACKTRACE");
    command
}

/// Runs a line into the folder `out` with a fault, on two threads.
pub(crate) fn run_with(folder: &Path, line: &str, out: &str, fault: &Fault) -> Ended {
    let line = format!("{line} --threads 2 -o {out}");
    let mut command = match fault {
        Fault::Memory(limit) => {
            let asperity = env!("CARGO_BIN_EXE_asperity");
            let script = format!("ulimit -v {limit}; exec {asperity} {line} --quiet");
            let mut shell = Command::new("bash");
            shell.current_dir(folder).args(["-c", &script]);
            shell.env_remove("RUST_BACKTRACE");
            shell
        }
        _ => program(folder, &line),
    };
    let command = command.stdout(Stdio::null()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    if let Fault::Signal(signal, after) = fault {
        sleep(*after);
        // One that has ended is a zombie until it is waited for, which takes signals too.
        let id = child.id().to_string();
        let sent = Command::new("kill")
            .args(["-s", &signal[3..], &id])
            .status();
        assert!(sent.unwrap().success());
    }
    let output = child.wait_with_output().unwrap();
    Ended {
        code: output.status.code(),
        said: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// A small disk in memory, mounted at `place` in a folder until it is dropped.
pub(crate) struct SmallDisk(PathBuf);

impl SmallDisk {
    /// The disk of a fault that has one; `None` where it cannot be mounted.
    pub(crate) fn of(fault: &Fault, folder: &Path) -> Option<Self> {
        let Fault::Disk(bytes) = fault else {
            return None;
        };
        let place = folder.join("place");
        fs::create_dir_all(&place).unwrap();
        // A page for the user's own file
        let size = format!("size={}", bytes + 4096);
        let mut mount = Command::new("mount");
        mount
            .args(["-t", "tmpfs", "-o", &size, "tmpfs"])
            .arg(&place);
        let is_mounted = mount
            .stderr(Stdio::null())
            .status()
            .is_ok_and(|status| status.success());
        is_mounted.then_some(Self(place))
    }

    /// Makes room.
    pub(crate) fn grow(&self) {
        let mut mount = Command::new("mount");
        mount.args(["-o", "remount,size=256m"]).arg(&self.0);
        assert!(mount.status().unwrap().success());
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}
