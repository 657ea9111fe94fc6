//! One segment of every path: find the surface, take its light, sample the lights, scatter.

use super::chunk::{CHUNK, Workspace};
use super::intersect::{NOTHING, Rays, lane_vector, nearest};
use super::model::Model;
use super::parts::word;
use super::pool::{Carried, Paths, WIDEST, array, bit_where, each, flags, has, int_array};
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
    pub model: &'a Model<L::Scalar>,
    pub workspace: &'a mut Workspace<L::Scalar, C>,
    /// As the pool had them, but for flags that change on the way.
    pub paths: Paths<L>,
    /// Where the spectra of each lane are among the rows.
    pub slots: [u32; WIDEST],
}

/// Advances the packet at `at` by one segment, writes the paths that go on from place `to` ≤ `at` on, and
/// returns their number.
#[inline(always)]
pub fn bounce<L: Lanes, const C: usize>(
    l: L,
    model: &Model<L::Scalar>,
    workspace: &mut Workspace<L::Scalar, C>,
    at: usize,
    to: usize,
) -> usize {
    let (paths, active) = workspace.pool.read(l, at);
    let rays = Rays {
        ray: LaneRay::new(l, paths.origin, paths.direction),
        leaving: paths.leaving,
        inward: has(l, paths.flags, flags::INWARD),
    };
    let arrival = Arrival {
        rays: &rays,
        nearest: nearest(l, model, &rays, active, &mut workspace.tiers),
        pdf: paths.pdf,
        specular: has(l, paths.flags, flags::SPECULAR),
    };
    let mut step = Step {
        model,
        workspace,
        slots: int_array(l, paths.slot),
        paths,
    };
    let hit = active & !arrival.nearest.part.same(l.int(NOTHING));
    if let Some(environment) = model.environment {
        step.add(l, active & !hit, l.int(environment), l.real(1.0));
    }
    let surface = surfaces(l, model, &arrival, hit);
    step.note_arrival(l, &arrival, &surface);
    let going = step.arrive(l, &surface, hit);
    let meeting = Meeting {
        surface: &surface,
        wo: -paths.direction,
        normal: Vec3::select(l, surface.front, surface.normal, -surface.normal),
        going,
    };
    let next = step.scatter(l, &meeting);
    let alive = active & step.roulette(l, going);
    step.note_end(l, &next, alive);
    let kept = step.paths.flags & l.int(flags::TERMINATED | flags::BEYOND);
    let survivors = Paths {
        origin: surface.point,
        direction: next.direction,
        pdf: next.pdf,
        leaving: surface.object,
        flags: kept
            | bit_where(l, next.inward, flags::INWARD)
            | bit_where(l, next.specular, flags::SPECULAR),
        id: Identity {
            bounce: step.depth(l),
            ..paths.id
        },
        slot: l.load_int(&step.slots),
        row: paths.row,
    };
    step.workspace.pool.keep(l, to, &survivors, alive);
    alive.bits().count_ones() as usize
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
        let beyond = has(l, self.paths.flags, flags::BEYOND);
        let within = self.depth(l).below(l.int(model.max_depth));
        let mut going = scatters & (within | beyond);
        let cut = scatters & !going;
        if cut.any() {
            let u = model.sequence.single(l, self.paths.id, Slot::Beyond);
            let chosen = cut & u.lt(l.real(BEYOND_SHARE));
            self.go_beyond(l, chosen);
            going = going | chosen;
        }
        going
    }

    /// Number of segments traced, this one included.
    #[inline(always)]
    fn depth(&self, l: L) -> L::Int {
        self.paths.id.bounce.plus(l.int(1))
    }

    /// Throughput and radiance of lane 0.
    fn carried(&self) -> [Vec<f64>; 2] {
        let Carried {
            throughput,
            radiance,
        } = self.workspace.rows.paths[self.slots[0] as usize];
        [throughput, radiance].map(|spectrum| spectrum.map(Scalar::to_f64).to_vec())
    }

    /// The vertex that is being written down, of lane 0.
    #[inline(always)]
    pub fn vertex(&mut self) -> Option<&mut Vertex> {
        self.workspace.trace.as_mut()?.last_mut()
    }

    /// Writes down where lane 0 has come to.
    #[inline(always)]
    fn note_arrival(&mut self, l: L, arrival: &Arrival<'_, L>, surface: &Surfaces<L>) {
        if self.workspace.trace.is_some() {
            let mut vertex = arrival.vertex(l, surface);
            vertex.depth = l.int_lane(self.paths.id.bounce, 0);
            [vertex.throughput, _] = self.carried();
            self.workspace.trace.get_or_insert_default().push(vertex);
        }
    }

    /// Writes down how lane 0 goes on.
    #[inline(always)]
    fn note_end(&mut self, l: L, next: &Scattered<L>, alive: L::Mask) {
        if self.workspace.trace.is_none() {
            return;
        }
        let [throughput, radiance] = self.carried();
        if let Some(vertex) = self.vertex() {
            let specular = next.specular.bits() & 1 == 1;
            vertex.scattered = (alive.bits() & 1 == 1).then(|| ScatteredVertex {
                direction: lane_vector(l, next.direction, 0),
                pdf: (!specular).then(|| l.lane(next.pdf, 0).to_f64()),
                throughput,
            });
            vertex.radiance = radiance;
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
        let paths = self.workspace.rows.paths.as_mut_slice();
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
        int_array(l, spectrum.plus(self.paths.row))
    }

    /// A lane's largest throughput over the wavelengths.
    #[inline(always)]
    fn largest(&self, i: usize) -> L::Scalar {
        let mut throughput = self.workspace.rows.paths[self.slots[i] as usize].throughput;
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
            let rows = &mut self.workspace.rows;
            rows.paths[own] = Carried {
                throughput: rows.paths[slot].throughput.map(|value| value * weight),
                ..Carried::default()
            };
            rows.row[own] = rows.row[slot];
            rows.hero[own] = rows.hero[slot];
            rows.fraction[own] = rows.fraction[slot];
            self.slots[i] = own as u32;
            self.workspace.beyond_slots.push(own as u32);
        }
        self.paths.flags = self.paths.flags | bit_where(l, chosen, flags::BEYOND);
    }

    /// Ends paths with the probability that their throughput is lost anyway, and rewards the rest.
    #[inline(always)]
    fn roulette(&mut self, l: L, going: L::Mask) -> L::Mask {
        let late = going & !self.depth(l).below(l.int(ROULETTE_FROM));
        if !late.any() {
            return going;
        }
        let mut largest = [L::Scalar::default(); WIDEST];
        for i in each(late.bits()) {
            largest[i] = self.largest(i);
        }
        let largest = l.load(&largest);
        let one = l.real(1.0);
        let terminated = has(l, self.paths.flags, flags::TERMINATED);
        let carried = l.select(terminated, l.real(1.0 / C as f64), one);
        let beyond = has(l, self.paths.flags, flags::BEYOND);
        let share = l.select(beyond, l.real(BEYOND_SHARE), one);
        let survival = (largest * carried * share).min(l.real(LARGEST_SURVIVAL));
        let sequence = &self.model.sequence;
        let u = sequence.single(l, self.paths.id, Slot::Roulette);
        let survives = late & u.lt(survival);
        let rewards = array(l, one / survival);
        for i in each(survives.bits()) {
            for value in &mut self.workspace.rows.paths[self.slots[i] as usize].throughput {
                *value = *value * rewards[i];
            }
        }
        going & (survives | !late)
    }
}
