//! Rays that lanes cannot decide, taken to the certified ladder.

use super::list::{Query, nearest, occluded};
use super::{Hit, Placed, Ray, Start, Tally};

/// The certified shapes of a scene, by their index among all objects.
#[derive(Debug, Clone, Default)]
pub struct Resolver {
    placed: Vec<Placed>,
    objects: Vec<u32>,
    priorities: Vec<u8>,
}

/// The object that a ray leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Departure {
    /// Its index; `u32::MAX` for none.
    pub object: u32,
    /// Whether the ray goes into it.
    pub inward: bool,
}

/// A ray that lanes could not decide.
#[derive(Debug, Clone, Copy)]
pub struct UndecidedRay<'a> {
    /// The objects that it may meet; `None` for all.
    pub candidates: Option<&'a [u32]>,
    pub ray: Ray,
    pub departure: Departure,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolved {
    pub t: f64,
    pub object: u32,
    /// Which of its parts: the axis of a cube's face, else 0.
    pub part: u32,
}

impl Resolver {
    /// Adds object `object`, in increasing order; at equal t the lower priority wins.
    pub fn push(&mut self, object: u32, placed: Placed, priority: u8) {
        self.placed.push(placed);
        self.objects.push(object);
        self.priorities.push(priority);
    }

    /// The shapes to test, with their places in `placed`.
    fn chosen<'a>(
        &'a self,
        candidates: Option<&'a [u32]>,
    ) -> Box<dyn Iterator<Item = (usize, &'a Placed)> + 'a> {
        match candidates {
            None => Box::new(self.placed.iter().enumerate()),
            Some(candidates) => Box::new(candidates.iter().filter_map(|object| {
                let index = self.objects.binary_search(object).ok()?;
                Some((index, &self.placed[index]))
            })),
        }
    }

    /// The first hit at t ≥ 0.
    pub fn nearest(&self, undecided: &UndecidedRay<'_>, tally: &mut Tally) -> Option<Resolved> {
        let UndecidedRay { ray, departure, .. } = *undecided;
        let found = nearest(
            self.chosen(undecided.candidates),
            &before(ray, f64::INFINITY),
            |i| self.start(i, departure),
            |i| self.priorities[i],
            tally,
        );
        if let Some(index) = self.entered(departure)
            && found.as_ref().is_none_or(|(found, _)| *found != index)
            && self.exit(index, &ray, tally).is_none()
        {
            let placed = &self.placed[index];
            return Some(Resolved {
                t: 0.0,
                object: departure.object,
                part: placed.kind.part(placed.ladder.inverse().point(ray.origin)),
            });
        }
        let (index, hit) = found?;
        Some(Resolved {
            t: hit.t,
            object: self.objects[index],
            part: self.placed[index].kind.part(hit.local),
        })
    }

    /// The closed shape that a ray enters from a point of its surface.
    fn entered(&self, departure: Departure) -> Option<usize> {
        let index = self.objects.binary_search(&departure.object).ok()?;
        (departure.inward && !self.placed[index].kind.is_flat()).then_some(index)
    }

    /// Where that ray leaves the shape, at t ≥ 0. Nowhere if its start is rounded to a place outside from
    /// which the line misses; then it has left at the start.
    fn exit(&self, index: usize, ray: &Ray, tally: &mut Tally) -> Option<Hit> {
        self.placed[index].first_hit(ray, 0.0, Start::OnSurfaceInward, tally)
    }

    /// Whether anything but the object `except` lies strictly between the origin and `t_max`.
    pub fn occluded(
        &self,
        undecided: &UndecidedRay<'_>,
        t_max: f64,
        except: u32,
        tally: &mut Tally,
    ) -> bool {
        let UndecidedRay { ray, departure, .. } = *undecided;
        let start = |i: usize| {
            if self.objects[i] == except {
                Start::Excluded
            } else {
                self.start(i, departure)
            }
        };
        if occluded(
            self.chosen(undecided.candidates),
            &before(ray, t_max),
            start,
            tally,
        ) {
            return true;
        }
        // What lies beyond the exit from the shape that the ray enters is hidden, also where the exit is
        // not ahead.
        match self.entered(departure) {
            Some(index) if departure.object != except => {
                let exit = self.exit(index, &ray, tally);
                exit.is_none_or(|exit| exit.t < t_max)
            }
            _ => false,
        }
    }

    fn start(&self, index: usize, departure: Departure) -> Start {
        if self.objects[index] != departure.object {
            Start::Free
        } else if departure.inward {
            Start::OnSurfaceInward
        } else if self.placed[index].kind.is_convex() {
            Start::Excluded
        } else {
            Start::Free
        }
    }
}

fn before(ray: Ray, t_max: f64) -> Query {
    Query {
        ray,
        t_min: 0.0,
        t_max,
    }
}
