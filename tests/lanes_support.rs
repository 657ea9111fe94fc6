//! Asking lane code on every instruction set of this machine.

use etalon::Instructions;
use glam::DVec3;

pub use etalon::inside::math::instructions::Precision;

pub const PRECISIONS: [Precision; 2] = Precision::ALL;

/// What comes of a question on every instruction set, the best first, with their names.
pub fn on_each<R>(ask: impl Fn(Instructions) -> R) -> Vec<(&'static str, R)> {
    let all = Instructions::all().into_iter();
    all.map(|set| (set.name(), ask(set))).collect()
}

/// Columns of numbers asked on every instruction set, which must agree in every bit.
pub fn everywhere<const O: usize>(ask: impl Fn(Instructions) -> [Vec<f64>; O]) -> [Vec<f64>; O] {
    let mut all = on_each(ask).into_iter();
    let Some((best, first)) = all.next() else {
        panic!("no instruction set for lanes on this machine");
    };
    for (name, other) in all {
        for (a, b) in first.iter().zip(&other) {
            assert_eq!(a.len(), b.len(), "{best}, {name}");
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                assert!(same_bits(*a, *b), "{best} {a:?}, {name} {b:?} at {i}");
            }
        }
    }
    first
}

/// Vectors as the columns of their coordinates.
pub fn axes(vectors: &[DVec3]) -> [Vec<f64>; 3] {
    [0, 1, 2].map(|axis| vectors.iter().map(|v| v[axis]).collect())
}

/// Whether both are the same bits; any NaN is as good as another.
pub fn same_bits(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}
