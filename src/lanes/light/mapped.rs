//! Ellipsoids, and cylinders that are not right circular: images of the canonical shapes under any
//! affine map.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};

use super::{
    CylinderLight, Emitting, Light, SphereLight, Towards, combined, products, scalars, vector,
};
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::vec3::Vec3;
use crate::shape::Emitter;

/// Points of the lattice that areas are summed over.
const POINTS: usize = 256;

/// The map q ↦ Mq + c of a canonical light. Directions are those that the canonical light samples for
/// the receiver's preimage, carried over; a solid angle dω about the unit vector ω becomes
/// |det M|/|Mω|³ dω (the cone over it has the volume dω/3 before, |det M| dω/3 after, and height |Mω|).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MappedLight<T> {
    canonical: Canonical<T>,
    centre: [T; 3],
    /// Columns of M.
    linear: [[T; 3]; 3],
    /// Rows of M⁻¹.
    inverse: [[T; 3]; 3],
    /// 1/|det M|.
    shrinking: T,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Canonical<T> {
    /// Radius 1.
    Sphere(SphereLight<T>),
    /// Radius 1, from z = −1 to 1.
    Cylinder(CylinderLight<T>),
}

impl<T: Scalar> MappedLight<T> {
    /// The image of the sphere of radius 1 under the map with this linear part and centre.
    pub fn ellipsoid(centre: DVec3, linear: DMat3, emits: [bool; 2]) -> Self {
        let off = Self::off(centre, linear);
        let sphere = SphereLight::with_walls(DVec3::ZERO, 1.0, off, emits);
        Self::new(Canonical::Sphere(sphere), centre, linear)
    }

    /// The image of the cylinder of radius 1 from z = −1 to 1.
    pub fn cylinder(centre: DVec3, linear: DMat3, emits: [bool; 2]) -> Self {
        let off = Self::off(centre, linear);
        let base = [DVec3::X, DVec3::Y];
        let cylinder = CylinderLight::with_walls(DVec3::ZERO, base, DVec3::Z, off, emits);
        Self::new(Canonical::Cylinder(cylinder), centre, linear)
    }

    fn new(canonical: Canonical<T>, centre: DVec3, linear: DMat3) -> Self {
        let inverse = linear.inverse().transpose();
        Self {
            canonical,
            centre: scalars(centre),
            linear: [linear.x_axis, linear.y_axis, linear.z_axis].map(scalars),
            inverse: [inverse.x_axis, inverse.y_axis, inverse.z_axis].map(scalars),
            shrinking: T::from_f64(1.0 / linear.determinant().abs()),
        }
    }

    /// How far from the canonical wall a receiver on the wall can seem to be. In the world it is within
    /// 4u (|c| + 4‖M‖) of it (see [`SphereLight::new`]), its preimage within ‖M⁻¹‖ times that, and three
    /// fused products of p − c with entries within u add 4u ‖M⁻¹‖‖M‖; doubled.
    fn off(centre: DVec3, linear: DMat3) -> f64 {
        let norm = |m: DMat3| m.to_cols_array().map(|x| x * x).iter().sum::<f64>().sqrt();
        let size = norm(linear);
        T::ROUNDOFF * norm(linear.inverse()) * (8.0 * centre.length() + 40.0 * size)
    }

    /// The receiver's preimage.
    #[inline(always)]
    fn preimage<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>) -> Vec3<L::Real> {
        products(l, &self.inverse, p - vector(l, &self.centre))
    }

    /// The canonical direction of a unit vector, and what the map makes of a density there: with
    /// |Mω| = 1/|M⁻¹d|, the factor is 1/(|det M| |M⁻¹d|³).
    #[inline(always)]
    fn canonical_direction<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        direction: Vec3<L::Real>,
    ) -> (Vec3<L::Real>, L::Real) {
        let back = products(l, &self.inverse, direction);
        let squared = back.length_squared();
        let length = squared.sqrt();
        let factor = l.splat(self.shrinking) / (squared * length);
        (back.scale(l.real(1.0) / length), factor)
    }

    /// What the map makes of a sample, with the factor of its density, and the canonical direction of
    /// its own rounded direction, of which both strategies are to see the density.
    #[inline(always)]
    fn mapped<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        towards: &Towards<L>,
    ) -> (Towards<L>, Vec3<L::Real>) {
        let along = combined(l, &self.linear, towards.direction);
        let stretch = along.length_squared().sqrt();
        let direction = along.scale(l.real(1.0) / stretch);
        let (back, factor) = self.canonical_direction(l, direction);
        let towards = Towards {
            direction,
            distance: towards.distance * stretch,
            pdf: factor,
            valid: towards.valid,
        };
        (towards, back)
    }
}

impl<T: Scalar> Light<T> for MappedLight<T> {
    const STRATEGY: &'static str = "as the round shape that it is an image of";

    fn of_shape(shape: &Emitting<'_>) -> Option<(Self, f64)> {
        let (centre, linear) = (shape.to_world.translation(), shape.linear());
        match shape.form {
            Emitter::Sphere => Some((
                Self::ellipsoid(centre, linear, shape.emits),
                ellipsoid_area(linear),
            )),
            Emitter::Cylinder => Some((
                Self::cylinder(centre, linear, shape.emits),
                cylinder_area(linear),
            )),
            Emitter::Disk | Emitter::Rectangle | Emitter::Cube | Emitter::Unsampled => None,
        }
    }

    #[inline(never)]
    fn sample<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>, u: [L::Real; 2]) -> Towards<L> {
        l.vectorize(inlined!(|| {
            let q = self.preimage(l, p);
            match &self.canonical {
                Canonical::Sphere(sphere) => {
                    let (towards, back) = self.mapped(l, &sphere.sample(l, q, u));
                    Towards {
                        pdf: sphere.density(l, q, back) * towards.pdf,
                        ..towards
                    }
                }
                Canonical::Cylinder(cylinder) => {
                    let (towards, part) = cylinder.sample_part(l, q, u);
                    let (towards, back) = self.mapped(l, &towards);
                    Towards {
                        pdf: cylinder.pdf_of_part(l, q, back, &part) * towards.pdf,
                        ..towards
                    }
                }
            }
        }))
    }

    #[inline(never)]
    fn pdf<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
        normal: Vec3<L::Real>,
    ) -> L::Real {
        l.vectorize(inlined!(|| {
            let q = self.preimage(l, p);
            let (back, factor) = self.canonical_direction(l, direction);
            let pdf = match &self.canonical {
                Canonical::Sphere(sphere) => sphere.density(l, q, back),
                Canonical::Cylinder(cylinder) => {
                    // Normals are mapped by the inverse's transpose, so back by the transpose.
                    let normal = products(l, &self.linear, normal);
                    cylinder.pdf(l, q, back, normal.normalized(l))
                }
            };
            pdf * factor
        }))
    }
}

/// Area of the image of the sphere of radius 1 under a linear map, to a thousandth or so: enough for
/// choosing among lights.
fn ellipsoid_area(linear: DMat3) -> f64 {
    4.0 * PI * mean_stretch(linear, &spiral())
}

/// The same of the closed cylinder of radius 1 from z = −1 to 1.
fn cylinder_area(linear: DMat3) -> f64 {
    let around = spiral().map(|n| n.with_z(0.0).normalize());
    4.0 * PI * mean_stretch(linear, &around) + 2.0 * PI * mean_stretch(linear, &[DVec3::Z])
}

/// By how much a linear map M enlarges areas with these unit normals in the mean: |cof(M) n|.
fn mean_stretch(linear: DMat3, normals: &[DVec3]) -> f64 {
    let cofactors = linear.inverse().transpose() * linear.determinant().abs();
    let sum: f64 = normals.iter().map(|n| (cofactors * *n).length()).sum();
    sum / normals.len() as f64
}

/// Unit vectors spread evenly over the sphere, on a spiral that turns by the golden ratio (A. González,
/// "Measurement of Areas on a Sphere Using Fibonacci and Latitude-Longitude Lattices", Mathematical
/// Geosciences 42 (2010)).
fn spiral() -> [DVec3; POINTS] {
    let golden = (1.0 + 5.0f64.sqrt()) / 2.0;
    std::array::from_fn(|k| {
        let z = (2 * k + 1) as f64 / POINTS as f64 - 1.0;
        let angle = TAU * (k as f64 / golden).fract();
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * libm::cos(angle), radius * libm::sin(angle), z)
    })
}
