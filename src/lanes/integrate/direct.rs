//! Direct light: one light a lane chosen, a point of it sampled, the way there tested, and the share
//! that scattered rays find by themselves taken off.

use super::bounce::{Step, some_object};
use super::intersect::{Leaving, NOTHING, Shadow, lane_vector, occluded};
use super::pool::{WIDEST, any, array, each};
use super::replay::LightVertex;
use crate::light::Towards;
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar};
use crate::math::lookup::SMALL;
use crate::math::vec3::Vec3;
use crate::sample::Slot;
use crate::sample::warp::cosine_hemisphere_pdf;
use crate::shape::lanes::LaneRay;

/// Where light is received.
#[derive(Clone, Copy)]
pub struct Receiver<L: Lanes> {
    /// Points.
    pub point: Vec3<L::Real>,
    /// Unit normals on the side that scatters.
    pub normal: Vec3<L::Real>,
    /// The surfaces' objects, and whether the scattering side is their inside.
    pub leaving: Leaving<L>,
}

/// What arrives from sampled lights.
pub struct Lit<L: Lanes> {
    /// Spectrum of the light.
    pub spectrum: L::Int,
    /// What its spectrum is multiplied with beside throughput and albedo; 0 where it is hidden.
    pub weight: L::Real,
}

/// Points of lights, one a lane.
struct Sampled<L: Lanes> {
    /// How they are seen; the density contains the probability of the light.
    towards: Towards<L>,
    /// Spectra of the lights.
    spectrum: L::Int,
    /// Their objects.
    object: L::Int,
    /// Scattered rays can hit them.
    extended: L::Mask,
}

impl<L: Lanes, const C: usize> Step<'_, L, C> {
    /// Next-event estimation: what arrives from one light a lane.
    #[inline(always)]
    pub fn direct(
        &mut self,
        l: L,
        receiver: &Receiver<L>,
        m: L::Mask,
        numbers: [L::Real; 2],
    ) -> Lit<L> {
        let zero = l.real(0.0);
        let light = self.sample_lights(l, receiver, m, numbers);
        let cosine = light.towards.direction.dot(receiver.normal);
        // With q the ratio of the densities, the power heuristic is 1/(1 + q²) (see `sample::mis`),
        // and bsdf · cos/pdf is q times the albedo.
        let ratio = cosine_hemisphere_pdf(l, cosine) / light.towards.pdf;
        let shared = ratio / ratio.mul_add(ratio, l.real(1.0));
        let weight = l.select(light.extended, shared, ratio);
        #[cfg(feature = "planted")]
        let weight = super::planted::light_weight(l, self.model.planted, weight, cosine);
        let asked = m & light.towards.valid & cosine.gt(zero) & weight.gt(zero);
        let arrives = self.arrives(l, receiver, &light, asked, weight);
        Lit {
            spectrum: light.spectrum,
            weight: l.select(arrives, weight, zero),
        }
    }

    /// Chooses a light for each lane of `m` and a point of it.
    #[inline(always)]
    fn sample_lights(
        &self,
        l: L,
        receiver: &Receiver<L>,
        m: L::Mask,
        [u, v]: [L::Real; 2],
    ) -> Sampled<L> {
        let (chosen, u) = self.choose_light(l, u, m);
        let numbers = [u, v];
        let zero = l.real(0.0);
        let mut sampled = Sampled {
            towards: Towards {
                direction: receiver.normal,
                distance: zero,
                pdf: zero,
                valid: l.mask(false),
            },
            spectrum: l.int(0),
            object: l.int(NOTHING),
            extended: l.mask(true),
        };
        let left = self.sample_spheres(l, receiver, (chosen, m), numbers, &mut sampled);
        let mut pending = left.bits();
        while pending != 0 {
            let k = l.int_lane(chosen, pending.trailing_zeros() as usize);
            let here = m & chosen.same(l.int(k));
            pending &= !here.bits();
            self.sample_light(l, receiver, (k, here), numbers, &mut sampled);
        }
        sampled
    }

    /// Samples spheres, where several are among the lights, all at once; what is left is returned.
    #[inline(always)]
    fn sample_spheres(
        &self,
        l: L,
        receiver: &Receiver<L>,
        (chosen, m): (L::Int, L::Mask),
        numbers: [L::Real; 2],
        sampled: &mut Sampled<L>,
    ) -> L::Mask {
        let Some(table) = &self.model.small_lights else {
            return m;
        };
        let spheres = m & l.lookup_int(&table.is_sphere, chosen).same(l.int(1));
        if !any(spheres) {
            return m;
        }
        let lights = table.spheres.at(l, chosen);
        let own = lights.sample(l, receiver.point, numbers, spheres);
        sampled.towards = Towards {
            pdf: own.pdf * l.lookup(&table.probability, chosen),
            valid: spheres & own.valid,
            ..own
        };
        sampled.spectrum = l.lookup_int(&table.spectrum, chosen);
        sampled.object = l.lookup_int(&table.object, chosen);
        m & !spheres
    }

    /// Samples light `k` for the lanes in `here`.
    #[inline(always)]
    fn sample_light(
        &self,
        l: L,
        receiver: &Receiver<L>,
        (k, here): (u32, L::Mask),
        numbers: [L::Real; 2],
        sampled: &mut Sampled<L>,
    ) {
        let light = &self.model.lights[k as usize];
        let own = light.shape.sample(l, receiver.point, numbers);
        let pdf = own.pdf * l.splat(light.probability);
        let mut valid = here & own.valid;
        if light.shape.is_flat() {
            valid = valid & !receiver.leaving.object.same(l.int(light.object));
        }
        let towards = &mut sampled.towards;
        towards.direction = Vec3::select(l, here, own.direction, towards.direction);
        towards.distance = l.select(here, own.distance, towards.distance);
        towards.pdf = l.select(here, pdf, towards.pdf);
        towards.valid = towards.valid | valid;
        sampled.spectrum = l.select_int(here, l.int(light.spectrum), sampled.spectrum);
        sampled.object = l.select_int(here, l.int(light.object), sampled.object);
        if !light.shape.has_extent() {
            sampled.extended = sampled.extended & !here;
        }
    }

    /// Where nothing stands between receiver and light, of the lanes that ask.
    #[inline(always)]
    fn arrives(
        &mut self,
        l: L,
        receiver: &Receiver<L>,
        light: &Sampled<L>,
        asked: L::Mask,
        weight: L::Real,
    ) -> L::Mask {
        if !any(asked) {
            return asked;
        }
        let Towards {
            direction,
            distance,
            ..
        } = light.towards;
        let shadow = Shadow {
            ray: LaneRay::new(l, receiver.point, direction),
            limit: distance,
            except: light.object,
        };
        let leaving = &receiver.leaving;
        let blocked = occluded(l, self.model, &shadow, leaving, asked, self.rungs);
        if let Some(vertex) = &mut self.vertex
            && asked.bits() & 1 == 1
        {
            vertex.light = Some(LightVertex {
                object: some_object(l.int_lane(light.object, 0)),
                direction: lane_vector(l, direction, 0),
                distance: l.lane(distance, 0).to_f64(),
                weight: l.lane(weight, 0).to_f64(),
                blocked: blocked.bits() & 1 == 1,
            });
        }
        asked & !blocked
    }

    /// The number of each lane's light, by the lights' probabilities, and a number for its point:
    /// of few lights u chooses, stretched afterwards from the share of [0, 1) that belongs to the
    /// light over all of it; a number of its own, searched for, among many.
    #[inline(always)]
    fn choose_light(&self, l: L, u: L::Real, m: L::Mask) -> (L::Int, L::Real) {
        let mut chosen = l.int(0);
        let [first, others @ ..] = self.model.lights.as_slice() else {
            return (chosen, u);
        };
        if others.is_empty() {
            return (chosen, u);
        }
        if others.len() >= SMALL {
            return (self.choose_among_many(l, m), u);
        }
        let mut below = l.splat(first.below);
        let mut probability = l.splat(first.probability);
        for (k, light) in others.iter().enumerate() {
            let here = u.ge(l.splat(light.below));
            chosen = l.select_int(here, l.int(k as u32 + 1), chosen);
            below = l.select(here, l.splat(light.below), below);
            probability = l.select(here, l.splat(light.probability), probability);
        }
        let largest = 1.0 - 1.0 / (1u64 << L::UNIFORM_BITS) as f64;
        let stretched = ((u - below) / probability).min(l.real(largest));
        (chosen, stretched)
    }

    /// The number of each lane's light where a share of the numbers' digits would be too coarse for
    /// its point, and looking at every light too slow.
    #[inline(never)]
    fn choose_among_many(&self, l: L, m: L::Mask) -> L::Int {
        let sequence = &self.model.sequence;
        let variates = array(l, sequence.single(l, self.id, Slot::Choice, self.depth));
        let lights = &self.model.lights;
        let mut chosen = [0; WIDEST];
        for i in each(m.bits()) {
            let later = lights.partition_point(|light| light.below <= variates[i % WIDEST]);
            chosen[i % WIDEST] = later.saturating_sub(1) as u32;
        }
        l.load_int(&chosen)
    }
}
