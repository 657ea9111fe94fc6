//! Direct light: one light a lane chosen, a point of it sampled, the way there tested, and the share
//! that scattered rays find by themselves taken off.

use super::bounce::{Step, some_object};
use super::intersect::{NOTHING, Rays, Shadow, lane_vector, occluded};
use super::model::Model;
use super::pool::{WIDEST, array, each};
use super::replay::LightVertex;
use super::scatter::{Meeting, Question};
use super::surface::Distinct;
use crate::light::Towards;
use crate::material::{Material, Transport, each_material};
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar};
use crate::math::lookup::SMALL;
use crate::math::vec3::Vec3;
use crate::planted::light_weight;
use crate::sample::Slot;
use crate::sample::mis::power_weight;
use crate::sample::sequence::Identity;
use crate::sample::warp::cosine_hemisphere_pdf;
use crate::shape::lanes::LaneRay;

/// What arrives from sampled lights.
pub struct Lit<L: Lanes> {
    /// Lanes in which some does.
    pub arrives: L::Mask,
    /// Where the light's spectrum stands in the bank.
    pub spectrum: L::Int,
    /// What its spectrum is multiplied with beside throughput and bsdf, or albedo where the material
    /// is Lambertian; 0 where it is hidden.
    pub weight: L::Real,
}

/// Points of lights, one a lane.
pub struct Sampled<L: Lanes> {
    /// How they are seen; the density contains the probability of the light.
    pub towards: Towards<L>,
    /// Where the lights' spectra stand in the bank.
    pub spectrum: L::Int,
    pub object: L::Int,
    /// Scattered rays can hit them.
    pub extended: L::Mask,
}

impl<L: Lanes> Sampled<L> {
    /// The weight of light that a material evaluates: |cos| · mis weight/pdf, where `pdf` is the
    /// density with which the material would choose the direction.
    #[inline(always)]
    pub fn weight(&self, l: L, cosine: L::Real, pdf: L::Real) -> L::Real {
        let share = power_weight(l, self.towards.pdf, pdf);
        let share = l.select(self.extended, share, l.real(1.0));
        cosine.abs() * share / self.towards.pdf
    }

    /// The same for Lambertian surfaces, beside the albedo: with q the ratio of the densities, the
    /// power heuristic is 1/(1 + q²), and bsdf · cos/pdf is q times the albedo.
    #[inline(always)]
    pub fn lambertian_weight(&self, l: L, cosine: L::Real) -> L::Real {
        let ratio = cosine_hemisphere_pdf(l, cosine) / self.towards.pdf;
        let shared = ratio / ratio.mul_add(ratio, l.real(1.0));
        l.select(self.extended, shared, ratio)
    }
}

impl<L: Lanes, const C: usize> Step<'_, L, C> {
    /// Next-event estimation: what arrives from one light a lane.
    #[inline(always)]
    pub fn direct(
        &mut self,
        l: L,
        meeting: &Meeting<'_, L>,
        m: L::Mask,
        numbers: [L::Real; 2],
    ) -> Lit<L> {
        let zero = l.real(0.0);
        let light = self.sample_lights(l, meeting, m, numbers);
        let direction = light.towards.direction;
        let cosine = direction.dot(meeting.normal);
        let weight = light.lambertian_weight(l, cosine);
        let mut weight = light_weight(l, self.model.planted, weight, cosine);
        let kinds = self.model.needs.materials;
        let mut scatters = cosine.gt(zero);
        let mut across = l.mask(false);
        each_material!(M, KIND => if M::SPREAD && !M::LAMBERTIAN && kinds.contains(KIND) {
            let own = m & meeting.of(l, KIND);
            if own.any() {
                let Question { at, values, .. } = self.question::<M>(l, meeting, own);
                let densities = M::evaluate(
                    l,
                    &at,
                    [meeting.wo, direction],
                    Transport::Radiance,
                    #[inline(always)]
                    |i, value| values[i] = *value,
                );
                weight = l.select(own, light.weight(l, cosine, densities.pdf), weight);
                if M::REFRACTS {
                    scatters = scatters | (own & densities.pdf.gt(zero));
                    across = across | (own & cosine.lt(zero));
                }
            }
        });
        let asked = m & light.towards.valid & scatters & weight.gt(zero);
        let mut arrives = asked;
        if asked.any() {
            let shadow = Shadow {
                rays: Rays {
                    ray: LaneRay::new(l, meeting.surface.point, direction),
                    leaving: meeting.surface.object,
                    inward: meeting.inward(across),
                },
                limit: light.towards.distance,
                except: light.object,
            };
            arrives = self.arrives(l, &shadow, asked, weight);
        }
        Lit {
            arrives,
            spectrum: light.spectrum,
            weight: l.select(arrives, weight, zero),
        }
    }

    /// Chooses a light for each lane of `m` and a point of it.
    #[inline(always)]
    fn sample_lights(
        &self,
        l: L,
        meeting: &Meeting<'_, L>,
        m: L::Mask,
        [u, v]: [L::Real; 2],
    ) -> Sampled<L> {
        let (chosen, u) = self.choose_light(l, u, m);
        let numbers = [u, v];
        let zero = l.real(0.0);
        let mut sampled = Sampled {
            towards: Towards {
                direction: meeting.normal,
                distance: zero,
                pdf: zero,
                valid: l.mask(false),
            },
            spectrum: l.int(0),
            object: l.int(NOTHING),
            extended: l.mask(true),
        };
        let left = self.sample_spheres(l, meeting, (chosen, m), numbers, &mut sampled);
        for (k, here) in Distinct::new(l, chosen, left) {
            self.sample_light(l, meeting, (k, here), numbers, &mut sampled);
        }
        sampled
    }

    /// Samples spheres, where several are among the lights, all at once; what is left is returned.
    #[inline(always)]
    fn sample_spheres(
        &self,
        l: L,
        meeting: &Meeting<'_, L>,
        (chosen, m): (L::Int, L::Mask),
        numbers: [L::Real; 2],
        sampled: &mut Sampled<L>,
    ) -> L::Mask {
        let Some(table) = &self.model.small_lights else {
            return m;
        };
        let spheres = m & l.lookup_int(&table.is_sphere, chosen).same(l.int(1));
        if !spheres.any() {
            return m;
        }
        let lights = table.spheres.at(l, chosen);
        let own = lights.sample(l, meeting.surface.point, numbers, spheres);
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
        meeting: &Meeting<'_, L>,
        (k, here): (u32, L::Mask),
        numbers: [L::Real; 2],
        sampled: &mut Sampled<L>,
    ) {
        let light = &self.model.lights[k as usize];
        let own = light.shape.sample(l, meeting.surface.point, numbers);
        let pdf = own.pdf * l.splat(light.probability);
        let mut valid = here & own.valid;
        if light.shape.is_flat() {
            valid = valid & !meeting.surface.object.same(l.int(light.object));
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

    /// Where nothing stands between a surface and its light, of the lanes that ask.
    #[inline(always)]
    fn arrives(&mut self, l: L, shadow: &Shadow<L>, asked: L::Mask, weight: L::Real) -> L::Mask {
        let tiers = &mut self.workspace.tiers;
        let blocked = occluded(l, self.model, shadow, asked, tiers);
        if asked.bits() & 1 == 1
            && let Some(vertex) = self.vertex()
        {
            vertex.light = Some(LightVertex {
                object: some_object(l.int_lane(shadow.except, 0)),
                direction: lane_vector(l, shadow.rays.ray.direction, 0),
                distance: l.lane(shadow.limit, 0).to_f64(),
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
            return (choose_among_many(l, self.model, self.paths.id, m), u);
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
}

/// The number of each lane's light where a share of the numbers' digits would be too coarse for its
/// point, and looking at every light too slow.
#[inline(never)]
fn choose_among_many<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    id: Identity<L>,
    m: L::Mask,
) -> L::Int {
    let variates = array(l, model.sequence.single(l, id, Slot::Choice));
    let mut chosen = [0; WIDEST];
    for i in each(m.bits()) {
        let lights = &model.lights;
        let later = lights.partition_point(|light| light.below <= variates[i % WIDEST]);
        chosen[i % WIDEST] = later.saturating_sub(1) as u32;
    }
    l.load_int(&chosen)
}
