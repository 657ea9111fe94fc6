//! What single precision may blur: the plan's bounds over invented scenes of all scales.

use etalon::inside::integrate::chunk::Request;
use etalon::inside::math::instructions::{Instructions, Precision};
use etalon::inside::math::lanes::Scalar;
use etalon::inside::plan::bounds::gaps::{smallest, smallest_pairwise};
use etalon::inside::plan::bounds::{Blur, sites};
use etalon::inside::render::replay;
use etalon::inside::scene::SamplerKind;
use etalon::{First, Plan, Ray, Scene, Tracer};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Pixels of a picture's side.
const SIZE: u32 = 64;

/// An invented scene as text: a camera and objects.
#[derive(Clone)]
struct Invented {
    camera: String,
    objects: Vec<String>,
}

/// 10^x for a uniform x.
fn any_size(rng: &mut Pcg64Mcg, low: f64, high: f64) -> f64 {
    10f64.powf(rng.random_range(low..high))
}

fn direction(rng: &mut Pcg64Mcg) -> DVec3 {
    loop {
        let v = DVec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        if (0.1..1.0).contains(&v.length()) {
            return v.normalize();
        }
    }
}

/// A shape stretched to `sizes` half along its axes, turned, and put at `centre`.
fn object(rng: &mut Pcg64Mcg, sizes: [f64; 3], centre: DVec3) -> String {
    let rectangle = "rectangle = { size = [2, 2] }";
    let [cube, cylinder] = ["cube = { side = 2 }", "cylinder = { height = 2 }"];
    let shapes = [
        "sphere = {}",
        cube,
        cylinder,
        "disk = {}",
        rectangle,
        "plane = {}",
    ];
    let shape = shapes[rng.random_range(0..shapes.len())];
    let [a, b, c] = sizes;
    let turns: [f64; 2] = if rng.random::<bool>() {
        std::array::from_fn(|_| rng.random_range(0.0..360.0))
    } else {
        [0.0, [0.0, 90.0][rng.random_range(0..2)]]
    };
    let transform = format!(
        "{{ scale = [{a:e}, {b:e}, {c:e}] }}, {{ rotate_x = {} }}, {{ rotate_y = {} }}, \
         {{ translate = {:?} }}",
        turns[0],
        turns[1],
        centre.to_array()
    );
    placed(shape, &transform)
}

fn placed(shape: &str, transform: &str) -> String {
    crate::support::object(&format!("{{ {shape} }}"), "m", transform)
}

fn ball(centre: [f64; 3], radius: f64) -> String {
    let shape = format!("sphere = {{ radius = {radius:e} }}");
    placed(&shape, &format!("{{ translate = {centre:?} }}"))
}

impl Invented {
    /// Some objects about a place at a distance that the camera looks at, all of one scale that is
    /// anything from 1e-9 to 1e9.
    fn new(rng: &mut Pcg64Mcg) -> Self {
        let scale = any_size(rng, -9.0, 9.0);
        let from = direction(rng) * scale * any_size(rng, -1.0, 1.5);
        let to = direction(rng) * scale * any_size(rng, -2.0, 0.0);
        let projection = if rng.random_range(0..4) == 0 {
            format!("orthographic = {:e}", scale * any_size(rng, -1.0, 1.0))
        } else {
            format!("fov = {}", rng.random_range(5.0..120.0))
        };
        let camera = format!(
            "camera = {{ from = {:?}, to = {:?}, up = {:?}, {projection} }}\n",
            from.to_array(),
            to.to_array(),
            direction(rng).to_array()
        );
        let count = rng.random_range(1..8);
        let objects = (0..count).map(|_| Self::some_object(rng, scale)).collect();
        Self { camera, objects }
    }

    fn some_object(rng: &mut Pcg64Mcg, scale: f64) -> String {
        let size = scale * any_size(rng, -2.0, 0.5);
        let sizes = if rng.random::<bool>() {
            [size; 3]
        } else {
            std::array::from_fn(|_| size * any_size(rng, -1.5, 1.0))
        };
        let centre = direction(rng) * scale * any_size(rng, -1.0, 0.5);
        object(rng, sizes, centre)
    }

    fn scene(&self, precision: &str) -> Scene {
        let text = format!(
            "{}environment = 1\nimage = {{ size = [{SIZE}, {SIZE}], spp = 1, max_depth = 1, sampler = \
             \"center\", precision = \"{precision}\" }}\nmaterials.m = {{ diffuse = 0.5 }}\n{}",
            self.camera,
            self.objects.concat()
        );
        Scene::parse(&text).unwrap()
    }
}

fn plan(scene: &Scene) -> Plan {
    Plan::new(scene, false).unwrap()
}

fn single(scene: &Scene) -> Blur {
    Blur::new(scene, f32::ROUNDOFF)
}

/// Whether each of `b`'s bounds is at least as strict as those of `a`.
fn is_as_strict(b: Blur, a: Blur) -> bool {
    let gap = |blur: Blur| blur.gap.unwrap_or(f64::INFINITY);
    b.position >= a.position && b.pixels >= a.pixels && gap(b) <= gap(a)
}

/// In how many scenes another object, anywhere in the list, loosens a bound.
fn loosened(seed: u64, measure: impl Fn(&Scene) -> Blur) -> usize {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let scenes = (0..400).filter(|_| {
        let mut invented = Invented::new(&mut rng);
        let lights = "[[light]]\ndirection = [1, -2, 3]\nirradiance = 1\n\
                      [[light]]\npoint = [0.1, 0.2, 0.3]\nintensity = 1\n";
        invented.objects.push(lights.into());
        let before = measure(&invented.scene("auto"));
        let scale = any_size(&mut rng, -9.0, 9.0);
        let object = Invented::some_object(&mut rng, scale);
        let place = rng.random_range(0..=invented.objects.len());
        invented.objects.insert(place, object);
        !is_as_strict(measure(&invented.scene("auto")), before)
    });
    scenes.count()
}

#[test]
fn another_object_never_loosens_a_bound() {
    assert_eq!(loosened(1, single), 0);
    // Planted: the bounds of the first object in the list, instead of the worst.
    let planted = |scene: &Scene| {
        let mut scene = scene.clone();
        scene.objects.truncate(1);
        single(&scene)
    };
    assert!(loosened(1, planted) > 20);
}

#[test]
fn thin_slabs_are_as_bad_behind_a_ball() {
    let slab = |y: f64| {
        let thin = "{ scale = [4000, 1e-3, 4000] }, { rotate_z = 30 }";
        placed(
            "cube = {}",
            &format!("{thin}, {{ translate = [0, {y}, 0] }}"),
        )
    };
    let mut invented = Invented {
        camera: "camera = { from = [0, 0, 5000], to = [0, 0, 0], fov = 40 }\n".into(),
        objects: vec![slab(1.0), slab(-1.0)],
    };
    let alone = single(&invented.scene("auto"));
    invented.objects.insert(0, ball([0.0, 0.0, 4999.0], 0.01));
    let behind = single(&invented.scene("auto"));
    assert!(behind.position >= alone.position && behind.pixels >= alone.pixels);
}

#[test]
fn a_pixel_is_as_wide_as_at_the_nearest_point() {
    let mut invented = Invented {
        camera: "camera = { from = [0, 0.02, 0], to = [0, 0, -0.3], fov = 60 }\n".into(),
        objects: vec![ball([0.0, -1000.0, 0.0], 1000.0)],
    };
    let precision = |invented: &Invented| plan(&invented.scene("auto")).choices.precision;
    assert_eq!(precision(&invented), Precision::Double);
    // A plane in the ball's place is as far off as its distance is.
    invented.objects = vec![placed("plane = {}", "{ rotate_x = -90 }")];
    assert_eq!(precision(&invented), Precision::Single);
}

#[test]
fn the_tree_finds_the_gap_that_pairs_have() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    let mut found = 0;
    for _ in 0..300 {
        let mut invented = Invented::new(&mut rng);
        let scale = any_size(&mut rng, -9.0, 9.0);
        let more = rng.random_range(0..40);
        invented
            .objects
            .extend((0..more).map(|_| Invented::some_object(&mut rng, scale)));
        let sites = sites(&invented.scene("auto"));
        let gap = smallest(&sites);
        assert_eq!(gap, smallest_pairwise(&sites));
        found += usize::from(gap.is_some());
    }
    assert!(found > 200, "{found}");
}

/// A grid of balls of radius 0.4 a unit apart, two of them closer.
#[test]
fn a_gap_is_found_among_many_objects() {
    let place = |i: usize| [i % 10, i / 10 % 10, i / 100].map(|x| x as f64);
    let mut invented = Invented {
        camera: "camera = { from = [0, 0, 50], to = [0, 0, 0], fov = 40 }\n".into(),
        objects: (0..1000).map(|i| ball(place(i), 0.4)).collect(),
    };
    let [x, y, z] = place(437);
    invented.objects[437] = ball([x, y + 0.1875, z], 0.4);
    let gap = single(&invented.scene("auto")).gap.unwrap();
    // Coordinates are rounded to 2⁻⁴⁷ at the camera's distance.
    assert!((gap - 0.0125).abs() < 1e-13, "{gap:e}");
}

/// How single precision met what double did.
#[derive(Debug, Default)]
struct Tally {
    /// Hits farther from every edge than the bound.
    inner: usize,
    /// Hits closer to an edge.
    edge: usize,
    /// Inner hits that single precision has on another object, or farther off than the bound.
    off: usize,
    /// Rays that single precision takes past what double meets, or the other way round.
    other: usize,
}

/// Whether the same face of the object is met all around a ray, `shift` aside.
fn is_inner(
    tracer: &Tracer,
    ray: Ray,
    (object, normal, t): (usize, DVec3, f64),
    shift: f64,
) -> bool {
    let a = ray.direction.any_orthonormal_vector();
    let b = ray.direction.cross(a);
    (0..8).all(|i| {
        let turn = f64::from(i) * std::f64::consts::FRAC_PI_4;
        let aside = (a * turn.cos() + b * turn.sin()) * shift;
        // Rays that diverge from the camera, or run beside each other: both pass the hit so far off.
        let diverging = (ray.origin, ray.direction + aside / t);
        let beside = (ray.origin + aside, ray.direction);
        [diverging, beside].into_iter().all(|(origin, direction)| {
            let First::Hit(hit) = tracer.first(Ray { origin, direction }) else {
                return false;
            };
            hit.object == object && hit.normal.is_some_and(|n| n.dot(normal) > 0.5)
        })
    })
}

/// How far a point is from a surface that is met near it, whose unit normal is given.
fn beside_surface(tracer: &Tracer, point: DVec3, normal: DVec3, far: f64) -> f64 {
    let probe = Ray {
        origin: point + normal * far,
        direction: -normal,
    };
    match tracer.first(probe) {
        First::Hit(hit) => (hit.t - far).abs(),
        _ => f64::INFINITY,
    }
}

/// Compares forced single with forced double wherever the plan chooses single; the bound is multiplied
/// by `share`, which is 1 unless a mistake is planted.
fn met(seed: u64, share: f64) -> Tally {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut tally = Tally::default();
    for _ in 0..120 {
        let invented = Invented::new(&mut rng);
        let scene = invented.scene("auto");
        let blur = single(&scene);
        if !blur.is_small() {
            continue;
        }
        let plans = ["f64", "f32"].map(|precision| plan(&invented.scene(precision)));
        let tracer = Tracer::new(&scene).unwrap();
        for _ in 0..48 {
            let [x, y] = std::array::from_fn(|_| rng.random_range(0..SIZE));
            let request = Request { x, y, sample: 0 };
            let [double, single] = plans
                .each_ref()
                .map(|plan| replay(plan, Instructions::best(), request).vertices[0].clone());
            let from = scene.camera.from;
            let ray = Ray {
                origin: double.origin + from,
                direction: double.direction,
            };
            let Some(object) = double.object else {
                tally.other += usize::from(single.object.is_some());
                continue;
            };
            // An error of this size in each coordinate is up to √3 of it long.
            let beyond = (double.point.abs().max_element() / blur.reach).max(1.0);
            let length = 3f64.sqrt() * blur.position * beyond;
            let hit = (object as usize, double.normal, double.distance);
            if !is_inner(&tracer, ray, hit, length) {
                tally.edge += 1;
                tally.other += usize::from(single.object != double.object);
                continue;
            }
            tally.inner += 1;
            let off = single.point - double.point;
            let across = off - double.direction * off.dot(double.direction);
            let surface = beside_surface(&tracer, single.point + from, single.normal, 8.0 * length);
            let ratio = across.length().max(surface) / length;
            tally.off += usize::from(single.object != double.object || ratio > share);
        }
    }
    tally
}

#[test]
fn single_meets_what_double_does_within_the_bound() {
    let tally = met(3, 1.0);
    assert!(tally.inner > 1000, "{tally:?}");
    assert_eq!(tally.off, 0, "{tally:?}");
    // A hundredth of a pixel about an edge: at most one ray in a hundred comes so close.
    assert!(tally.edge + tally.other < tally.inner / 100, "{tally:?}");
    // Planted: a quarter of the bound.
    assert!(met(3, 0.25).off > 0);
}

/// A floor at the camera's feet, and the edge of a ball's shadow through the middle of the picture.
fn shadowed(rng: &mut Pcg64Mcg, sun: bool) -> Invented {
    let height = any_size(rng, -3.0, 3.0);
    let middle = DVec3::new(0.0, 0.0, -height);
    let towards = (direction(rng) + DVec3::new(0.0, 2.0, 0.0)).normalize();
    let aside = towards.any_orthonormal_vector();
    let far = height * any_size(rng, 0.0, if sun { 7.0 } else { 5.0 });
    // The line from the light to the middle touches the ball.
    let (light, centre, radius) = if sun {
        let travels = (-towards).to_array();
        let light = format!("direction = {travels:?}\nirradiance = 1\n");
        let radius = far / 2.0;
        (light, middle + towards * far + aside * radius, radius)
    } else {
        let at = middle + towards * far;
        let close = far * any_size(rng, -2.0, -0.3);
        let radius = close / 2.0;
        let light = format!("point = {:?}\nintensity = 1\n", at.to_array());
        (light, at - towards * close + aside * radius, radius)
    };
    let camera = format!(
        "camera = {{ from = [0, {height:e}, 0], to = {:?}, fov = 60 }}\n",
        middle.to_array()
    );
    let floor = placed("plane = {}", "{ rotate_x = -90 }");
    let ball = ball(centre.to_array(), radius);
    Invented {
        camera,
        objects: vec![floor, ball, format!("[[light]]\n{light}")],
    }
}

/// The scene in a picture with a pixel in the middle, of which samples are taken all over.
fn with_a_middle(invented: &Invented, precision: &str) -> Scene {
    let mut scene = invented.scene(precision);
    scene.image.size = [SIZE + 1; 2];
    scene.image.sampler = SamplerKind::Sobol;
    scene.image.spp = 64;
    scene.image.max_depth = Some(2);
    scene
}

/// Samples of the middle pixel that both precisions follow to the floor, and those among them that only
/// one sees lit.
fn lit_otherwise(invented: &Invented) -> [usize; 2] {
    let plans = ["f64", "f32"].map(|precision| plan(&with_a_middle(invented, precision)));
    let blocked = |sample: u32| {
        let [x, y] = [SIZE / 2; 2];
        let request = Request { x, y, sample };
        let lights = plans.each_ref().map(|plan| {
            let replayed = replay(plan, Instructions::best(), request);
            replayed.vertices[0].light.map(|light| light.blocked)
        });
        Some([lights[0]?, lights[1]?])
    };
    let seen: Vec<[bool; 2]> = (0..64).filter_map(blocked).collect();
    [seen.len(), seen.iter().filter(|[a, b]| a != b).count()]
}

/// Samples in scenes for which the bound lets single be taken, how many of them may be lit otherwise, and
/// how many are; the bound is divided by `weaker`, which is 1 unless a mistake is planted.
///
/// What may be lit otherwise is the part of the pixel between the edges in both precisions: as wide as
/// the bound, at most √2 pixels long, and as much again because the hit itself may be off by as much.
fn shaded(sun: bool, weaker: f64) -> (usize, f64, usize) {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    let (mut taken, mut allowed, mut otherwise) = (0, 0.0, 0);
    for _ in 0..80 {
        let invented = shadowed(&mut rng, sun);
        let mut blur = single(&with_a_middle(&invented, "auto"));
        blur.pixels /= weaker;
        if blur.is_small() {
            let [seen, differ] = lit_otherwise(&invented);
            taken += seen;
            allowed += 2.0 * std::f64::consts::SQRT_2 * blur.pixels * seen as f64;
            otherwise += differ;
        }
    }
    (taken, allowed, otherwise)
}

#[test]
fn hard_shadows_fall_where_they_do_in_double() {
    for sun in [true, false] {
        let (taken, allowed, otherwise) = shaded(sun, 1.0);
        assert!(taken > 1000, "{taken}");
        assert!(otherwise as f64 <= allowed, "{otherwise} {allowed}");
        let (_, allowed, otherwise) = shaded(sun, 100.0);
        assert!(otherwise as f64 > allowed, "{otherwise} {allowed}");
    }
}
