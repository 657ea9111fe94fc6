//! Lights that can be sampled from a point: direction, distance and solid-angle density.

mod cube;
mod cylinder;
mod emitting;
mod mapped;
mod rectangle;
mod small;
mod sphere;

use glam::DVec3;

use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::vec3::Vec3;
use crate::sample::warp::square_to_disk;

pub use cube::CubeLight;
pub use cylinder::CylinderLight;
pub use emitting::of_shape;
pub use mapped::{MappedLight, cylinder_area, ellipsoid_area};
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
    /// Where its points are.
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

/// The lights that can be sampled, by shape.
#[derive(Debug, Clone)]
pub enum LightShape<T> {
    /// Right-angled rectangle: solid angle near, area far.
    Rectangle(RectangleLight<T>),
    /// Any ellipse, by area.
    Disk(PlanarLight<T>),
    /// Any parallelogram, by area.
    Parallelogram(PlanarLight<T>),
    /// A sphere: its cone from outside, by area from inside.
    Sphere(SphereLight<T>),
    /// Any parallelepiped: its visible faces by area.
    Cube(CubeLight<T>),
    /// A right circular cylinder: its visible parts.
    Cylinder(CylinderLight<T>),
    /// An ellipsoid, or a cylinder that is not right circular: as the canonical shape, mapped.
    Mapped(MappedLight<T>),
    Point([T; 3]),
    /// Parallel light: the direction towards it.
    Directional([T; 3]),
}

impl<T: Scalar> LightShape<T> {
    /// Whether scattered rays can hit the light, so that the two strategies are to be weighted.
    pub fn has_extent(&self) -> bool {
        !matches!(self, Self::Point(_) | Self::Directional(_))
    }

    /// Whether it cannot light itself, whatever rounding makes of a point on it: by a hair behind
    /// the plane, a rectangle would fill half of all directions.
    pub fn is_flat(&self) -> bool {
        matches!(
            self,
            Self::Rectangle(_) | Self::Disk(_) | Self::Parallelogram(_)
        )
    }

    /// Samples a direction from points p.
    #[inline(always)]
    pub fn sample<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        [u, v]: [L::Real; 2],
    ) -> Towards<L> {
        match self {
            Self::Rectangle(light) => light.sample(l, p, [u, v]),
            Self::Disk(light) => {
                let (x, y) = square_to_disk(l, u, v);
                light.towards(l, p, x, y)
            }
            Self::Parallelogram(light) => {
                let two = l.real(2.0);
                let one = l.real(1.0);
                light.towards(l, p, two.mul_add(u, -one), two.mul_add(v, -one))
            }
            Self::Sphere(light) => light.sample(l, p, [u, v]),
            Self::Cube(light) => light.sample(l, p, [u, v]),
            Self::Cylinder(light) => light.sample(l, p, [u, v]),
            Self::Mapped(light) => light.sample(l, p, [u, v]),
            Self::Point(at) => {
                let to = vector(l, at) - p;
                let squared = to.length_squared();
                let distance = squared.sqrt();
                Towards {
                    direction: to.scale(l.real(1.0) / distance),
                    distance,
                    pdf: squared,
                    valid: squared.gt(l.real(0.0)),
                }
            }
            Self::Directional(direction) => Towards {
                direction: vector(l, direction),
                distance: l.real(f64::INFINITY),
                pdf: l.real(1.0),
                valid: l.mask(true),
            },
        }
    }

    /// Density in solid angle with which [`Self::sample`] from p would have chosen the unit
    /// direction `direction`, which meets the light where its normal is `normal`.
    ///
    /// It is a function of p and the direction alone, the same for both sampling strategies, bit
    /// for bit: the weights of a direction then sum to 1 however grazing it is. (The hit's own
    /// distance and normal would be as good, but rounded otherwise, and 1/cos enlarges that.) The
    /// normal only tells the faces of a cube or cylinder apart.
    #[inline(always)]
    pub fn pdf<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
        normal: Vec3<L::Real>,
    ) -> L::Real {
        match self {
            Self::Rectangle(light) => light.pdf(l, p, direction),
            Self::Disk(light) | Self::Parallelogram(light) => light.pdf(l, p, direction),
            Self::Sphere(light) => light.pdf(l, p, direction),
            Self::Cube(light) => light.pdf(l, p, direction, normal),
            Self::Cylinder(light) => light.pdf(l, p, direction, normal),
            Self::Mapped(light) => light.pdf(l, p, direction, normal),
            Self::Point(_) | Self::Directional(_) => l.real(0.0),
        }
    }
}

/// A parallelogram or ellipse: centre ± two half-axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarLight<T> {
    centre: [T; 3],
    half: [[T; 3]; 2],
    normal: [T; 3],
    inverse_area: T,
    emits: [bool; 2],
}

impl<T: Scalar> PlanarLight<T> {
    /// From its centre and half-axes; `shape_area` is the area of the canonical shape (4 or π),
    /// `normal` the unit normal of the front.
    pub fn new(
        centre: DVec3,
        half: [DVec3; 2],
        normal: DVec3,
        shape_area: f64,
        emits: [bool; 2],
    ) -> Self {
        let area = half[0].cross(half[1]).length() * shape_area;
        Self {
            centre: centre.to_array().map(T::from_f64),
            half: half.map(|h| h.to_array().map(T::from_f64)),
            normal: normal.to_array().map(T::from_f64),
            inverse_area: T::from_f64(1.0 / area),
            emits,
        }
    }

    #[inline(always)]
    fn towards<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        x: L::Real,
        y: L::Real,
    ) -> Towards<L> {
        let to = (vector(l, &self.centre) - p)
            .along(vector(l, &self.half[0]), x)
            .along(vector(l, &self.half[1]), y);
        let normal = vector(l, &self.normal);
        let height = (vector(l, &self.centre) - p).dot(normal);
        by_area(
            l,
            to,
            normal,
            height,
            l.splat(self.inverse_area),
            self.emits,
        )
    }

    #[inline(always)]
    fn pdf<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
    ) -> L::Real {
        let normal = vector(l, &self.normal);
        let height = (vector(l, &self.centre) - p).dot(normal);
        area_pdf(direction.dot(normal), height, l.splat(self.inverse_area))
    }
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
