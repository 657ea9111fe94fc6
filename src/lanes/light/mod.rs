//! Lights that can be sampled from a point: direction, distance and solid-angle density.

mod cube;
mod cylinder;
mod directional;
mod kind;
mod mapped;
mod planar;
mod point;
mod rectangle;
mod small;
mod sphere;

use glam::DVec3;

use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::vec3::Vec3;

pub use cube::CubeLight;
pub use cylinder::CylinderLight;
pub use directional::DirectionalLight;
pub use kind::{Emitting, Light, LightShape, Place, Source, SourceKind, WithoutSurface};
pub use mapped::MappedLight;
pub use planar::PlanarLight;
pub use point::PointLight;
pub use rectangle::RectangleLight;
pub use small::SmallLights;
pub use sphere::{SphereLight, SphereTable};

/// A sampled direction towards a light.
#[derive(Clone, Copy)]
pub struct Towards<L: Lanes> {
    /// Unit direction from the receiving point.
    pub direction: Vec3<L::Real>,
    /// Distance to the light's point; infinite for directional light.
    pub distance: L::Real,
    /// Density in solid angle, sr⁻¹; for lights without extent the factor d² or 1 by which the
    /// intensity or irradiance is divided.
    pub pdf: L::Real,
    /// Whether the light sends anything this way.
    pub valid: L::Mask,
}

/// A light as lanes use it.
#[derive(Debug, Clone)]
pub struct LaneLight<T> {
    pub shape: LightShape<T>,
    /// Probability of choosing it.
    pub probability: T,
    /// Probability of choosing an earlier one.
    pub below: T,
    /// Its spectrum: radiance, intensity or irradiance.
    pub spectrum: u32,
    /// The emitting object; `u32::MAX` for lights without a surface.
    pub object: u32,
}

/// A plane with two axes, at right angles or not: centre + x · first + y · second.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Plane<T> {
    centre: [T; 3],
    axes: [[T; 3]; 2],
    /// Unit vector outward, or of the front.
    normal: [T; 3],
}

impl<T: Scalar> Plane<T> {
    fn new(centre: DVec3, axes: [DVec3; 2], normal: DVec3) -> Self {
        Self {
            centre: scalars(centre),
            axes: axes.map(scalars),
            normal: scalars(normal),
        }
    }

    /// From p to the centre.
    #[inline(always)]
    fn towards_centre<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>) -> Vec3<L::Real> {
        vector(l, &self.centre) - p
    }

    /// To the point (x, y), from where the centre is `to_centre` away.
    #[inline(always)]
    fn towards<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        to_centre: Vec3<L::Real>,
        [x, y]: [L::Real; 2],
    ) -> Vec3<L::Real> {
        let [first, second] = &self.axes;
        to_centre
            .along(vector(l, first), x)
            .along(vector(l, second), y)
    }

    #[inline(always)]
    fn normal<L: Lanes<Scalar = T>>(&self, l: L) -> Vec3<L::Real> {
        vector(l, &self.normal)
    }
}

fn scalars<T: Scalar>(v: DVec3) -> [T; 3] {
    v.to_array().map(T::from_f64)
}

/// Three scalars as a lane vector.
#[inline(always)]
fn vector<L: Lanes>(l: L, v: &[L::Scalar; 3]) -> Vec3<L::Real> {
    Vec3::new(l.splat(v[0]), l.splat(v[1]), l.splat(v[2]))
}

/// Dot products of a vector with three: a matrix of these rows times the vector.
#[inline(always)]
fn products<L: Lanes>(l: L, rows: &[[L::Scalar; 3]; 3], v: Vec3<L::Real>) -> Vec3<L::Real> {
    let [x, y, z] = rows;
    Vec3::new(
        v.dot(vector(l, x)),
        v.dot(vector(l, y)),
        v.dot(vector(l, z)),
    )
}

/// The sum of three vectors, each times a component of `v`: a matrix of these columns times v.
#[inline(always)]
fn combined<L: Lanes>(l: L, columns: &[[L::Scalar; 3]; 3], v: Vec3<L::Real>) -> Vec3<L::Real> {
    let [x, y, z] = columns;
    vector(l, x)
        .scale(v.x)
        .along(vector(l, y), v.y)
        .along(vector(l, z), v.z)
}

/// A number in [0, 1) as one in [−1, 1).
#[inline(always)]
fn signed<L: Lanes>(l: L, u: L::Real) -> L::Real {
    l.real(2.0).mul_add(u, -l.real(1.0))
}

/// Direction, distance and density for a point chosen uniformly on a plane area, `to` away from
/// the receiver, with the sides that emit; `height` is the plane's, along its normal.
#[inline(always)]
fn by_area<L: Lanes>(
    l: L,
    to: Vec3<L::Real>,
    normal: Vec3<L::Real>,
    height: L::Real,
    inverse_area: L::Real,
    emits: [bool; 2],
) -> Towards<L> {
    let squared = to.length_squared();
    let distance = squared.sqrt();
    let direction = to.scale(l.real(1.0) / distance);
    let zero = l.real(0.0);
    // Light leaves along −direction: the front is seen where direction · normal < 0.
    let cosine = direction.dot(normal);
    let front = cosine.lt(zero) & l.mask(emits[0]);
    let back = cosine.gt(zero) & l.mask(emits[1]);
    Towards {
        direction,
        distance,
        pdf: area_pdf(cosine, height, inverse_area),
        valid: front | back,
    }
}

/// Density in solid angle of uniform sampling of a plane area A: d²/(A |cos|) with d = h/cos.
#[inline(always)]
fn area_pdf<R: Real>(cosine: R, height: R, inverse_area: R) -> R {
    height * height * inverse_area / (cosine * cosine * cosine.abs())
}
