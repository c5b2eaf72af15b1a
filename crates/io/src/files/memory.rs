//! Memory that the machine and the limits of this process leave.

use std::fs;

/// Limits of a process on its memory, with the line of its status that says how much of it is in use.
const LIMITS: [(&str, &str); 2] = [
    ("Max address space", "VmSize:"),
    ("Max data size", "VmData:"),
];

/// Bytes of memory that can be taken without swapping and within the limits of this process, where the operating system says (Linux).
///
/// Systems that grant more memory than they have kill a program that uses it, and limits end it. Checking first lets the
/// program refuse with a message instead.
#[must_use]
pub fn available_memory() -> Option<u64> {
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
    let (limits, status) = (read("/proc/self/limits"), read("/proc/self/status"));
    let left = LIMITS.map(|(limit, used)| {
        let used = kibibytes(&status, used).unwrap_or(0);
        Some(soft_limit(&limits, limit)?.saturating_sub(used))
    });
    let available = kibibytes(&read("/proc/meminfo"), "MemAvailable:");
    left.into_iter().chain([available]).flatten().min()
}

/// Bytes on the line that begins with `name`, in text of the kernel.
fn kibibytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// Soft limit in bytes on the line that begins with `name`; `None` if it is unlimited.
fn soft_limit(limits: &str, name: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_the_lines_of_the_kernel() {
        let text = "MemTotal:       24000000 kB\nMemAvailable:   20000000 kB\n";
        let available = |text| kibibytes(text, "MemAvailable:");
        assert_eq!(available(text), Some(20_480_000_000));
        assert_eq!(available("MemTotal: 5 kB\n"), None);
        assert_eq!(available("MemAvailable: many kB\n"), None);
        let limits = "Limit                     Soft Limit           Hard Limit           Units     \n\
            Max data size             unlimited            unlimited            bytes     \n\
            Max address space         102400000            unlimited            bytes     \n";
        assert_eq!(soft_limit(limits, "Max address space"), Some(102_400_000));
        assert_eq!(soft_limit(limits, "Max data size"), None);
    }
}
