//! Rays in whole scenes.

use etalon_lanes::integrate::bounce::bounce;
use etalon_lanes::integrate::chunk::Workspace;
use etalon_lanes::integrate::intersect::{NOTHING, Rays, Rungs, Shadow, nearest, occluded};
use etalon_lanes::integrate::model::Model;
use etalon_lanes::integrate::pool::{Paths, flags};
use etalon_lanes::math::instructions::{Instructions, Job};
use etalon_lanes::math::lanes::{Lanes, Mask, Scalar, WIDEST};
use etalon_lanes::math::twice::Twice;
use etalon_lanes::math::vec3::Vec3;
use etalon_lanes::sample::sequence::Identity;
use etalon_lanes::shape::Ray;
use etalon_lanes::shape::lanes::balls::Balls;

use crate::columns::load_rays;
use crate::{Made, of};

/// A scene's tables in either precision.
pub type AnyModel<'a> = Made<&'a Model<f32>, &'a Model<f64>>;

/// A ray that leaves a surface, or none ([`NOTHING`]).
#[derive(Debug, Clone, Copy)]
pub struct Question {
    /// Scene units about the camera; a unit direction.
    pub ray: Ray,
    /// The object it leaves.
    pub leaving: u32,
    /// Whether it goes into that object.
    pub inward: bool,
}

/// What a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Distance.
    pub t: f64,
    /// Number of the part, or [`NOTHING`].
    pub part: u32,
    /// The object that it belongs to, or [`NOTHING`].
    pub object: u32,
    /// Whether it is blocked as a shadow ray.
    pub blocked: bool,
}

/// How rays are asked.
#[derive(Debug, Clone, Copy)]
pub struct Asking {
    /// By packets of twice the width.
    pub twice: bool,
    /// Where shadow rays end.
    pub limit: f64,
    /// The object that does not block them.
    pub except: u32,
}

/// The nearest hits of rays, and whether they are blocked.
pub fn answers(
    set: Instructions,
    model: AnyModel,
    questions: &[Question],
    asking: Asking,
) -> Vec<Answer> {
    of!(model, |model| set.run(Answers {
        model,
        questions,
        asking
    }))
}

struct Answers<'a, T: Scalar> {
    model: &'a Model<T>,
    questions: &'a [Question],
    asking: Asking,
}

impl<T: Scalar> Job<T> for Answers<'_, T> {
    type Output = Vec<Answer>;

    #[inline(always)]
    fn run<L: Lanes<Scalar = T>>(self, l: L) -> Vec<Answer> {
        if self.asking.twice {
            self.by(Twice(l))
        } else {
            self.by(l)
        }
    }
}

impl<T: Scalar> Answers<'_, T> {
    #[inline(always)]
    fn by<L: Lanes<Scalar = T>>(&self, l: L) -> Vec<Answer> {
        let mut answers = Vec::with_capacity(self.questions.len());
        for questions in self.questions.chunks(L::COUNT) {
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
            let mut rungs = Rungs::default();
            let found = nearest(l, self.model, &rays, active, &mut rungs);
            let shadow = Shadow {
                rays,
                limit: l.real(self.asking.limit),
                except: l.int(self.asking.except),
            };
            let blocked = occluded(l, self.model, &shadow, active, &mut rungs).bits();
            answers.extend((0..questions.len()).map(|i| {
                let part = l.int_lane(found.part, i);
                let entry = self.model.parts.entries.get(part as usize);
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
}

/// The sets of the balls, among objects that are such, that rays are said to come near, object k of
/// the list as bit k; each ray is asked in all lanes.
///
/// # Panics
/// If an object is no ball.
pub fn balls_near(set: Instructions, model: AnyModel, objects: &[u32], rays: &[Ray]) -> Vec<u32> {
    of!(model, |model| {
        let balls = Balls::new(objects, &model.shapes).expect("balls");
        set.run(BallsNear { balls, rays })
    })
}

struct BallsNear<'a, T> {
    balls: Balls<T>,
    rays: &'a [Ray],
}

impl<T: Scalar> Job<T> for BallsNear<'_, T> {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run<L: Lanes<Scalar = T>>(self, l: L) -> Vec<u32> {
        let mut all = Vec::with_capacity(self.rays.len());
        for &ray in self.rays {
            let ray = load_rays(l, std::iter::once(ray));
            let limit = l.real(f64::INFINITY);
            let near = self.balls.near(l, &ray, [l.int(u32::MAX)], limit);
            all.push(l.int_lane(near, 0));
        }
        all
    }
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
