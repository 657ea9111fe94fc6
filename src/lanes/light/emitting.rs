//! From shapes that emit to lights that can be sampled.

use glam::{DMat3, DVec3};

use super::{
    CubeLight, CylinderLight, LightShape, MappedLight, PlanarLight, RectangleLight, SphereLight,
    cylinder_area, ellipsoid_area,
};
use crate::math::affine::{Affine, perpendicular};
use crate::math::lanes::Scalar;
use crate::shape::{Emitter, ShapeKind};

/// The light that a placed shape makes which emits on its front and on its back, and its area; `None`
/// where only scattered rays find it.
pub fn of_shape<T: Scalar>(
    kind: Option<ShapeKind>,
    to_world: &Affine,
    inverse: &Affine,
    emits: [bool; 2],
) -> Option<(LightShape<T>, f64)> {
    let [a, b, c] = to_world.columns();
    let centre = to_world.translation();
    let normal = |axis: usize| {
        let row = inverse.rows[axis];
        DVec3::new(row[0], row[1], row[2]).normalize()
    };
    match kind.map_or(Emitter::Unsampled, ShapeKind::emitter) {
        Emitter::Rectangle => {
            let area = 4.0 * a.cross(b).length();
            let shape = if perpendicular(a, b) {
                LightShape::Rectangle(RectangleLight::new(centre, [a, b], normal(2), emits))
            } else {
                LightShape::Parallelogram(PlanarLight::new(centre, [a, b], normal(2), 4.0, emits))
            };
            Some((shape, area))
        }
        Emitter::Disk => {
            let pi = std::f64::consts::PI;
            let light = PlanarLight::new(centre, [a, b], normal(2), pi, emits);
            Some((LightShape::Disk(light), pi * a.cross(b).length()))
        }
        Emitter::Sphere if to_world.is_similarity() => {
            let radius = a.length();
            let light = SphereLight::new(centre, radius, emits);
            Some((
                LightShape::Sphere(light),
                4.0 * std::f64::consts::PI * radius * radius,
            ))
        }
        Emitter::Cube => {
            let normals = [normal(0), normal(1), normal(2)];
            let area = 8.0 * (a.cross(b).length() + b.cross(c).length() + c.cross(a).length());
            Some((
                LightShape::Cube(CubeLight::new(centre, [a, b, c], normals, emits)),
                area,
            ))
        }
        Emitter::Cylinder if to_world.is_right_circular() => {
            let (radius, height) = (a.length(), 2.0 * c.length());
            let area = 2.0 * std::f64::consts::PI * radius * (radius + height);
            let light = CylinderLight::new(centre, [a, b], c, emits);
            Some((LightShape::Cylinder(light), area))
        }
        Emitter::Sphere => {
            let linear = DMat3::from_cols(a, b, c);
            let light = MappedLight::ellipsoid(centre, linear, emits);
            Some((LightShape::Mapped(light), ellipsoid_area(linear)))
        }
        Emitter::Cylinder => {
            let linear = DMat3::from_cols(a, b, c);
            let light = MappedLight::cylinder(centre, linear, emits);
            Some((LightShape::Mapped(light), cylinder_area(linear)))
        }
        Emitter::Unsampled => None,
    }
}
