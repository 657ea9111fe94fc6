//! Running code over lanes: on the best instruction set, or on all of them with the bits compared.

use etalon::Instructions;
use etalon::inside::math::instructions;
use etalon::inside::math::lanes::{Lanes, Scalar};

pub use etalon::inside::math::instructions::Precision;

pub const PRECISIONS: [Precision; 2] = Precision::ALL;

/// Something to do in lanes of any kind.
pub trait Job {
    type Output;
    fn run<L: Lanes>(&self, l: L) -> Self::Output;
}

/// A job of either precision as one of each.
struct Either<'a, J>(&'a J);

impl<T: Scalar, J: Job> instructions::Job<T> for Either<'_, J> {
    type Output = J::Output;
    fn run<L: Lanes<Scalar = T>>(self, l: L) -> J::Output {
        self.0.run(l)
    }
}

/// Runs a job on every instruction set of this machine, the best first, with their names.
pub fn on_each<J: Job>(precision: Precision, job: &J) -> Vec<(&'static str, J::Output)> {
    let all = Instructions::all().into_iter();
    all.map(|set| (set.name(), set.run_in(precision, Either(job))))
        .collect()
}

/// Runs a job on the best instruction set only.
pub fn best<J: Job>(precision: Precision, job: &J) -> J::Output {
    Instructions::best().run_in(precision, Either(job))
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
