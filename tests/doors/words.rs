//! Integers in lanes.

use etalon_lanes::math::instructions::{Instructions, Job, Precision};
use etalon_lanes::math::lanes::{Int, Lanes, Mask, Scalar, WIDEST};
use etalon_lanes::math::packet::{array, int_array};

use crate::columns::{jobs, widen};

/// What operations make of words a and b.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Results {
    /// a + b, a − b, a · b, a << 7, a >> 9, a ^ b, a & b, a | b, a reversed.
    pub words: [Vec<u32>; 9],
    /// a >> 8 made a real and truncated again.
    pub truncated: Vec<u32>,
    /// a >> 8 as a real.
    pub reals: Vec<f64>,
    /// a as a uniform variate.
    pub uniform: Vec<f64>,
    /// Whether a < b.
    pub below: Vec<bool>,
    /// Whether the words of each packet equal themselves, and no lane is true beyond the packet.
    pub same: Vec<bool>,
}

jobs! {
    /// All operations, on as many words as fill packets of any width.
    ///
    /// # Panics
    /// If the number of words is no multiple of [`WIDEST`].
    operations<'a>(l: L, a: &'a [u32], b: &'a [u32]) -> Results {
        assert!(a.len() == b.len() && a.len().is_multiple_of(WIDEST));
        let mut results = Results::default();
        for from in (0..a.len()).step_by(L::COUNT) {
            let [a, b] = [a, b].map(|words| l.load_int(&words[from..]));
            let words = [
                a.plus(b),
                a.minus(b),
                a.times(b),
                a.left(7),
                a.right(9),
                a ^ b,
                a & b,
                a | b,
                a.reversed(),
            ];
            for (column, word) in results.words.iter_mut().zip(words) {
                column.extend(&int_array(l, word)[..L::COUNT]);
            }
            let real = l.to_real(a.right(8));
            let truncated = int_array(l, l.truncate(real));
            results.truncated.extend(&truncated[..L::COUNT]);
            widen(&array(l, real)[..L::COUNT], &mut results.reals);
            widen(&array(l, l.uniform(a))[..L::COUNT], &mut results.uniform);
            let below = a.below(b).bits();
            let lanes = (0..L::COUNT).map(|i| below >> i & 1 == 1);
            results.below.extend(lanes);
            let all = u32::MAX >> (u32::BITS as usize - L::COUNT);
            results.same.push(a.same(a).bits() == all);
        }
        results
    }
}
