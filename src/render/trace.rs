//! First surfaces along single rays, exactly: for given rays and for the centres of pixels.

use std::borrow::Cow;

use crate::math::instructions::Instructions;
use crate::scene::{Named, Object, Scene, Shape};
use crate::shape::hierarchy::{Bounds, RayIndex};
use crate::shape::implicit::certified::Workspace;
use crate::shape::implicit::placed::{ImplicitAnswer, PlacedImplicit};
use crate::shape::list::nearest;
use crate::shape::{Placed, Query, Ray, Start, Tally, Tier};
use glam::DVec3;
use rayon::prelude::*;

use super::tile::Window;
use crate::camera::centre_ray;

/// All objects of a scene, placed for single rays.
#[derive(Debug)]
pub struct Tracer {
    names: Vec<String>,
    /// At equal t the lower one wins: 0 for opaque objects, 1 for glass.
    priorities: Vec<u8>,
    objects: Vec<Traced>,
    /// Indices of all objects, in order.
    all: Vec<u32>,
    /// Boxes over the objects, where there are many.
    index: Option<RayIndex>,
}

#[derive(Debug)]
enum Traced {
    Canonical(Box<Placed>),
    Implicit(Box<PlacedImplicit>),
}

/// Most objects that are intersected one after the other, without boxes over them. Exact
/// intersections cost far more than boxes; the limit keeps boxes, which are f64 with a bound, away from
/// scenes that are made to be difficult.
const LARGEST_LIST: usize = 64;

/// The first surface that a ray meets.
#[derive(Debug, Clone)]
pub struct FirstHit {
    /// Index of the object.
    pub object: usize,
    /// Position on the ray, in units of its direction.
    pub t: f64,
    /// World coordinates.
    pub point: DVec3,
    /// Unit outward normal in the world, where there is one.
    pub normal: Option<DVec3>,
    /// How the hit was found, for an implicit surface.
    pub found: Option<Found>,
}

/// How a hit on an implicit surface was found.
#[derive(Debug, Clone)]
pub struct Found {
    /// Name of the root finder.
    pub finder: &'static str,
    /// Lower and upper bound of t.
    pub enclosure: [f64; 2],
    /// Multiplicity of the root t, where it is known.
    pub multiplicity: Option<u32>,
    /// The arithmetic that proved the root; `None` where nothing is proved.
    pub tier: Option<Tier>,
}

/// The first surface that a ray meets, as far as it could be decided.
#[derive(Debug, Clone)]
pub enum First {
    /// The ray meets this surface first.
    Hit(FirstHit),
    /// The ray meets no surface.
    Nothing,
    /// The root finder of that name could not decide.
    Undecided(&'static str),
}

/// How many rays were traced, and which arithmetic decided them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Decided {
    /// Rays traced.
    pub rays: u64,
    /// Rays that hit a surface.
    pub hits: u64,
    /// Questions about canonical shapes, by the arithmetic that decided them.
    pub ladder: Tally,
    /// Rays that stay undecided.
    pub undecided: u64,
    /// Questions about implicit surfaces, by the arithmetic that decided them.
    pub implicit: Tally,
}

impl Decided {
    /// The sums of both counts.
    pub fn joined(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            hits: self.hits + other.hits,
            ladder: self.ladder.joined(other.ladder),
            undecided: self.undecided + other.undecided,
            implicit: self.implicit.joined(other.implicit),
        }
    }
}

/// An object whose matrix has no inverse.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the object \"{name}\" has a transform that is not invertible")]
pub struct Singular {
    /// Name of the object.
    pub name: String,
}

impl Tracer {
    /// Places the objects of a scene.
    ///
    /// # Errors
    /// [`Singular`] for a matrix that has no inverse.
    pub fn new(scene: &Scene) -> Result<Self, Singular> {
        let place = |Named { name, value }: &Named<Object>| {
            let traced = match &value.shape {
                Shape::Canonical(kind) => Placed::new(*kind, &value.to_world)
                    .map(|placed| Traced::Canonical(Box::new(placed))),
                Shape::Implicit(implicit) => PlacedImplicit::new(implicit, &value.to_world)
                    .map(|placed| Traced::Implicit(Box::new(placed))),
            };
            traced.map_err(|_| Singular { name: name.clone() })
        };
        let bounds = |object: &Named<Object>| {
            let [low, high] = object.value.shape.corners()?;
            Some(Bounds::around_image(&object.value.to_world, low, high))
        };
        let priority = |object: &Named<Object>| {
            let material = scene.materials.get(object.value.material);
            u8::from(material.is_some_and(|m| m.value.surface.kind.refracts()))
        };
        let objects = &scene.objects;
        Ok(Self {
            names: objects.iter().map(|o| o.name.clone()).collect(),
            priorities: objects.iter().map(priority).collect(),
            objects: objects.iter().map(place).collect::<Result<_, _>>()?,
            all: (0..objects.len() as u32).collect(),
            index: (objects.len() > LARGEST_LIST)
                .then(|| RayIndex::new(objects.iter().map(bounds))),
        })
    }

    /// The name of an object.
    pub fn name(&self, object: usize) -> &str {
        &self.names[object]
    }

    /// The first surface that a ray meets at t ≥ 0.
    ///
    /// Hits on canonical shapes are decided exactly; those on implicit surfaces come with an
    /// enclosure of t, and with the arithmetic that proved it.
    pub fn first(&self, ray: Ray) -> First {
        let query = Query {
            ray,
            t_min: 0.0,
            t_max: f64::INFINITY,
        };
        let mut workspace = Workspace::new(Instructions::best());
        self.first_hit(&query, &mut workspace, &mut Decided::default())
    }

    /// The first hit within the limits of `query`; `decided` counts the answers, and one
    /// `workspace` serves any number of them.
    pub fn first_hit(
        &self,
        query: &Query,
        workspace: &mut Workspace,
        decided: &mut Decided,
    ) -> First {
        let candidates = match &self.index {
            Some(index) => Cow::Owned(index.candidates(&query.ray, query.t_max)),
            None => Cow::Borrowed(&self.all),
        };
        let mut first = self.first_certified(&candidates, query, &mut decided.ladder);
        let mut undecided = None;
        for &object in candidates.iter() {
            let Traced::Implicit(implicit) = &self.objects[object as usize] else {
                continue;
            };
            let finder = implicit.finder.kind.name();
            match implicit.first_hit(query, workspace, &mut decided.implicit) {
                ImplicitAnswer::Absent => {}
                ImplicitAnswer::Undecided => undecided = Some(finder),
                ImplicitAnswer::Found(found) => {
                    let hit = FirstHit {
                        object: object as usize,
                        t: found.t,
                        point: found.point,
                        normal: found.normal,
                        found: Some(Found {
                            finder,
                            enclosure: found.enclosure,
                            multiplicity: found.multiplicity,
                            tier: found.tier,
                        }),
                    };
                    if first.as_ref().is_none_or(|first| self.beats(&hit, first)) {
                        first = Some(hit);
                    }
                }
            }
        }
        decided.rays += 1;
        // The surface that was not decided may lie before the one that was found.
        if let Some(finder) = undecided {
            decided.undecided += 1;
            return First::Undecided(finder);
        }
        decided.hits += u64::from(first.is_some());
        first.map_or(First::Nothing, First::Hit)
    }

    fn first_certified(
        &self,
        candidates: &[u32],
        query: &Query,
        tally: &mut Tally,
    ) -> Option<FirstHit> {
        let canonical = candidates.iter().filter_map(|&object| {
            let object = object as usize;
            match &self.objects[object] {
                Traced::Canonical(placed) => Some((object, &**placed)),
                Traced::Implicit(_) => None,
            }
        });
        let start = |_| Start::Free;
        let priority = |object: usize| self.priorities[object];
        let (object, hit) = nearest(canonical, query, start, priority, tally)?;
        Some(FirstHit {
            object,
            t: hit.t,
            point: hit.point,
            normal: Some(hit.normal),
            found: None,
        })
    }

    /// By t, then opaque before glass, then by index. The t of implicit surfaces is known to f64
    /// at best, so equality of these numbers is all the equality there is.
    fn beats(&self, hit: &FirstHit, other: &FirstHit) -> bool {
        let rank = |hit: &FirstHit| (self.priorities[hit.object], hit.object);
        hit.t < other.t || (hit.t == other.t && rank(hit) < rank(other))
    }
}

/// The first surface on the ray through the centre of each pixel of a window, row by row; `None`
/// too where it stays undecided.
///
/// # Errors
/// As [`Tracer::new`].
pub fn first_hits(
    scene: &Scene,
    window: Window,
    instructions: Instructions,
) -> Result<Vec<Option<FirstHit>>, Singular> {
    let tracer = Tracer::new(scene)?;
    let row = |y: u32| (window.x0..window.x1).map(move |x| [x, y]);
    let workspace = || Workspace::new(instructions);
    let pixels: Vec<[u32; 2]> = (window.y0..window.y1).flat_map(row).collect();
    Ok(pixels
        .into_par_iter()
        .map_init(workspace, |workspace, pixel| {
            let query = Query {
                ray: centre_ray(&scene.camera, scene.image.size, pixel),
                t_min: 0.0,
                t_max: f64::INFINITY,
            };
            match tracer.first_hit(&query, workspace, &mut Decided::default()) {
                First::Hit(hit) => Some(hit),
                First::Nothing | First::Undecided(_) => None,
            }
        })
        .collect())
}
