//! An implicit surface placed in the world, and a ray's first hit with it by the surface's finder.

pub use super::baseline::ImplicitHit;
use super::baseline::SteppingFinder;
use super::certified::{Packet, Workspace};
use super::finder::Finder;
use crate::math::affine::Affine;
use crate::shape::implicit::Implicit;
use crate::shape::{Query, Ray, SingularMatrix, Tally};

use glam::DVec3;

#[derive(Debug, Clone)]
pub struct PlacedImplicit {
    stepping: SteppingFinder,
    pub finder: Finder,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ImplicitAnswer {
    Found(ImplicitHit),
    Absent,
    /// The finder's arithmetic or its work bound did not suffice.
    Undecided,
}

impl PlacedImplicit {
    pub fn new(implicit: &Implicit, to_world: &Affine) -> Result<Self, SingularMatrix> {
        let stepping = SteppingFinder::new(implicit, to_world)?;
        Ok(Self {
            finder: Finder::new(implicit, &stepping.ladder),
            stepping,
        })
    }

    /// The first hit with `t_min` < t < `t_max` inside the clip box; t = 0 counts where `t_min` is 0.
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

    /// [`Self::first_hit`] without the normal, which takes longer than all else where it must be exact.
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
        let Some(prover) = &self.finder.prover else {
            tally.uncertified += 1;
            let stepped = self.stepping.first_hit(query);
            return stepped.map_or(ImplicitAnswer::Absent, ImplicitAnswer::Found);
        };
        let answers = prover.first_hits(&packet, true, workspace);
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
        let exact = || {
            let (tape, prover) = (&self.stepping.field.tape, self.finder.prover.as_ref()?);
            let gradient = prover.gradient_direction(tape, ray, enclosure)?;
            self.stepping.world_normal(gradient)
        };
        certain
            .or_else(exact)
            .or_else(|| self.stepping.normal_at(ray, t))
    }
}
