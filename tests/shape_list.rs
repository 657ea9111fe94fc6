//! Several objects: ties of t, exact order, limits.

use etalon::inside::shape::list::{nearest, occluded};
use etalon::inside::shape::{Placed, Query, ShapeKind, Start, Tally, Tier};
use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::shape_ladder::{cubed, decade, first_hit, placed};
use crate::support::{from_zero, ray};

fn free(_: usize) -> Start {
    Start::Free
}

fn all(objects: &[Placed]) -> impl Iterator<Item = (usize, &Placed)> {
    objects.iter().enumerate()
}

#[test]
fn equal_t_goes_by_priority_then_index() {
    // A cube on a cube of twice the size, seen through the common plane z = 1 from inside.
    let cube = |scale, z| placed(ShapeKind::Cube, scale, DVec3::Z * z);
    let cubes = [cube(0.5, 1.5), cube(1.0, 0.0)];
    let up = from_zero(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.01, 0.03, 0.1));
    for (first, priority) in [(0, [0, 0]), (0, [0, 1]), (1, [1, 0])] {
        let mut tally = Tally::default();
        let (index, hit) = nearest(all(&cubes), &up, free, |i| priority[i], &mut tally).unwrap();
        assert_eq!(index, first);
        // 0.7 / 0.1 with the exact values of these doubles rounds to 7.
        assert!((hit.t - 7.0).abs() < 1e-14 && hit.local[2].abs() == 1.0);
        assert_eq!(hit.front, index == 0);
        assert_eq!(tally.exact, 1, "{tally:?}");
    }
}

#[test]
fn equal_irrational_t_is_recognised_and_the_smallest_difference_too() {
    // Sphere and cylinder share the circle z = 0; the crossing is irrational.
    let unit = |kind, shift| placed(kind, 1.0, shift);
    let round = [ShapeKind::Sphere, ShapeKind::Cylinder].map(|kind| unit(kind, DVec3::ZERO));
    let flat = from_zero(DVec3::new(-3.0, 0.1, 0.0), DVec3::new(0.7, 0.1, 0.0));
    for first in [0, 1] {
        let winner = |i: usize| u8::from(i != first);
        let (index, _) = nearest(all(&round), &flat, free, winner, &mut Tally::default()).unwrap();
        assert_eq!(index, first);
    }
    // Spheres 2⁻²⁰⁰ apart: whatever the priority, the nearer one is nearer.
    let shifts = [DVec3::ZERO, DVec3::X * 2f64.powi(-200)];
    let spheres = shifts.map(|shift| unit(ShapeKind::Sphere, shift));
    for (side, first) in [(-3.0, 0), (3.0, 1)] {
        let ray = from_zero(DVec3::new(side, 0.1, 0.2), DVec3::new(-side, 0.05, 0.1));
        let loser = |i: usize| u8::from(i == first);
        let mut tally = Tally::default();
        let (index, hit) = nearest(all(&spheres), &ray, free, loser, &mut tally).unwrap();
        assert_eq!((index, tally.exact, hit.tier), (first, 1, Tier::Double));
    }
}

#[test]
fn nearest_agrees_with_the_hits_one_by_one() {
    let mut rng = Pcg64Mcg::seed_from_u64(77);
    let mut found = 0;
    for _ in 0..500 {
        let mut object = |i: usize| {
            let scale = decade(&mut rng, -1.0, 0.5);
            placed(ShapeKind::ALL[i], scale, 2.0 * cubed(&mut rng))
        };
        let objects = [0, 1, 2, 3, 4].map(&mut object);
        let from = 6.0 * cubed(&mut rng);
        let query = from_zero(from, 2.0 * cubed(&mut rng) - from);
        let mut tally = Tally::default();
        let hit = |o: &Placed| Some(first_hit(o, &query.ray, 0.0, Start::Free)?.t);
        let single = objects.iter().filter_map(hit).min_by(f64::total_cmp);
        let several = nearest(all(&objects), &query, free, |_| 0, &mut tally).map(|(_, hit)| hit);
        assert_eq!(single, several.map(|hit| hit.t));
        let Some(t) = single else { continue };
        found += 1;
        let until = |t_max| Query { t_max, ..query };
        let [before, past] = [until(t * 0.999), until(t * 1.001)];
        let mut blocked = |query, start| occluded(all(&objects), query, |_| start, &mut tally);
        assert!(!blocked(&before, Start::Free));
        assert!(blocked(&past, Start::Free));
        assert!(!blocked(&past, Start::Excluded));
        assert!(nearest(all(&objects), &before, free, |_| 0, &mut tally).is_none());
    }
    assert!(found > 100);
}

#[test]
fn limits_are_strict_except_at_zero() {
    let cube = placed(ShapeKind::Cube, 1.0, DVec3::ZERO);
    let along_x = |x: f64| ray(DVec3::new(x, 0.25, 0.5), DVec3::X);
    for (origin, t_min, wanted) in [
        (-2.0, 0.0, Some(1.0)),
        (-2.0, 1.0, Some(3.0)),
        (-2.0, 3.0, None),
        (-1.0, 0.0, Some(0.0)),
        (1.0, 0.0, Some(0.0)),
    ] {
        let hit = first_hit(&cube, &along_x(origin), t_min, Start::Free);
        assert_eq!(hit.map(|hit| hit.t), wanted);
    }
    let ray = along_x(-2.0);
    let query = |t_min, t_max| Query { ray, t_min, t_max };
    let cubes = [cube.clone()];
    let blocked = |q: Query| occluded(all(&cubes), &q, free, &mut Tally::default());
    assert!(!blocked(query(0.0, 1.0)) && blocked(query(0.0, 1.0 + f64::EPSILON)));
    assert!(!blocked(query(1.0, 3.0)) && blocked(query(0.0, f64::INFINITY)));
    let mut touching = from_zero(DVec3::new(-1.0, 0.25, 0.5), -DVec3::X);
    touching.t_max = 9.0;
    assert!(!blocked(touching));
}
