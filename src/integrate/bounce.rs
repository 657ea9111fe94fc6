//! One segment of every path: find the surface, take its light, sample the lights, scatter.

use super::chunk::CHUNK;
use super::intersect::{Leaving, NOTHING, Nearest, Rungs, Shadow, lane_vector, nearest, occluded};
use super::model::{Model, Scatter};
use super::pool::{
    IntField, Pool, RealField, Rows, WIDEST, any, array, bit_where, each, flags, has, int_array,
};
use super::replay::{LightVertex, ScatteredVertex, Vertex};
use super::surface::{Arrival, Surfaces, surfaces};
use crate::material::fresnel;
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar, inlined};
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
struct Step<'a, L: Lanes, const C: usize> {
    model: &'a Model<L::Scalar>,
    rows: &'a mut Rows<L::Scalar, C>,
    rungs: &'a mut Rungs,
    /// The vertex being written down, of lane 0.
    vertex: Option<&'a mut Vertex>,
    /// Where the spectra of each lane are.
    slots: [u32; WIDEST],
    /// Which row of every table holds the wavelengths.
    row: L::Int,
    flags: L::Int,
    depth: L::Int,
    id: Identity<L>,
}

/// How rays meet smooth surfaces.
struct Incidence<L: Lanes> {
    /// Unit direction of the ray.
    direction: Vec3<L::Real>,
    /// Unit normal on the ray's side.
    facing: Vec3<L::Real>,
    /// Cosine between normal and reversed ray.
    cosine: L::Real,
    /// Direction of reflection.
    mirrored: Vec3<L::Real>,
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
#[expect(clippy::too_many_arguments, reason = "the parts of one worker's state")]
pub fn bounce<L: Lanes, const C: usize>(
    l: L,
    model: &Model<L::Scalar>,
    pool: &mut Pool<L::Scalar>,
    rows: &mut Rows<L::Scalar, C>,
    beyond_slots: &mut Vec<u32>,
    at: usize,
    active: u32,
    rungs: &mut Rungs,
    trace: &mut Option<Vec<Vertex>>,
) -> u32 {
    let active = l.mask_from_bits(active);
    let ray = LaneRay::<L>::new(
        vector(l, pool, RealField::Origin, at),
        vector(l, pool, RealField::Direction, at),
    );
    let mut step = Step::<L, C> {
        model,
        rows,
        rungs,
        vertex: None,
        slots: int_array(l, pool.int(l, IntField::Slot, at)),
        row: pool.int(l, IntField::Row, at),
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

    let found = nearest(l, model, &ray, &leaving, active, step.rungs);
    let hit = active & !found.object.same(l.int(NOTHING));
    if let Some(environment) = model.environment {
        step.add(l, active & !hit, l.int(environment), l.real(1.0));
    }
    let arrival = Arrival {
        pdf: pool.real(l, RealField::Pdf, 0, at),
        specular: has(l, step.flags, flags::SPECULAR),
    };
    let surface = surfaces(l, model, &ray, &found, &arrival, hit);
    let mut vertex = trace
        .is_some()
        .then(|| step.vertex(l, &ray, &found, &surface, &arrival));
    step.vertex = vertex.as_mut();
    if model.needs.emission {
        step.add(l, surface.emits, surface.emission, surface.emission_weight);
    }

    let scatters = hit & !surface.scatter.same(l.int(Scatter::Black as u32));
    let beyond = has(l, step.flags, flags::BEYOND);
    let within = step.depth.plus(l.int(1)).below(l.int(model.max_depth));
    let mut going = scatters & (within | beyond);
    let cut = scatters & !going;
    if any(cut) {
        let slot = Slot::Beyond.at(l, step.depth);
        let u = model.sequence.single(l, step.id, slot);
        let chosen = cut & u.lt(l.real(BEYOND_SHARE));
        step.go_beyond(l, chosen, beyond_slots);
        going = going | chosen;
    }

    let next = step.scatter(l, &ray, &surface, found.object, going);
    let alive = step.roulette(l, going);
    step.note_end(l, &next, alive);

    let kept = step.flags & l.int(flags::TERMINATED | flags::BEYOND);
    let flags = kept
        | bit_where(l, next.inward, flags::INWARD)
        | bit_where(l, next.specular, flags::SPECULAR);
    let slots = l.load_int(&step.slots);
    let depth = step.depth.plus(l.int(1));
    set_vector(l, pool, RealField::Origin, at, surface.point);
    set_vector(l, pool, RealField::Direction, at, next.direction);
    pool.set_real(l, RealField::Pdf, 0, at, next.pdf);
    pool.set_int(l, IntField::Departure, at, found.object);
    pool.set_int(l, IntField::Flags, at, flags);
    pool.set_int(l, IntField::Depth, at, depth);
    pool.set_int(l, IntField::Slot, at, slots);
    if let (Some(trace), Some(vertex)) = (trace, vertex) {
        trace.push(vertex);
    }
    alive.bits()
}

#[inline(always)]
fn vector<L: Lanes>(l: L, pool: &Pool<L::Scalar>, field: RealField, at: usize) -> Vec3<L::Real> {
    Vec3::new(
        pool.real(l, field, 0, at),
        pool.real(l, field, 1, at),
        pool.real(l, field, 2, at),
    )
}

#[inline(always)]
fn set_vector<L: Lanes>(
    l: L,
    pool: &mut Pool<L::Scalar>,
    field: RealField,
    at: usize,
    v: Vec3<L::Real>,
) {
    pool.set_real(l, field, 0, at, v.x);
    pool.set_real(l, field, 1, at, v.y);
    pool.set_real(l, field, 2, at, v.z);
}

/// An object's index unless it is [`NOTHING`].
fn some_object(index: u32) -> Option<u32> {
    (index != NOTHING).then_some(index)
}

impl<L: Lanes, const C: usize> Step<'_, L, C> {
    /// Lane 0 on arrival.
    #[cold]
    fn vertex(
        &self,
        l: L,
        ray: &LaneRay<L>,
        found: &Nearest<L>,
        surface: &Surfaces<L>,
        arrival: &Arrival<L>,
    ) -> Vertex {
        let set = |m: L::Mask| m.bits() & 1 == 1;
        Vertex {
            depth: l.int_lane(self.depth, 0),
            origin: lane_vector(l, ray.origin, 0),
            direction: lane_vector(l, ray.direction, 0),
            distance: l.lane(found.t, 0).to_f64(),
            object: some_object(l.int_lane(found.object, 0)),
            point: lane_vector(l, surface.point, 0),
            normal: lane_vector(l, surface.normal, 0),
            front: set(surface.front),
            arrival_pdf: (!set(arrival.specular)).then(|| l.lane(arrival.pdf, 0).to_f64()),
            emission_weight: set(surface.emits)
                .then(|| l.lane(surface.emission_weight, 0).to_f64()),
            throughput: self.spectrum(&self.rows.throughput),
            light: None,
            scattered: None,
            radiance: Vec::new(),
        }
    }

    /// Lane 0's row of a table of rows.
    fn spectrum(&self, rows: &[[L::Scalar; C]]) -> Vec<f64> {
        rows[self.slots[0] as usize].map(Scalar::to_f64).to_vec()
    }

    /// Writes down how lane 0 goes on.
    #[inline(always)]
    fn note_end(&mut self, l: L, next: &Scattered<L>, alive: L::Mask) {
        if self.vertex.is_some() {
            let goes_on = alive.bits() & 1 == 1;
            let specular = next.specular.bits() & 1 == 1;
            let scattered = goes_on.then(|| ScatteredVertex {
                direction: lane_vector(l, next.direction, 0),
                pdf: (!specular).then(|| l.lane(next.pdf, 0).to_f64()),
                throughput: self.spectrum(&self.rows.throughput),
            });
            let radiance = self.spectrum(&self.rows.radiance);
            if let Some(vertex) = &mut self.vertex {
                vertex.scattered = scattered;
                vertex.radiance = radiance;
            }
        }
    }

    /// Adds throughput × weight × spectrum to the radiance where the mask is true.
    #[inline(always)]
    fn add(&mut self, l: L, m: L::Mask, spectrum: L::Int, weight: L::Real) {
        let bits = m.bits();
        if bits == 0 {
            return;
        }
        let (at, weights) = (self.table_rows(l, spectrum), array(l, weight));
        let table = self.model.spectra.rows::<C>();
        let Rows {
            throughput,
            radiance,
            ..
        } = &mut *self.rows;
        let (throughput, radiance) = (throughput.as_slice(), radiance.as_mut_slice());
        for i in each(bits) {
            let slot = self.slots[i % WIDEST] as usize;
            // Copies: arrays that cannot overlap become vectors.
            let values = table[at[i % WIDEST] as usize];
            let carried = throughput[slot];
            let mut sum = radiance[slot];
            let weight = weights[i % WIDEST];
            for c in 0..C {
                sum[c] = (carried[c] * weight).fused(values[c], sum[c]);
            }
            radiance[slot] = sum;
        }
    }

    /// Multiplies the throughput by a spectrum where the mask is true.
    #[inline(always)]
    fn multiply_by(&mut self, l: L, m: L::Mask, spectrum: L::Int) {
        let at = self.table_rows(l, spectrum);
        let table = self.model.spectra.rows::<C>();
        let throughput = self.rows.throughput.as_mut_slice();
        for i in each(m.bits()) {
            let slot = self.slots[i % WIDEST] as usize;
            let factors = table[at[i % WIDEST] as usize];
            let mut carried = throughput[slot];
            for c in 0..C {
                carried[c] = carried[c] * factors[c];
            }
            throughput[slot] = carried;
        }
    }

    /// Numbers of the table rows that hold a spectrum at each lane's wavelengths.
    #[inline(always)]
    fn table_rows(&self, l: L, spectrum: L::Int) -> [u32; WIDEST] {
        int_array(l, spectrum.plus(self.row))
    }

    /// Multiplies a lane's throughput by a spectrum of factors.
    #[inline(always)]
    fn multiply(&mut self, i: usize, factors: &[L::Scalar; C]) {
        let throughput = &mut self.rows.throughput[self.slots[i] as usize];
        for c in 0..C {
            throughput[c] = throughput[c] * factors[c];
        }
    }

    /// A lane's largest throughput over the wavelengths.
    #[inline(always)]
    fn largest(&self, i: usize) -> L::Scalar {
        let mut throughput = self.rows.throughput[self.slots[i] as usize];
        let mut width = C / 2;
        while width > 0 {
            for c in 0..width {
                throughput[c] = throughput[c].larger(throughput[c + width]);
            }
            width /= 2;
        }
        throughput[0]
    }

    /// Lets paths at `max_depth` go on in rows of their own, for the cut-off estimate.
    #[inline(always)]
    fn go_beyond(&mut self, l: L, chosen: L::Mask, beyond_slots: &mut Vec<u32>) {
        for i in each(chosen.bits()) {
            let slot = self.slots[i] as usize;
            let own = slot + CHUNK;
            let weight = L::Scalar::from_f64(1.0 / BEYOND_SHARE);
            let rows = &mut *self.rows;
            rows.throughput[own] = rows.throughput[slot];
            for value in &mut rows.throughput[own] {
                *value = *value * weight;
            }
            rows.radiance[own] = [L::Scalar::default(); C];
            rows.row[own] = rows.row[slot];
            rows.hero[own] = rows.hero[slot];
            rows.fraction[own] = rows.fraction[slot];
            self.slots[i] = own as u32;
            beyond_slots.push(own as u32);
        }
        self.flags = self.flags | bit_where(l, chosen, flags::BEYOND);
    }

    /// Samples the lights and the surface; throughput becomes that of the scattered ray.
    #[inline(always)]
    fn scatter(
        &mut self,
        l: L,
        ray: &LaneRay<L>,
        surface: &Surfaces<L>,
        object: L::Int,
        going: L::Mask,
    ) -> Scattered<L> {
        let needs = self.model.needs;
        let mut next = Scattered {
            direction: ray.direction,
            pdf: l.real(0.0),
            specular: l.mask(true),
            // Reflection stays on the side it came from.
            inward: !surface.front,
        };
        let kind = inlined(
            #[inline(always)]
            |scatter: Scatter| going & surface.scatter.same(l.int(scatter as u32)),
        );
        if needs.diffuse {
            let diffuse = kind(Scatter::Diffuse);
            if any(diffuse) {
                self.diffuse(l, surface, object, diffuse, &mut next);
            }
        }
        if !(needs.conductor || needs.ideal_mirror || needs.glass) {
            return next;
        }
        let facing = Vec3::select(l, surface.front, surface.normal, -surface.normal);
        let cosine = (-ray.direction.dot(facing))
            .max(l.real(0.0))
            .min(l.real(1.0));
        let mirrored = ray.direction.along(facing, cosine + cosine);
        if needs.conductor {
            let conductor = kind(Scatter::Conductor);
            self.conductor(l, surface, cosine, conductor);
            next.direction = Vec3::select(l, conductor, mirrored, next.direction);
        }
        if needs.ideal_mirror {
            let mirror = kind(Scatter::IdealMirror);
            self.multiply_by(l, mirror, surface.spectrum);
            next.direction = Vec3::select(l, mirror, mirrored, next.direction);
        }
        if needs.glass {
            let glass = kind(Scatter::Glass);
            if any(glass) {
                let incidence = Incidence {
                    direction: ray.direction,
                    facing,
                    cosine,
                    mirrored,
                };
                self.glass(l, surface, glass, &incidence, &mut next);
            }
        }
        // One Newton step keeps mirrored and refracted directions unit however many there are.
        let correction = next
            .direction
            .length_squared()
            .mul_add(l.real(-0.5), l.real(1.5));
        let corrected = next.direction.scale(correction);
        next.direction = Vec3::select(l, next.specular, corrected, next.direction);
        next
    }

    /// Fresnel reflection at every wavelength.
    #[inline(always)]
    fn conductor(&mut self, l: L, surface: &Surfaces<L>, cosine: L::Real, m: L::Mask) {
        let (indices, extinctions) = (
            self.table_rows(l, surface.spectrum),
            self.table_rows(l, surface.extinction),
        );
        let table = self.model.spectra.rows::<C>();
        let cosines = array(l, cosine);
        for i in each(m.bits()) {
            let n = table[indices[i] as usize];
            let k = table[extinctions[i] as usize];
            let mut reflectance = n;
            for c in 0..C {
                reflectance[c] = fresnel::conductor(cosines[i], n[c], k[c]);
            }
            self.multiply(i, &reflectance);
        }
    }

    /// Lambertian reflection: one light, one cosine-distributed direction.
    #[inline(always)]
    fn diffuse(
        &mut self,
        l: L,
        surface: &Surfaces<L>,
        object: L::Int,
        diffuse: L::Mask,
        next: &mut Scattered<L>,
    ) {
        // bsdf · cos / pdf of the cosine-distributed direction is the albedo at every wavelength.
        self.multiply_by(l, diffuse, surface.spectrum);
        let normal = Vec3::select(l, surface.front, surface.normal, -surface.normal);
        if !self.model.lights.is_empty() {
            let leaving = Leaving {
                object,
                inward: next.inward,
            };
            self.lights(l, surface.point, normal, &leaving, diffuse);
        }
        let slot = Slot::Bsdf.at(l, self.depth);
        let [u, v] = self.model.sequence.pair(l, self.id, slot);
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
        point: Vec3<L::Real>,
        normal: Vec3<L::Real>,
        leaving: &Leaving<L>,
        diffuse: L::Mask,
    ) {
        let model = self.model;
        let zero = l.real(0.0);
        let slot = Slot::Light.at(l, self.depth);
        let pair = model.sequence.pair(l, self.id, slot);
        let mut chosen = l.int(0);
        if model.lights.len() > 1 {
            let slot = Slot::Choice.at(l, self.depth);
            let u = model.sequence.single(l, self.id, slot);
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
                l.real(1.0)
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
        let shadow = Shadow {
            ray: LaneRay::new(point, direction),
            limit: distance,
            except,
        };
        let blocked = occluded(l, model, &shadow, leaving, asked, self.rungs);
        if let Some(vertex) = &mut self.vertex
            && asked.bits() & 1 == 1
        {
            vertex.light = Some(LightVertex {
                object: some_object(l.int_lane(except, 0)),
                direction: lane_vector(l, direction, 0),
                distance: l.lane(distance, 0).to_f64(),
                weight: l.lane(weight, 0).to_f64(),
                blocked: blocked.bits() & 1 == 1,
            });
        }
        self.add(l, asked & !blocked, spectrum, weight);
    }

    /// Reflection or refraction at glass, chosen by the mean reflectance over the wavelengths
    /// still carried; refraction that disperses ends all but the hero.
    #[inline(always)]
    fn glass(
        &mut self,
        l: L,
        surface: &Surfaces<L>,
        glass: L::Mask,
        incidence: &Incidence<L>,
        next: &mut Scattered<L>,
    ) {
        let one = L::Scalar::from_f64(1.0);
        let disperses = surface.disperses & !has(l, self.flags, flags::TERMINATED);
        let spreads = disperses.bits();
        let front = surface.front.bits();
        let cosines = array(l, incidence.cosine);
        let at = self.table_rows(l, surface.spectrum);
        let slot = Slot::Choice.at(l, self.depth);
        let variates = array(l, self.model.sequence.single(l, self.id, slot));
        let mut etas = [one; WIDEST];
        let mut refracts = 0;
        let mut ends = 0;
        for i in each(glass.bits()) {
            let slot = self.slots[i] as usize;
            let hero = self.rows.hero[slot] as usize % C;
            let eta = self.relative_indices(i, at[i], front >> i & 1 == 1);
            etas[i] = eta[hero];
            let mut reflectance = [fresnel::dielectric_reflectance(cosines[i], eta[hero]); C];
            let mut mean = reflectance[hero];
            if spreads >> i & 1 == 1 {
                let mut sum = L::Scalar::default();
                for c in 0..C {
                    reflectance[c] = fresnel::dielectric_reflectance(cosines[i], eta[c]);
                    sum = sum + reflectance[c];
                }
                mean = sum * L::Scalar::from_f64(1.0 / C as f64);
            }
            let mut factors = reflectance;
            if variates[i] < mean {
                for factor in &mut factors {
                    *factor = *factor / mean;
                }
            } else {
                refracts |= 1 << i;
                // Radiance changes by 1/η² (Veach 1997, section 5.2).
                let scale = one / ((one - mean) * eta[hero] * eta[hero]);
                for factor in &mut factors {
                    *factor = (one - *factor) * scale;
                }
                if spreads >> i & 1 == 1 {
                    // Secondary pdfs become 0, the hero's is divided by C.
                    ends |= 1 << i;
                    let carried = factors[hero] * L::Scalar::from_f64(C as f64);
                    factors = [L::Scalar::default(); C];
                    factors[hero] = carried;
                }
            }
            self.multiply(i, &factors);
        }
        self.flags = self.flags | bit_where(l, l.mask_from_bits(ends), flags::TERMINATED);
        let refracts = l.mask_from_bits(refracts);
        let eta = l.load(&etas);
        let (transmitted, _) = fresnel::dielectric(l, incidence.cosine, eta);
        let inverse = l.real(1.0) / eta;
        let refracted = incidence.direction.scale(inverse).along(
            incidence.facing,
            inverse.mul_add(incidence.cosine, -transmitted),
        );
        next.direction = Vec3::select(l, glass, incidence.mirrored, next.direction);
        next.direction = Vec3::select(l, refracts, refracted, next.direction);
        next.inward = (next.inward & !refracts) | (refracts & surface.front);
    }

    /// n_transmitted/n_incident at a lane's wavelengths, n linear between the grid's nodes.
    #[inline(always)]
    fn relative_indices(&self, i: usize, at: u32, entering: bool) -> [L::Scalar; C] {
        let fraction = self.rows.fraction[self.slots[i] as usize];
        let table = self.model.spectra.rows::<C>();
        let (low, high) = (table[at as usize], table[at as usize + 1]);
        let mut eta = low;
        for c in 0..C {
            let n = fraction.fused(high[c] - low[c], low[c]);
            eta[c] = if entering {
                n
            } else {
                L::Scalar::from_f64(1.0) / n
            };
        }
        eta
    }

    /// Ends paths with the probability that their throughput is lost anyway, and rewards the rest.
    #[inline(always)]
    fn roulette(&mut self, l: L, going: L::Mask) -> L::Mask {
        let late = going & !self.depth.plus(l.int(1)).below(l.int(ROULETTE_FROM));
        if !any(late) {
            return going;
        }
        let mut largest = [L::Scalar::default(); WIDEST];
        for i in each(late.bits()) {
            largest[i] = self.largest(i);
        }
        let largest = l.load(&largest);
        let one = l.real(1.0);
        let terminated = has(l, self.flags, flags::TERMINATED);
        let carried = l.select(terminated, l.real(1.0 / C as f64), one);
        let beyond = has(l, self.flags, flags::BEYOND);
        let share = l.select(beyond, l.real(BEYOND_SHARE), one);
        let survival = (largest * carried * share).min(l.real(LARGEST_SURVIVAL));
        let slot = Slot::Roulette.at(l, self.depth);
        let u = self.model.sequence.single(l, self.id, slot);
        let survives = late & u.lt(survival);
        let rewards = array(l, one / survival);
        for i in each(survives.bits()) {
            for value in &mut self.rows.throughput[self.slots[i] as usize] {
                *value = *value * rewards[i];
            }
        }
        going & (survives | !late)
    }
}
