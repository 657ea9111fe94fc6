//! A good floating-point polynomial solver that proves nothing, to measure certified ones by.
//!
//! The family of Yuksel 2022, "High-Performance Polynomial Root Finding for Graphics" (Proc. ACM
//! Comput. Graph. Interact. Tech. 5(3)): the roots of each derivative cut the interval into monotone
//! pieces of the one before it; in each piece with a change of sign Newton's method within a bracket
//! finds the root. Only the first root of the polynomial itself is wanted.

use std::cell::RefCell;

use etalon::inside::field::program::{LARGEST_DEGREE, Program, Step};
use etalon::inside::field::tape::Tape;
use etalon::inside::root::bernstein::DEGREES;
use glam::DVec3;

const ROOM: usize = LARGEST_DEGREE + 1;

pub struct Yardstick {
    program: Program,
    half: f64,
    rows: RefCell<Vec<f64>>,
}

impl Yardstick {
    pub fn new(tape: &Tape, half: f64) -> Self {
        #[expect(clippy::expect_used, reason = "only polynomials are measured")]
        let program = Program::new(tape, &DEGREES).expect("a polynomial");
        let rows = RefCell::new(vec![0.0; program.rows]);
        Self {
            program,
            half,
            rows,
        }
    }

    fn clip(&self, o: DVec3, d: DVec3, t_min: f64) -> Option<[f64; 2]> {
        let inverse = d.recip();
        let (a, b) = ((-self.half - o) * inverse, (self.half - o) * inverse);
        let near = a.min(b).max_element().max(t_min);
        let far = a.max(b).min_element();
        (near < far).then_some([near, far])
    }

    /// The first root on the clipped ray.
    pub fn first_hit(&self, o: DVec3, d: DVec3, t_min: f64) -> Option<f64> {
        let [near, far] = self.clip(o, d, t_min)?;
        let mut powers = [0.0; ROOM];
        let degree = self.powers(o + d * near, d, &mut powers);
        let (c, end) = (&powers[..=degree], far - near);
        let root = match degree {
            0..=4 => first_root::<5>(c, end),
            5..=6 => first_root::<7>(c, end),
            7..=12 => first_root::<13>(c, end),
            _ => first_root::<ROOM>(c, end),
        };
        root.map(|t| near + t)
    }

    /// Coefficients of powers of t about a point; returns the degree.
    fn powers(&self, point: DVec3, d: DVec3, powers: &mut [f64; ROOM]) -> usize {
        let mut rows = self.rows.borrow_mut();
        for step in &self.program.steps {
            match step {
                Step::Coordinate { axis, to } => {
                    rows[to.at] = point[*axis];
                    rows[to.at + 1] = d[*axis];
                }
                Step::Product { a, b, to } => {
                    let (known, result) = rows.split_at_mut(to.at);
                    result[..=to.degree].fill(0.0);
                    for i in 0..=a.degree {
                        let x = known[a.at + i];
                        let other = &known[b.at..=b.at + b.degree];
                        for (r, y) in result[i..].iter_mut().zip(other) {
                            *r += x * *y;
                        }
                    }
                }
                Step::Combination {
                    terms,
                    constant,
                    to,
                } => {
                    let (known, result) = rows.split_at_mut(to.at);
                    result[..=to.degree].fill(0.0);
                    result[0] = constant.parts[0];
                    for (factor, form) in terms {
                        let form = &known[form.at..=form.at + form.degree];
                        for (r, x) in result.iter_mut().zip(form) {
                            *r += factor.parts[0] * *x;
                        }
                    }
                }
            }
        }
        let result = self.program.result;
        powers[..=result.degree].copy_from_slice(&rows[result.at..=result.at + result.degree]);
        let mut degree = result.degree;
        while degree > 0 && powers[degree] == 0.0 {
            degree -= 1;
        }
        degree
    }
}

fn value_and_slope(c: &[f64], t: f64) -> (f64, f64) {
    let (mut f, mut d) = (c[c.len() - 1], 0.0);
    for &c in c[..c.len() - 1].iter().rev() {
        d = d * t + f;
        f = f * t + c;
    }
    (f, d)
}

fn value(c: &[f64], t: f64) -> f64 {
    c.iter().rev().fold(0.0, |f, &c| f * t + c)
}

/// The root in a bracket by Newton's method, with halves where it leaves it, until a step is as short
/// as the result is to be exact.
fn newton(c: &[f64], [mut low, mut high]: [f64; 2], rising: bool, tolerance: f64) -> f64 {
    let mut t = 0.5 * (low + high);
    for _ in 0..60 {
        let (f, d) = value_and_slope(c, t);
        if (f < 0.0) == rising {
            low = t;
        } else {
            high = t;
        }
        let next = t - f / d;
        let next = if next >= low && next <= high {
            next
        } else {
            0.5 * (low + high)
        };
        if (next - t).abs() <= tolerance {
            return next;
        }
        t = next;
    }
    t
}

/// The first root in (0, end) of a polynomial of degree M − 1 at most.
fn first_root<const M: usize>(c: &[f64], end: f64) -> Option<f64> {
    let degree = c.len() - 1;
    // derivatives[k] is the polynomial of degree k.
    let mut derivatives = [[0.0; M]; M];
    derivatives[degree][..=degree].copy_from_slice(c);
    for k in (1..degree).rev() {
        for i in 0..=k {
            derivatives[k][i] = derivatives[k + 1][i + 1] * (i + 1) as f64;
        }
    }
    let mut cuts = [0.0; M];
    let mut count = 0;
    for k in 1..=degree {
        let c = &derivatives[k][..=k];
        let mut roots = [0.0; M];
        let mut found = 0;
        let mut low = 0.0;
        let mut at_low = c[0];
        #[expect(clippy::needless_range_loop, reason = "pieces lie between the cuts")]
        for piece in 0..=count {
            let high = if piece < count { cuts[piece] } else { end };
            let at_high = value(c, high);
            if (at_low < 0.0) != (at_high < 0.0) {
                let root = newton(c, [low, high], at_low < 0.0, 1e-12 * end);
                if k == degree {
                    return Some(root);
                }
                roots[found] = root;
                found += 1;
            }
            (low, at_low) = (high, at_high);
        }
        (cuts, count) = (roots, found);
    }
    None
}
