//! One segment of every path: find the surface, take its light, sample the lights, scatter.

use super::intersect::{Leaving, NOTHING, Rungs, nearest, occluded};
use super::model::{Model, Scatter};
use super::pool::{IntField, Pool, RealField, Results, SpectralField, any, bit_where, flags, has};
use super::surface::{Arrival, Surfaces, surfaces};
use crate::material::fresnel;
use crate::math::lanes::{Int, Lanes, Mask, Real};
use crate::math::vec3::Vec3;
use crate::sample::Slot;
use crate::sample::mis::power_weight;
use crate::sample::sequence::Identity;
use crate::sample::warp::{cosine_hemisphere, cosine_hemisphere_pdf};
use crate::shape::lanes::LaneRay;

/// Segments after which Russian roulette may end a path.
const ROULETTE_FROM: u32 = 5;
/// Largest chance of going on: a path of lossless surfaces still ends, after 20 more segments in
/// the mean.
const LARGEST_SURVIVAL: f64 = 0.95;
/// Share of the paths at `max_depth` that go on to measure what it cuts off.
pub const BEYOND_SHARE: f64 = 1.0 / 16.0;

/// A packet of paths on its way through the step.
struct Step<L: Lanes, const C: usize> {
    throughput: [L::Real; C],
    radiance: [L::Real; C],
    position: [L::Real; C],
    flags: L::Int,
    depth: L::Int,
    id: Identity<L>,
}

/// The scattered rays.
struct Scattered<L: Lanes> {
    direction: Vec3<L::Real>,
    pdf: L::Real,
    specular: L::Mask,
    inward: L::Mask,
}

/// Advances the packet at `at` by one segment and returns which of its lanes go on.
#[inline(always)]
pub fn bounce<L: Lanes, const C: usize>(
    l: L,
    model: &Model<L::Scalar>,
    pool: &mut Pool<L::Scalar, C>,
    results: &mut Results<L::Scalar, C>,
    at: usize,
    active: u32,
    rungs: &mut Rungs,
) -> u32 {
    let active = l.mask_from_bits(active);
    let vector = |pool: &Pool<L::Scalar, C>, field| {
        Vec3::new(
            pool.real(l, field, 0, at),
            pool.real(l, field, 1, at),
            pool.real(l, field, 2, at),
        )
    };
    let ray = LaneRay::<L>::new(
        vector(pool, RealField::Origin),
        vector(pool, RealField::Direction),
    );
    let mut step = Step::<L, C> {
        throughput: pool.spectral(l, SpectralField::Throughput, at),
        radiance: pool.spectral(l, SpectralField::Radiance, at),
        position: pool.spectral(l, SpectralField::Position, at),
        flags: pool.int(l, IntField::Flags, at),
        depth: pool.int(l, IntField::Depth, at),
        id: Identity {
            key: pool.int(l, IntField::Key, at),
            index: pool.int(l, IntField::Index, at),
        },
    };
    let leaving = Leaving {
        object: pool.int(l, IntField::Departure, at),
        inward: has(l, step.flags, flags::INWARD),
    };

    let found = nearest(l, model, &ray, &leaving, active, rungs);
    let hit = active & !found.object.same(l.int(NOTHING));
    let escaped = active & !hit;
    if let Some(environment) = model.environment
        && any(escaped)
    {
        step.add(l, model, escaped, l.int(environment), l.real(1.0));
    }
    let arrival = Arrival {
        pdf: pool.real(l, RealField::Pdf, 0, at),
        specular: has(l, step.flags, flags::SPECULAR),
    };
    let surface = surfaces(l, model, &ray, &found, &arrival, hit);
    if model.needs.emission && any(surface.emits) {
        step.add(
            l,
            model,
            surface.emits,
            surface.emission,
            surface.emission_weight,
        );
    }

    let scatters = hit & !surface.scatter.same(l.int(Scatter::Black as u32));
    let beyond = has(l, step.flags, flags::BEYOND);
    let within = step.depth.plus(l.int(1)).below(l.int(model.max_depth));
    let mut going = scatters & (within | beyond);
    let cut = scatters & !going;
    if any(cut) {
        let u = model
            .sequence
            .single(l, step.id, Slot::Beyond.at(l, step.depth));
        let chosen = cut & u.lt(l.real(BEYOND_SHARE));
        if any(chosen) {
            step.go_beyond(l, pool, results, at, chosen);
            going = going | chosen;
        }
    }

    let next = step.scatter(l, model, &ray, &surface, &found.object, going, rungs);
    let alive = step.roulette(l, model, going);

    let keep = flags::TERMINATED | flags::BEYOND;
    step.flags = (step.flags & l.int(keep))
        | bit_where(l, next.inward, flags::INWARD)
        | bit_where(l, next.specular, flags::SPECULAR);
    step.depth = step.depth.plus(l.int(1));
    let vectors = [
        (RealField::Origin, surface.point),
        (RealField::Direction, next.direction),
    ];
    for (field, v) in vectors {
        pool.set_real(l, field, 0, at, v.x);
        pool.set_real(l, field, 1, at, v.y);
        pool.set_real(l, field, 2, at, v.z);
    }
    pool.set_real(l, RealField::Pdf, 0, at, next.pdf);
    pool.set_spectral(l, SpectralField::Throughput, at, step.throughput);
    pool.set_spectral(l, SpectralField::Radiance, at, step.radiance);
    pool.set_int(l, IntField::Departure, at, found.object);
    pool.set_int(l, IntField::Flags, at, step.flags);
    pool.set_int(l, IntField::Depth, at, step.depth);
    alive.bits()
}

impl<L: Lanes, const C: usize> Step<L, C> {
    /// Adds `weight` times a spectrum to the radiance where the mask is true.
    #[inline(always)]
    fn add(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        m: L::Mask,
        spectrum: L::Int,
        weight: L::Real,
    ) {
        let weight = l.select(m, weight, l.real(0.0));
        for j in 0..C {
            let value = model.spectra.mean(l, spectrum, self.position[j]);
            self.radiance[j] = (self.throughput[j] * weight).mul_add(value, self.radiance[j]);
        }
    }

    /// Delivers the radiance of paths at `max_depth` and lets them go on for the cut-off estimate.
    #[inline(always)]
    fn go_beyond(
        &mut self,
        l: L,
        pool: &Pool<L::Scalar, C>,
        results: &mut Results<L::Scalar, C>,
        at: usize,
        chosen: L::Mask,
    ) {
        let mut bits = chosen.bits();
        while bits != 0 {
            let i = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let slot = pool.int_of(IntField::Slot, at + i) as usize;
            for j in 0..C {
                results.radiance[j * results.capacity + slot] = l.lane(self.radiance[j], i);
            }
        }
        let zero = l.real(0.0);
        for j in 0..C {
            self.radiance[j] = l.select(chosen, zero, self.radiance[j]);
            let weighted = self.throughput[j] * l.real(1.0 / BEYOND_SHARE);
            self.throughput[j] = l.select(chosen, weighted, self.throughput[j]);
        }
        self.flags = self.flags | bit_where(l, chosen, flags::BEYOND);
    }

    /// Samples the lights and the surface; throughput becomes that of the scattered ray.
    #[inline(always)]
    fn scatter(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        ray: &LaneRay<L>,
        surface: &Surfaces<L>,
        object: &L::Int,
        going: L::Mask,
        rungs: &mut Rungs,
    ) -> Scattered<L> {
        let zero = l.real(0.0);
        let mut next = Scattered {
            direction: ray.direction,
            pdf: zero,
            specular: l.mask(true),
            // Reflection stays on the side it came from.
            inward: !surface.front,
        };
        let kind = |scatter: Scatter| going & surface.scatter.same(l.int(scatter as u32));
        if model.needs.diffuse {
            let diffuse = kind(Scatter::Diffuse);
            if any(diffuse) {
                self.diffuse(l, model, surface, object, diffuse, &mut next, rungs);
            }
        }
        if model.needs.conductor || model.needs.ideal_mirror || model.needs.glass {
            let facing = Vec3::select(l, surface.front, surface.normal, -surface.normal);
            let cosine = (-ray.direction.dot(facing)).max(zero).min(l.real(1.0));
            let mirrored = ray.direction.along(facing, cosine + cosine);
            if model.needs.conductor {
                let conductor = kind(Scatter::Conductor);
                if any(conductor) {
                    for j in 0..C {
                        let n = model.spectra.mean(l, surface.spectrum, self.position[j]);
                        let k = model.spectra.mean(l, surface.extinction, self.position[j]);
                        let r = fresnel::conductor(l, cosine, n, k);
                        self.scale(l, conductor, j, r);
                    }
                    next.direction = Vec3::select(l, conductor, mirrored, next.direction);
                }
            }
            if model.needs.ideal_mirror {
                let mirror = kind(Scatter::IdealMirror);
                if any(mirror) {
                    for j in 0..C {
                        let r = model.spectra.mean(l, surface.spectrum, self.position[j]);
                        self.scale(l, mirror, j, r);
                    }
                    next.direction = Vec3::select(l, mirror, mirrored, next.direction);
                }
            }
            if model.needs.glass {
                let glass = kind(Scatter::Glass);
                if any(glass) {
                    self.glass(
                        l,
                        model,
                        surface,
                        glass,
                        (ray.direction, facing, cosine, mirrored),
                        &mut next,
                    );
                }
            }
            // One Newton step keeps mirrored and refracted directions unit however many there are.
            let correction = next
                .direction
                .length_squared()
                .mul_add(l.real(-0.5), l.real(1.5));
            let corrected = next.direction.scale(correction);
            next.direction = Vec3::select(l, next.specular, corrected, next.direction);
        }
        next
    }

    #[inline(always)]
    fn scale(&mut self, l: L, m: L::Mask, j: usize, factor: L::Real) {
        self.throughput[j] = l.select(m, self.throughput[j] * factor, self.throughput[j]);
    }

    /// Lambertian reflection: one light, one cosine-distributed direction.
    #[inline(always)]
    fn diffuse(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        surface: &Surfaces<L>,
        object: &L::Int,
        diffuse: L::Mask,
        next: &mut Scattered<L>,
        rungs: &mut Rungs,
    ) {
        // bsdf · cos / pdf of the cosine-distributed direction is the albedo at every wavelength.
        for j in 0..C {
            let albedo = model.spectra.mean(l, surface.spectrum, self.position[j]);
            self.scale(l, diffuse, j, albedo);
        }
        let normal = Vec3::select(l, surface.front, surface.normal, -surface.normal);
        if !model.lights.is_empty() {
            let leaving = Leaving {
                object: *object,
                inward: next.inward,
            };
            self.lights(l, model, surface.point, normal, &leaving, diffuse, rungs);
        }
        let [u, v] = model
            .sequence
            .pair(l, self.id, Slot::Bsdf.at(l, self.depth));
        let local = cosine_hemisphere(l, u, v);
        let (s, t) = normal.frame(l);
        let direction = normal.scale(local.z).along(s, local.x).along(t, local.y);
        next.direction = Vec3::select(l, diffuse, direction, next.direction);
        next.pdf = l.select(diffuse, cosine_hemisphere_pdf(l, local.z), next.pdf);
        next.specular = next.specular & !diffuse;
    }

    /// Next-event estimation with the albedo already in the throughput.
    #[inline(always)]
    fn lights(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        point: Vec3<L::Real>,
        normal: Vec3<L::Real>,
        leaving: &Leaving<L>,
        diffuse: L::Mask,
        rungs: &mut Rungs,
    ) {
        let zero = l.real(0.0);
        let one = l.real(1.0);
        let pair = model
            .sequence
            .pair(l, self.id, Slot::Light.at(l, self.depth));
        let mut chosen = l.int(0);
        if model.lights.len() > 1 {
            let u = model
                .sequence
                .single(l, self.id, Slot::Choice.at(l, self.depth));
            for (k, light) in model.lights.iter().enumerate().skip(1) {
                let here = u.ge(l.splat(light.below));
                chosen = l.select_int(here, l.int(k as u32), chosen);
            }
        }
        let mut direction = normal;
        let mut distance = zero;
        let mut weight = zero;
        let mut spectrum = l.int(0);
        let mut except = l.int(NOTHING);
        let mut pending = diffuse.bits();
        while pending != 0 {
            let k = l.int_lane(chosen, pending.trailing_zeros() as usize);
            let here = diffuse & chosen.same(l.int(k));
            pending &= !here.bits();
            let light = &model.lights[k as usize];
            let towards = light.shape.sample(l, point, pair);
            let cosine = towards.direction.dot(normal);
            let valid = here & towards.valid & cosine.gt(zero);
            let scattering = cosine_hemisphere_pdf(l, cosine);
            let pdf = towards.pdf * l.splat(light.probability);
            let mis = if light.shape.has_extent() {
                power_weight(l, pdf, scattering)
            } else {
                one
            };
            direction = Vec3::select(l, valid, towards.direction, direction);
            distance = l.select(valid, towards.distance, distance);
            weight = l.select(valid, scattering * mis / pdf, weight);
            spectrum = l.select_int(here, l.int(light.spectrum), spectrum);
            except = l.select_int(here, l.int(light.object), except);
        }
        let asked = diffuse & weight.gt(zero);
        if !any(asked) {
            return;
        }
        let shadow = LaneRay::<L>::new(point, direction);
        let blocked = occluded(l, model, &shadow, leaving, distance, except, asked, rungs);
        let lit = asked & !blocked;
        if any(lit) {
            self.add(l, model, lit, spectrum, weight);
        }
    }

    /// Reflection or refraction at glass, chosen by the mean reflectance over the wavelengths
    /// still carried; refraction that disperses ends all but the hero.
    #[inline(always)]
    fn glass(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        surface: &Surfaces<L>,
        glass: L::Mask,
        (incoming, facing, cosine, mirrored): (
            Vec3<L::Real>,
            Vec3<L::Real>,
            L::Real,
            Vec3<L::Real>,
        ),
        next: &mut Scattered<L>,
    ) {
        let one = l.real(1.0);
        let terminated = has(l, self.flags, flags::TERMINATED);
        let eta_of = |position: L::Real| {
            let n = model.spectra.between(l, surface.spectrum, position);
            l.select(surface.front, n, one / n)
        };
        let hero_eta = eta_of(self.position[0]);
        let (transmitted, hero_reflectance) = fresnel::dielectric(l, cosine, hero_eta);
        let mut reflectance = [hero_reflectance; C];
        let mut mean = hero_reflectance;
        let spreads = surface.disperses & !terminated;
        if model.needs.dispersion && C > 1 {
            let mut sum = hero_reflectance;
            for (j, r) in reflectance.iter_mut().enumerate().skip(1) {
                *r = fresnel::dielectric(l, cosine, eta_of(self.position[j])).1;
                sum = sum + *r;
            }
            mean = l.select(spreads, sum * l.real(1.0 / C as f64), mean);
        }
        let u = model
            .sequence
            .single(l, self.id, Slot::Choice.at(l, self.depth));
        let reflects = glass & u.lt(mean);
        let refracts = glass & !reflects;
        let inverse = one / hero_eta;
        // Radiance per solid angle changes by 1/η² (Veach 1997, section 5.2).
        let refracted_scale = inverse * inverse / (one - mean);
        for j in 0..C {
            self.scale(l, reflects, j, reflectance[j] / mean);
            self.scale(l, refracts, j, (one - reflectance[j]) * refracted_scale);
        }
        let ends = refracts & spreads;
        if model.needs.dispersion && C > 1 && any(ends) {
            // Secondary pdfs become 0, the hero's is divided by C.
            self.scale(l, ends, 0, l.real(C as f64));
            for j in 1..C {
                self.scale(l, ends, j, l.real(0.0));
            }
            self.flags = self.flags | bit_where(l, ends, flags::TERMINATED);
        }
        let refracted = incoming
            .scale(inverse)
            .along(facing, inverse.mul_add(cosine, -transmitted));
        next.direction = Vec3::select(l, reflects, mirrored, next.direction);
        next.direction = Vec3::select(l, refracts, refracted, next.direction);
        next.inward = (next.inward & !refracts) | (refracts & surface.front);
    }

    /// Ends paths with the probability that their throughput is lost anyway, and rewards the rest.
    #[inline(always)]
    fn roulette(&mut self, l: L, model: &Model<L::Scalar>, going: L::Mask) -> L::Mask {
        let zero = l.real(0.0);
        let mut largest = zero;
        for throughput in self.throughput {
            largest = largest.max(throughput);
        }
        let going = going & largest.gt(zero);
        let late = going & !self.depth.plus(l.int(1)).below(l.int(ROULETTE_FROM));
        if !any(late) {
            return going;
        }
        let terminated = has(l, self.flags, flags::TERMINATED);
        let carried = l.select(terminated, l.real(1.0 / C as f64), l.real(1.0));
        let beyond = has(l, self.flags, flags::BEYOND);
        let share = l.select(beyond, l.real(BEYOND_SHARE), l.real(1.0));
        let survival = (largest * carried * share).min(l.real(LARGEST_SURVIVAL));
        let u = model
            .sequence
            .single(l, self.id, Slot::Roulette.at(l, self.depth));
        let survives = u.lt(survival);
        let reward = l.real(1.0) / survival;
        for j in 0..C {
            self.scale(l, late & survives, j, reward);
        }
        going & (survives | !late)
    }
}
