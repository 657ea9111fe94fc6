//! Implicit surfaces in lanes.
//!
//! Finders that prove their answers work in f64, whatever the precision of the loop, on packets of
//! eight rays. The finder by changes of sign, in lanes here, is that of
//! [`baseline`](crate::shape::implicit::baseline).

use std::cell::RefCell;

use glam::DVec3;

use crate::field::evaluate::{Field, each};
use crate::field::normal;
use crate::math::affine::Affine;
use crate::math::instructions::Instructions;
use crate::math::lanes::{Lanes, Mask, Real, Scalar, WIDEST};
use crate::math::packet::array;
use crate::math::vec3::{Rows, Vec3};
use crate::shape::Tally;
use crate::shape::hierarchy::{Bounds, OuterBox};
use crate::shape::implicit::Implicit;
use crate::shape::implicit::certified::{Packet, WIDTH, Workspace};
use crate::shape::implicit::finder::{Finder, Prover};
use crate::shape::ladder::Ladder;

use super::LaneRay;

#[derive(Debug, Clone)]
pub struct LaneImplicit<T> {
    field: Field<T>,
    /// The field in f64 and the largest edge of the box, for normals where the gradient vanishes.
    scalar: Field,
    size: f64,
    centre: [T; 3],
    half: [T; 3],
    steps: u32,
    inverse: Rows<T>,
    /// The clip box's image.
    bounds: OuterBox<T>,
    /// 16u of a world coordinate of 1 (see [`Packet::roundoff`]), as a length in object coordinates.
    rounding: T,
    pub finder: Finder,
}

thread_local! {
    // Room for the polynomials of a packet.
    static WORKSPACE: RefCell<Workspace> = RefCell::default();
}

/// Steps evaluated together: reading an operation from the tape costs about as much as executing three.
const STRIDE: usize = 4;

/// The sign of the field just after the start, for rays that start on the surface.
#[derive(Clone, Copy)]
pub struct StartSign<L: Lanes> {
    /// Lanes that start on this surface.
    pub on: L::Mask,
    /// Of those, the ones that go inward, where the field is negative.
    pub inward: L::Mask,
}

/// Rays that are tested against an implicit surface.
#[derive(Clone, Copy)]
pub struct FieldQuestion<'a, L: Lanes> {
    pub ray: &'a LaneRay<L>,
    pub start: StartSign<L>,
    /// Hits count before this.
    pub limit: L::Real,
    pub active: L::Mask,
}

impl<T: Scalar> LaneImplicit<T> {
    pub fn new(implicit: &Implicit, to_world: &Affine, ladder: &Ladder) -> Self {
        let inverse = ladder.inverse();
        let inside = implicit.inside;
        let centre = (inside[0] + inside[1]) / 2.0;
        let half = (inside[1] - inside[0]) / 2.0;
        let largest_row = inverse.abs().vector(DVec3::ONE).max_element();
        Self {
            field: Field::new(&implicit.field.tape),
            scalar: Field::new(&implicit.field.tape),
            size: (inside[1] - inside[0]).max_element(),
            centre: centre.to_array().map(T::from_f64),
            half: half.to_array().map(T::from_f64),
            steps: implicit.steps,
            inverse: Rows::from_f64(&inverse.rows),
            bounds: OuterBox::new(&Bounds::around_image(to_world, inside[0], inside[1])),
            rounding: T::from_f64(16.0 * T::ROUNDOFF * largest_row),
            finder: Finder::new(implicit, ladder),
        }
    }

    /// The first hits before `limit`; where the mask is false, none is known.
    ///
    /// The ray is clipped to the surface's own box and the hit compared with the limit afterwards, so
    /// that a hit's last digits do not depend on what was tested before.
    #[inline(never)]
    pub fn first_hit<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        question: &FieldQuestion<'_, L>,
        tally: &mut Tally,
    ) -> (L::Real, L::Mask) {
        l.vectorize(inlined!(|| {
            let FieldQuestion {
                ray,
                start,
                limit,
                active,
            } = *question;
            let inverse = ray.direction.reciprocal(l);
            let active = active & self.bounds.meets(l, ray.origin, inverse, limit);
            if !active.any() {
                return (limit, active);
            }
            let (t, found) = match &self.finder.prover {
                None => {
                    tally.uncertified += u64::from(active.bits().count_ones());
                    self.first_change(l, ray, start, active)
                }
                Some(prover) => {
                    let arrays =
                        inlined!(|v: Vec3<L::Real>| [array(l, v.x), array(l, v.y), array(l, v.z)]);
                    let rays = [arrays(ray.origin), arrays(ray.direction)];
                    let bits = [active.bits(), start.on.bits()];
                    let set = l.instructions();
                    let (t, found) = ask(&rays, set, &**prover, bits, L::COUNT, tally);
                    (l.load(&t), l.mask_from_bits(found))
                }
            };
            (t, found & t.lt(limit))
        }))
    }

    /// Outward normals at object points that are met in these directions: the gradient, of any
    /// length; where it vanishes, the unit normal that [`normal::outward`] finds. And the steps onto the
    /// surface, for points that rounding on a long way has put off it.
    ///
    /// A point p = o + t d is off by roundings of |o| and |t d|, at most 16 u `reach` in each coordinate
    /// with u the unit roundoff and `reach` the sum of both (as for the start of a ray, see
    /// [`Packet::roundoff`]); a ray that leaves it is taken to start within 16 u `extent`, with `extent`
    /// the largest of the point's own coordinates. A Newton step along the gradient that is longer
    /// than half of the latter and within the former is one that this rounding explains.
    #[inline(always)]
    pub fn surface<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
        [extent, reach]: [L::Real; 2],
        here: L::Mask,
    ) -> (Vec3<L::Real>, Vec3<L::Real>) {
        let (value, gradient) = self.field.with_gradient(l, p);
        let normal = self.or_found(l, gradient, p, direction, here);
        let step = gradient.scale(value / gradient.length_squared());
        let rounding = l.splat(self.rounding);
        let length = step.max_abs();
        let explained = length.gt(extent * rounding * l.real(0.5)) & length.le(reach * rounding);
        let nothing = l.real(0.0);
        let nothing = Vec3::new(nothing, nothing, nothing);
        (normal, Vec3::select(l, explained, step, nothing))
    }

    /// Gradients that are there; for the others, the unit normal that [`normal::outward`] finds.
    #[inline(always)]
    fn or_found<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        mut gradient: Vec3<L::Real>,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
        here: L::Mask,
    ) -> Vec3<L::Real> {
        let square = gradient.length_squared();
        let defined = square.gt(l.real(0.0)) & square.lt(l.real(f64::INFINITY));
        let mut missing = (here & !defined).bits();
        while missing != 0 {
            let i = missing.trailing_zeros() as usize;
            missing &= missing - 1;
            let lane = |v: Vec3<L::Real>| {
                let [x, y, z] = [v.x, v.y, v.z].map(|x| l.lane(x, i).to_f64());
                DVec3::new(x, y, z)
            };
            let normal = normal::outward(&self.scalar, lane(p), lane(direction), self.size);
            let put = |x: L::Real, value: f64| l.with_lane(x, i, T::from_f64(value));
            gradient = Vec3::new(
                put(gradient.x, normal.x),
                put(gradient.y, normal.y),
                put(gradient.z, normal.z),
            );
        }
        gradient
    }

    /// The first sign change along each ray; where the mask is false, none.
    #[inline(never)]
    pub fn first_change<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        ray: &LaneRay<L>,
        start: StartSign<L>,
        active: L::Mask,
    ) -> (L::Real, L::Mask) {
        l.vectorize(inlined!(|| {
            let o = self.inverse.point(l, ray.origin);
            let d = self.inverse.vector(l, ray.direction);
            let zero = l.real(0.0);
            let (mut near, mut far) = (zero, l.real(f64::INFINITY));
            for (o, d, c, h) in [
                (o.x, d.x, self.centre[0], self.half[0]),
                (o.y, d.y, self.centre[1], self.half[1]),
                (o.z, d.z, self.centre[2], self.half[2]),
            ] {
                let inverse = l.real(1.0) / d;
                let (c, h) = (l.splat(c), l.splat(h));
                let (t1, t2) = ((c - h - o) * inverse, (c + h - o) * inverse);
                near = t1.min(t2).max(near);
                far = t1.max(t2).min(far);
            }
            let clipped = active & near.lt(far);
            let mut found = l.mask(false);
            let (mut low, mut high) = (near, near);
            if !clipped.any() {
                return (near, found);
            }
            let mut scratch = Vec::<[L::Real; 1]>::new();
            let mut value = inlined!(|p| self.field.values(l, [p], &mut scratch)[0]);
            let mut scratch = Vec::<[L::Real; STRIDE]>::new();
            let step = (far - near) * l.real(1.0 / f64::from(self.steps));
            let mut negative = value(o.along(d, near)).lt(zero);
            // On the surface the field's sign at the start is rounding noise, its sign after it known.
            negative = (negative & !start.on) | (start.inward & start.on);
            let mut t = near;
            for first in (1..=self.steps).step_by(STRIDE) {
                let steps: [L::Real; STRIDE] = each(
                    zero,
                    inlined!(|i: usize| {
                        // Beyond the last step it is asked again, which changes nothing.
                        let number = (first + i as u32).min(self.steps);
                        step.mul_add(l.real(f64::from(number)), near)
                    }),
                );
                let points: [Vec3<L::Real>; STRIDE] =
                    each(o, inlined!(|i: usize| o.along(d, steps[i])));
                let values = self.field.values(l, points, &mut scratch);
                for (next, value) in steps.into_iter().zip(values) {
                    let change_to = value.lt(zero);
                    let changed =
                        ((change_to & !negative) | (negative & !change_to)) & clipped & !found;
                    low = l.select(changed, t, low);
                    high = l.select(changed, next, high);
                    found = found | changed;
                    t = next;
                }
                if !(clipped & !found).any() {
                    break;
                }
            }
            if !found.any() {
                return (near, found);
            }
            // Half the step as often as the significand has bits.
            for _ in 0..L::UNIFORM_BITS.max(24) {
                let middle = (low + high) * l.real(0.5);
                let inside = value(o.along(d, middle)).lt(zero);
                let same = (inside & negative) | (!inside & !negative);
                low = l.select(same, middle, low);
                high = l.select(same, high, middle);
            }
            ((low + high) * l.real(0.5), found)
        }))
    }
}

/// Asks a finder that proves its answers, eight rays at a time, given by origins and directions:
/// `active` and `leaving` rays by bit.
#[inline(never)]
fn ask<T: Scalar>(
    [origin, direction]: &[[[T; WIDEST]; 3]; 2],
    instructions: Instructions,
    prover: &dyn Prover,
    [active, leaving]: [u32; 2],
    count: usize,
    tally: &mut Tally,
) -> ([T; WIDEST], u32) {
    let mut t = [T::default(); WIDEST];
    let mut found = 0;
    for base in (0..count).step_by(WIDTH) {
        let mut packet = Packet {
            active: active >> base & 0xff,
            leaving: leaving >> base & 0xff,
            roundoff: T::ROUNDOFF,
            ..Packet::default()
        };
        if packet.active == 0 {
            continue;
        }
        for lane in 0..WIDTH {
            for axis in 0..3 {
                packet.origin[axis][lane] = origin[axis][base + lane].to_f64();
                packet.direction[axis][lane] = direction[axis][base + lane].to_f64();
            }
        }
        let answers = WORKSPACE.with_borrow_mut(|workspace| {
            workspace.instructions = instructions;
            prover.first_hits(&packet, false, workspace)
        });
        let decided = answers.found | answers.absent;
        for lane in (0..WIDTH).filter(|lane| packet.active >> lane & 1 == 1) {
            t[base + lane] = T::from_f64(answers.t[lane]);
            tally.count((decided >> lane & 1 == 1).then_some(answers.tiers[lane]));
        }
        found |= (answers.found & packet.active) << base;
    }
    (t, found)
}
