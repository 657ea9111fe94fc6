//! The formulas of textbooks, in f32 and f64: the ray is taken to canonical coordinates by the rounded
//! inverse matrix, and what comes out is believed.

use glam::{DMat3, DVec3};

use etalon::inside::math::affine::Affine;
use etalon::inside::math::lanes::Scalar;
use etalon::inside::shape::{Ray, ShapeKind};

/// A canonical shape, placed.
#[derive(Debug, Clone)]
pub struct Textbook<T> {
    kind: ShapeKind,
    rows: [[T; 4]; 3],
}

type Three<T> = [T; 3];

fn dot<T: Scalar>(a: &[T], b: &[T]) -> T {
    a.iter()
        .zip(b)
        .fold(T::default(), |sum, (x, y)| sum + *x * *y)
}

/// The map of its linear part and its shift.
pub fn affine(linear: DMat3, shift: DVec3) -> Affine {
    let rows = [0, 1, 2].map(|i| linear.row(i).extend(shift[i]).to_array());
    Affine { rows }
}

/// The inverse of a placing matrix by cofactors, in f64.
pub fn inverse(to_world: &Affine) -> Affine {
    let [a, b, c] = to_world.columns();
    let linear = DMat3::from_cols(a, b, c).inverse();
    affine(linear, -(linear * to_world.translation()))
}

/// A world ray in object coordinates, by a rounded map.
pub fn local<T: Scalar>(rows: &[[T; 4]; 3], ray: &Ray) -> [Three<T>; 2] {
    let [o, d] = [ray.origin, ray.direction].map(|v| v.to_array().map(T::from_f64));
    let direction = rows.each_ref().map(|row| dot(&row[..3], &d));
    let origin = rows.each_ref().map(|row| dot(&row[..3], &o) + row[3]);
    [origin, direction]
}

impl<T: Scalar> Textbook<T> {
    pub fn new(kind: ShapeKind, to_world: &Affine) -> Self {
        let rows = inverse(to_world).rows.map(|row| row.map(T::from_f64));
        Self { kind, rows }
    }

    /// The first t > 0.
    pub fn first_hit(&self, ray: &Ray) -> Option<f64> {
        let [o, d] = local(&self.rows, ray);
        let span = match self.kind {
            ShapeKind::Sphere => round(&o, &d),
            ShapeKind::Cube => slab(o[0], d[0])
                .and_then(|x| common(x, slab(o[1], d[1])?))
                .and_then(|xy| common(xy, slab(o[2], d[2])?)),
            ShapeKind::Cylinder => {
                round(&o[..2], &d[..2]).and_then(|r| common(r, slab(o[2], d[2])?))
            }
            ShapeKind::Disk | ShapeKind::Rectangle | ShapeKind::Plane => self.flat(&o, &d),
        };
        let [near, far] = span?;
        let zero = T::default();
        let first = if near > zero { near } else { far };
        (first > zero).then(|| first.to_f64())
    }

    fn flat(&self, o: &Three<T>, d: &Three<T>) -> Option<[T; 2]> {
        let one = T::from_f64(1.0);
        let t = (T::default() - o[2]) / d[2];
        let point = [o[0] + t * d[0], o[1] + t * d[1]];
        let within = |x: T| x <= one && x >= T::default() - one;
        let inside = match self.kind {
            ShapeKind::Disk => dot(&point, &point) <= one,
            ShapeKind::Rectangle => within(point[0]) && within(point[1]),
            _ => true,
        };
        inside.then_some([t, t])
    }
}

/// −b ∓ √(b² − a c), over a.
fn round<T: Scalar>(o: &[T], d: &[T]) -> Option<[T; 2]> {
    let (a, b) = (dot(d, d), dot(o, d));
    let c = dot(o, o) - T::from_f64(1.0);
    let discriminant = b * b - a * c;
    let zero = T::default();
    if discriminant < zero {
        return None;
    }
    let root = discriminant.root();
    Some([(zero - b - root) / a, (zero - b + root) / a])
}

fn slab<T: Scalar>(o: T, d: T) -> Option<[T; 2]> {
    let one = T::from_f64(1.0);
    let (a, b) = ((T::default() - one - o) / d, (one - o) / d);
    Some(if a > b { [b, a] } else { [a, b] })
}

fn common<T: Scalar>([a, b]: [T; 2], [c, d]: [T; 2]) -> Option<[T; 2]> {
    let near = a.larger(c);
    let far = if b < d { b } else { d };
    (near <= far).then_some([near, far])
}
