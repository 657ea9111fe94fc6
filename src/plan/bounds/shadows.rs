//! How far rounded directions move hard shadows.
//!
//! Whether a shadow ray meets an object is decided exactly, but for the ray as it is rounded: the light
//! seems to stand a little aside, and the edges of shadows are as far aside on what they fall on. The
//! shadow of a lamp that has extent is soft over far more than that.

use glam::DVec3;

use super::{Site, pixels};
use crate::scene::{Place, Scene};
use crate::shape::hierarchy::Bounds;

/// Roundings of the direction of parallel light: one of each component.
const PARALLEL: f64 = 1.0;
/// Roundings of a direction towards a point, as shares of its distance: one of the difference, one of
/// the factor that makes it a unit vector, one of the product with that; the fourth is of the point's
/// own coordinates, which the sum of the distances from the camera is no less than.
const POINT: f64 = 4.0;

/// The largest shift of a shadow's edge in arithmetic of unit roundoff `roundoff`, on what is within
/// `reach`: as an angle from the camera in central projection, else in scene units.
pub fn shift(scene: &Scene, sites: &[Site], roundoff: f64, reach: f64) -> f64 {
    let central = scene.camera.projection.kind.is_central();
    let receives = |site: &&Site| {
        let object = &scene.objects[site.index].value;
        scene.material_of(object).surface.kind.is_spread()
    };
    // Where receivers begin and end.
    let receivers = sites.iter().filter(receives).map(|site| {
        let near = pixels::nearest(site, DVec3::ZERO);
        (site.index, [near, farthest(site).min(reach.max(near))])
    });
    let receivers: Vec<_> = receivers.collect();
    let casters: Vec<&Site> = sites.iter().filter(|site| site.bounds.is_some()).collect();
    let of_light = |place: Place| match place {
        Place::Towards(_) => {
            let far = greatest(&casters, farthest);
            worst(&receivers, &far, central, |far, d| {
                PARALLEL * roundoff * (far + d)
            })
        }
        Place::At(at) => {
            let close = greatest(&casters, |site| 1.0 / pixels::nearest(site, at));
            // A ray that is aside by the angle e passes the light, at most L away, by eL; beyond an
            // object that is at least g from the light, the shadow is aside by no more than eL · L/g.
            worst(&receivers, &close, central, |close, d| {
                POINT * roundoff * (at.length() + d).powi(2) * close
            })
        }
    };
    let places = scene.lights.iter();
    let places = places.filter_map(|light| light.place(scene.camera.from));
    places.map(of_light).fold(0.0, f64::max)
}

/// The worst shift over all receivers, where `shift` is that of a caster's number at a distance from the
/// camera; over that distance it is largest at one of the ends.
fn worst(
    receivers: &[(usize, [f64; 2])],
    casters: &[(f64, usize)],
    central: bool,
    shift: impl Fn(f64, f64) -> f64,
) -> f64 {
    let of_receiver = |(index, ends): &(usize, [f64; 2])| {
        // No object casts a shadow on itself here.
        let Some((caster, _)) = casters.iter().find(|(_, own)| own != index) else {
            return 0.0;
        };
        let seen = ends.map(|d| shift(*caster, d) / if central { d } else { 1.0 });
        seen[0].max(seen[1])
    };
    receivers.iter().map(of_receiver).fold(0.0, f64::max)
}

/// Distance from the camera to the farthest corner of the box; infinite for a plane.
fn farthest(site: &Site) -> f64 {
    let corner = |bounds: &Bounds| bounds.low.abs().max(bounds.high.abs()).length();
    site.bounds.as_ref().map_or(f64::INFINITY, corner)
}

/// The two greatest of the numbers that objects have, with the objects.
fn greatest(sites: &[&Site], number: impl Fn(&Site) -> f64) -> Vec<(f64, usize)> {
    let numbers = sites.iter().map(|site| (number(site), site.index));
    let mut numbers: Vec<_> = numbers.collect();
    numbers.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    numbers.truncate(2);
    numbers
}
