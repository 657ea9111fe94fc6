//! Functions of lane reals, applied to columns of numbers.

use etalon_lanes::math::instructions::{Instructions, Job, Precision};
use etalon_lanes::math::lanes::{Lanes, Scalar, WIDEST};
use etalon_lanes::math::packet::array;
use etalon_lanes::math::vec3::Vec3;
use etalon_lanes::shape::Ray;
use etalon_lanes::shape::lanes::LaneRay;
use glam::DVec3;

/// Does a job in one of the two precisions.
pub fn run_in<J, O>(set: Instructions, precision: Precision, job: J) -> O
where
    J: Job<f32, Output = O> + Job<f64, Output = O>,
{
    match precision {
        Precision::Single => set.run::<f32, J>(job),
        Precision::Double => set.run::<f64, J>(job),
    }
}

/// A function of `I` reals with `O` results.
pub trait Kernel<const I: usize, const O: usize> {
    /// Its results; to be inlined.
    fn apply<L: Lanes>(&self, l: L, x: [L::Real; I]) -> [L::Real; O];
}

/// A kernel applied to columns of equal length.
pub struct Columns<'a, K, const I: usize, const O: usize> {
    pub kernel: K,
    pub input: [&'a [f64]; I],
}

impl<T: Scalar, K: Kernel<I, O>, const I: usize, const O: usize> Job<T> for Columns<'_, K, I, O> {
    type Output = [Vec<f64>; O];

    #[inline(always)]
    fn run<L: Lanes<Scalar = T>>(self, l: L) -> Self::Output {
        let count = self.input[0].len();
        let mut out = [(); O].map(|()| Vec::with_capacity(count));
        for from in (0..count).step_by(L::COUNT) {
            let here = L::COUNT.min(count - from);
            let mut x = [l.real(0.0); I];
            for (x, column) in x.iter_mut().zip(self.input) {
                *x = load(l, column[from..from + here].iter().copied());
            }
            let y = self.kernel.apply(l, x);
            for (out, y) in out.iter_mut().zip(y) {
                widen(&array(l, y)[..here], out);
            }
        }
        out
    }
}

/// Functions of an instruction set, a precision and columns, from functions of lane reals.
macro_rules! columns {
    ($(
        $(#[$doc:meta])*
        $name:ident($l:ident, [$($x:ident),+]: $in:literal) -> $out:literal $body:block
    )+) => {$(
        $(#[$doc])*
        pub fn $name(
            set: etalon_lanes::math::instructions::Instructions,
            precision: etalon_lanes::math::instructions::Precision,
            input: [&[f64]; $in],
        ) -> [Vec<f64>; $out] {
            struct Function;
            impl $crate::columns::Kernel<$in, $out> for Function {
                #[inline(always)]
                fn apply<L: etalon_lanes::math::lanes::Lanes>(
                    &self,
                    $l: L,
                    [$($x),+]: [L::Real; $in],
                ) -> [L::Real; $out] $body
            }
            $crate::columns::run_in(set, precision, $crate::columns::Columns { kernel: Function, input })
        }
    )+};
}
pub(crate) use columns;

/// Functions of an instruction set and arguments that calculate in lanes `l`: of a precision, or of
/// tables of either precision, which come first.
macro_rules! jobs {
    ($(
        $(#[$doc:meta])*
        $name:ident<$a:lifetime>($l:ident: $L:ident, $($x:ident: $type:ty),+) -> $output:ty $body:block
    )+) => {$(
        $(#[$doc])*
        pub fn $name<$a>(set: Instructions, precision: Precision, $($x: $type),+) -> $output {
            struct Task<$a>($($type),+);
            impl<$a, T: Scalar> Job<T> for Task<$a> {
                type Output = $output;

                #[inline(always)]
                fn run<$L: Lanes<Scalar = T>>(self, $l: $L) -> $output {
                    let Self($($x),+) = self;
                    $body
                }
            }
            $crate::columns::run_in(set, precision, Task($($x),+))
        }
    )+};
    ($(
        $(#[$doc:meta])*
        $name:ident<$a:lifetime>(
            $l:ident: $L:ident, $tables:ident of $Tables:ident, $($x:ident: $type:ty),+
        ) -> $output:ty $body:block
    )+) => {$(
        $(#[$doc])*
        pub fn $name<$a>(
            set: Instructions,
            $tables: $crate::Made<&$a $Tables<f32>, &$a $Tables<f64>>,
            $($x: $type),+
        ) -> $output {
            struct Task<$a, T: Scalar>(&$a $Tables<T>, $($type),+);
            impl<$a, T: Scalar> Job<T> for Task<$a, T> {
                type Output = $output;

                #[inline(always)]
                fn run<$L: Lanes<Scalar = T>>(self, $l: $L) -> $output {
                    let Self($tables, $($x),+) = self;
                    $body
                }
            }
            match $tables {
                $crate::Made::Single(tables) => set.run(Task(tables, $($x),+)),
                $crate::Made::Double(tables) => set.run(Task(tables, $($x),+)),
            }
        }
    )+};
}
pub(crate) use jobs;

/// A packet of rounded numbers, the first repeated in lanes that are left over.
#[inline(always)]
pub fn load<L: Lanes>(l: L, numbers: impl IntoIterator<Item = f64>) -> L::Real {
    l.load(&rounded(numbers))
}

/// The same of vectors.
#[inline(always)]
pub fn load_vectors<L: Lanes>(l: L, vectors: impl Iterator<Item = DVec3> + Clone) -> Vec3<L::Real> {
    let axis = |axis: usize| vectors.clone().map(move |v| v[axis]);
    Vec3::new(load(l, axis(0)), load(l, axis(1)), load(l, axis(2)))
}

/// The same of rays.
#[inline(always)]
pub fn load_rays<L: Lanes>(l: L, rays: impl Iterator<Item = Ray> + Clone) -> LaneRay<L> {
    let origin = load_vectors(l, rays.clone().map(|ray| ray.origin));
    LaneRay::new(l, origin, load_vectors(l, rays.map(|ray| ray.direction)))
}

fn rounded<T: Scalar>(numbers: impl IntoIterator<Item = f64>) -> [T; WIDEST] {
    let mut numbers = numbers.into_iter().map(T::from_f64);
    let first = numbers.next().unwrap_or_default();
    let mut packet = [first; WIDEST];
    for (place, number) in packet[1..].iter_mut().zip(numbers) {
        *place = number;
    }
    packet
}

/// Adds numbers to a column.
pub fn widen<T: Scalar>(numbers: &[T], column: &mut Vec<f64>) {
    column.extend(numbers.iter().map(|x| x.to_f64()));
}

/// One lane of a packet of vectors.
#[inline(always)]
pub fn vector<L: Lanes>(l: L, v: Vec3<L::Real>, i: usize) -> DVec3 {
    let lane = |x| l.lane(x, i).to_f64();
    DVec3::new(lane(v.x), lane(v.y), lane(v.z))
}
