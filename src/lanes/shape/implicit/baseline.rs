//! Implicit surfaces by changes of sign, in scalar f64: equal steps along the clipped ray, then
//! bisection.
//!
//! This proves nothing: roots that do not change the sign are missed, and so is a pair of roots within
//! one step. It is the yardstick for certified finders, which take points and normals of their hits
//! from here.

use glam::DVec3;

use crate::field::evaluate::Field;
use crate::field::{bounded, normal};
use crate::math::affine::Affine;
use crate::math::double_double::DoubleDouble;
use crate::math::number::{Number, power_of_two};
use crate::root::sign_change::first_change;
use crate::shape::implicit::finder::{Finder, RootFinder};
use crate::shape::implicit::{FinderChoice, Implicit};
use crate::shape::ladder::{Ladder, ScaledRay};
use crate::shape::{Query, Ray, SingularMatrix, Tier};

#[derive(Debug, Clone)]
pub struct SteppingFinder {
    pub field: Field,
    inside: [DVec3; 2],
    steps: u32,
    pub ladder: Ladder,
    to_world: Affine,
}

/// The finder by changes of sign, of which each caller has its own.
pub struct SignChange;

impl RootFinder for SignChange {
    const NAME: &'static str = "sign-change";
    const WORDS: &'static str = "equal steps and bisection, not certified";

    fn place(_: &Implicit, _: &Ladder) -> Finder {
        Finder {
            kind: FinderChoice::SignChange,
            prover: None,
        }
    }
}

/// Where a ray meets an implicit surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImplicitHit {
    /// In units of the ray's direction; finite.
    pub t: f64,
    /// World coordinates.
    pub point: DVec3,
    /// Unit outward normal in the world; see [`normal`] for where the gradient vanishes.
    pub normal: Option<DVec3>,
    /// Bounds of t; t twice where nothing is proved.
    pub enclosure: [f64; 2],
    /// Multiplicity of the root along the ray, where it is known.
    pub multiplicity: Option<u32>,
    /// What has decided; `None` where nothing is proved.
    pub tier: Option<Tier>,
}

impl SteppingFinder {
    pub fn new(implicit: &Implicit, to_world: &Affine) -> Result<Self, SingularMatrix> {
        Ok(Self {
            field: Field::new(&implicit.field.tape),
            inside: implicit.inside,
            steps: implicit.steps,
            ladder: Ladder::new(to_world)?,
            to_world: *to_world,
        })
    }

    /// The first zero of the field, or change of its sign between two steps, with `t_min` < t <
    /// `t_max` inside the clip box; t = 0 counts where `t_min` is 0.
    pub fn first_hit(&self, query: &Query) -> Option<ImplicitHit> {
        if !query.ray.is_valid() {
            return None;
        }
        let ray = ScaledRay::new(&query.ray);
        let line = self.local(&ray);
        // t is counted in units of the scaled direction, whose largest component is near 1.
        let unit = power_of_two(ray.exponent);
        let limits = [query.t_min * unit, query.t_max * unit];
        let scaled_t = self.first_root(&line, limits, query.t_min == 0.0)?;
        let t = scaled_t / unit;
        let normal = self.normal(line.at(scaled_t), line.direction);
        let point = query.ray.at(t);
        (t.is_finite() && point.is_finite()).then_some(ImplicitHit {
            t,
            point,
            normal,
            enclosure: [t, t],
            multiplicity: None,
            tier: None,
        })
    }

    /// The unit outward normal, in the world, of a hit at t.
    pub fn normal_at(&self, ray: &Ray, t: f64) -> Option<DVec3> {
        let ray = ScaledRay::new(ray);
        let line = self.local(&ray);
        self.normal(line.at(t * power_of_two(ray.exponent)), line.direction)
    }

    /// The unit outward normal, in the world, of a hit at t ± `within`, where f64 is certain of it.
    pub fn certain_normal(&self, ray: &Ray, t: f64, within: f64) -> Option<DVec3> {
        let scaled = ScaledRay::new(ray);
        let line = self.ladder.double_double.local(&scaled);
        let at = scaled.scaled_t::<DoubleDouble>(t);
        let over = |x: &DoubleDouble| x.divided_by(&line.scale).to_f64();
        let point = [0, 1, 2].map(|i| over(&line.origin[i].plus(&line.direction[i].times(&at))));
        let fastest = line.direction.iter().map(|d| over(d).abs());
        // The rounding of a point from double-double is that of its last digit.
        let moved = fastest.fold(0.0, f64::max) * within * power_of_two(scaled.exponent);
        let (gradient, error) = bounded::gradient(&self.field, point.into(), 2.0 * moved);
        // Written so that NaN fails.
        let certain = error <= gradient.length() * normal::SHARP;
        self.world_normal(gradient).filter(|_| certain)
    }

    /// The point, in the world, of a hit at t. From a far origin o + t d is off by the rounding of its
    /// large terms, so it is moved onto the surface by a Newton step along the gradient, unless that is
    /// longer than rounding explains.
    pub fn point_at(&self, ray: &Ray, t: f64) -> DVec3 {
        let plain = ray.at(t);
        let scaled = ScaledRay::new(ray);
        let line = self.local(&scaled);
        let scaled_t = t * power_of_two(scaled.exponent);
        let local = line.at(scaled_t);
        let gradient = self.field.gradient(local);
        let step = gradient * (self.field.value(local) / gradient.length_squared());
        // o, d, t, their product and sum and the map are each off by u of the terms: 8u with some room.
        let terms = line.origin.abs() + (line.direction * scaled_t).abs();
        let blur = 4.0 * f64::EPSILON * terms.max_element();
        if step.length() <= blur {
            self.to_world.point(local - step)
        } else {
            plain
        }
    }

    /// The ray in object coordinates, rounded once from double-double.
    fn local(&self, ray: &ScaledRay) -> Ray {
        let line = self.ladder.double_double.local(ray);
        let divided = |v: &[DoubleDouble; 3]| {
            DVec3::from_array(v.each_ref().map(|x| x.divided_by(&line.scale).to_f64()))
        };
        Ray {
            origin: divided(&line.origin),
            direction: divided(&line.direction),
        }
    }

    /// Of the neighbouring f64 between which the sign changes, the one with the smaller |field|.
    fn first_root(&self, line: &Ray, limits: [f64; 2], from_zero: bool) -> Option<f64> {
        let [t_min, t_max] = limits;
        let [near, far] = self.clip(line, limits)?;
        let value = |t: f64| self.field.value(line.at(t));
        let first = value(near);
        if first == 0.0 && (near > t_min || from_zero) {
            return (near < t_max).then_some(near);
        }
        let [low, high] = first_change(value, [near, far], self.steps)?;
        let lower = value(low).abs() < value(high).abs();
        let t = if lower { low } else { high };
        (t > t_min && t < t_max).then_some(t)
    }

    /// The part of the line within the closed clip box and the limits.
    fn clip(&self, line: &Ray, [mut near, mut far]: [f64; 2]) -> Option<[f64; 2]> {
        let [lower, upper] = self.inside;
        for axis in 0..3 {
            let (o, d) = (line.origin[axis], line.direction[axis]);
            if d == 0.0 {
                if o < lower[axis] || o > upper[axis] {
                    return None;
                }
                continue;
            }
            let (t1, t2) = ((lower[axis] - o) / d, (upper[axis] - o) / d);
            near = near.max(t1.min(t2));
            far = far.min(t1.max(t2));
        }
        (near <= far && near.is_finite() && far.is_finite()).then_some([near, far])
    }

    /// Normals go by the inverse transpose; the adjugate has the sign that keeps them outward.
    fn normal(&self, point: DVec3, direction: DVec3) -> Option<DVec3> {
        let size = (self.inside[1] - self.inside[0]).max_element();
        self.world_normal(normal::outward(&self.field, point, direction, size))
    }

    /// The unit vector in the world that a gradient in object coordinates becomes.
    pub fn world_normal(&self, gradient: DVec3) -> Option<DVec3> {
        let rows = self.ladder.double_double.adjugate.each_ref();
        let rows = rows.map(|row| DVec3::from_array(row.each_ref().map(Number::to_f64)));
        let normal = rows[0] * gradient.x + rows[1] * gradient.y + rows[2] * gradient.z;
        // The squares of very short or long normals would leave the range of f64.
        (normal / normal.abs().max_element()).try_normalize()
    }
}
