//! How much memory there is.

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
