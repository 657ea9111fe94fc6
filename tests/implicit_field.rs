//! Fields of implicit surfaces in f64 and in lanes: values, gradients, and normals where the
//! gradient vanishes.

use etalon::inside::field::bounded;
use etalon::inside::field::evaluate::{Field, nearest};
use etalon::inside::field::expression::{Expression, parse};
use etalon::inside::field::named::{self, SURFACES};
use etalon::inside::field::normal::outward;
use etalon::inside::math::affine::Affine;
use etalon::inside::scene::FinderChoice;
use etalon::inside::shape::Tally;
use etalon::inside::shape::implicit::certified::Workspace;
use etalon::inside::shape::implicit::placed::{ImplicitAnswer, PlacedImplicit};
use etalon_doors::fields::values_and_gradients;
use glam::DVec3;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::lanes_support::{PRECISIONS, Precision, axes, everywhere};
use crate::polynomial_support::{gradient, value};
use crate::support::{from_zero, implicit};

fn expression(text: &str) -> Expression {
    parse(text, &[]).expect(text)
}

fn field(text: &str) -> Field {
    Field::new(&expression(text).tape)
}

fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).expect("a finite number")
}

fn random_point(random: &mut impl Rng, size: f64) -> DVec3 {
    [(); 3].map(|()| random.random_range(-size..size)).into()
}

#[test]
fn constants_are_rounded_to_nearest() {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    for _ in 0..2_000 {
        let [a, b] = [(); 2].map(|()| {
            let digits = random.random_range(1..5);
            (0..digits).fold(BigInt::from(1), |n, _| (n << 61) + random.random::<u32>())
        });
        let value = BigRational::new(a, b);
        let rounded = nearest(&value);
        let off = |x: f64| (exact(x) - &value).abs();
        assert!(off(rounded) <= off(rounded.next_up()), "{value}");
        assert!(off(rounded) <= off(rounded.next_down()), "{value}");
    }
    assert_eq!(nearest(&BigRational::new(9.into(), 80.into())), 9.0 / 80.0);
    let subnormal = f64::MIN_POSITIVE / 8.0;
    assert_eq!(nearest(&exact(subnormal)), subnormal);
}

/// Automatic differentiation against the exact gradient of the polynomial, within the bound that
/// comes with it; and the bound is no excuse.
#[test]
fn gradients_of_named_surfaces_are_exact_but_for_rounding() {
    let mut random = Pcg64Mcg::seed_from_u64(2);
    for surface in SURFACES {
        let expression = surface.field(&[]).expect("a field");
        let field = Field::new(&expression.tape);
        let exact_gradient = gradient(&expression.polynomial.expect("a polynomial"));
        for _ in 0..100 {
            let p = random_point(&mut random, surface.half_width);
            let point = p.to_array().map(exact);
            let derivative = |d| value(d, &point).to_f64().expect("finite");
            let wanted = DVec3::from_array(exact_gradient.each_ref().map(derivative));
            let (bounded, error) = bounded::gradient(&field, p, 0.0);
            assert_eq!(bounded, field.gradient(p), "{}", surface.name);
            // The reference itself is rounded once.
            let off = (bounded - wanted).length();
            let limit = error + f64::EPSILON * wanted.length();
            assert!(off <= limit, "{}: {off} > {limit}", surface.name);
            // Some hundred operations on numbers up to some thousands: far below this.
            let most = 1e-9 * (1.0 + wanted.length());
            assert!(error < most, "{}: {error}", surface.name);
        }
    }
}

/// Each rule of differentiation against central differences: their error is h²/6 times the third
/// derivative, below 100 on these boxes, and 2⁻⁵³ · |f|/h, with |f| below 10: together below 3e-9
/// at h = 1e-5, to which comes that of the functions' last digits, twice as much.
#[test]
fn rules_of_differentiation_agree_with_differences() {
    let cases = "
        sqrt(x + 2); abs(x*y); exp(x*z); log(x + 2); sin(2*x); cos(x + y); tan(x/2); asin(x/2); acos(y/2);
        atan(3*z); sinh(x); cosh(y); tanh(x*2); x/(y + 3); min(x, y); max(x, y*z); atan2(y + 2, x + 3);
        atan2(x, -y - 2); (x + 2)^(y + 1); (x + 2)^0.3; 2^x; x^5; (x + 2)^-3; pi*x; -x*y + z;
        sqrt(x + 2)^3";
    let mut random = Pcg64Mcg::seed_from_u64(3);
    for text in cases.split(';') {
        let field = field(text);
        for _ in 0..50 {
            let p = random_point(&mut random, 1.0);
            // Where a minimum or an absolute value bends there is no derivative.
            let bends = [p.x - p.y, p.x * p.y, p.x - p.y * p.z];
            if bends.iter().any(|x| x.abs() < 1e-3) {
                continue;
            }
            let h = 1e-5;
            let wanted = DVec3::from_array([0, 1, 2].map(|axis| {
                let step = DVec3::AXES[axis] * h;
                (field.value(p + step) - field.value(p - step)) / (2.0 * h)
            }));
            let (bounded, error) = bounded::gradient(&field, p, 0.0);
            let off = (field.gradient(p) - wanted).abs().max_element();
            assert!(off < 1e-8, "{text} at {p}: {off}");
            assert_eq!(bounded, field.gradient(p), "{text}");
            assert!(error < 1e-12, "{text} at {p}: {error}");
        }
    }
}

/// Lanes of f64 give the bits of scalar f64, on every instruction set; those of f32 are near.
#[test]
fn lanes_compute_what_scalars_do() {
    let everything = "sqrt(abs(x)) + exp(y) - log(2 + x)/sin(z + 4) + cos(x)*tan(y) + asin(z) \
                      - acos(x) + atan(y) + sinh(x)*cosh(z) - tanh(y) + min(x, y) - max(y, z) \
                      + atan2(x, z) + (x + 2)^y + x^7 - (y + 3)^-2 + 9/80*x*y";
    let mut random = Pcg64Mcg::seed_from_u64(4);
    for precision in PRECISIONS {
        for text in SURFACES.iter().map(|s| s.name).chain([everything]) {
            let expression = match named::find(text) {
                Some(surface) => surface.field(&[]).expect(text),
                None => expression(text),
            };
            let field = Field::new(&expression.tape);
            let mut point = |_| {
                let p = random_point(&mut random, 1.0);
                DVec3::from_array(p.to_array().map(|x| precision.rounded(x)))
            };
            let points: Vec<DVec3> = (0..64).map(&mut point).collect();
            let [x, y, z] = &axes(&points);
            let tape = &expression.tape;
            let found = everywhere(|set| values_and_gradients(set, precision, tape, [x, y, z]));
            for (i, p) in points.into_iter().enumerate() {
                let (value, gradient) = (field.value(p), field.gradient(p));
                let wanted = [value, gradient.x, gradient.y, gradient.z];
                let found = found.each_ref().map(|column| column[i]);
                for (wanted, found) in wanted.into_iter().zip(found) {
                    let right = match precision {
                        Precision::Double => wanted.to_bits() == found.to_bits(),
                        // Roundings of 6e-8, raised by slopes of up to a thousand.
                        Precision::Single => (wanted - found).abs() / (1.0 + wanted.abs()) < 1e-3,
                    };
                    assert!(right, "{text} at {p}: {wanted} {found}");
                }
            }
        }
    }
}

/// On the circle z = 0, x² + 9/4 y² = 1 the heart is (x² + 9/4 y² + z² − 1)³ = (x² + 9/80 y²) z³,
/// that is s = (x² + 9/80 y²)^⅓ z: smooth, with the gradient (2x, 9/2 y, −(x² + 9/80 y²)^⅓).
#[test]
fn the_heart_has_its_normal_where_the_gradient_vanishes() {
    let heart = named::find("heart").expect("a heart");
    let field = Field::new(&heart.field(&[]).expect("a field").tape);
    let mut random = Pcg64Mcg::seed_from_u64(5);
    for _ in 0..200 {
        let angle: f64 = random.random_range(0.0..std::f64::consts::TAU);
        let (x, y) = (libm::cos(angle), libm::sin(angle) / 1.5);
        let slope = libm::cbrt(x * x + 9.0 / 80.0 * y * y);
        let wanted = DVec3::new(2.0 * x, 4.5 * y, -slope).normalize();
        // A ray that comes from outside, not too flat.
        let direction = loop {
            let direction = random_point(&mut random, 1.0);
            if direction.dot(wanted) < -0.3 * direction.length() {
                break direction;
            }
        };
        let found = outward(&field, DVec3::new(x, y, 0.0), direction, 3.0);
        // Looked up at 3 · 2⁻²⁶ … 3 · 2⁻²² beside it, with curvatures up to some tens.
        let off = (found - wanted).length();
        assert!(off < 1e-4, "{x} {y} along {direction}: {found}");
    }
}

#[test]
fn normals_are_finite_everywhere() {
    let mut random = Pcg64Mcg::seed_from_u64(6);
    let half = 0.5_f64.sqrt();
    let heart = "(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3";
    let roman = "x^2*y^2 + y^2*z^2 + z^2*x^2 - x*y*z";
    let square = "(x^2 + y^2 + z^2 - 1)^2";
    let quartic = "x^4+y^4+z^4-x^2-y^2-z^2-x^2*y^2-y^2*z^2-z^2*x^2+1";
    let cases = [
        (heart, DVec3::Z),
        (heart, -DVec3::Z),
        ("(x^2 + y^2 + z^2)^2 - 4*(x^2 + y^2)", DVec3::ZERO),
        (quartic, DVec3::ONE),
        (roman, DVec3::new(0.25, 0.0, 0.0)),
        (roman, DVec3::ZERO),
        (square, DVec3::new(half, half, 0.0)),
        (square, DVec3::X),
        ("x^2 + y^2 - z^2", DVec3::ZERO),
        ("x^2 + y^2 + z^2", DVec3::ZERO),
        ("sqrt(x)", DVec3::ZERO),
        ("abs(x)", DVec3::ZERO),
        ("log(x)", DVec3::new(-1.0, 0.0, 0.0)),
        ("x^64*1e300*y^64", DVec3::splat(1e-300)),
        ("min(x, y)^3", DVec3::ZERO),
    ];
    for (text, p) in cases {
        let field = field(text);
        for axis in [DVec3::X, -DVec3::Y, DVec3::Z * 1e-200, DVec3::ONE] {
            let random_direction = random_point(&mut random, 1.0);
            for direction in [axis, random_direction] {
                let normal = outward(&field, p, direction, 4.0);
                let off = (normal.length() - 1.0).abs();
                assert!(off < 1e-14, "{text} at {p}: {normal}");
            }
        }
    }
}

/// A square has no sign to go by: the normal faces the ray, on the line through the centre.
#[test]
fn squares_have_normals_that_face_the_ray() {
    let field = field("(x^2 + y^2 + z^2 - 1)^2");
    for along in [-1.0, 1.0] {
        let normal = outward(&field, DVec3::X, DVec3::new(along, 0.25, 0.0), 4.0);
        assert!((normal + along * DVec3::X).length() < 1e-3, "{normal}");
    }
}

/// The caps of a closed surface belong to it, on whichever side a ray comes from; an open one has
/// none.
#[test]
fn closed_surfaces_have_caps() {
    let inside = [-DVec3::ONE, DVec3::ONE];
    let open = expression("x^2 + y^2 - z^2/2 - 1/5");
    let first = |field: Expression, half: f64, z: f64| {
        let implicit = implicit(field, half, FinderChoice::Auto);
        let placed = PlacedImplicit::new(&implicit, &Affine::IDENTITY).expect("a regular matrix");
        let query = from_zero(DVec3::new(0.1, 0.2, z), DVec3::NEG_Z);
        let (mut workspace, mut tally) = (Workspace::default(), Tally::default());
        match placed.first_hit(&query, &mut workspace, &mut tally) {
            ImplicitAnswer::Found(hit) => Some((hit.t, hit.normal)),
            ImplicitAnswer::Absent => None,
            ImplicitAnswer::Undecided => panic!("undecided"),
        }
    };
    assert_eq!(first(open.clone(), 1.0, 5.0), None);
    let capped = open.capped(&inside).expect("finite corners");
    for (z, t, up) in [(5.0, 4.0, 1.0), (0.5, 1.5, -1.0)] {
        let (found, normal) = first(capped.clone(), 1.125, z).expect("a cap");
        assert!((found - t).abs() < 1e-14, "{found}");
        assert_eq!(normal, Some(DVec3::Z * up));
    }
}
