//! Families of rays that grow harder by one number.

use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::Subject;
use super::textbook::{affine, inverse};
use crate::finders::implicit;
use etalon::inside::field::evaluate::Field;
use etalon::inside::field::expression::{Expression, parse};
use etalon::inside::field::named;
use etalon::inside::math::affine::Affine;
use etalon::inside::scene::Implicit;
use etalon::inside::shape::implicit::certified::Certified;
use etalon::inside::shape::ladder::Ladder;
use etalon::inside::shape::{Ray, ShapeKind};

/// What makes rays hard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// The line passes the silhouette at a small distance, on either side.
    Graze,
    /// The ray comes from afar.
    Distance,
    /// The placing matrix is nearly singular, in no direction of its own.
    Condition,
    /// Two surfaces lie close to each other.
    Gap,
    /// The object is thin along its z axis.
    Aspect,
}

/// All of them, in the order of the picture's columns.
pub const FAMILIES: [Family; 5] = [
    Family::Graze,
    Family::Distance,
    Family::Condition,
    Family::Gap,
    Family::Aspect,
];

impl Family {
    /// Its name, what its number is, and the first and the last of the numbers as powers of ten, easy
    /// ones first.
    fn facts(self) -> (&'static str, &'static str, [i32; 2]) {
        match self {
            Self::Graze => ("graze", "offset from silhouette", [-1, -14]),
            Self::Distance => ("distance", "distance / size", [0, 9]),
            Self::Condition => ("condition", "condition number", [0, 12]),
            Self::Gap => ("gap", "gap between sheets", [-1, -12]),
            Self::Aspect => ("aspect", "aspect ratio", [0, 12]),
        }
    }

    pub fn name(self) -> &'static str {
        self.facts().0
    }

    /// What its number is, for an axis.
    pub fn axis(self) -> &'static str {
        self.facts().1
    }

    /// Its numbers as powers of ten, easy ones first.
    pub fn exponents(self) -> Vec<i32> {
        let [first, last] = self.facts().2;
        let harder = if first < last { 1 } else { -1 };
        (0..=(last - first).abs())
            .map(|i| first + harder * i)
            .collect()
    }
}

#[derive(Debug, Clone)]
pub struct Body {
    /// Canonical or object coordinates → world.
    pub to_world: Affine,
    pub kind: Option<ShapeKind>,
    pub implicit: Option<Implicit>,
    /// The same with exact arithmetic.
    pub certified: Option<Certified>,
}

/// Bodies, and rays that are asked for their first hit.
#[derive(Debug, Clone)]
pub struct Problem {
    pub bodies: Vec<Body>,
    pub rays: Vec<Ray>,
    /// Size of an object in the world, for what counts as the same hit.
    pub size: f64,
    /// Where a camera would stand that sees the object from as far as the rays come.
    pub camera: DVec3,
}

/// A surface by itself, in its own box.
struct Model {
    expression: Arc<Expression>,
    half: f64,
}

fn unit(random: &mut Pcg64Mcg) -> DVec3 {
    loop {
        let mut one = || random.random_range(-1.0..1.0);
        let v = DVec3::new(one(), one(), one());
        let square = v.length_squared();
        if square > 1e-3 && square <= 1.0 {
            return v / square.sqrt();
        }
    }
}

fn rotation(random: &mut Pcg64Mcg) -> DMat3 {
    DMat3::from_quat(DQuat::from_axis_angle(
        unit(random),
        random.random_range(0.3..2.8),
    ))
}

/// The placing matrix of a family at a difficulty.
fn placing(family: Family, difficulty: f64, random: &mut Pcg64Mcg) -> Affine {
    let shift = unit(random) * 0.3;
    let squeezed = |x: f64| DMat3::from_diagonal(DVec3::new(1.0, x.sqrt(), x));
    let linear = match family {
        Family::Condition => rotation(random) * squeezed(1.0 / difficulty) * rotation(random),
        Family::Aspect => DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1.0 / difficulty)),
        _ => rotation(random),
    };
    affine(linear, shift)
}

/// A point of a canonical shape's silhouette, its outward direction, and that of a line that touches
/// the shape there.
fn touching(kind: ShapeKind, random: &mut Pcg64Mcg) -> [DVec3; 3] {
    let angle: f64 = random.random_range(0.0..std::f64::consts::TAU);
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    let radial = DVec3::new(cosine, sine, 0.0);
    let across = DVec3::new(-sine, cosine, 0.0);
    let along: f64 = random.random_range(-0.9..0.9);
    let mixed = |a: DVec3, b: DVec3, random: &mut Pcg64Mcg| {
        let turn: f64 = random.random_range(0.2..1.3);
        (a * libm::cos(turn) + b * libm::sin(turn)).normalize()
    };
    match kind {
        ShapeKind::Sphere => {
            let p = unit(random);
            [p, p, p.cross(unit(random)).normalize()]
        }
        ShapeKind::Cube => {
            let n = DVec3::new(1.0, 1.0, 0.0).normalize();
            let line = mixed(DVec3::Z, DVec3::new(1.0, -1.0, 0.0).normalize(), random);
            [DVec3::new(1.0, 1.0, along), n, line]
        }
        ShapeKind::Cylinder if random.random_bool(0.5) => {
            let line = mixed(across, DVec3::Z, random);
            [radial + DVec3::Z * along, radial, line]
        }
        ShapeKind::Cylinder => {
            let line = mixed(across, (radial - DVec3::Z).normalize(), random);
            [radial + DVec3::Z, (radial + DVec3::Z).normalize(), line]
        }
        ShapeKind::Disk => [radial, radial, mixed(DVec3::Z, across, random)],
        ShapeKind::Rectangle => {
            let line = mixed(DVec3::Z, DVec3::Y, random);
            [DVec3::new(1.0, along, 0.0), DVec3::X, line]
        }
        // It has no silhouette but the horizon.
        ShapeKind::Plane => [radial * along, DVec3::Z, radial],
    }
}

impl Problem {
    /// A family at a difficulty, with this many rays; the same for the same arguments.
    pub fn new(subject: Subject, family: Family, exponent: i32, rays: usize) -> Option<Self> {
        let seed = 1 + subject.index() as u64 * 1_000 + exponent.unsigned_abs() as u64;
        let mut random = Pcg64Mcg::seed_from_u64(seed * 8 + family as u64);
        let difficulty = 10f64.powi(exponent);
        let to_world = placing(family, difficulty, &mut random);
        let gap = (family == Family::Gap).then_some(difficulty);
        let model = match subject {
            Subject::Canonical(_) => None,
            Subject::Implicit(name) => Some(Model::new(name, gap)?),
        };
        let bodies = bodies(subject, &to_world, gap, model.as_ref())?;
        let half = model.as_ref().map_or(1.0, |model| model.half);
        let far = if family == Family::Distance {
            difficulty
        } else {
            4.0
        };
        let mut problem = Self {
            bodies,
            rays: Vec::new(),
            size: 2.0 * half,
            camera: DVec3::Z * (far * half + 2.0 * half),
        };
        for _ in 0..rays {
            let [o, d] = problem.line(subject, family, difficulty, model.as_ref(), &mut random);
            let target = to_world.point(o + d * (3.0 * half));
            // A thin object is looked at from all sides of the world.
            let (origin, direction) = if family == Family::Aspect {
                let origin = unit(&mut random) * (4.0 * half);
                (origin, target - origin)
            } else {
                (to_world.point(o), to_world.vector(d))
            };
            problem.rays.push(Ray { origin, direction });
        }
        Some(problem)
    }

    /// Origin and direction in object coordinates.
    fn line(
        &self,
        subject: Subject,
        family: Family,
        difficulty: f64,
        model: Option<&Model>,
        random: &mut Pcg64Mcg,
    ) -> [DVec3; 2] {
        let half = self.size / 2.0;
        let inside = |random: &mut Pcg64Mcg| unit(random) * (half * random.random_range(0.0..1.1));
        match family {
            Family::Graze => {
                let [p, n, line] = match (subject, model) {
                    (Subject::Canonical(kind), _) => touching(kind, random),
                    (_, Some(model)) => model.touching(self, random),
                    (_, None) => [DVec3::X, DVec3::X, DVec3::Y],
                };
                let side = if random.random_bool(0.5) { 1.0 } else { -1.0 };
                let back = random.random_range(2.0..4.0) * half;
                if subject == Subject::Canonical(ShapeKind::Plane) {
                    // Down to the plane at a slope, or away from it.
                    let origin = p + n * (difficulty * back) - line * back;
                    return [origin, line - n * (side * difficulty)];
                }
                [p + n * (side * difficulty * half) - line * back, line]
            }
            Family::Gap => self.between(subject, difficulty, random),
            Family::Distance | Family::Condition | Family::Aspect => {
                let far = match family {
                    Family::Distance => difficulty * half + 2.0 * half,
                    _ => 3.0 * half,
                };
                let direction = unit(random);
                [inside(random) - direction * far, direction]
            }
        }
    }

    /// From between two sheets, or from outside of both.
    fn between(&self, subject: Subject, gap: f64, random: &mut Pcg64Mcg) -> [DVec3; 2] {
        let half = self.size / 2.0;
        let target = unit(random) * (half * random.random_range(0.0..0.9));
        let outside = unit(random) * (3.0 * half);
        if random.random_bool(0.5) || matches!(subject, Subject::Implicit(_)) {
            return [outside, target - outside];
        }
        let start = match subject {
            Subject::Canonical(ShapeKind::Disk | ShapeKind::Rectangle | ShapeKind::Plane) => {
                let side = random.random_range(-0.5..0.5);
                DVec3::new(side, -side, gap / 2.0)
            }
            Subject::Canonical(ShapeKind::Cube) => {
                let side = random.random_range(-0.9..0.9);
                DVec3::new(side, 1.0 + gap / 2.0, -side)
            }
            Subject::Canonical(ShapeKind::Cylinder) => {
                let radial = unit(random).with_z(0.0).normalize_or(DVec3::X);
                radial * (1.0 + gap / 2.0)
            }
            _ => unit(random) * (1.0 + gap / 2.0),
        };
        let target = match subject {
            Subject::Canonical(ShapeKind::Disk | ShapeKind::Rectangle | ShapeKind::Plane) => {
                target.with_z(-1.0)
            }
            _ => target * 0.5,
        };
        [start, target - start]
    }
}

/// One object, or two of them a gap apart: the inner one first.
fn bodies(
    subject: Subject,
    to_world: &Affine,
    gap: Option<f64>,
    model: Option<&Model>,
) -> Option<Vec<Body>> {
    let Subject::Canonical(kind) = subject else {
        let model = model?;
        let implicit = implicit(&model.expression, model.half);
        let ladder = Ladder::new(to_world).ok()?;
        let certified = Certified::new(&implicit.field.tape, implicit.inside, &ladder)?;
        return Some(vec![Body {
            to_world: *to_world,
            kind: None,
            implicit: Some(implicit),
            certified: Some(certified),
        }]);
    };
    let plain = |to_world: Affine| Body {
        to_world,
        kind: Some(kind),
        implicit: None,
        certified: None,
    };
    let Some(gap) = gap else {
        return Some(vec![plain(*to_world)]);
    };
    let other = if kind.is_flat() {
        Affine::translate(DVec3::Z * gap)
    } else {
        Affine::scale(DVec3::splat(1.0 + gap))
    };
    Some(vec![plain(*to_world), plain(to_world.after(&other))])
}

impl Model {
    /// A named surface; with a gap, the two sheets f = ± g beside it.
    fn new(name: &str, gap: Option<f64>) -> Option<Self> {
        let named = named::find(name)?;
        let expression = match gap {
            None => named.field(&[]).ok()?,
            Some(gap) => {
                let values = named.parameters.iter();
                let mut text = named.expression.to_owned();
                for (name, value) in values {
                    text = substituted(&text, name, value);
                }
                parse(&format!("({text})^2 - ({gap:e})^2"), &[]).ok()?
            }
        };
        Some(Self {
            expression: Arc::new(expression),
            half: named.half_width,
        })
    }

    /// A point of the surface, its normal and a tangent.
    fn touching(&self, problem: &Problem, random: &mut Pcg64Mcg) -> [DVec3; 3] {
        let field = Field::new(&self.expression.tape);
        let body = &problem.bodies[0];
        let inverse = inverse(&body.to_world);
        loop {
            let direction = unit(random);
            let origin = unit(random) * (self.half * 0.7) - direction * (3.0 * self.half);
            let ray = Ray {
                origin: body.to_world.point(origin),
                direction: body.to_world.vector(direction),
            };
            let root = body
                .certified
                .as_ref()
                .and_then(|certified| certified.exactly(&ray, [0.0, f64::INFINITY]));
            let Some(root) = root else { continue };
            let point = inverse.point(ray.origin + ray.direction * root.t);
            let Some(normal) = field.gradient(point).try_normalize() else {
                continue;
            };
            let tangent = normal.cross(unit(random)).try_normalize();
            if let Some(tangent) = tangent {
                return [point, normal, tangent];
            }
        }
    }
}

/// A text with a whole word replaced by a number.
fn substituted(text: &str, word: &str, value: &str) -> String {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut result = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(word) {
        let before = rest[..at].chars().next_back().is_some_and(is_word);
        let after = rest[at + word.len()..].chars().next().is_some_and(is_word);
        result += &rest[..at];
        result += if before || after { word } else { value };
        rest = &rest[at + word.len()..];
    }
    result + rest
}
