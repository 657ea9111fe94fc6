//! What a packet of hits looks like: geometry, appearance, emission.

use super::intersect::Nearest;
use super::model::{Model, Scatter};
use super::pool::any;
use crate::math::lanes::{Int, Lanes, Mask, Real, inlined};
use crate::math::vec3::Vec3;
use crate::sample::mis::power_weight;
use crate::shape::lanes::{LaneRay, LaneSurface};

/// The surfaces that a packet of rays has met.
#[derive(Clone, Copy)]
pub struct Surfaces<L: Lanes> {
    /// Points, moved onto the surface.
    pub point: Vec3<L::Real>,
    /// Unit outward normals (+z side of flat shapes).
    pub normal: Vec3<L::Real>,
    /// The ray meets the outward side.
    pub front: L::Mask,
    /// [`Scatter`] as a number.
    pub scatter: L::Int,
    /// Spectrum of albedo, reflectance or n.
    pub spectrum: L::Int,
    /// Spectrum of the extinction coefficient.
    pub extinction: L::Int,
    /// The glass disperses.
    pub disperses: L::Mask,
    /// The side that is met emits.
    pub emits: L::Mask,
    /// Spectrum of the emission.
    pub emission: L::Int,
    /// Weight of the emission against light sampling.
    pub emission_weight: L::Real,
}

/// What light sampling knows of the ray that came here.
#[derive(Clone, Copy)]
pub struct Arrival<L: Lanes> {
    /// Density with which the direction was sampled.
    pub pdf: L::Real,
    /// Light sampling could not have found it.
    pub specular: L::Mask,
}

/// Gathers what the loop needs to know about each hit, one distinct object at a time.
#[inline(never)]
pub fn surfaces<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    ray: &LaneRay<L>,
    nearest: &Nearest<L>,
    arrival: &Arrival<L>,
    hit: L::Mask,
) -> Surfaces<L> {
    l.vectorize(
        #[inline(always)]
        || {
            let zero = l.real(0.0);
            let one = l.real(1.0);
            let nowhere = Vec3::new(zero, zero, one);
            let mut out = Surfaces::<L> {
                point: nowhere,
                normal: nowhere,
                front: l.mask(false),
                scatter: l.int(Scatter::Black as u32),
                spectrum: l.int(0),
                extinction: l.int(0),
                disperses: l.mask(false),
                emits: l.mask(false),
                emission: l.int(0),
                emission_weight: one,
            };
            let mut pending = hit.bits();
            while pending != 0 {
                let k = l.int_lane(nearest.object, pending.trailing_zeros() as usize);
                let here = hit & nearest.object.same(l.int(k));
                pending &= !here.bits();
                let shape = &model.shapes[k as usize];
                let shading = &model.shading[k as usize];
                let p = ray.origin.along(ray.direction, nearest.t);
                let LaneSurface { point, normal } = if shape.kind.is_some() {
                    shape.surface(l, p)
                } else {
                    implicit_surface(l, model, k, p, ray.direction, here)
                };
                let front = normal.dot(ray.direction).lt(zero);
                out.point = Vec3::select(l, here, point, out.point);
                out.normal = Vec3::select(l, here, normal, out.normal);
                out.front = out.front | (here & front);
                out.scatter = l.select_int(here, l.int(shading.scatter as u32), out.scatter);
                let mut spectrum = l.int(shading.spectrum);
                if let Some(checker) = &shading.checker {
                    let cell = inlined(
                        #[inline(always)]
                        |x: L::Real, frequency| (x * l.splat(frequency)).floor(),
                    );
                    let [fx, fy, fz] = checker.frequency;
                    let local = shape.local(l, point);
                    let half =
                        (cell(local.x, fx) + cell(local.y, fy) + cell(local.z, fz)) * l.real(0.5);
                    let odd = !half.same(half.floor());
                    spectrum = l.select_int(odd, l.int(checker.odd), spectrum);
                }
                out.spectrum = l.select_int(here, spectrum, out.spectrum);
                if model.needs.conductor {
                    out.extinction = l.select_int(here, l.int(shading.extinction), out.extinction);
                }
                if shading.disperses {
                    out.disperses = out.disperses | here;
                }
                if let Some(emission) = shading.emission {
                    let emits = here
                        & ((front & l.mask(shading.emits[0]))
                            | (!front & l.mask(shading.emits[1])));
                    out.emits = out.emits | emits;
                    out.emission = l.select_int(emits, l.int(emission), out.emission);
                    if let Some(index) = shading.light
                        && any(emits & !arrival.specular)
                    {
                        let light = &model.lights[index as usize];
                        let chosen = l.splat(light.probability)
                            * light.shape.pdf(l, ray.origin, ray.direction, normal);
                        let weight = power_weight(l, arrival.pdf, chosen);
                        let weighted = emits & !arrival.specular;
                        out.emission_weight = l.select(weighted, weight, out.emission_weight);
                    }
                }
            }
            out
        },
    )
}

/// An implicit surface's outward normal; finite everywhere.
#[inline(always)]
fn implicit_surface<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    object: u32,
    point: Vec3<L::Real>,
    direction: Vec3<L::Real>,
    here: L::Mask,
) -> LaneSurface<L> {
    let inverse = &model.shapes[object as usize].inverse;
    let local = inverse.point(l, point);
    let mut normal = local;
    for (k, implicit) in &model.implicits {
        if *k == object {
            normal = implicit.normal(l, local, inverse.vector(l, direction), here);
        }
    }
    LaneSurface {
        point,
        normal: inverse.transposed(l, normal).normalized(l),
    }
}
