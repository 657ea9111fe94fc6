//! The expression language of implicit surfaces: grammar, exactness, polynomials, limits, and its
//! place in scene files.

use std::path::Path;

use etalon::inside::field::expression::{
    DEEPEST, Expression, LONGEST, MOST_BITS, MOST_EXPONENT, MOST_OPERATIONS, Parameter, Problem,
    check_name, parse, parse_constant, rational,
};
use etalon::inside::field::named::{self, SURFACES};
use etalon::inside::field::polynomial::{MOST_DEGREE, Polynomial};
use etalon::inside::field::tape::{Algebra, Binary, Operation, Tape, Unary};
use etalon::inside::scene::{self, FinderChoice, Implicit, Shape};
use etalon::{Diagnostic, Origin, Overrides, Scene};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::oracle_support::{OracleShape, shapes};
use crate::polynomial_support::{scaled, value};
use crate::support::cells;

fn ratio(numerator: i64, denominator: i64) -> BigRational {
    BigRational::new(numerator.into(), denominator.into())
}

fn parameter(name: &str, value: BigRational) -> Parameter {
    let name = name.to_owned();
    Parameter { name, value }
}

/// Tapes in exact arithmetic, apart from the polynomials; `None` is undefined or irrational.
struct Rationals([BigRational; 3]);

impl Algebra for Rationals {
    type Value = Option<BigRational>;
    fn coordinate(&self, axis: usize) -> Self::Value {
        Some(self.0[axis].clone())
    }
    fn constant(&self, _: usize, exact: &BigRational) -> Self::Value {
        Some(exact.clone())
    }
    fn unary(&self, function: Unary, a: &Self::Value) -> Self::Value {
        match function {
            Unary::Negative => Some(-a.clone()?),
            Unary::Absolute => Some(a.clone()?.abs()),
            _ => None,
        }
    }
    fn binary(&self, function: Binary, a: &Self::Value, b: &Self::Value) -> Self::Value {
        let (a, b) = (a.clone()?, b.clone()?);
        match function {
            Binary::Sum => Some(a + b),
            Binary::Difference => Some(a - b),
            Binary::Product => Some(a * b),
            Binary::Quotient if !b.is_zero() => Some(a / b),
            Binary::Minimum => Some(a.min(b)),
            Binary::Maximum => Some(a.max(b)),
            _ => None,
        }
    }
    fn whole_power(&self, a: &Self::Value, n: i32) -> Self::Value {
        let mut product = BigRational::one();
        for _ in 0..n.unsigned_abs() {
            product *= a.clone()?;
        }
        match n {
            0.. => Some(product),
            _ if product.is_zero() => None,
            _ => Some(product.recip()),
        }
    }
}

fn exact(tape: &Tape, point: [BigRational; 3]) -> Option<BigRational> {
    tape.evaluate(&Rationals(point), &mut Vec::new())?
}

fn random_point(random: &mut impl Rng) -> [BigRational; 3] {
    [(); 3].map(|()| {
        let numerator = random.random_range(-4000..4000);
        ratio(numerator, random.random_range(1..2000))
    })
}

/// A field without parameters.
#[track_caller]
fn field(text: &str) -> Expression {
    parse(text, &[]).expect(text)
}

#[track_caller]
fn polynomial(text: &str) -> Polynomial {
    field(text).polynomial.expect(text)
}

/// Expressions and the numbers that they are, from a list of equations.
fn equalities(list: &str) -> impl Iterator<Item = (&str, BigRational)> {
    let sides = list.split(';').map(|case| case.split_once('=').unwrap());
    sides.map(|(text, value)| (text, value.trim().parse().unwrap()))
}

#[test]
fn operators_bind_as_in_mathematics() {
    let cases = "1 + 2*3 = 7; (1 + 2)*3 = 9; 7 - 4 - 2 = 1; 7 - (4 - 2) = 5; 12/3/2 = 2; 12/3*2 = 8;
        -2^2 = -4; (-2)^2 = 4; 2^3^2 = 512; (2^3)^2 = 64; 2^-3 = 1/8; 2^-2^2 = 1/16; 2*-3 = -6; 1--3 = 4;
        - -3 = 3; +3 = 3; -3*2 = -6; 3*2^2 = 12; -1/2^2 = -1/4; min(3, 1, 2) + max(1, 5) = 6;
        abs(-3/4) = 3/4; sqrt(9/4) = 3/2; 4^0.5 + 4^(3/2) = 10; cos(0) + exp(0) + log(1) = 2;
        \t1\n+ 2 = 3";
    for (text, wanted) in equalities(cases) {
        assert_eq!(parse_constant(text, &[]), Ok(wanted), "{text}");
    }
}

#[test]
fn operators_with_coordinates_bind_as_in_mathematics() {
    let point = || [ratio(2, 1), ratio(3, 1), ratio(5, 1)];
    let cases = "-x^2 = -4; x - y - z = -6; x - (y - z) = 4; x*y^2*z = 90; z*12/y/x = 10; x^2^2 = 16;
        -x*-y = 6; abs(x - z)*min(x, y, z) + max(y, z) = 11; x*x*x = 8; (x^2)^3*x = 128; 12*x^-2 = 3";
    for (text, wanted) in equalities(cases) {
        let value = exact(&field(text).tape, point());
        assert_eq!(value, Some(wanted), "{text}");
    }
}

#[test]
fn constants_are_the_rationals_they_look_like() {
    let value = |text: &str| parse_constant(text, &[]).expect(text);
    let double = |x: f64| BigRational::from_float(x).expect("finite");
    assert_ne!(value("9/80"), double(9.0 / 80.0));
    let golden = "1.6180339887498949025257388711906969547271728515625";
    for (text, wanted) in [
        ("9/80", ratio(9, 80)),
        ("0.1", ratio(1, 10)),
        (".5e-1", ratio(1, 20)),
        ("5.E+2", ratio(500, 1)),
        ("2^-1074", double(f64::from_bits(1))),
        (golden, double(f64::midpoint(1.0, 5f64.sqrt()))),
    ] {
        assert_eq!(value(text), wanted, "{text}");
    }
    assert_eq!(value("1e-300") * value("1e300"), ratio(1, 1));
    assert_eq!(rational("-2.5"), Some(ratio(-5, 2)));
    for text in ["", "-", ".", "1e", "e5", "1.2.3", "0x1", "nan", "1_0"] {
        assert_eq!(rational(text), None, "{text}");
    }
}

#[test]
fn parameters_are_constants_with_names() {
    let long = parameter("long_name2", ratio(2, 1));
    let set = [parameter("a", ratio(9, 80)), long];
    let field = parse("a*x + long_name2", &set).expect("a field");
    let value = exact(&field.tape, [ratio(80, 1), ratio(0, 1), ratio(0, 1)]);
    assert_eq!(value, Some(ratio(11, 1)));
    assert_eq!(parse_constant("a*80/3", &set), Ok(ratio(3, 1)));
    assert_eq!(check_name("major"), Ok(()));
    for name in ["x", "pi", "sin", "", "2a", "a-b", "é"] {
        assert!(check_name(name).is_err(), "{name}");
    }
}

#[test]
fn equal_operations_are_done_once() {
    let field = field("(x^2 + y^2)*(y^2 + x*x) + 0*z + 1*x - x");
    let expected = [
        Operation::Coordinate(0),
        Operation::WholePower(0, 2),
        Operation::Coordinate(1),
        Operation::WholePower(2, 2),
        Operation::Binary(Binary::Sum, 1, 3),
        Operation::WholePower(4, 2),
        Operation::Binary(Binary::Sum, 0, 5),
        Operation::Binary(Binary::Difference, 6, 0),
    ];
    assert_eq!(field.tape.operations(), expected);
    assert_eq!(field.spans.len(), expected.len());
    assert_eq!(field.spans[4], 1..10);
}

/// The part between « and » is what the complaint must point at.
#[test]
fn complaints_point_at_their_cause() {
    let cases = r#"
        «» | empty | such as
        x^2 + «» | ends here | a number, a name
        x^2 + «*» y | "*" cannot stand here | a number, a name
        2 «x» | "x" cannot stand here | + - * / ^
        x «$» 2 | '$' has no meaning |
        x «−» 2 | '−' has no meaning | "-"
        x«²» - 1 | '²' has no meaning | "^2"
        sqrt«(»x + 1 | not closed | for each
        x + 1«)» | closes nothing |
        (x + 1 «,» 2) | "," cannot stand | ")"
        x + «radius» | "radius" is not known |
        x + «sine»(x) | no function "sine" |
        x + «sin»*2 | "sin" has no arguments | "("
        «x»(y + 1) | no function "x" | such as *
        1 + «atan2(x)» | "atan2" has 1 argument | 2
        «sin(x, y)» | "sin" has 2 arguments | 1
        min(«)» | |
        x + «1/0» | division by zero is undefined |
        x/«» | ends here | a number
        x + «sqrt(1 - 2)» | root of a negative number is undefined |
        x + «log(0)» | logarithm of a number that is not positive |
        x + «asin(1.5)» | beyond ±1 |
        x + «0^-1» | division by zero |
        x + «(-2)^0.3» | power of a constant |
        x + «1e9999» | more than 4096 bits |
        x + «3^99999» | more than 4096 bits |
        x + «9^9^9^9» | |
        «x^2000» - 1 | the exponent is beyond ±1024 |
        «x^1e300» - 1 | the exponent is beyond ±1024 |
        «sin(1)» | its surface is empty | depends on
        «(x + 1)^2 - x^2 - 2*x» | its surface is empty | depends on
        «x - x» | zero everywhere | depends on
        «(x + 1)^2 - x^2 - 2*x - 1» | zero everywhere | depends on
        x «=» 0 | '=' has no meaning | f = 0
        x«.»y | '.' has no meaning |
        1.5«.5» + x | cannot stand here |"#;
    let spaced = [" «1 + 2» ", "its surface is empty", "depends on"];
    for [marked, message, expected] in cells(cases).chain([spaced]) {
        let text = marked.replace(['«', '»'], "");
        let start = marked.find('«').expect("a mark");
        let end = marked.find('»').expect("a mark") - '«'.len_utf8();
        let error = parse(&text, &[]).expect_err(marked);
        assert!(error.to_string().contains(message), "{marked}: {error}");
        let hint = error.expected.clone().unwrap_or_default();
        assert!(hint.contains(expected), "{marked}: expected {hint}");
        // Some of these only must not hang; their place is not one thing.
        if !message.is_empty() {
            assert_eq!(error.span, start..end, "{marked}: {error}");
        }
    }
}

/// What is written wrongly, or means nothing, is an error in words; long and deep texts too.
#[test]
fn senseless_expressions_are_errors() {
    let deep = format!("{}x{}", "(".repeat(5_000), ")".repeat(5_000));
    let long = vec!["x"; 10_000].join("*y+");
    let minus = "-".repeat(5_000);
    let short = " ;0;0*x;1/0;x/0;sqrt(-1)*x;max(x, 0/0);atan2(0, 0)*x;min(x, x) - x;x^100000;x y;3x;\
                 (x;sin x;1e;floor(x);NaN*x;inf*x;é;x..y";
    for text in short.split(';').chain([&*deep, &*long, &*minus]) {
        let error = parse(text, &[]).err();
        let error = error.unwrap_or_else(|| panic!("{text:.40} is an expression"));
        assert!(!error.to_string().is_empty());
    }
}

#[test]
fn constants_must_be_rational_and_without_coordinates() {
    let problem = |text| parse_constant(text, &[]).expect_err(text).problem;
    assert_eq!(problem("sqrt(2)"), Problem::NotRational);
    assert_eq!(problem("pi"), Problem::NotRational);
    assert_eq!(problem("2*x"), Problem::Coordinate("x".to_owned()));
    assert_eq!(problem(""), Problem::Empty);
}

#[test]
fn unknown_names_come_with_the_known_ones() {
    let set = [parameter("radius", ratio(1, 1))];
    let error = parse("x - raduis", &set).expect_err("a misspelt name");
    assert!(error.names.contains(&"radius".to_owned()));
    assert!(error.names.contains(&"pi".to_owned()));
    let error = parse("sqr(x)", &set).expect_err("a misspelt function");
    assert!(error.names.contains(&"sqrt".to_owned()));
    assert!(!error.names.contains(&"radius".to_owned()));
}

#[test]
fn sizes_are_bounded() {
    let problem = |text: &str| parse(text, &[]).expect_err("too much").problem;
    let nested = |depth: usize| format!("{}x{}", "(".repeat(depth), ")".repeat(depth));
    assert!(parse(&nested(DEEPEST), &[]).is_ok());
    let sines = |count: usize| {
        let terms: Vec<String> = (0..count).map(|i| format!("sin({i}*x)")).collect();
        terms.join("+")
    };
    assert!(parse(&sines(500), &[]).is_ok());
    for (text, wanted) in [
        ("x".repeat(LONGEST + 1), Problem::TooLong),
        (nested(DEEPEST + 1), Problem::TooDeep),
        ("(".repeat(LONGEST), Problem::TooDeep),
        ("-".repeat(LONGEST), Problem::TooDeep),
        ("sin(".repeat(LONGEST / 4), Problem::TooDeep),
        ("x^".repeat(LONGEST / 2), Problem::TooDeep),
        (sines(MOST_OPERATIONS / 3), Problem::TooManyOperations),
        (
            format!("x^{}", MOST_EXPONENT + 1),
            Problem::ExponentTooLarge,
        ),
        ("(x^33)^33".to_owned(), Problem::ExponentTooLarge),
        (format!("x{}", "^2".repeat(DEEPEST)), Problem::TooManyDigits),
        // Long sums are no nesting.
        (vec!["x"; 20_000].join("+"), Problem::TooManyOperations),
    ] {
        assert_eq!(problem(&text), wanted, "{text:.40}");
    }
    let power = |bits: u64| parse_constant(&format!("2^{bits}"), &[]);
    assert!(power(MOST_BITS - 1).is_ok());
    let large = power(MOST_BITS + 1).expect_err("too large").problem;
    assert_eq!(large, Problem::TooManyDigits);
}

#[test]
fn polynomials_beyond_measure_stay_expressions() {
    let large = field(&format!("(x + y + z + 1)^{MOST_DEGREE}")).polynomial;
    assert!(large.is_none_or(|p| p.degree() == MOST_DEGREE));
    let larger = format!("x^{} - 1", MOST_DEGREE + 1);
    let texts = "sqrt(x) abs(x) 1/x x^-1 x^y min(x,y) pi*x x^0.3";
    for text in texts.split(' ').chain([&*larger]) {
        assert_eq!(field(text).polynomial, None, "{text}");
    }
    assert_eq!(polynomial("x/3 + y*2^-40 - sqrt(4)").degree(), 1);
}

#[test]
fn all_oracle_surfaces_are_polynomials_of_their_degree() {
    let shapes = shapes();
    assert_eq!(shapes.len(), 16);
    let mut random = Pcg64Mcg::seed_from_u64(1);
    for shape in shapes {
        let (name, field) = (shape.name, shape.field);
        let polynomial = field.polynomial.as_ref().expect(&name);
        assert_eq!(polynomial.degree(), shape.degree, "{name}");
        let terms = polynomial.terms().collect();
        for _ in 0..20 {
            let point = random_point(&mut random);
            let value = value(&terms, &point);
            assert_eq!(exact(&field.tape, point), Some(value), "{name}");
        }
    }
}

#[test]
fn named_surfaces_are_those_of_the_oracle() {
    let mut met = Vec::new();
    for OracleShape { name, field, .. } in shapes() {
        let surface = named::find(if name == "chmutov6" { "chmutov" } else { &name });
        let Some(surface) = surface else { continue };
        let ours = surface.field(&[]).expect(&name).polynomial;
        let [ours, theirs] = [&ours, &field.polynomial].map(|p| scaled(p.as_ref().expect(&name)));
        assert_eq!(ours, theirs, "{name}");
        met.push(surface.name);
    }
    assert_eq!(met.len(), SURFACES.len(), "{met:?}");
}

#[test]
fn named_surfaces_take_parameters() {
    let torus = named::find("torus").expect("a torus");
    let horn = torus.field(&[parameter("minor", ratio(1, 1))]);
    let wanted = polynomial("(x^2+y^2+z^2)^2-4*(x^2+y^2)");
    assert_eq!(horn.expect("a torus").polynomial, Some(wanted));
}

#[test]
fn polynomials_are_in_lowest_terms_and_keep_their_sign() {
    let polynomial = polynomial("-x/6 + 3/4*y^2 - 9");
    let wanted = [
        ([0, 0, 0], ratio(-9, 1)),
        ([0, 2, 0], ratio(3, 4)),
        ([1, 0, 0], ratio(-1, 6)),
    ];
    assert_eq!(polynomial.terms().collect::<Vec<_>>(), wanted);
    assert_eq!(*polynomial.denominator(), 12.into());
    let whole = BigInt::from;
    assert!(Polynomial::new([], 1.into()).is_zero());
    let over = |a, b| Polynomial::new([([1, 0, 0], whole(a))], whole(b));
    assert_eq!(over(2, -4), over(-1, 2));
}

#[test]
fn powers_products_and_differences_of_squares_come_apart() {
    let parts = |text: &str| {
        let factors = field(text).tape.factors();
        let list = factors.factors.iter().map(|f| {
            let polynomial = Polynomial::from_tape(&f.tape).expect(text);
            (polynomial, f.multiplicity)
        });
        (factors.negative, list.collect::<Vec<_>>())
    };
    let sphere = "x^2+y^2+z^2-1";
    let shells = [("x^2+y^2+z^2-1-2^-20", 1), ("x^2+y^2+z^2-1+2^-20", 1)];
    for (text, negative, list) in [
        ("(s)^2", false, &[(sphere, 2)][..]),
        ("-3*(s)^3*x", true, &[("x", 1), (sphere, 3)]),
        ("(s)*x*(s)", false, &[(sphere, 2), ("x", 1)]),
        ("(s)^2-2^-40", false, &shells),
        ("-2^-40+(s)^2", false, &shells),
        ("x^4-y^2", false, &[("x^2-y", 1), ("x^2+y", 1)]),
        ("(x^2-y^2)^3/-7", true, &[("x-y", 3), ("x+y", 3)]),
        // √2 is not rational, and a sum of squares stays.
        ("x^2-2", false, &[("x^2-2", 1)]),
        ("x^2+4", false, &[("x^2+4", 1)]),
    ] {
        let list = list.iter().map(|(text, n)| (polynomial(text), *n));
        let wanted = (negative, list.collect::<Vec<_>>());
        assert_eq!(parts(&text.replace('s', sphere)), wanted, "{text}");
    }
}

#[test]
fn random_words_never_panic() {
    let words = "x;y;z;pi;a;sqrt;min;atan2;log;abs;(;(;););+;-;*;/;^;^;,;2;0;0.5;1e9;-1;1e-400;.; ;é;\0;\
                 3;1/3;e;_";
    let words: Vec<&str> = words.split(';').collect();
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let set = [parameter("a", ratio(-1, 3))];
    let (mut fields, mut errors) = (0, 0);
    for _ in 0..60_000 {
        let count = random.random_range(0..14);
        let pick = |_| words[random.random_range(0..words.len())];
        let text: String = (0..count).map(pick).collect();
        match parse(&text, &set) {
            Ok(field) => {
                fields += 1;
                assert_eq!(field.spans.len(), field.tape.operations().len());
                let mut spans = field.spans.iter();
                assert!(spans.all(|s| text.get(s.clone()).is_some()), "{text}");
                let _ = field.tape.factors();
            }
            Err(error) => {
                errors += 1;
                assert!(text.get(error.span.clone()).is_some(), "{text}: {error:?}");
            }
        }
    }
    assert!(fields > 300 && errors > 300, "{fields} {errors}");
}

/// A scene with one implicit surface.
fn scene_of(shape: &str) -> String {
    format!(
        "camera = {{ from = [0, 0, 5], to = [0, 0, 0], fov = 40 }}\n\
         image = {{ size = [8, 8], spp = 1 }}\n\
         materials.black = {{}}\n[[object]]\nmaterial = \"black\"\n{shape}\n"
    )
}

fn read(shape: &str, finder: Option<&str>) -> Result<(String, Implicit), Box<Diagnostic>> {
    let options = Overrides {
        finder: finder.map(str::to_owned),
        ..Overrides::default()
    };
    match scene::parse("test.toml", &scene_of(shape), Path::new(""), &options) {
        Ok(mut scene) => {
            let object = scene.objects.remove(0);
            Ok((object.name, implicit_of(object.value.shape)))
        }
        Err(error) => Err(Box::new(error.diagnostic().expect("a place").clone())),
    }
}

pub fn implicit_of(shape: Shape) -> Implicit {
    match shape {
        Shape::Implicit(implicit) => implicit,
        other => panic!("{other:?}"),
    }
}

#[test]
fn scene_files_name_surfaces_or_write_them() {
    let (name, torus) = read(r#"shape = { implicit = "torus" }"#, None).expect("a torus");
    assert_eq!((name.as_str(), torus.name), ("torus #0", Some("torus")));
    assert_eq!(torus.inside.map(|p| p.to_array()), [[-2.0; 3], [2.0; 3]]);
    let defaults = (torus.closed, torus.finder, torus.steps);
    assert_eq!(defaults, (false, FinderChoice::Auto, 1000));

    let shape = r#"shape = { implicit = "a*x^2 + b*y - c", inside = [[0, 0, 0], [1, 2, 3]],
        parameters = { a = 0.1, b = "a*9/8", c = 1_0.5e0 } }"#;
    let (name, field) = read(shape, None).expect("a field");
    let told = (name.as_str(), field.name, field.closed);
    assert_eq!(told, ("implicit #0", None, false));
    let wanted = polynomial("x^2/10 + 9/80*y - 21/2");
    assert_eq!(field.field.polynomial, Some(wanted));
    // Caps make it the largest of several fields.
    let closed = shape.replace("} }", "}, closed = true }");
    let (_, field) = read(&closed, None).expect("a field");
    assert!(field.closed && field.field.polynomial.is_none());
}

#[test]
fn finders_are_the_object_s_else_the_image_s_unless_the_command_says() {
    let finder = |shape: &str, command| Some(read(shape, command).ok()?.1.finder);
    let own = r#"shape = { implicit = "heart", finder = "interval" }"#;
    let plain = r#"shape = { implicit = "heart" }"#;
    for (shape, command, wanted) in [
        (own, None, FinderChoice::Interval),
        (own, Some("sign-change"), FinderChoice::SignChange),
        (plain, Some("polynomial"), FinderChoice::Polynomial),
    ] {
        assert_eq!(finder(shape, command), Some(wanted));
    }
    let text = scene_of(plain).replace("spp = 1", "spp = 1, finder = \"sphere-trace\"");
    let heart = Scene::parse(&text).expect("a scene").objects.remove(0);
    let finder = implicit_of(heart.value.shape).finder;
    assert_eq!(finder, FinderChoice::SphereTrace);
    let error = read(own, Some("intervall")).expect_err("a misspelt finder");
    assert_eq!((&error.origin, error.column), (&Origin::Finder, 1));
    assert_eq!(error.suggestion.as_deref(), Some("interval"));
}

/// The mark « is where the message must point; the strings are of every kind TOML has.
#[test]
fn complaints_point_into_the_string_of_the_scene_file() {
    let inside = ", inside = [[0, 0, 0], [1, 1, 1]]";
    let torus = r#""torus", parameters = { minor = "2*(«1/0)" }"#;
    let sine = r#"no function "sine""#;
    let cases = [
        (r#""x^2 + «sine(x)""#, sine),
        (r"'x^2 + «sine(x)'", sine),
        ("\"\"\"\nx^2\n + «sine(x)\"\"\"", sine),
        ("'''x^2\n + «sine(x)'''", sine),
        (r#""x^2 +«""#, "the expression ends here"),
        (r#""x + «é""#, "'é'"),
        (r#""«""#, "is empty"),
        // An escape moves the bytes: the whole string is meant.
        (r#"«"x^2 +\tsine(x)""#, sine),
        (torus, "division by zero"),
    ];
    for (marked, message) in cases {
        let rest = if marked == torus { "" } else { inside };
        let marked = format!("shape = {{ implicit = {marked}{rest} }}");
        let (before, after) = marked.split_once('«').expect("a mark");
        let error = read(&format!("{before}{after}"), None).expect_err(&marked);
        let line = before.rsplit('\n').next().unwrap_or("");
        assert!(error.message.contains(message), "{error}");
        assert_eq!(error.column, line.chars().count() + 1, "{error}");
        assert_eq!(error.line, 6 + before.matches('\n').count(), "{error}");
    }
    let misspelt = format!("shape = {{ implicit = \"sqr(x)\"{inside} }}");
    let error = read(&misspelt, None).expect_err("a misspelt function");
    assert_eq!(error.suggestion.as_deref(), Some("sqrt"));
}

#[test]
fn scene_files_refuse_what_is_no_surface() {
    let cases = r#"
        implicit = "1 + 1", inside = B | does not depend on x, y or z
        implicit = "x - x", inside = B | zero everywhere
        implicit = "(x + y)^2 - x^2 - 2*x*y - y^2", inside = B | zero everywhere
        implicit = "x^2 + y^2 - 1" | object.shape.inside is missing
        implicit = "torus", parameters = { q = 1 } | no parameter of torus
        implicit = "torus", parameters = 3 | object.shape.parameters is an integer
        implicit = "torus", parameters = { minor = true } | minor is a boolean
        implicit = "torus", parameters = { minor = "sqrt(2)" } | not a rational number
        implicit = "sin(x)", inside = B, finder = "polynomial" | no polynomial
        implicit = 3 | object.shape.implicit is an integer
        implicit = "goursat", parameters = { a = 0, b = 0, c = 1 } | with these parameters of goursat"#;
    for [shape, message] in cells(cases) {
        let shape = shape.replace('B', "[[0, 0, 0], [1, 1, 1]]");
        let error = read(&format!("shape = {{ {shape} }}"), None).expect_err(&shape);
        assert!(error.message.contains(message), "{shape}: {error}");
    }
    let tiny = r#"shape = { implicit = "torus", parameters = { minor = 1e-400 } }"#;
    let (_, torus) = read(tiny, None).expect("exact as written, though no f64");
    let polynomial = torus.field.polynomial.as_ref().expect("a polynomial");
    assert!(polynomial.denominator().bits() > 2600);
}
