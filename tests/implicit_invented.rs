//! Invented polynomials whose roots are known because they were chosen: simple ones, multiple ones,
//! some closer than f64 can tell, complex pairs next to the real line, and leading coefficients
//! large and small.

use etalon::inside::field::tape::{Binary, Operation, Tape};
use etalon::inside::math::affine::Affine;
use etalon::inside::shape::implicit::certified::{Answers, Certified, Effort, Packet, Workspace};
use etalon::inside::shape::ladder::Ladder;
use etalon::{Instructions, Tier};
use glam::DVec3;
use num_bigint::BigInt;
use num_rational::BigRational;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::implicit_oracle::known;
use crate::support::cube;

/// Half the clip box; roots lie well within it.
const HALF: f64 = 2.0;
const MOST: f64 = 1.9;

fn rational(x: f64) -> BigRational {
    BigRational::from_float(x).unwrap()
}

/// A polynomial in x as its coefficients, lowest power first.
struct Invented {
    coefficients: Vec<BigRational>,
    /// Real roots, rising, with their multiplicities.
    roots: Vec<(f64, u32)>,
}

impl Invented {
    fn times(&mut self, factor: &[BigRational]) {
        let zero = BigRational::from_integer(BigInt::ZERO);
        let mut product = vec![zero; self.coefficients.len() + factor.len() - 1];
        for (i, a) in self.coefficients.iter().enumerate() {
            for (j, b) in factor.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        self.coefficients = product;
    }

    fn real_root(&mut self, r: f64) {
        let one = rational(1.0);
        self.times(&[-rational(r), one]);
        match self.roots.iter_mut().find(|(root, _)| *root == r) {
            Some((_, multiplicity)) => *multiplicity += 1,
            None => self.roots.push((r, 1)),
        }
    }

    /// Roots a ± i b.
    fn complex_pair(&mut self, a: f64, b: f64) {
        let (a, b) = (rational(a), rational(b));
        self.times(&[&a * &a + &b * &b, -(&a + &a), rational(1.0)]);
    }

    fn new(random: &mut Pcg64Mcg) -> Self {
        let mut power = || 2.0_f64.powi(random.random_range(-300..300));
        let leading = match power() {
            // Half of them of ordinary size.
            x if x.log2() as i32 % 2 == 0 => 1.0,
            x => -x,
        };
        let mut invented = Self {
            coefficients: vec![rational(leading)],
            roots: Vec::new(),
        };
        let mut last = 0.0;
        for _ in 0..random.random_range(0..4) {
            let apart = 2.0_f64.powi(-random.random_range(10..52));
            last = match random.random_range(0..4) {
                0 => last,
                1 => last + apart,
                _ => random.random_range(-MOST..MOST),
            };
            invented.real_root(last);
        }
        for _ in 0..random.random_range(0..3) {
            let b = 2.0_f64.powi(-random.random_range(0..45));
            let a = match random.random_range(0..2) {
                0 => last,
                _ => random.random_range(-MOST..MOST),
            };
            invented.complex_pair(a, b);
        }
        invented.roots.sort_by(|a, b| a.0.total_cmp(&b.0));
        invented
    }

    /// Σ cᵢ xⁱ: nothing of the way it was made shows.
    fn tape(&self) -> Tape {
        let mut tape = Tape::default();
        let x = tape.push(Operation::Coordinate(0));
        let mut sum = tape.push_constant(self.coefficients[0].clone());
        for (i, c) in self.coefficients.iter().enumerate().skip(1) {
            let c = tape.push_constant(c.clone());
            let power = tape.push(Operation::WholePower(x, i as i32));
            let term = tape.push(Operation::Binary(Binary::Product, c, power));
            sum = tape.push(Operation::Binary(Binary::Sum, sum, term));
        }
        tape
    }
}

/// A ray that crosses the box forwards or backwards, its start inside or outside.
fn ray(random: &mut Pcg64Mcg) -> (DVec3, DVec3) {
    let side = |random: &mut Pcg64Mcg| random.random_range(-0.5..0.5);
    let forwards = if random.random_bool(0.5) { 1.0 } else { -1.0 };
    let start = random.random_range(-4.0..1.0) * forwards;
    let slope = [side(random), side(random)].map(|s: f64| s * 0.1);
    let direction = DVec3::new(forwards, slope[0], slope[1]) * random.random_range(0.1..10.0);
    (DVec3::new(start, side(random), side(random)), direction)
}

/// The root that comes first for t ≥ 0.
fn expected(invented: &Invented, origin: DVec3, direction: DVec3) -> Option<(f64, u32)> {
    let ahead = |(r, _): &&(f64, u32)| (*r >= origin.x) == (direction.x > 0.0) || *r == origin.x;
    let mut roots = invented.roots.iter().filter(ahead).copied();
    if direction.x > 0.0 {
        roots.next()
    } else {
        roots.next_back()
    }
}

/// Whether the enclosure holds the t at which x is r, exactly.
fn holds(answers: &Answers, origin: DVec3, direction: DVec3, r: f64) -> bool {
    let ends = [answers.low[0], answers.high[0]];
    let [a, b] = ends.map(|t| rational(t) * rational(direction.x) + rational(origin.x));
    let (low, high) = if a <= b { (a, b) } else { (b, a) };
    let r = rational(r);
    low <= r && r <= high
}

#[test]
fn invented_polynomials_are_isolated_as_they_were_made() {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let sets = Instructions::all().into_iter();
    let mut workspaces: Vec<Workspace> = sets.map(Workspace::new).collect();
    let (sharp, exact) = (true, true);
    let effort = Effort { sharp, exact };
    let mut tiers = [0; 3];
    for case in 0..1000 {
        let invented = Invented::new(&mut random);
        let tape = invented.tape();
        let ladder = Ladder::new(&Affine::IDENTITY).unwrap();
        let certified = Certified::new(&tape, cube(HALF), &ladder).unwrap();
        for _ in 0..4 {
            let (origin, direction) = ray(&mut random);
            let mut packet = Packet::default();
            packet.set(0, origin, direction, [0.0, f64::INFINITY]);
            let ask = |w| certified.first_hits(&packet, effort, w);
            let all: Vec<Answers> = workspaces.iter_mut().map(ask).collect();
            let answers = all[0];
            let same = |other: &Answers| known(other, 0) == known(&answers, 0);
            assert!(all.iter().all(same), "case {case}: {all:?}");
            let expected = expected(&invented, origin, direction);
            let found = answers.found & 1 == 1;
            assert!(found != (answers.absent & 1 == 1), "case {case}: undecided");
            let roots = &invented.roots;
            assert_eq!(found, expected.is_some(), "case {case}: {roots:?}");
            tiers[answers.tiers[0] as usize] += 1;
            let Some((root, multiplicity)) = expected else {
                continue;
            };
            let held = holds(&answers, origin, direction, root);
            assert!(held, "case {case}: {root} of {roots:?}");
            let told = answers.multiplicity[0];
            assert!(told == 0 || told == multiplicity, "case {case}: {told}");
        }
    }
    println!("decided in f64, double-double, exactly: {tiers:?}");
    // Each tier has had its share of the work.
    assert!(tiers.iter().all(|&count| count > 50), "{tiers:?}");
    assert_eq!(Tier::Exact as usize, 2);
}
