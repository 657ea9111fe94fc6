//! Random numbers where rounding goes wrong.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A stream of numbers and intervals.
pub struct Source(Pcg64Mcg);

impl Source {
    pub fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    /// A whole number below `bound`.
    pub fn below(&mut self, bound: u64) -> u64 {
        self.0.random_range(0..bound)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0.random()
    }

    /// A finite number: any bits, of moderate size, whole, a power of two or its neighbour,
    /// subnormal, or near the largest.
    pub fn number(&mut self) -> f64 {
        let sign = if self.below(2) == 0 { 1.0 } else { -1.0 };
        let magnitude = match self.below(16) {
            0 => f64::from_bits(self.below(f64::INFINITY.to_bits())),
            1 => self.below(1 << 20) as f64,
            2 => {
                let exponent = self.below(200) as i32 - 100;
                self.near(2f64.powi(exponent))
            }
            3 => f64::from_bits(self.below(f64::MIN_POSITIVE.to_bits() * 2)),
            4 => f64::from_bits(f64::MAX.to_bits() - self.below(1 << 20)),
            5 => 0.0,
            6..=9 => self.unit() * 2f64.powi(self.below(40) as i32 - 20),
            _ => self.unit() * 4.0,
        };
        sign * magnitude
    }

    /// A number at most four steps away.
    pub fn near(&mut self, x: f64) -> f64 {
        let mut y = x;
        for _ in 0..self.below(5) {
            y = if self.below(2) == 0 {
                y.next_up()
            } else {
                y.next_down()
            };
        }
        if y.is_finite() { y } else { x }
    }

    /// An interval of finite numbers: a point, neighbours, wide, or unbounded on a side.
    pub fn interval(&mut self) -> [f64; 2] {
        let a = self.number();
        let b = match self.below(8) {
            0 => a,
            1..=3 => self.near(a),
            4 => a + a.abs() * self.unit() * 1e-8,
            _ => self.number(),
        };
        let b = if b.is_finite() { b } else { a };
        let [low, high] = if a < b { [a, b] } else { [b, a] };
        match self.below(64) {
            0 => [f64::NEG_INFINITY, high],
            1 => [low, f64::INFINITY],
            _ => [low, high],
        }
    }

    /// Two intervals, every fourth time such that sums or differences nearly cancel.
    pub fn pair(&mut self) -> [[f64; 2]; 2] {
        let a = self.interval();
        let b = match self.below(8) {
            0 => [-a[1], -a[0]],
            1 => a,
            _ => return [a, self.interval()],
        };
        let [low, high] = b.map(|x| if x.is_finite() { self.near(x) } else { x });
        [a, if low <= high { [low, high] } else { b }]
    }
}
