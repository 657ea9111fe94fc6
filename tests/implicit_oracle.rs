//! The oracle of implicit surfaces: rays with answers from exact rational arithmetic.
//!
//! `tests/data/implicit_shapes.csv` (16 surfaces), `implicit.csv` (3 040 rays, each meant exactly as its f64
//! numbers, t to 22 digits), `bounce.csv` (331 second hits).

#![allow(
    clippy::unwrap_used,
    reason = "a malformed oracle file must fail the test"
)]

use std::collections::{BTreeMap, HashMap};

use etalon::inside::field::normal::SHARP;
use etalon::inside::math::affine::Affine;
use etalon::inside::scene::{FinderChoice, Implicit};
use etalon::inside::shape::implicit::certified::{
    Answers, Certified, Effort, Packet, WIDTH, Workspace,
};
use etalon::inside::shape::implicit::placed::{ImplicitAnswer, ImplicitHit, PlacedImplicit};
use etalon::inside::shape::{Query, Ray, Tally};
use etalon::{Instructions, Tier};
use etalon_doors::shapes::without_bounds;

use crate::oracle_support::{IMPLICIT, OracleShape, Row, number, rows, shapes, vector};

struct Surface {
    implicit: Implicit,
    half: f64,
}

fn surfaces() -> BTreeMap<String, Surface> {
    let surface = |shape: OracleShape| {
        let implicit = Implicit {
            name: None,
            inside: shape.inside(),
            field: shape.field,
            closed: false,
            finder: FinderChoice::Auto,
            steps: 256,
        };
        let half = shape.half_width;
        (shape.name, Surface { implicit, half })
    };
    shapes().into_iter().map(surface).collect()
}

fn placed(finder: FinderChoice) -> BTreeMap<String, (PlacedImplicit, f64)> {
    surfaces()
        .into_iter()
        .map(|(name, Surface { mut implicit, half })| {
            implicit.finder = finder;
            let placed = PlacedImplicit::new(&implicit, &Affine::IDENTITY).unwrap();
            (name, (placed, half))
        })
        .collect()
}

fn query(row: &Row) -> Query {
    Query {
        ray: Ray {
            origin: vector(row, ["ox", "oy", "oz"]),
            direction: vector(row, ["dx", "dy", "dz"]),
        },
        t_min: number(row, "tmin"),
        t_max: f64::INFINITY,
    }
}

/// What is wrong with an answer, if anything.
fn fault(row: &Row, answer: &ImplicitAnswer, half: f64) -> Option<String> {
    let hits = row["hit"] == "1";
    let hit = match answer {
        ImplicitAnswer::Undecided => return None,
        ImplicitAnswer::Absent if hits => return Some("a hit is missing".to_owned()),
        ImplicitAnswer::Absent => return None,
        ImplicitAnswer::Found(hit) if hits => hit,
        ImplicitAnswer::Found(hit) => return Some(format!("no hit at {}", hit.t)),
    };
    let t = number(row, "t");
    // The oracle's t is read to within half a unit in the last place.
    let [low, high] = [hit.enclosure[0].next_down(), hit.enclosure[1].next_up()];
    if !(low <= t && t <= high && low <= hit.t && hit.t <= high) {
        return Some(format!("{t} and {} in {:?}", hit.t, hit.enclosure));
    }
    let clip = 2.0 * half / vector(row, ["dx", "dy", "dz"]).length();
    let separated = row["gap"].is_empty() || number(row, "gap") > 1e-3 * clip;
    if row["mult"] == "1" && separated && (hit.t - t).abs() > 1e-12 * clip {
        return Some(format!(
            "t off by {:e} of the clip",
            (hit.t - t).abs() / clip
        ));
    }
    let known = hit
        .multiplicity
        .is_none_or(|m| m.to_string() == row["mult"]);
    if !known {
        return Some(format!(
            "multiplicity {:?}, want {}",
            hit.multiplicity, row["mult"]
        ));
    }
    normal_fault(row, hit)
}

/// What the rule for normals promises, and a little for the 12 digits that the oracle prints.
const NORMAL: f64 = SHARP + 1e-11;

fn normal_fault(row: &Row, hit: &ImplicitHit) -> Option<String> {
    let normal = hit.normal?;
    if !(normal.is_finite() && (normal.length() - 1.0).abs() < 4.0 * f64::EPSILON) {
        return Some(format!("normal {normal}"));
    }
    let checked = !row["nx"].is_empty();
    let off = |row| (normal - vector(row, ["nx", "ny", "nz"])).length();
    (checked && off(row) > NORMAL).then(|| format!("normal off by {:e}", off(row)))
}

/// Faults and tally of all rays, the same on every instruction set.
fn trace(finder: FinderChoice) -> (Vec<String>, Tally) {
    let surfaces = placed(finder);
    let all = Instructions::all().into_iter();
    let mut each = all.map(|instructions| trace_on(instructions, &surfaces));
    let first = each.next().unwrap();
    assert!(each.all(|other| other == first));
    first
}

fn trace_on(
    instructions: Instructions,
    surfaces: &BTreeMap<String, (PlacedImplicit, f64)>,
) -> (Vec<String>, Tally) {
    let (mut workspace, mut tally) = (Workspace::new(instructions), Tally::default());
    let mut faults = Vec::new();
    for row in &rows(IMPLICIT) {
        let (surface, half) = &surfaces[&row["shape"]];
        let answer = surface.first_hit(&query(row), &mut workspace, &mut tally);
        faults.extend(fault(row, &answer, *half).map(|fault| format!("{}: {fault}", row["id"])));
    }
    (faults, tally)
}

#[test]
fn every_ray_is_decided_and_right() {
    let (faults, tally) = trace(FinderChoice::Auto);
    println!("{tally:?}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert_eq!(
        (tally.rays(), tally.undecided, tally.uncertified),
        (3040, 0, 0)
    );
}

#[test]
fn isolation_alone_is_right_wherever_it_is_certain() {
    let (faults, tally) = trace(FinderChoice::Polynomial);
    println!("{tally:?}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    // Rays through singular points, 5 % of the oracle's, and no others.
    assert_eq!(tally.exact, 0);
    assert!(tally.undecided <= 3040 / 20, "{tally:?}");
}

#[test]
fn the_baseline_is_wrong_where_it_is_known_to_be() {
    let (faults, tally) = trace(FinderChoice::SignChange);
    assert_eq!(tally.uncertified, 3040);
    assert!(faults.len() > 500, "{}", faults.len());
}

#[test]
fn second_hits_from_printed_points() {
    let surfaces = placed(FinderChoice::Auto);
    let (mut workspace, mut tally) = (Workspace::default(), Tally::default());
    let table = rows(IMPLICIT);
    let first: HashMap<&str, &Row> = table.iter().map(|row| (row["id"].as_str(), row)).collect();
    let mut faults = Vec::new();
    for row in &rows(include_str!("data/bounce.csv")) {
        let ray = first[row["id"].as_str()];
        let (surface, _) = &surfaces[&ray["shape"]];
        let ImplicitAnswer::Found(hit) = surface.first_hit(&query(ray), &mut workspace, &mut tally)
        else {
            panic!("{}: no first hit", row["id"]);
        };
        let again = Query {
            ray: Ray {
                origin: hit.point,
                direction: vector(row, ["d2x", "d2y", "d2z"]),
            },
            // As in the oracle's own rays that start on a surface.
            t_min: 1.0 / (1u64 << 24) as f64,
            t_max: f64::INFINITY,
        };
        let right = match surface.first_hit(&again, &mut workspace, &mut tally) {
            ImplicitAnswer::Found(hit) => {
                row["hit2"] == "1" && (hit.t - number(row, "t2")).abs() < 1e-5
            }
            ImplicitAnswer::Absent => row["hit2"] == "0",
            ImplicitAnswer::Undecided => false,
        };
        if !right {
            faults.push(row["id"].clone());
        }
    }
    assert!(faults.is_empty(), "{faults:?}");
}

/// The same second hits as the path loop finds them: from t = 0, the surface it leaves being known.
#[test]
fn second_hits_of_rays_that_leave() {
    let (mut workspace, mut tally) = (Workspace::default(), Tally::default());
    let table = rows(IMPLICIT);
    let first: HashMap<&str, &Row> = table.iter().map(|row| (row["id"].as_str(), row)).collect();
    let surfaces = surfaces();
    let placed = placed(FinderChoice::Auto);
    let mut faults = Vec::new();
    let effort = Effort {
        sharp: false,
        exact: true,
    };
    let certified: BTreeMap<&String, Certified> = surfaces
        .iter()
        .map(|(name, surface)| {
            let Implicit { field, inside, .. } = &surface.implicit;
            let certified = Certified::new(&field.tape, *inside, &Affine::IDENTITY);
            (name, certified.unwrap().unwrap())
        })
        .collect();
    for row in &rows(include_str!("data/bounce.csv")) {
        let ray = first[row["id"].as_str()];
        let (surface, _) = &placed[&ray["shape"]];
        let hit = surface.first_hit(&query(ray), &mut workspace, &mut tally);
        let ImplicitAnswer::Found(hit) = hit else {
            panic!("{}: no first hit", row["id"]);
        };
        let mut packet = Packet::default();
        let direction = vector(row, ["d2x", "d2y", "d2z"]);
        packet.set(0, hit.point, direction, [0.0, f64::INFINITY]);
        packet.leaving = 1;
        let certified = &certified[&ray["shape"]];
        let answers = certified.first_hits(&packet, effort, &mut workspace);
        let right = if answers.found & 1 == 1 {
            row["hit2"] == "1" && (answers.t[0] - number(row, "t2")).abs() < 1e-5
        } else {
            answers.absent & 1 == 1 && row["hit2"] == "0"
        };
        if !right {
            faults.push(format!("{} {} {}", row["id"], answers.t[0], row["t2"]));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// What answers say of a ray: found, absent, where, how many times, by what.
pub fn known(answers: &Answers, lane: usize) -> ([bool; 2], [u64; 3], u32, Tier) {
    let bits = [answers.found, answers.absent].map(|set| set >> lane & 1 == 1);
    let t = [answers.t, answers.low, answers.high].map(|t| t[lane].to_bits());
    (
        bits,
        if bits[0] { t } else { [0; 3] },
        answers.multiplicity[lane],
        answers.tiers[lane],
    )
}

/// Rays have the same answers in company as alone, on every instruction set.
#[test]
fn full_packets_agree_with_single_rays() {
    let sets = Instructions::all().into_iter();
    let mut workspaces: Vec<Workspace> = sets.map(Workspace::new).collect();
    let table = rows(IMPLICIT);
    for (name, surface) in &surfaces() {
        let Implicit { field, inside, .. } = &surface.implicit;
        let certified = Certified::new(&field.tape, *inside, &Affine::IDENTITY);
        let certified = certified.unwrap().unwrap();
        let rays: Vec<&Row> = table.iter().filter(|row| row["shape"] == *name).collect();
        let packet = |rows: &[&Row]| {
            let mut packet = Packet::default();
            for (lane, row) in rows.iter().enumerate() {
                let Query { ray, t_min, t_max } = query(row);
                packet.set(lane, ray.origin, ray.direction, [t_min, t_max]);
            }
            packet
        };
        for (rays, sharp) in rays
            .chunks(WIDTH)
            .flat_map(|rays| [(rays, false), (rays, true)])
        {
            let effort = Effort { sharp, exact: true };
            let alone: Vec<Answers> = rays
                .iter()
                .map(|row| certified.first_hits(&packet(&[row]), effort, &mut workspaces[0]))
                .collect();
            for workspace in &mut workspaces {
                let together = certified.first_hits(&packet(rays), effort, workspace);
                for (lane, alone) in alone.iter().enumerate() {
                    assert_eq!(
                        known(&together, lane),
                        known(alone, 0),
                        "{name}, {} lane {lane}",
                        workspace.instructions.name()
                    );
                }
            }
        }
    }
}

/// A finder that believes its arithmetic must be caught by this oracle.
#[test]
fn bounds_of_zero_are_noticed() {
    let surfaces = surfaces();
    let mut workspace = Workspace::default();
    let effort = Effort {
        sharp: false,
        exact: true,
    };
    let finders: BTreeMap<&String, Certified> = surfaces
        .iter()
        .map(|(name, surface)| {
            let Implicit { field, inside, .. } = &surface.implicit;
            let certified = Certified::new(&field.tape, *inside, &Affine::IDENTITY);
            (name, without_bounds(certified.unwrap().unwrap()))
        })
        .collect();
    let wrong = rows(IMPLICIT)
        .iter()
        .filter(|row| {
            let Query { ray, t_min, t_max } = query(row);
            let mut packet = Packet::default();
            packet.set(0, ray.origin, ray.direction, [t_min, t_max]);
            let finder = &finders[&row["shape"]];
            let answers = finder.first_hits(&packet, effort, &mut workspace);
            (answers.found & 1 == 1) != (row["hit"] == "1")
        })
        .count();
    assert!(wrong > 0);
}
