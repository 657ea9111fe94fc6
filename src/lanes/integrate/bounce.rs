//! One segment of every path: find the surface, take its light, sample the lights, scatter.

use super::chunk::{CHUNK, Workspace};
use super::intersect::{Leaving, NOTHING, Rungs, lane_vector, nearest};
use super::model::Model;
use super::parts::word;
use super::pool::{
    Carried, IntField, Pool, RealField, Rows, WIDEST, any, array, bit_where, each, flags, has,
    int_array,
};
use super::replay::{ScatteredVertex, Vertex};
use super::scatter::{Meeting, Scattered};
use super::surface::{Arrival, Surfaces, surfaces};
use crate::material::MaterialKind;
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar};
use crate::math::vec3::Vec3;
use crate::sample::Slot;
use crate::sample::sequence::Identity;
use crate::shape::lanes::LaneRay;

/// Segments after which Russian roulette may end a path.
const ROULETTE_FROM: u32 = 5;
/// Largest chance of going on: a path of lossless surfaces still ends, after 20 more segments in
/// the mean.
const LARGEST_SURVIVAL: f64 = 0.95;
/// Share of the paths at `max_depth` that go on to measure what it cuts off.
pub const BEYOND_SHARE: f64 = 1.0 / 16.0;

/// A packet of paths on its way through the step.
pub struct Step<'a, L: Lanes, const C: usize> {
    /// The scene's tables.
    pub model: &'a Model<L::Scalar>,
    /// Spectra by sample.
    pub rows: &'a mut Rows<L::Scalar, C>,
    /// Which arithmetic decided.
    pub rungs: &'a mut Rungs,
    /// Rows of the paths that go on beyond `max_depth`.
    pub beyond_slots: &'a mut Vec<u32>,
    /// The bsdf of each lane towards the sampled light, where the material is not Lambertian.
    pub values: &'a mut [[L::Scalar; C]; WIDEST],
    /// The vertex being written down, of lane 0.
    pub vertex: Option<&'a mut Vertex>,
    /// Where the spectra of each lane are.
    pub slots: [u32; WIDEST],
    /// Which row of every table holds the wavelengths.
    pub row: L::Int,
    /// Bits of [`flags`].
    pub flags: L::Int,
    /// Segments traced before this one.
    pub depth: L::Int,
    /// Which random numbers are theirs.
    pub id: Identity<L>,
}

/// Where in the pool a packet stands, and where its survivors go.
#[derive(Debug, Clone, Copy)]
pub struct Places {
    pub at: usize,
    /// Its survivors, not after it.
    pub to: usize,
}

/// Advances a packet by one segment and returns how many of its paths go on.
#[inline(always)]
pub fn bounce<L: Lanes, const C: usize>(
    l: L,
    model: &Model<L::Scalar>,
    workspace: &mut Workspace<L::Scalar, C>,
    Places { at, to }: Places,
) -> usize {
    let Workspace {
        pool,
        rows,
        beyond_slots,
        rungs,
        values,
        trace,
        ..
    } = workspace;
    let active = l.mask_from_bits(pool.active::<L>(at));
    let ray = LaneRay::<L>::new(
        l,
        vector(l, pool, RealField::Origin, at),
        vector(l, pool, RealField::Direction, at),
    );
    let mut step = Step::<L, C> {
        model,
        rows,
        rungs,
        beyond_slots,
        values,
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
    let arrival = Arrival {
        ray: &ray,
        leaving: &leaving,
        nearest: nearest(l, model, &ray, &leaving, active, step.rungs),
        pdf: pool.real(l, RealField::Pdf, 0, at),
        specular: has(l, step.flags, flags::SPECULAR),
    };
    let hit = active & !arrival.nearest.part.same(l.int(NOTHING));
    if let Some(environment) = model.environment {
        step.add(l, active & !hit, l.int(environment), l.real(1.0));
    }
    let surface = surfaces(l, model, &arrival, hit);
    let mut vertex = trace.is_some().then(|| step.vertex(l, &arrival, &surface));
    step.vertex = vertex.as_mut();
    let going = step.arrive(l, &surface, hit);
    let meeting = Meeting {
        surface: &surface,
        direction: ray.direction,
        normal: Vec3::select(l, surface.front, surface.normal, -surface.normal),
        going,
        kinds: model.needs.materials,
    };
    let next = step.scatter(l, &meeting);
    let alive = active & step.roulette(l, going);
    step.note_end(l, &next, alive);
    step.keep(l, pool, &meeting, &next, (to, alive));
    if let (Some(trace), Some(vertex)) = (trace, vertex) {
        trace.push(vertex);
    }
    alive.bits().count_ones() as usize
}

#[inline(always)]
fn vector<L: Lanes>(l: L, pool: &Pool<L::Scalar>, field: RealField, at: usize) -> Vec3<L::Real> {
    Vec3::new(
        pool.real(l, field, 0, at),
        pool.real(l, field, 1, at),
        pool.real(l, field, 2, at),
    )
}

/// An object's index unless it is [`NOTHING`].
pub fn some_object(index: u32) -> Option<u32> {
    (index != NOTHING).then_some(index)
}

impl<L: Lanes, const C: usize> Step<'_, L, C> {
    /// Takes the light of the surfaces that are hit, and decides which paths go on from there.
    #[inline(always)]
    fn arrive(&mut self, l: L, surface: &Surfaces<L>, hit: L::Mask) -> L::Mask {
        let model = self.model;
        if model.needs.has(word::EMITS) {
            self.add(l, surface.emits, surface.emission, surface.emission_weight);
        }
        let scatters = hit & !surface.kind.same(l.int(MaterialKind::Black as u32));
        let beyond = has(l, self.flags, flags::BEYOND);
        let within = self.depth.plus(l.int(1)).below(l.int(model.max_depth));
        let mut going = scatters & (within | beyond);
        let cut = scatters & !going;
        if any(cut) {
            let u = model.sequence.single(l, self.id, Slot::Beyond, self.depth);
            let chosen = cut & u.lt(l.real(BEYOND_SHARE));
            self.go_beyond(l, chosen);
            going = going | chosen;
        }
        going
    }

    /// Writes down how the paths go on, those that live.
    #[inline(always)]
    fn keep(
        &self,
        l: L,
        pool: &mut Pool<L::Scalar>,
        meeting: &Meeting<'_, L>,
        next: &Scattered<L>,
        (to, alive): (usize, L::Mask),
    ) {
        let kept = self.flags & l.int(flags::TERMINATED | flags::BEYOND);
        let flags = kept
            | bit_where(l, next.inward, flags::INWARD)
            | bit_where(l, next.specular, flags::SPECULAR);
        for (field, v) in [
            (RealField::Origin, meeting.surface.point),
            (RealField::Direction, next.direction),
        ] {
            pool.keep_real(l, field, 0, to, (v.x, alive));
            pool.keep_real(l, field, 1, to, (v.y, alive));
            pool.keep_real(l, field, 2, to, (v.z, alive));
        }
        pool.keep_real(l, RealField::Pdf, 0, to, (next.pdf, alive));
        for (field, x) in [
            (IntField::Departure, meeting.surface.object),
            (IntField::Flags, flags),
            (IntField::Depth, self.depth.plus(l.int(1))),
            (IntField::Key, self.id.key),
            (IntField::Index, self.id.index),
            (IntField::Slot, l.load_int(&self.slots)),
            (IntField::Row, self.row),
        ] {
            pool.keep_int(l, field, to, (x, alive));
        }
    }

    /// Lane 0 on arrival.
    #[cold]
    fn vertex(&self, l: L, arrival: &Arrival<'_, L>, surface: &Surfaces<L>) -> Vertex {
        let set = |m: L::Mask| m.bits() & 1 == 1;
        Vertex {
            depth: l.int_lane(self.depth, 0),
            origin: lane_vector(l, arrival.ray.origin, 0),
            direction: lane_vector(l, arrival.ray.direction, 0),
            distance: l.lane(arrival.nearest.t, 0).to_f64(),
            object: some_object(l.int_lane(surface.object, 0)),
            point: lane_vector(l, surface.point, 0),
            normal: lane_vector(l, surface.normal, 0),
            front: set(surface.front),
            arrival_pdf: (!set(arrival.specular)).then(|| l.lane(arrival.pdf, 0).to_f64()),
            emission_weight: set(surface.emits)
                .then(|| l.lane(surface.emission_weight, 0).to_f64()),
            throughput: self.spectrum(&self.carried().throughput),
            light: None,
            scattered: None,
            radiance: Vec::new(),
        }
    }

    /// What lane 0 carries.
    fn carried(&self) -> &Carried<L::Scalar, C> {
        &self.rows.paths[self.slots[0] as usize]
    }

    fn spectrum(&self, row: &[L::Scalar; C]) -> Vec<f64> {
        row.map(Scalar::to_f64).to_vec()
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
                throughput: self.spectrum(&self.carried().throughput),
            });
            let radiance = self.spectrum(&self.carried().radiance);
            if let Some(vertex) = &mut self.vertex {
                vertex.scattered = scattered;
                vertex.radiance = radiance;
            }
        }
    }

    /// Adds throughput × weight × spectrum to the radiance where the mask is true.
    #[inline(always)]
    pub fn add(&mut self, l: L, m: L::Mask, spectrum: L::Int, weight: L::Real) {
        let bits = m.bits();
        if bits == 0 {
            return;
        }
        let (at, weights) = (self.table_rows(l, spectrum), array(l, weight));
        let table = self.model.spectra.rows::<C>();
        let paths = self.rows.paths.as_mut_slice();
        for i in each(bits) {
            // Copies: arrays that cannot overlap become vectors.
            let values = table[at[i % WIDEST] as usize];
            let path = &mut paths[self.slots[i % WIDEST] as usize];
            let Carried {
                throughput,
                mut radiance,
            } = *path;
            let weight = weights[i % WIDEST];
            for c in 0..C {
                radiance[c] = (throughput[c] * weight).fused(values[c], radiance[c]);
            }
            path.radiance = radiance;
        }
    }

    /// Numbers of the table rows that hold a spectrum at each lane's wavelengths.
    #[inline(always)]
    pub fn table_rows(&self, l: L, spectrum: L::Int) -> [u32; WIDEST] {
        int_array(l, spectrum.plus(self.row))
    }

    /// A lane's largest throughput over the wavelengths.
    #[inline(always)]
    fn largest(&self, i: usize) -> L::Scalar {
        let mut throughput = self.rows.paths[self.slots[i] as usize].throughput;
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
    fn go_beyond(&mut self, l: L, chosen: L::Mask) {
        for i in each(chosen.bits()) {
            let slot = self.slots[i] as usize;
            let own = slot + CHUNK;
            let weight = L::Scalar::from_f64(1.0 / BEYOND_SHARE);
            let rows = &mut *self.rows;
            rows.paths[own] = Carried {
                throughput: rows.paths[slot].throughput.map(|value| value * weight),
                ..Carried::new()
            };
            rows.row[own] = rows.row[slot];
            rows.hero[own] = rows.hero[slot];
            rows.fraction[own] = rows.fraction[slot];
            self.slots[i] = own as u32;
            self.beyond_slots.push(own as u32);
        }
        self.flags = self.flags | bit_where(l, chosen, flags::BEYOND);
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
        let u = self
            .model
            .sequence
            .single(l, self.id, Slot::Roulette, self.depth);
        let survives = late & u.lt(survival);
        let rewards = array(l, one / survival);
        for i in each(survives.bits()) {
            for value in &mut self.rows.paths[self.slots[i] as usize].throughput {
                *value = *value * rewards[i];
            }
        }
        going & (survives | !late)
    }
}
