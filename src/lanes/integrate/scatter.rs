//! How a packet of paths goes on from the surfaces it has met.

use super::bounce::Step;
use super::chunk::Workspace;
use super::direct::Lit;
use super::pool::{Carried, WIDEST, array, bit_where, each, flags, has};
use super::surface::{Distinct, Surfaces};
use crate::material::diffuse::reflected;
use crate::material::{
    Event, Interface, Material, MaterialKind, Medium, NUMBERS, Transport, Variates, Wavelengths,
    each_material,
};
use crate::math::lanes::{Int, Lanes, Mask, Scalar};
use crate::math::vec3::Vec3;
use crate::sample::Slot;

/// A packet of surfaces, seen from the side on which paths arrive.
pub struct Meeting<'a, L: Lanes> {
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

    /// Whether rays go into the object, those that cross its surface and the others.
    #[inline(always)]
    pub fn inward(&self, across: L::Mask) -> L::Mask {
        let front = self.surface.front;
        (front & across) | !(front | across)
    }
}

/// What a material is asked about, and where its answers go.
pub struct Question<'a, L: Lanes, const C: usize> {
    pub at: Interface<'a, L, C>,
    /// Throughputs and radiances.
    pub paths: &'a mut [Carried<L::Scalar, C>],
    /// [`Workspace::values`](super::chunk::Workspace).
    pub values: &'a mut [[L::Scalar; C]; WIDEST],
}

/// The rays with which paths go on.
pub struct Scattered<L: Lanes> {
    /// Unit directions.
    pub direction: Vec3<L::Real>,
    /// Their densities, sr⁻¹.
    pub pdf: L::Real,
    /// The direction was the only one possible.
    pub specular: L::Mask,
    /// The ray goes into the object.
    pub inward: L::Mask,
}

impl<L: Lanes> Scattered<L> {
    /// Takes over the events of a material.
    #[inline(always)]
    fn take<M: Material>(
        &mut self,
        l: L,
        meeting: &Meeting<'_, L>,
        own: L::Mask,
        event: &Event<L>,
    ) {
        self.direction = Vec3::select(l, own, event.direction, self.direction);
        // The loop has no use for the probabilities of delta events.
        if M::SPREAD {
            self.pdf = l.select(own, event.pdf, self.pdf);
            self.specular = self.specular & !(own & !event.delta);
        }
        if M::REFRACTS {
            self.inward = (self.inward & !own) | (meeting.inward(event.transmitted) & own);
        }
    }
}

impl<L: Lanes, const C: usize> Step<'_, L, C> {
    /// Samples the lights and the surfaces; throughput becomes that of the scattered rays.
    #[inline(always)]
    pub fn scatter(&mut self, l: L, meeting: &Meeting<'_, L>) -> Scattered<L> {
        let mut next = Scattered {
            direction: meeting.wo,
            pdf: l.real(0.0),
            specular: l.mask(true),
            inward: !meeting.surface.front,
        };
        let kinds = self.model.needs.materials;
        let mut spread = l.mask(false);
        each_material!(M, KIND => if M::SPREAD && kinds.contains(KIND) {
            spread = spread | meeting.of(l, KIND);
        });
        let (mut direction, mut lit) = ([l.real(0.0); 2], None);
        if spread.any() {
            let (sequence, id) = (&self.model.sequence, self.paths.id);
            if self.model.lights.is_empty() {
                direction = sequence.pair(l, id, Slot::Bsdf);
            } else {
                let [light, bsdf] = sequence.light_and_bsdf(l, id);
                direction = bsdf;
                lit = Some(self.direct(l, meeting, spread, light));
            }
        }
        each_material!(M, KIND => if (M::SPREAD || M::DELTA) && kinds.contains(KIND) {
            let own = meeting.of(l, KIND);
            if own.any() {
                let event = if M::LAMBERTIAN {
                    self.reflect(l, own, meeting.surface.spectra[0], &lit);
                    reflected(l, meeting.normal, meeting.wo, direction)
                } else {
                    self.sample::<M>(l, meeting, (own, direction), &lit)
                };
                next.take::<M>(l, meeting, own, &event);
            }
        });
        next
    }

    /// Lambertian surfaces: multiplies the throughput by the albedo, which is bsdf · cos/pdf of the
    /// cosine-distributed direction at every wavelength, and adds the light that came that way from
    /// a sampled light.
    #[inline(always)]
    fn reflect(&mut self, l: L, m: L::Mask, albedo: L::Int, lit: &Option<Lit<L>>) {
        let albedos = self.table_rows(l, albedo);
        let table = self.model.spectra.rows::<C>();
        let Some(lit) = lit else {
            let paths = self.workspace.rows.paths.as_mut_slice();
            for i in each(m.bits()) {
                let albedo = &table[albedos[i % WIDEST] as usize];
                paths[self.slots[i % WIDEST] as usize].weigh(albedo);
            }
            return;
        };
        let emissions = self.table_rows(l, lit.spectrum);
        let weights = array(l, lit.weight);
        let paths = self.workspace.rows.paths.as_mut_slice();
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
            self.receive(l, own, lit);
        }
        let choice = if M::CHOOSES {
            let sequence = &self.model.sequence;
            sequence.single(l, self.paths.id, Slot::Choice)
        } else {
            l.real(0.0)
        };
        let slots = self.slots;
        let Question { at, paths, .. } = self.question::<M>(l, meeting, own);
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
            self.paths.flags = self.paths.flags | bit_where(l, event.ends, flags::TERMINATED);
        }
        event
    }

    /// Adds what came from the sampled lights by way of the part that is not delta.
    #[inline(always)]
    fn receive(&mut self, l: L, own: L::Mask, lit: &Lit<L>) {
        let emissions = self.table_rows(l, lit.spectrum);
        let weights = array(l, lit.weight);
        let table = self.model.spectra.rows::<C>();
        let Workspace { rows, values, .. } = &mut *self.workspace;
        for i in each((own & lit.arrives).bits()) {
            let path = &mut rows.paths[self.slots[i] as usize];
            path.receive(weights[i], &values[i], &table[emissions[i] as usize]);
        }
    }

    /// What a material is asked about in the given lanes.
    #[inline(always)]
    pub fn question<M: Material>(
        &mut self,
        l: L,
        meeting: &Meeting<'_, L>,
        lanes: L::Mask,
    ) -> Question<'_, L, C> {
        let surface = meeting.surface;
        let [n, k] = surface.spectra;
        let Workspace { rows, values, .. } = &mut *self.workspace;
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
                row: self.paths.row,
                slots: &self.slots,
                hero: &rows.hero,
                fraction: &rows.fraction,
                ended: has(l, self.paths.flags, flags::TERMINATED),
            },
            planted: self.model.planted,
        };
        if M::NUMBERED {
            for (k, here) in Distinct::new(l, surface.object, lanes) {
                let own = &self.model.appearances[k as usize].surface.numbers;
                for (number, own) in at.numbers.iter_mut().zip(own) {
                    *number = l.select(here, l.splat(*own), *number);
                }
            }
        }
        Question {
            at,
            paths: &mut rows.paths,
            values,
        }
    }
}
