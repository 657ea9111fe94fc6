//! The memory that is available, and pictures that need more.

/// A picture that does not fit into memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the picture needs about {} MiB of memory, and {} MiB are available",
    needed >> 20, available >> 20
)]
pub struct TooLarge {
    /// Bytes that the picture needs.
    pub needed: u64,
    /// Bytes that the system can give.
    pub available: u64,
}

/// Bytes available without swapping, as Linux estimates them; on other systems 4 GiB, which any
/// machine has.
pub fn available() -> u64 {
    of_linux().unwrap_or(1 << 32)
}

fn of_linux() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
