//! Vectors of three lane reals.

use std::ops::{Add, Mul, Neg, Sub};

use glam::DVec3;

use super::lanes::{Lanes, Real};

#[derive(Clone, Copy)]
pub struct Vec3<R> {
    pub x: R,
    pub y: R,
    pub z: R,
}

impl<R: Real> Vec3<R> {
    #[inline(always)]
    pub fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }

    /// The same vector, rounded, in every lane.
    #[inline(always)]
    pub fn splat<L: Lanes<Real = R>>(l: L, v: DVec3) -> Self {
        Self::new(l.real(v.x), l.real(v.y), l.real(v.z))
    }

    methods! {
        pub fn dot(self, b: Self) -> R = self.x.mul_add(b.x, self.y.mul_add(b.y, self.z * b.z));
        pub fn length_squared(self) -> R = self.dot(self);
        pub fn scale(self, s: R) -> Self = Self::new(self.x * s, self.y * s, self.z * s);
        pub fn max_abs(self) -> R = self.x.abs().max(self.y.abs()).max(self.z.abs());
    }

    #[inline(always)]
    pub fn cross(self, b: Self) -> Self {
        Self::new(
            self.y.mul_add(b.z, -(self.z * b.y)),
            self.z.mul_add(b.x, -(self.x * b.z)),
            self.x.mul_add(b.y, -(self.y * b.x)),
        )
    }

    /// `self + d · t`.
    #[inline(always)]
    pub fn along(self, d: Self, t: R) -> Self {
        Self::new(
            d.x.mul_add(t, self.x),
            d.y.mul_add(t, self.y),
            d.z.mul_add(t, self.z),
        )
    }

    #[inline(always)]
    pub fn normalized<L: Lanes<Real = R>>(self, l: L) -> Self {
        self.scale(l.real(1.0) / self.length_squared().sqrt())
    }

    #[inline(always)]
    pub fn reciprocal<L: Lanes<Real = R>>(self, l: L) -> Self {
        let one = l.real(1.0);
        Self::new(one / self.x, one / self.y, one / self.z)
    }

    /// Lane by lane `a` where the mask is true, else `b`.
    #[inline(always)]
    pub fn select<L: Lanes<Real = R>>(l: L, m: L::Mask, a: Self, b: Self) -> Self {
        Self::new(
            l.select(m, a.x, b.x),
            l.select(m, a.y, b.y),
            l.select(m, a.z, b.z),
        )
    }

    /// Orthonormal tangents of a unit normal: (s, t) with s × t = n (Duff et al. 2017,
    /// "Building an Orthonormal Basis, Revisited", JCGT 6(1), listing 3).
    #[inline(always)]
    pub fn frame<L: Lanes<Real = R>>(self, l: L) -> (Self, Self) {
        let one = l.real(1.0);
        let sign = one.copysign(self.z);
        let a = -(one / (sign + self.z));
        let b = self.x * self.y * a;
        let s = Self::new(
            (sign * self.x * self.x).mul_add(a, one),
            sign * b,
            -(sign * self.x),
        );
        let t = Self::new(b, (self.y * self.y).mul_add(a, sign), -self.y);
        (s, t)
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<R: Real> $trait for Vec3<R> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, b: Self) -> Self {
                Self::new(
                    self.x.$method(b.x),
                    self.y.$method(b.y),
                    self.z.$method(b.z),
                )
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);

impl<R: Real> Neg for Vec3<R> {
    type Output = Self;
    methods! { fn neg(self) -> Self = Self::new(-self.x, -self.y, -self.z); }
}

/// An affine map whose rows are scalars, applied to lanes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rows<T> {
    pub rows: [[T; 4]; 3],
    /// The only coordinate that each row depends on; [`SEVERAL`] where there is more than one.
    only: [u8; 3],
}

/// Marks a row that depends on more than one coordinate.
const SEVERAL: u8 = 3;

/// The only coordinate that a row depends on: most things stand square to the axes, and what is
/// multiplied by zero need not be computed.
fn only(row: &[f64; 4]) -> u8 {
    match row {
        [_, 0.0, 0.0, _] => 0,
        [0.0, _, 0.0, _] => 1,
        [0.0, 0.0, _, _] => 2,
        _ => SEVERAL,
    }
}

impl<T: super::lanes::Scalar> Rows<T> {
    pub fn from_f64(rows: &[[f64; 4]; 3]) -> Self {
        Self {
            rows: rows.map(|row| row.map(T::from_f64)),
            only: rows.each_ref().map(only),
        }
    }

    /// Row `i` of the images of a point and of a vector.
    #[inline(always)]
    pub fn row<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        i: usize,
        p: Vec3<L::Real>,
        v: Vec3<L::Real>,
    ) -> (L::Real, L::Real) {
        let r = &self.rows[i];
        let along = inlined!(|j: usize, p: L::Real, v: L::Real| {
            let scale = l.splat(r[j]);
            (scale.mul_add(p, l.splat(r[3])), scale * v)
        });
        match self.only[i] {
            0 => along(0, p.x, v.x),
            1 => along(1, p.y, v.y),
            2 => along(2, p.z, v.z),
            _ => (self.row_point(l, i, p), self.row_dot(l, i, v)),
        }
    }

    /// The numbers at three places, the same in each lane.
    #[inline(always)]
    fn splat<L: Lanes<Scalar = T>>(&self, l: L, places: [(usize, usize); 3]) -> Vec3<L::Real> {
        let at = inlined!(|(i, j): (usize, usize)| l.splat(self.rows[i][j]));
        Vec3::new(at(places[0]), at(places[1]), at(places[2]))
    }

    #[inline(always)]
    pub fn row_dot<L: Lanes<Scalar = T>>(&self, l: L, i: usize, v: Vec3<L::Real>) -> L::Real {
        self.splat(l, [(i, 0), (i, 1), (i, 2)]).dot(v)
    }

    #[inline(always)]
    pub fn row_point<L: Lanes<Scalar = T>>(&self, l: L, i: usize, p: Vec3<L::Real>) -> L::Real {
        let r = &self.rows[i];
        l.splat(r[0]).mul_add(
            p.x,
            l.splat(r[1])
                .mul_add(p.y, l.splat(r[2]).mul_add(p.z, l.splat(r[3]))),
        )
    }

    #[inline(always)]
    pub fn point<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>) -> Vec3<L::Real> {
        Vec3::new(
            self.row_point(l, 0, p),
            self.row_point(l, 1, p),
            self.row_point(l, 2, p),
        )
    }

    #[inline(always)]
    pub fn vector<L: Lanes<Scalar = T>>(&self, l: L, v: Vec3<L::Real>) -> Vec3<L::Real> {
        Vec3::new(
            self.row_dot(l, 0, v),
            self.row_dot(l, 1, v),
            self.row_dot(l, 2, v),
        )
    }

    /// Transpose of the linear part times a vector: normals, when these rows are the inverse.
    #[inline(always)]
    pub fn transposed<L: Lanes<Scalar = T>>(&self, l: L, v: Vec3<L::Real>) -> Vec3<L::Real> {
        let column = inlined!(|j: usize| self.splat(l, [(0, j), (1, j), (2, j)]).dot(v));
        Vec3::new(column(0), column(1), column(2))
    }
}
