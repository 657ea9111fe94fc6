//! The surfaces that a packet of rays has met: geometry, material, emission.

use super::bounce::some_object;
use super::intersect::{NOTHING, Nearest, Rays, lane_vector};
use super::model::Model;
use super::needs::Needs;
use super::parts::{Entry, NO_LIGHT, PartData, SmallTable, word};
use super::pool::has;
use super::replay::Vertex;
use crate::material::{MaterialKind, SPECTRA};
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar};
use crate::math::lookup::SMALL;
use crate::math::vec3::Vec3;
use crate::sample::mis::power_weight;
use crate::shape::lanes::LaneSurface;
use crate::shape::lanes::part::Outline;

/// The surfaces that a packet of rays has met.
#[derive(Clone, Copy)]
pub struct Surfaces<L: Lanes> {
    /// Points, moved onto the surface.
    pub point: Vec3<L::Real>,
    /// Objects; [`super::intersect::NOTHING`] where nothing is met.
    pub object: L::Int,
    /// Unit outward normals (+z side of flat shapes).
    pub normal: Vec3<L::Real>,
    /// The ray meets the outward side.
    pub front: L::Mask,
    /// The [`MaterialKind`] that scatters, as a number.
    pub kind: L::Int,
    /// Where the material's spectra stand in the bank.
    pub spectra: [L::Int; SPECTRA],
    /// Refraction there disperses.
    pub disperses: L::Mask,
    /// The side that is met emits.
    pub emits: L::Mask,
    /// Where the spectrum of the emission stands in the bank.
    pub emission: L::Int,
    /// Weight of the emission against light sampling.
    pub emission_weight: L::Real,
}

/// Rays that have come to surfaces.
pub struct Arrival<'a, L: Lanes> {
    pub rays: &'a Rays<L>,
    pub nearest: Nearest<L>,
    /// Density with which the direction was sampled, sr⁻¹.
    pub pdf: L::Real,
    /// The direction was the only one possible, so that light sampling could not have found it.
    pub specular: L::Mask,
}

impl<L: Lanes> Arrival<'_, L> {
    /// Lane 0 as it is written down, without what its path carries.
    #[cold]
    pub fn vertex(&self, l: L, surface: &Surfaces<L>) -> Vertex {
        let set = |m: L::Mask| m.bits() & 1 == 1;
        let Self {
            rays: Rays { ray, .. },
            nearest,
            ..
        } = self;
        Vertex {
            origin: lane_vector(l, ray.origin, 0),
            direction: lane_vector(l, ray.direction, 0),
            distance: l.lane(nearest.t, 0).to_f64(),
            object: some_object(l.int_lane(surface.object, 0)),
            point: lane_vector(l, surface.point, 0),
            normal: lane_vector(l, surface.normal, 0),
            front: set(surface.front),
            arrival_pdf: (!set(self.specular)).then(|| l.lane(self.pdf, 0).to_f64()),
            emission_weight: set(surface.emits)
                .then(|| l.lane(surface.emission_weight, 0).to_f64()),
            ..Vertex::default()
        }
    }
}

/// Gathers what the loop needs to know about each hit.
#[inline(never)]
pub fn surfaces<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    arrival: &Arrival<'_, L>,
    hit: L::Mask,
) -> Surfaces<L> {
    l.vectorize(inlined!(|| {
        let Arrival { rays, nearest, .. } = arrival;
        let ray = &rays.ray;
        let p = ray.origin.along(ray.direction, nearest.t);
        let (parts, needs) = (&model.parts, model.needs);
        let gathered = match &parts.small {
            Some(table) => looked_up(l, table, nearest.part, needs, hit),
            None => one_by_one(l, &parts.entries, nearest.part, hit),
        };
        let nobody = l.mask(false);
        let has = inlined!(|bit: u32| {
            if needs.has(bit) {
                hit & has(l, gathered.word, bit)
            } else {
                nobody
            }
        });
        let [x, y, z] = gathered.vector;
        let outline = Outline {
            vector: Vec3::new(x, y, z),
            level: gathered.level,
            half: gathered.half,
            faces: has(word::FACES),
            balls: has(word::BALL),
        };
        let LaneSurface { point, normal } = outline.surface(l, p);
        let mut out = Surfaces::<L> {
            point,
            normal,
            object: l.select_int(hit, gathered.object, l.int(NOTHING)),
            front: nobody,
            kind: l.select_int(
                hit,
                gathered.word & l.int(word::KIND),
                l.int(MaterialKind::Black as u32),
            ),
            spectra: gathered.spectra,
            disperses: has(word::DISPERSES),
            emits: nobody,
            emission: gathered.emission,
            emission_weight: l.real(1.0),
        };
        others(l, model, arrival, (p, has(word::OTHER)), &mut out);
        let mut front = out.normal.dot(ray.direction).lt(l.real(0.0));
        // A chord along the wall is short, and the normals at its ends are rounded.
        let exits = front & rays.inward & rays.leaving.same(out.object);
        if exits.any() {
            front = front & !(exits & has(word::CLOSED));
        }
        out.front = hit & front;
        out.emits = (has(word::EMITS_FRONT) & front) | (has(word::EMITS_BACK) & !front);
        textures(l, model, has(word::TEXTURED), &mut out);
        weights(l, model, arrival, gathered.light, &mut out);
        out
    }))
}

/// Weighs the emission of what light sampling could have found too.
#[inline(always)]
fn weights<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    arrival: &Arrival<'_, L>,
    light: L::Int,
    out: &mut Surfaces<L>,
) {
    let ray = &arrival.rays.ray;
    let weighted = out.emits & !arrival.specular & !light.same(l.int(NO_LIGHT));
    for (k, here) in Distinct::new(l, light, weighted) {
        let light = &model.lights[k as usize];
        let chosen =
            l.splat(light.probability) * light.shape.pdf(l, ray.origin, ray.direction, out.normal);
        let weight = power_weight(l, arrival.pdf, chosen);
        out.emission_weight = l.select(here, weight, out.emission_weight);
    }
}

/// Each value that occurs in some lanes, and where it does.
pub struct Distinct<L: Lanes> {
    l: L,
    values: L::Int,
    m: L::Mask,
    pending: u32,
}

impl<L: Lanes> Distinct<L> {
    /// The values in the lanes of `m`.
    #[inline(always)]
    pub fn new(l: L, values: L::Int, m: L::Mask) -> Self {
        Self {
            l,
            values,
            m,
            pending: m.bits(),
        }
    }
}

impl<L: Lanes> Iterator for Distinct<L> {
    type Item = (u32, L::Mask);

    #[inline(always)]
    fn next(&mut self) -> Option<(u32, L::Mask)> {
        if self.pending == 0 {
            return None;
        }
        let first = self.pending.trailing_zeros() as usize;
        let value = self.l.int_lane(self.values, first);
        let here = self.m & self.values.same(self.l.int(value));
        self.pending &= !here.bits();
        Some((value, here))
    }
}

/// The numbers of parts for all lanes at once, from a table that fits in registers; 0 for what no
/// branch needs.
#[inline(always)]
fn looked_up<L: Lanes>(
    l: L,
    table: &SmallTable<L::Scalar>,
    part: L::Int,
    needs: Needs,
    hit: L::Mask,
) -> PartData<L::Real, L::Int> {
    // Lanes that have hit nothing read some entry, and what it says is not used.
    let part = l.select_int(hit, part, l.int(0));
    let real = inlined!(|column: &[L::Scalar; SMALL]| l.lookup(column, part));
    let int = inlined!(|column: &[u32; SMALL]| l.lookup_int(column, part));
    let [x, y, z] = &table.vector;
    let [first, second] = &table.spectra;
    let (mut emission, mut light) = (l.int(0), l.int(0));
    if needs.has(word::EMITS) {
        (emission, light) = (int(&table.emission), int(&table.light));
    }
    PartData {
        vector: [real(x), real(y), real(z)],
        level: real(&table.level),
        half: if needs.has(word::FACES) {
            real(&table.half)
        } else {
            l.real(0.0)
        },
        object: int(&table.object),
        word: int(&table.word),
        spectra: [int(first), int(second)],
        emission,
        light,
    }
}

/// The numbers of parts, one distinct part at a time.
#[inline(always)]
fn one_by_one<L: Lanes>(
    l: L,
    entries: &[Entry<L::Scalar>],
    part: L::Int,
    hit: L::Mask,
) -> PartData<L::Real, L::Int> {
    let (nothing, none) = (l.real(0.0), l.int(0));
    let mut out = PartData {
        vector: [nothing, nothing, l.real(1.0)],
        level: nothing,
        half: nothing,
        object: none,
        word: none,
        spectra: [none; SPECTRA],
        emission: none,
        light: l.int(NO_LIGHT),
    };
    for (k, here) in Distinct::new(l, part, hit) {
        let own = &entries[k as usize];
        let real = inlined!(|x: L::Scalar, other| l.select(here, l.splat(x), other));
        let int = inlined!(|x: u32, other| l.select_int(here, l.int(x), other));
        for (out, own) in out.vector.iter_mut().zip(own.vector) {
            *out = real(own, *out);
        }
        for (out, own) in out.spectra.iter_mut().zip(own.spectra) {
            *out = int(own, *out);
        }
        out.level = real(own.level, out.level);
        out.half = real(own.half, out.half);
        out.object = int(own.object, out.object);
        out.word = int(own.word, out.word);
        out.emission = int(own.emission, out.emission);
        out.light = int(own.light, out.light);
    }
    out
}

/// Surfaces that the shapes themselves compute, met at `p`.
#[inline(always)]
fn others<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    arrival: &Arrival<'_, L>,
    (p, m): (Vec3<L::Real>, L::Mask),
    out: &mut Surfaces<L>,
) {
    let objects = out.object;
    let ray = &arrival.rays.ray;
    for (k, here) in Distinct::new(l, objects, m) {
        let shape = &model.shapes[k as usize];
        let surface = match shape.kind {
            Some(kind) => shape.surface(l, kind, p),
            None => {
                let reach = ray.extent + arrival.nearest.t;
                implicit_surface(l, model, k, [p, ray.direction], reach, here)
            }
        };
        out.point = Vec3::select(l, here, surface.point, out.point);
        out.normal = Vec3::select(l, here, surface.normal, out.normal);
    }
}

/// The spectra that textures choose.
#[inline(always)]
fn textures<L: Lanes>(l: L, model: &Model<L::Scalar>, textured: L::Mask, out: &mut Surfaces<L>) {
    let (objects, point) = (out.object, out.point);
    for (k, here) in Distinct::new(l, objects, textured) {
        let record = &model.appearances[k as usize].surface;
        let Some(texture) = record.texture else {
            continue;
        };
        let [a, b, c] = record.numbers;
        let numbers = [l.splat(a), l.splat(b), l.splat(c)];
        let local = model.shapes[k as usize].local(l, point);
        let chosen = texture.texture(l, numbers, local, out.spectra);
        for (spectrum, chosen) in out.spectra.iter_mut().zip(chosen) {
            *spectrum = l.select_int(here, chosen, *spectrum);
        }
    }
}

/// The point on an implicit surface and its outward normal; finite everywhere. What rounding has
/// moved a point by is bounded by that of the largest magnitude on the way to it, `reach`.
#[inline(always)]
fn implicit_surface<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    object: u32,
    [mut point, direction]: [Vec3<L::Real>; 2],
    reach: L::Real,
    here: L::Mask,
) -> LaneSurface<L> {
    let shape = &model.shapes[object as usize];
    let inverse = &shape.inverse;
    let local = inverse.point(l, point);
    let mut normal = local;
    if let Some(implicit) = model.implicit(object) {
        let scales = [point.max_abs(), reach];
        let direction = inverse.vector(l, direction);
        let (outward, step) = implicit.surface(l, local, direction, scales, here);
        normal = outward;
        point = point - shape.forward.vector(l, step);
    }
    LaneSurface {
        point,
        normal: inverse.transposed(l, normal).normalized(l),
    }
}
