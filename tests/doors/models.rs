//! Rays in whole scenes.

use etalon_lanes::integrate::bounce::bounce;
use etalon_lanes::integrate::chunk::Workspace;
use etalon_lanes::integrate::intersect::{NOTHING, Rays, Shadow, Tiers, nearest, occluded};
use etalon_lanes::integrate::model::Model;
use etalon_lanes::integrate::pool::{Paths, flags};
use etalon_lanes::math::instructions::{Instructions, Job};
use etalon_lanes::math::lanes::{Lanes, Mask, Scalar, WIDEST};
use etalon_lanes::math::twice::Twice;
use etalon_lanes::math::vec3::Vec3;
use etalon_lanes::sample::sequence::Identity;
use etalon_lanes::shape::Ray;
use etalon_lanes::shape::lanes::balls::Balls;

use crate::Made;
use crate::columns::{jobs, load_rays};

/// A scene's tables in either precision.
pub type AnyModel<'a> = Made<&'a Model<f32>, &'a Model<f64>>;

/// A ray that leaves a surface, or none ([`NOTHING`]).
#[derive(Debug, Clone, Copy)]
pub struct Question {
    /// Scene units about the camera; a unit direction.
    pub ray: Ray,
    pub leaving: u32,
    /// Whether it goes into that object.
    pub inward: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    pub t: f64,
    /// Number of the part, or [`NOTHING`].
    pub part: u32,
    /// The object that it belongs to, or [`NOTHING`].
    pub object: u32,
    /// Whether it is blocked as a shadow ray.
    pub blocked: bool,
}

#[derive(Debug, Clone, Copy)]
pub struct Asking {
    /// By packets of twice the width.
    pub twice: bool,
    /// Where shadow rays end.
    pub limit: f64,
    /// The object that does not block them.
    pub except: u32,
}

jobs! {
    /// The nearest hits of rays, and whether they are blocked.
    answers<'a>(l: L, model of Model, questions: &'a [Question], asking: Asking) -> Vec<Answer> {
        match asking.twice {
            true => answered(Twice(l), model, questions, asking),
            false => answered(l, model, questions, asking),
        }
    }

    /// The sets of the balls, among objects that are such, that rays are said to come near, object k
    /// of the list as bit k; each ray is asked in all lanes.
    ///
    /// # Panics
    /// If an object is no ball.
    balls_near<'a>(l: L, model of Model, objects: &'a [u32], rays: &'a [Ray]) -> Vec<u32> {
        let balls = Balls::new(objects, &model.shapes).expect("balls");
        let mut all = Vec::with_capacity(rays.len());
        for &ray in rays {
            let ray = load_rays(l, std::iter::once(ray));
            let near = balls.near(l, &ray, [l.int(u32::MAX)], l.real(f64::INFINITY));
            all.push(l.int_lane(near, 0));
        }
        all
    }
}

#[inline(always)]
fn answered<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    questions: &[Question],
    asking: Asking,
) -> Vec<Answer> {
    let mut answers = Vec::with_capacity(questions.len());
    for questions in questions.chunks(L::COUNT) {
        let (mut object, mut inward) = ([NOTHING; WIDEST], 0);
        for (i, question) in questions.iter().enumerate() {
            object[i] = question.leaving;
            inward |= u32::from(question.inward) << i;
        }
        let rays = Rays {
            ray: load_rays(l, questions.iter().map(|question| question.ray)),
            leaving: l.load_int(&object),
            inward: l.mask_from_bits(inward),
        };
        let active = l.mask_from_bits(u32::MAX >> (WIDEST - questions.len()));
        let mut tiers = Tiers::default();
        let found = nearest(l, model, &rays, active, &mut tiers);
        let shadow = Shadow {
            rays,
            limit: l.real(asking.limit),
            except: l.int(asking.except),
        };
        let blocked = occluded(l, model, &shadow, active, &mut tiers).bits();
        answers.extend((0..questions.len()).map(|i| {
            let part = l.int_lane(found.part, i);
            let entry = model.parts.entries.get(part as usize);
            Answer {
                t: l.lane(found.t, i).to_f64(),
                part,
                object: entry.map_or(NOTHING, |entry| entry.object),
                blocked: blocked >> i & 1 == 1,
            }
        }));
    }
    answers
}

/// Lengths of at most so many segments of a path of 4 wavelengths that begins with a ray, by the
/// step of the path loop without its roulette.
pub fn path_lengths(model: AnyModel, ray: Ray, most: usize) -> Vec<f64> {
    // One lane alone: the bits are the same in all.
    match model {
        Made::Single(model) => follow(f32::ONE, model, ray, most),
        Made::Double(model) => follow(f64::ONE, model, ray, most),
    }
}

fn follow<L: Lanes>(l: L, model: &Model<L::Scalar>, ray: Ray, most: usize) -> Vec<f64> {
    let mut workspace = Workspace::<L::Scalar, 4>::default();
    let zero = l.int(0);
    let start = Paths {
        origin: Vec3::splat(l, ray.origin),
        direction: Vec3::splat(l, ray.direction),
        pdf: l.real(0.0),
        leaving: l.int(NOTHING),
        flags: l.int(flags::SPECULAR),
        id: Identity {
            key: zero,
            index: zero,
            bounce: zero,
        },
        slot: zero,
        row: zero,
    };
    workspace.pool.write(l, 0, &start);
    workspace.trace = Some(Vec::new());
    for _ in 0..most {
        workspace.pool.length = 1;
        if bounce(l, model, &mut workspace, 0, 0) == 0 {
            break;
        }
        // Roulette is for later segments only.
        let (mut paths, _) = workspace.pool.read(l, 0);
        paths.id.bounce = zero;
        workspace.pool.write(l, 0, &paths);
    }
    let vertices = workspace.trace.unwrap_or_default();
    vertices.iter().map(|vertex| vertex.distance).collect()
}
