//! How much memory there is, and a picture that takes more.

/// A picture that does not fit into memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the picture needs about {} MiB of memory, and {} MiB are available",
    needed >> 20, available >> 20
)]
pub struct TooLarge {
    /// Bytes of the render.
    pub needed: u64,
    /// Bytes of the machine.
    pub available: u64,
}

/// Assumed where the system does not tell how much there is: what any machine has.
const UNKNOWN: u64 = 1 << 32;

/// Bytes that can be had without swapping, as Linux estimates them; what any machine has
/// elsewhere.
pub fn available() -> u64 {
    of_linux().unwrap_or(UNKNOWN)
}

fn of_linux() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
