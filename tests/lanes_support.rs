//! Running code over lanes: on the best instruction set, or on all of them with the bits compared.

use etalon::math::lanes::{Double, Lanes, Scalar, Single};
use fearless_simd::Level;

/// Which scalars.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// f32 × 16.
    Single,
    /// f64 × 8.
    Double,
}

pub const PRECISIONS: [Precision; 2] = [Precision::Single, Precision::Double];

impl Precision {
    /// Unit roundoff.
    pub fn roundoff(self) -> f64 {
        match self {
            Self::Single => f32::ROUNDOFF,
            Self::Double => f64::ROUNDOFF,
        }
    }

    /// The nearest number of this precision.
    pub fn rounded(self, x: f64) -> f64 {
        match self {
            Self::Single => f64::from(x as f32),
            Self::Double => x,
        }
    }
}

/// Something to do in lanes of any kind.
pub trait Job {
    type Output;
    fn run<L: Lanes>(&self, l: L) -> Self::Output;
}

/// Runs a job on every instruction set of this machine, the best first, with their names.
pub fn on_each<J: Job>(precision: Precision, job: &J) -> Vec<(&'static str, J::Output)> {
    let level = Level::new();
    let mut all = Vec::new();
    macro_rules! on {
        ($name:literal, $token:expr) => {
            if let Some(simd) = $token {
                all.push((
                    $name,
                    match precision {
                        Precision::Single => job.run(Single(simd)),
                        Precision::Double => job.run(Double(simd)),
                    },
                ));
            }
        };
    }
    #[cfg(target_arch = "x86_64")]
    {
        on!("avx512", level.as_avx512());
        on!("avx2", level.as_avx2());
        on!("sse2", level.as_sse2());
    }
    #[cfg(target_arch = "aarch64")]
    on!("neon", level.as_neon());
    all
}

/// Runs a job on the best instruction set only.
pub fn best<J: Job>(precision: Precision, job: &J) -> J::Output {
    let level = Level::new();
    macro_rules! on {
        ($token:expr) => {
            if let Some(simd) = $token {
                return match precision {
                    Precision::Single => job.run(Single(simd)),
                    Precision::Double => job.run(Double(simd)),
                };
            }
        };
    }
    #[cfg(target_arch = "x86_64")]
    {
        on!(level.as_avx512());
        on!(level.as_avx2());
        on!(level.as_sse2());
    }
    #[cfg(target_arch = "aarch64")]
    on!(level.as_neon());
    panic!("no instruction set for lanes on this machine");
}

/// A function of lane reals, to be applied to columns of numbers.
pub trait Kernel<const I: usize, const O: usize> {
    fn apply<L: Lanes>(&self, l: L, x: [L::Real; I]) -> [L::Real; O];
}

struct Columns<'a, K, const I: usize> {
    kernel: &'a K,
    input: &'a [Vec<f64>; I],
}

/// Columns of results as f64, exactly.
struct Mapped<const O: usize>([Vec<f64>; O]);

impl<K: Kernel<I, O>, const I: usize, const O: usize> Job for (Columns<'_, K, I>, [(); O]) {
    type Output = Mapped<O>;
    fn run<L: Lanes>(&self, l: L) -> Mapped<O> {
        let Columns { kernel, input } = &self.0;
        let count = input[0].len();
        let mut out = [(); O].map(|()| Vec::with_capacity(count + L::COUNT));
        for from in (0..count).step_by(L::COUNT) {
            let mut buffer = [[L::Scalar::default(); 16]; I];
            for (buffer, column) in buffer.iter_mut().zip(*input) {
                for (i, place) in buffer.iter_mut().enumerate() {
                    *place = L::Scalar::from_f64(column[(from + i).min(count - 1)]);
                }
            }
            let mut results = [[L::Scalar::default(); 16]; O];
            l.vectorize(
                #[inline(always)]
                || {
                    let x = std::array::from_fn(
                        #[inline(always)]
                        |i| l.load(&buffer[i]),
                    );
                    let y = kernel.apply(l, x);
                    for (y, result) in y.into_iter().zip(&mut results) {
                        l.store(y, result);
                    }
                },
            );
            let here = L::COUNT.min(count - from);
            for (out, result) in out.iter_mut().zip(&results) {
                out.extend(result[..here].iter().map(|x| x.to_f64()));
            }
        }
        Mapped(out)
    }
}

/// Applies a kernel to columns of numbers, which are rounded to the precision first.
pub fn map<K: Kernel<I, O>, const I: usize, const O: usize>(
    precision: Precision,
    kernel: &K,
    input: &[Vec<f64>; I],
) -> [Vec<f64>; O] {
    best(precision, &(Columns { kernel, input }, [(); O])).0
}

/// As [`map`], on every instruction set, which must agree in every bit.
pub fn map_everywhere<K: Kernel<I, O>, const I: usize, const O: usize>(
    precision: Precision,
    kernel: &K,
    input: &[Vec<f64>; I],
) -> [Vec<f64>; O] {
    let mut all = on_each(precision, &(Columns { kernel, input }, [(); O])).into_iter();
    let Some((best, Mapped(first))) = all.next() else {
        panic!("no instruction set for lanes on this machine");
    };
    for (name, Mapped(other)) in all {
        for (a, b) in first.iter().zip(&other) {
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                assert!(same_bits(*a, *b), "{best} {a:?}, {name} {b:?} at {i}");
            }
        }
    }
    first
}

/// Whether both are the same bits; any NaN is as good as another.
pub fn same_bits(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}
