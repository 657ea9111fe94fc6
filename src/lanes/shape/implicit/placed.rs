//! An implicit surface in the world and a ray's first hit with it, by the finder of its choice.

pub use super::baseline::ImplicitHit;
use super::baseline::SteppingFinder;
use super::certified::{Answers, Certified, Effort, Packet, Workspace};
use super::enclosed::{EnclosedPacket, Method};
use crate::math::affine::Affine;
use crate::shape::implicit::{FinderChoice, Implicit};
use crate::shape::{Query, Ray, SingularMatrix, Tally};

use glam::DVec3;

#[derive(Debug, Clone)]
pub enum Finder {
    /// Equal steps and bisection: proves nothing.
    SignChange,
    Polynomial {
        certified: Box<Certified>,
        /// Whether what double-double leaves undecided is decided exactly.
        exact: bool,
    },
    /// Interval subdivision, or sphere tracing with a proved bound.
    Enclosed(Box<EnclosedPacket>),
}

impl Finder {
    /// The finder that a surface asks for; `auto` is certified isolation for polynomials, and
    /// interval subdivision for other fields.
    ///
    /// # Errors
    /// [`SingularMatrix`] where the matrix is singular or has an entry that is not finite.
    pub fn new(implicit: &Implicit, to_world: &Affine) -> Result<Self, SingularMatrix> {
        let enclosed = |method| {
            let placed = EnclosedPacket::new(implicit, to_world, method)?;
            Ok(Self::Enclosed(Box::new(placed)))
        };
        let exact = match implicit.finder {
            FinderChoice::Auto => true,
            FinderChoice::Polynomial => false,
            FinderChoice::SignChange => return Ok(Self::SignChange),
            FinderChoice::Interval => return enclosed(Method::Subdivision),
            FinderChoice::SphereTrace => return enclosed(Method::Spheres),
        };
        match Certified::new(&implicit.field.tape, implicit.inside, to_world)? {
            Some(certified) => Ok(Self::Polynomial {
                certified: Box::new(certified),
                exact,
            }),
            None => enclosed(Method::Subdivision),
        }
    }

    /// The first hits of a packet; `None` from the finder that proves nothing. `sharp` asks for
    /// narrow enclosures where they cost more.
    pub fn first_hits(
        &self,
        packet: &Packet,
        sharp: bool,
        workspace: &mut Workspace,
    ) -> Option<Answers> {
        match self {
            Self::SignChange => None,
            Self::Polynomial { certified, exact } => {
                let effort = Effort {
                    sharp,
                    exact: *exact,
                };
                Some(certified.first_hits(packet, effort, workspace))
            }
            Self::Enclosed(enclosed) => Some(enclosed.first_hits(workspace.instructions, packet)),
        }
    }

    pub fn name(&self) -> &'static str {
        match self {
            Self::SignChange => "sign-change",
            Self::Polynomial { .. } => "polynomial",
            Self::Enclosed(enclosed) => match enclosed.method {
                Method::Subdivision => "interval",
                Method::Spheres => "sphere-trace",
            },
        }
    }
}

#[derive(Debug, Clone)]
pub struct PlacedImplicit {
    stepping: SteppingFinder,
    finder: Finder,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ImplicitAnswer {
    Found(ImplicitHit),
    Absent,
    /// The finder's arithmetic or its work bound did not suffice.
    Undecided,
}

impl PlacedImplicit {
    /// Places the surface.
    ///
    /// # Errors
    /// [`SingularMatrix`] where the matrix is singular or has an entry that is not finite.
    pub fn new(implicit: &Implicit, to_world: &Affine) -> Result<Self, SingularMatrix> {
        Ok(Self {
            stepping: SteppingFinder::new(implicit, to_world)?,
            finder: Finder::new(implicit, to_world)?,
        })
    }

    pub fn finder(&self) -> &Finder {
        &self.finder
    }

    /// The first hit with `t_min` < t < `t_max` inside the clip box; t = 0 counts where `t_min` is
    /// 0.
    pub fn first_hit(
        &self,
        query: &Query,
        workspace: &mut Workspace,
        tally: &mut Tally,
    ) -> ImplicitAnswer {
        match self.first_crossing(query, workspace, tally) {
            ImplicitAnswer::Found(hit) if hit.tier.is_some() => {
                ImplicitAnswer::Found(ImplicitHit {
                    normal: self.normal(&query.ray, hit.t, hit.enclosure),
                    ..hit
                })
            }
            answer => answer,
        }
    }

    /// The same without the normal, which takes longer than all else where it has to be exact.
    pub fn first_crossing(
        &self,
        query: &Query,
        workspace: &mut Workspace,
        tally: &mut Tally,
    ) -> ImplicitAnswer {
        if !query.ray.is_valid() {
            return ImplicitAnswer::Absent;
        }
        let mut packet = Packet::default();
        let limits = [query.t_min, query.t_max];
        packet.set(0, query.ray.origin, query.ray.direction, limits);
        let answers = self.finder.first_hits(&packet, true, workspace);
        let Some(answers) = answers else {
            tally.uncertified += 1;
            let stepped = self.stepping.first_hit(query);
            return stepped.map_or(ImplicitAnswer::Absent, ImplicitAnswer::Found);
        };
        let decided = (answers.found | answers.absent) & 1 == 1;
        tally.count(decided.then_some(answers.tiers[0]));
        if answers.found & 1 == 1 {
            let t = answers.t[0];
            let multiplicity = answers.multiplicity[0];
            let enclosure = [answers.low[0], answers.high[0]];
            ImplicitAnswer::Found(ImplicitHit {
                t,
                point: self.stepping.point_at(&query.ray, t),
                normal: None,
                enclosure,
                multiplicity: (multiplicity > 0).then_some(multiplicity),
                tier: Some(answers.tiers[0]),
            })
        } else if decided {
            ImplicitAnswer::Absent
        } else {
            ImplicitAnswer::Undecided
        }
    }

    /// The unit outward normal of a hit, as sharp as its enclosure where that determines it, else at
    /// the exact root, else by the rule for singular points.
    fn normal(&self, ray: &Ray, t: f64, enclosure: [f64; 2]) -> Option<DVec3> {
        let within = (t - enclosure[0]).max(enclosure[1] - t);
        let certain = self.stepping.certain_normal(ray, t, within);
        let exact = || match &self.finder {
            Finder::Polynomial { certified, .. } => {
                let tape = self.stepping.tape();
                let gradient = certified.gradient_direction(tape, ray, enclosure)?;
                self.stepping.world_normal(gradient)
            }
            _ => None,
        };
        certain
            .or_else(exact)
            .or_else(|| self.stepping.normal_at(ray, t))
    }
}
