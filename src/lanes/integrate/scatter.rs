//! How a packet of paths goes on from the surfaces it has met.

use super::bounce::Step;
use super::direct::Lit;
use super::intersect::Leaving;
use super::pool::{Carried, WIDEST, any, array, bit_where, each, flags, has};
use super::surface::{Surfaces, for_each_distinct};
use crate::material::diffuse::reflected;
use crate::material::{
    Event, Interface, Material, MaterialKind, Medium, NUMBERS, Transport, Variates, Wavelengths,
    each_material,
};
use crate::math::lanes::{Int, Lanes, Mask, Scalar};
use crate::math::vec3::Vec3;
use crate::sample::Slot;

/// A packet of surfaces, as a path sees them that has come there.
pub struct Meeting<'a, L: Lanes> {
    /// The surfaces.
    pub surface: &'a Surfaces<L>,
    /// Unit directions towards where the paths come from.
    pub wo: Vec3<L::Real>,
    /// Unit normals on that side.
    pub normal: Vec3<L::Real>,
    /// Lanes that go on from here.
    pub going: L::Mask,
}

impl<L: Lanes> Meeting<'_, L> {
    /// Lanes whose surfaces are of a material.
    #[inline(always)]
    pub fn of(&self, l: L, kind: MaterialKind) -> L::Mask {
        self.going & self.surface.kind.same(l.int(kind as u32))
    }

    /// The start of rays in directions on the side of wo, or across the surface.
    #[inline(always)]
    pub fn leaving(&self, across: L::Mask) -> Leaving<L> {
        let front = self.surface.front;
        Leaving {
            object: self.surface.object,
            inward: (front & across) | !(front | across),
        }
    }
}

impl<L: Lanes, const C: usize> Step<'_, L, C> {
    /// Whether the loop has a material at all.
    #[inline(always)]
    pub fn has<M: Material>(&self) -> bool {
        self.model.needs.materials.contains(M::KIND)
    }

    /// Samples the lights and the surfaces; throughput becomes that of the scattered rays.
    #[inline(always)]
    pub fn scatter(&mut self, l: L, meeting: &Meeting<'_, L>) -> Event<L> {
        let mut next = Event {
            pdf: l.real(0.0),
            ..Event::reflection(l, -meeting.wo)
        };
        let mut spread = l.mask(false);
        each_material!(M => if M::SPREAD && self.has::<M>() {
            spread = spread | meeting.of(l, M::KIND);
        });
        let mut direction = [l.real(0.0); 2];
        let mut lit = None;
        if any(spread) {
            (direction, lit) = self.light(l, meeting, spread);
        }
        each_material!(M => if (M::SPREAD || M::DELTA) && self.has::<M>() {
            let own = meeting.of(l, M::KIND);
            if any(own) {
                let event = if M::LAMBERTIAN {
                    self.reflect(l, own, meeting.surface.spectra[0], &lit);
                    reflected(l, meeting.normal, meeting.wo, direction)
                } else {
                    self.sample::<M>(l, meeting, (own, direction), &lit)
                };
                take::<L, M>(l, own, &event, &mut next);
            }
        });
        next
    }

    /// Direct light, where there are lights to be sampled, and the numbers for the directions.
    #[inline(always)]
    fn light(
        &mut self,
        l: L,
        meeting: &Meeting<'_, L>,
        spread: L::Mask,
    ) -> ([L::Real; 2], Option<Lit<L>>) {
        let sequence = &self.model.sequence;
        if self.model.lights.is_empty() {
            let numbers = sequence.pair(l, self.id, Slot::Bsdf, self.depth);
            return (numbers, None);
        }
        let slots = [Slot::Light, Slot::Bsdf];
        let [light, direction] = sequence.two_pairs(l, self.id, slots, self.depth);
        (direction, Some(self.direct(l, meeting, spread, light)))
    }

    /// Lambertian surfaces: multiplies the throughput by the albedo, which is bsdf · cos/pdf of the
    /// cosine-distributed direction at every wavelength, and adds the light that came that way from
    /// a sampled light.
    #[inline(always)]
    fn reflect(&mut self, l: L, m: L::Mask, albedo: L::Int, lit: &Option<Lit<L>>) {
        let albedos = self.table_rows(l, albedo);
        let table = self.model.spectra.rows::<C>();
        let Some(lit) = lit else {
            let paths = self.rows.paths.as_mut_slice();
            for i in each(m.bits()) {
                let albedo = &table[albedos[i % WIDEST] as usize];
                paths[self.slots[i % WIDEST] as usize].weigh(albedo);
            }
            return;
        };
        let emissions = self.table_rows(l, lit.spectrum);
        let weights = array(l, lit.weight);
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

    /// Surfaces of any other material: adds the light that came by way of the part that is not
    /// delta, then goes on in a direction of the material's choice.
    #[inline(always)]
    fn sample<M: Material>(
        &mut self,
        l: L,
        meeting: &Meeting<'_, L>,
        (own, direction): (L::Mask, [L::Real; 2]),
        lit: &Option<Lit<L>>,
    ) -> Event<L> {
        if M::SPREAD
            && let Some(lit) = lit
        {
            self.add_lit::<M>(l, meeting, own, lit);
        }
        let choice = if M::CHOOSES {
            let sequence = &self.model.sequence;
            sequence.single(l, self.id, Slot::Choice, self.depth)
        } else {
            l.real(0.0)
        };
        let slots = self.slots;
        let (at, paths) = self.interface::<M>(l, meeting, own);
        let event = M::sample(
            l,
            &at,
            meeting.wo,
            Transport::Radiance,
            Variates { choice, direction },
            #[inline(always)]
            |i, weight| paths[slots[i] as usize].weigh(weight),
        );
        if M::REFRACTS {
            self.flags = self.flags | bit_where(l, event.ends, flags::TERMINATED);
        }
        event
    }

    /// Adds what came from the sampled lights by way of a material's part that is not delta.
    #[inline(always)]
    fn add_lit<M: Material>(&mut self, l: L, meeting: &Meeting<'_, L>, own: L::Mask, lit: &Lit<L>) {
        let arrives = own & lit.arrives;
        let emissions = self.table_rows(l, lit.spectrum);
        let weights = array(l, lit.weight);
        let slots = self.slots;
        let (at, paths) = self.interface::<M>(l, meeting, arrives);
        let table = at.wavelengths.bank;
        M::evaluate(
            l,
            &at,
            [meeting.wo, lit.direction],
            Transport::Radiance,
            #[inline(always)]
            |i, value| {
                let emission = &table[emissions[i] as usize];
                paths[slots[i] as usize].receive(weights[i], value, emission);
            },
        );
    }

    /// What a material sees of surfaces, and the paths.
    #[inline(always)]
    pub fn interface<M: Material>(
        &mut self,
        l: L,
        meeting: &Meeting<'_, L>,
        lanes: L::Mask,
    ) -> (Interface<'_, L, C>, &mut [Carried<L::Scalar, C>]) {
        let surface = meeting.surface;
        let [n, k] = surface.spectra;
        let rows = &mut *self.rows;
        let mut at = Interface {
            lanes,
            geometric: meeting.normal,
            shading: meeting.normal,
            front: surface.front,
            outside: Medium::Vacuum,
            inside: if M::REFRACTS {
                Medium::Index([n, k])
            } else {
                Medium::Vacuum
            },
            disperses: surface.disperses,
            spectra: surface.spectra,
            numbers: [l.real(0.0); NUMBERS],
            wavelengths: Wavelengths {
                bank: self.model.spectra.rows::<C>(),
                row: self.row,
                slots: &self.slots,
                hero: &rows.hero,
                fraction: &rows.fraction,
                ended: has(l, self.flags, flags::TERMINATED),
            },
            #[cfg(feature = "planted")]
            planted: self.model.planted,
        };
        if M::NUMBERED {
            for_each_distinct(
                l,
                surface.object,
                lanes,
                #[inline(always)]
                |k, here| {
                    let own = &self.model.appearances[k as usize].surface.numbers;
                    for (number, own) in at.numbers.iter_mut().zip(own) {
                        *number = l.select(here, l.splat(*own), *number);
                    }
                },
            );
        }
        (at, &mut rows.paths)
    }
}

/// Takes the lanes of a material's event over into the whole packet's.
#[inline(always)]
fn take<L: Lanes, M: Material>(l: L, own: L::Mask, event: &Event<L>, next: &mut Event<L>) {
    next.direction = Vec3::select(l, own, event.direction, next.direction);
    next.transmitted = (next.transmitted & !own) | (event.transmitted & own);
    // The loop has no use for the probabilities of delta events.
    if M::SPREAD {
        next.pdf = l.select(own, event.pdf, next.pdf);
        next.delta = next.delta & !(own & !event.delta);
    }
}
