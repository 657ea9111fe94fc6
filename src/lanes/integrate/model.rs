//! The scene as the loop reads it: flat tables of scalars of one precision, built by the plan.

use super::list::List;
use super::needs::Needs;
use super::parts::Parts;
use crate::camera::LaneCamera;
use crate::light::{LaneLight, SmallLights};
use crate::material::Record;
use crate::math::lanes::Scalar;
use crate::planted::Planted;
use crate::sample::sequence::Sequence;
use crate::shape::hierarchy::{Bounds, Hierarchy, Item};
use crate::shape::lanes::LaneShape;
use crate::shape::lanes::implicit::LaneImplicit;
use crate::shape::resolve::Resolver;
use crate::spectrum::grid::SpectrumBank;

/// What an object looks like to the loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Appearance<T> {
    /// Its material.
    pub surface: Record<T>,
    /// Where the spectrum of the emitted radiance stands in the bank.
    pub emission: Option<u32>,
    /// Whether the front and the back emit.
    pub emits: [bool; 2],
    /// Index of the light that samples this object.
    pub light: Option<u32>,
    /// Index of the material in the scene.
    pub material: u32,
}

/// The index of a scene with many objects.
#[derive(Debug, Clone)]
pub struct Many<T> {
    /// Objects that most rays have to ask: infinite planes and those whose boxes are broad.
    pub broad: Vec<u32>,
    /// Boxes over the other objects.
    pub boxes: Hierarchy<T>,
    /// Whether an object can hide a light from a surface, by object.
    pub hides: Vec<bool>,
}

/// Most objects with boxes that packets ask, at about the price of one visit of the hierarchy.
const MOST_BROAD: usize = 8;
/// Share of the lines through all boxes that meet a broad one. A packet of at least 8 rays asks an
/// object at the price at which one ray asks it alone; twice that pays for what the hierarchy saves
/// by knowing a hit beforehand.
const BROAD: f64 = 0.25;

impl<T: Scalar> Many<T> {
    /// From objects with bounds, objects without, and those that can hide lights, each in order.
    pub fn new(
        bounded: &[Item],
        unbounded: Vec<u32>,
        shapes: &[LaneShape<T>],
        occluders: &[u32],
    ) -> Self {
        let mut broad = unbounded;
        let is_ball = |item: &Item| shapes[item.0 as usize].ball().is_some();
        let (mut items, others): (Vec<Item>, Vec<Item>) =
            bounded.iter().partition(|item| is_ball(item));
        let few = others.len() <= MOST_BROAD;
        if few {
            broad.extend(others.iter().map(|item| item.0));
        } else {
            items.extend(others);
        }
        items.sort_by(|a, b| a.1.half_area().total_cmp(&b.1.half_area()));
        for _ in 0..MOST_BROAD {
            let all = Bounds::around(&items).half_area();
            match items.pop_if(|item| item.1.half_area() >= BROAD * all) {
                Some((object, _)) => broad.push(object),
                None => break,
            }
        }
        broad.sort_unstable();
        items.sort_unstable_by_key(|item| item.0);
        let mut hides = vec![false; shapes.len()];
        for &object in occluders {
            hides[object as usize] = true;
        }
        Self {
            broad,
            boxes: Hierarchy::new(&items, shapes),
            hides,
        }
    }
}

/// Everything the loop reads.
#[derive(Debug)]
pub struct Model<T: Scalar> {
    pub camera: LaneCamera<T>,
    pub sequence: Sequence,
    /// Longest path in segments; `u32::MAX` where there is no limit.
    pub max_depth: u32,
    /// The branches that the loop takes.
    pub needs: Needs,
    /// The index of many objects; without one, `list` and `occluders` are asked.
    pub hierarchy: Option<Many<T>>,
    /// The shape of each object.
    pub shapes: Vec<LaneShape<T>>,
    /// All objects.
    pub list: List<T>,
    /// The objects that shadow rays are tested against.
    pub occluders: List<T>,
    /// Implicit surfaces: (object, surface), in order of the objects.
    pub implicits: Vec<(u32, LaneImplicit<T>)>,
    pub parts: Parts<T>,
    pub appearances: Vec<Appearance<T>>,
    /// The lights that can be sampled.
    pub lights: Vec<LaneLight<T>>,
    /// The same by column, where several can be sampled together.
    pub small_lights: Option<Box<SmallLights<T>>>,
    /// Where the spectrum of the environment stands in the bank.
    pub environment: Option<u32>,
    /// All spectra on the wavelength grid.
    pub spectra: SpectrumBank<T>,
    /// Decides about rays that lanes leave undecided.
    pub resolver: Resolver,
    /// A deliberate mistake, for builds that make it.
    pub planted: Option<Planted>,
}

impl<T: Scalar> Model<T> {
    /// The implicit surface that an object is, if it is one.
    #[inline(always)]
    pub fn implicit(&self, object: u32) -> Option<&LaneImplicit<T>> {
        if self.shapes[object as usize].kind.is_some() {
            return None;
        }
        let place = self.implicits.binary_search_by_key(&object, |(k, _)| *k);
        Some(&self.implicits.get(place.ok()?)?.1)
    }

    /// Whether an object can hide a light from a surface.
    pub fn hides(&self, object: u32) -> bool {
        self.occluders.objects.binary_search(&object).is_ok()
    }
}
