//! How a packet of paths goes on from the surfaces it has met.

use super::bounce::Step;
use super::direct::{Lit, Receiver};
use super::intersect::Leaving;
use super::pool::{WIDEST, any, array, bit_where, each, flags, has};
use super::surface::Surfaces;
use crate::material::{MaterialKind, fresnel};
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar, inlined};
use crate::math::vec3::Vec3;
use crate::sample::Slot;
use crate::sample::warp::{cosine_hemisphere, cosine_hemisphere_pdf};
use crate::shape::lanes::LaneRay;

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
pub struct Scattered<L: Lanes> {
    /// Unit direction.
    pub direction: Vec3<L::Real>,
    /// Its density, sr⁻¹.
    pub pdf: L::Real,
    /// It had no alternative.
    pub specular: L::Mask,
    /// It goes into the object.
    pub inward: L::Mask,
}

impl<L: Lanes, const C: usize> Step<'_, L, C> {
    /// Samples the lights and the surface; throughput becomes that of the scattered ray.
    #[inline(always)]
    pub fn scatter(
        &mut self,
        l: L,
        ray: &LaneRay<L>,
        surface: &Surfaces<L>,
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
            |kind: MaterialKind| going & surface.kind.same(l.int(kind as u32)),
        );
        if needs.diffuse {
            let diffuse = kind(MaterialKind::Diffuse);
            if any(diffuse) {
                self.diffuse(l, surface, diffuse, &mut next);
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
            let conductor = kind(MaterialKind::Conductor);
            self.conductor(l, surface, cosine, conductor);
            next.direction = Vec3::select(l, conductor, mirrored, next.direction);
        }
        if needs.ideal_mirror {
            let mirror = kind(MaterialKind::Mirror);
            self.multiply_by(l, mirror, surface.spectra[0]);
            next.direction = Vec3::select(l, mirror, mirrored, next.direction);
        }
        if needs.glass {
            let glass = kind(MaterialKind::Glass);
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
            self.table_rows(l, surface.spectra[0]),
            self.table_rows(l, surface.spectra[1]),
        );
        let table = self.model.spectra.rows::<C>();
        let cosines = array(l, cosine);
        #[cfg(not(feature = "planted"))]
        let reflected = fresnel::conductor::<L::Scalar>;
        #[cfg(feature = "planted")]
        let reflected = super::planted::reflectance(self.model.planted);
        for i in each(m.bits()) {
            let n = table[indices[i] as usize];
            let k = table[extinctions[i] as usize];
            let mut reflectance = n;
            for c in 0..C {
                reflectance[c] = reflected(cosines[i], n[c], k[c]);
            }
            self.multiply(i, &reflectance);
        }
    }

    /// Lambertian reflection: one light, one cosine-distributed direction.
    #[inline(always)]
    fn diffuse(&mut self, l: L, surface: &Surfaces<L>, diffuse: L::Mask, next: &mut Scattered<L>) {
        let normal = Vec3::select(l, surface.front, surface.normal, -surface.normal);
        let sequence = &self.model.sequence;
        let [u, v] = if self.model.lights.is_empty() {
            self.multiply_by(l, diffuse, surface.spectra[0]);
            sequence.pair(l, self.id, Slot::Bsdf, self.depth)
        } else {
            let [light, bsdf] =
                sequence.two_pairs(l, self.id, [Slot::Light, Slot::Bsdf], self.depth);
            let receiver = Receiver {
                point: surface.point,
                normal,
                leaving: Leaving {
                    object: surface.object,
                    inward: next.inward,
                },
            };
            let lit = self.direct(l, &receiver, diffuse, light);
            self.reflect(l, diffuse, surface.spectra[0], &lit);
            bsdf
        };
        let local = cosine_hemisphere(l, u, v);
        let (s, t) = normal.frame(l);
        let direction = normal.scale(local.z).along(s, local.x).along(t, local.y);
        next.direction = Vec3::select(l, diffuse, direction, next.direction);
        next.pdf = l.select(diffuse, cosine_hemisphere_pdf(l, local.z), next.pdf);
        next.specular = next.specular & !diffuse;
    }

    /// Multiplies the throughput by the albedo, which is bsdf · cos / pdf of the cosine-distributed
    /// direction at every wavelength, and adds the light that came that way from a sampled light.
    #[inline(always)]
    fn reflect(&mut self, l: L, m: L::Mask, albedo: L::Int, lit: &Lit<L>) {
        let (albedos, emissions) = (self.table_rows(l, albedo), self.table_rows(l, lit.spectrum));
        let weights = array(l, lit.weight);
        let table = self.model.spectra.rows::<C>();
        let paths = self.rows.paths.as_mut_slice();
        for i in each(m.bits()) {
            let slot = self.slots[i % WIDEST] as usize;
            // Copies: arrays that cannot overlap become vectors.
            let (albedo, emission) = (
                table[albedos[i % WIDEST] as usize],
                table[emissions[i % WIDEST] as usize],
            );
            let path = &mut paths[slot];
            let mut carried = *path;
            let weight = weights[i % WIDEST];
            for c in 0..C {
                let throughput = carried.throughput[c] * albedo[c];
                carried.throughput[c] = throughput;
                carried.radiance[c] = (throughput * weight).fused(emission[c], carried.radiance[c]);
            }
            *path = carried;
        }
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
        let at = self.table_rows(l, surface.spectra[0]);
        let variates = self
            .model
            .sequence
            .single(l, self.id, Slot::Choice, self.depth);
        let variates = array(l, variates);
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
}
