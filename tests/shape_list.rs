//! Several objects: ties of t, exact order, limits.

#![allow(
    clippy::unwrap_used,
    reason = "the tests' own scenes are hit by construction"
)]

use etalon::inside::shape::list::{nearest, occluded};
use etalon::inside::shape::{Placed, Query, Ray, ShapeKind, Start, Tally, Tier};
use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::shape_ladder::{KINDS, cubed, decade, placed};

fn free(_: usize) -> Start {
    Start::Free
}

fn all(objects: &[Placed]) -> impl Iterator<Item = (usize, &Placed)> {
    objects.iter().enumerate()
}

fn along(origin: DVec3, direction: DVec3) -> Query {
    Query {
        ray: Ray { origin, direction },
        t_min: 0.0,
        t_max: f64::INFINITY,
    }
}

#[test]
fn equal_t_goes_by_priority_then_index() {
    // A cube on a cube of twice the size, seen through the common plane z = 1 from inside.
    let cubes = [
        placed(ShapeKind::Cube, 0.5, DVec3::new(0.0, 0.0, 1.5)),
        placed(ShapeKind::Cube, 1.0, DVec3::ZERO),
    ];
    let up = along(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.01, 0.03, 0.1));
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
    let round = [
        placed(ShapeKind::Sphere, 1.0, DVec3::ZERO),
        placed(ShapeKind::Cylinder, 1.0, DVec3::ZERO),
    ];
    let flat = along(DVec3::new(-3.0, 0.1, 0.0), DVec3::new(0.7, 0.1, 0.0));
    for first in [0, 1] {
        let winner = |i: usize| u8::from(i != first);
        let (index, _) = nearest(all(&round), &flat, free, winner, &mut Tally::default()).unwrap();
        assert_eq!(index, first);
    }
    // Spheres 2⁻²⁰⁰ apart: whatever the priority, the nearer one is nearer.
    let spheres = [
        placed(ShapeKind::Sphere, 1.0, DVec3::ZERO),
        placed(ShapeKind::Sphere, 1.0, DVec3::X * 2f64.powi(-200)),
    ];
    for (side, first) in [(-3.0, 0), (3.0, 1)] {
        let ray = along(DVec3::new(side, 0.1, 0.2), DVec3::new(-side, 0.05, 0.1));
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
        let objects: Vec<Placed> = (0..5)
            .map(|i| placed(KINDS[i], decade(&mut rng, -1.0, 0.5), 2.0 * cubed(&mut rng)))
            .collect();
        let from = 6.0 * cubed(&mut rng);
        let query = along(from, 2.0 * cubed(&mut rng) - from);
        let mut tally = Tally::default();
        let single = objects
            .iter()
            .filter_map(|o| o.first_hit(&query.ray, 0.0, Start::Free, &mut tally))
            .map(|hit| hit.t)
            .min_by(f64::total_cmp);
        let several = nearest(all(&objects), &query, free, |_| 0, &mut tally).map(|(_, hit)| hit);
        assert_eq!(single, several.map(|hit| hit.t));
        let Some(t) = single else { continue };
        found += 1;
        let (before, past) = (
            Query {
                t_max: t * 0.999,
                ..query
            },
            Query {
                t_max: t * 1.001,
                ..query
            },
        );
        assert!(!occluded(all(&objects), &before, free, &mut tally));
        assert!(occluded(all(&objects), &past, free, &mut tally));
        assert!(!occluded(
            all(&objects),
            &past,
            |_| Start::Excluded,
            &mut tally
        ));
        assert!(nearest(all(&objects), &before, free, |_| 0, &mut tally).is_none());
    }
    assert!(found > 100);
}

#[test]
fn limits_are_strict_except_at_zero() {
    let cube = placed(ShapeKind::Cube, 1.0, DVec3::ZERO);
    let ray = Ray {
        origin: DVec3::new(-2.0, 0.25, 0.5),
        direction: DVec3::X,
    };
    let t = |origin: f64, t_min: f64| {
        let ray = Ray {
            origin: DVec3::new(origin, 0.25, 0.5),
            ..ray
        };
        let hit = cube.first_hit(&ray, t_min, Start::Free, &mut Tally::default());
        hit.map(|hit| hit.t)
    };
    assert_eq!(t(-2.0, 0.0), Some(1.0));
    assert_eq!(t(-2.0, 1.0), Some(3.0));
    assert_eq!(t(-2.0, 3.0), None);
    assert_eq!(t(-1.0, 0.0), Some(0.0));
    assert_eq!(t(1.0, 0.0), Some(0.0));
    let query = |t_min, t_max| Query { ray, t_min, t_max };
    let cubes = [cube.clone()];
    let blocked = |q: Query| occluded(all(&cubes), &q, free, &mut Tally::default());
    assert!(!blocked(query(0.0, 1.0)) && blocked(query(0.0, 1.0 + f64::EPSILON)));
    assert!(!blocked(query(1.0, 3.0)) && blocked(query(0.0, f64::INFINITY)));
    let touching = Query {
        ray: Ray {
            origin: DVec3::new(-1.0, 0.25, 0.5),
            direction: -DVec3::X,
        },
        t_min: 0.0,
        t_max: 9.0,
    };
    assert!(!blocked(touching));
}
