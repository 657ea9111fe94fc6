//! Seeds of further renders of a scene: each its own, and the same again when it is repeated.

use sha2::{Digest, Sha256};

/// The seed of one render: 63 bits of the SHA-256 of everything that names it. Two renders share
/// their random numbers with probability 2⁻⁶³.
pub fn seed(base: u64, what: &str, replicate: u32) -> u64 {
    let digest = Sha256::digest(format!("{base}\n{what}\n{replicate}").as_bytes());
    let bytes = digest.iter().take(8);
    bytes.fold(0, |seed, byte| (seed << 8) | u64::from(*byte)) >> 1
}
