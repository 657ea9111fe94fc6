//! The oracle of implicit surfaces: rays with answers from exact rational arithmetic.
//!
//! `tests/data/implicit_shapes.csv` (16 surfaces), `implicit.csv` (3 040 rays, each meant exactly as its f64
//! numbers, t to 22 digits), `bounce.csv` (331 second hits).

use std::collections::{BTreeMap, HashMap};

use etalon::inside::field::normal::SHARP;
use etalon::inside::math::affine::Affine;
use etalon::inside::scene::FinderChoice;
use etalon::inside::shape::implicit::certified::{
    Answers, Certified, Effort, Packet, WIDTH, Workspace,
};
use etalon::inside::shape::implicit::placed::{ImplicitAnswer, ImplicitHit, PlacedImplicit};
use etalon::inside::shape::ladder::Ladder;
use etalon::inside::shape::{Query, Tally};
use etalon::{Instructions, Tier};
use etalon_doors::shapes::without_bounds;

use crate::oracle_support::{OracleShape, Row, number, query, ray, rows, shapes, vector};
use crate::support::{from_zero, implicit};

/// A surface in both forms, and half its cube's edge.
struct Surface {
    placed: PlacedImplicit,
    certified: Certified,
    half: f64,
}

type Surfaces = BTreeMap<String, Surface>;

fn surfaces(finder: FinderChoice) -> Surfaces {
    let surface = |shape: OracleShape| {
        let half = shape.half_width;
        let implicit = implicit(shape.field, half, finder);
        let (tape, to_world) = (&implicit.field.tape, &Affine::IDENTITY);
        let ladder = Ladder::new(to_world).unwrap();
        let certified = Certified::new(tape, implicit.inside, &ladder);
        let surface = Surface {
            placed: PlacedImplicit::new(&implicit, to_world).unwrap(),
            certified: certified.unwrap(),
            half,
        };
        (shape.name, surface)
    };
    shapes().into_iter().map(surface).collect()
}

/// Rays in the lanes of a packet.
fn packet(queries: impl IntoIterator<Item = Query>) -> Packet {
    let mut packet = Packet::default();
    for (lane, Query { ray, t_min, t_max }) in queries.into_iter().enumerate() {
        packet.set(lane, ray.origin, ray.direction, [t_min, t_max]);
    }
    packet
}

/// What the path loop asks for.
const HITS: Effort = Effort {
    sharp: false,
    exact: true,
};

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
    let clip = 2.0 * half / ray(row).direction.length();
    let separated = row["gap"].is_empty() || number(row, "gap") > 1e-3 * clip;
    let off = (hit.t - t).abs() / clip;
    if row["mult"] == "1" && separated && off > 1e-12 {
        return Some(format!("t off by {off:e} of the clip"));
    }
    let (told, wanted) = (hit.multiplicity, &row["mult"]);
    if told.is_some_and(|told| told.to_string() != *wanted) {
        return Some(format!("multiplicity {told:?}, want {wanted}"));
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
    let surfaces = surfaces(finder);
    let trace_on = |instructions| {
        let (mut workspace, mut tally) = (Workspace::new(instructions), Tally::default());
        let mut faults = Vec::new();
        for row in &rows("implicit.csv") {
            let Surface { placed, half, .. } = &surfaces[&row["shape"]];
            let answer = placed.first_hit(&query(row), &mut workspace, &mut tally);
            let fault = fault(row, &answer, *half);
            faults.extend(fault.map(|fault| format!("{}: {fault}", row["id"])));
        }
        (faults, tally)
    };
    let mut each = Instructions::all().into_iter().map(trace_on);
    let first = each.next().unwrap();
    assert!(each.all(|other| other == first));
    first
}

#[test]
fn every_ray_is_decided_and_right() {
    let (faults, tally) = trace(FinderChoice::Auto);
    println!("{tally:?}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let counts = (tally.rays(), tally.undecided, tally.uncertified);
    assert_eq!(counts, (3040, 0, 0));
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

/// Second hits, from printed points as from anywhere, and as the path loop finds them: from t = 0,
/// the surface they leave being known.
#[test]
fn second_hits() {
    let surfaces = surfaces(FinderChoice::Auto);
    let (mut workspace, mut tally) = (Workspace::default(), Tally::default());
    let table = rows("implicit.csv");
    let first: HashMap<&str, &Row> = table.iter().map(|row| (row["id"].as_str(), row)).collect();
    let mut faults = Vec::new();
    for row in &rows("bounce.csv") {
        let ray = first[row["id"].as_str()];
        let surface = &surfaces[&ray["shape"]];
        let (placed, certified) = (&surface.placed, &surface.certified);
        let hit = placed.first_hit(&query(ray), &mut workspace, &mut tally);
        let ImplicitAnswer::Found(hit) = hit else {
            panic!("{}: no first hit", row["id"]);
        };
        let from_zero = from_zero(hit.point, vector(row, ["d2x", "d2y", "d2z"]));
        let again = Query {
            // As in the oracle's own rays that start on a surface.
            t_min: 1.0 / (1u64 << 24) as f64,
            ..from_zero
        };
        // The t of a hit, and whether there is none for certain.
        let printed = match placed.first_hit(&again, &mut workspace, &mut tally) {
            ImplicitAnswer::Found(hit) => (Some(hit.t), false),
            other => (None, other == ImplicitAnswer::Absent),
        };
        let mut packet = packet([from_zero]);
        packet.leaving = 1;
        let answers = certified.first_hits(&packet, HITS, &mut workspace);
        let found = answers.found & 1 == 1;
        let leaving = (found.then_some(answers.t[0]), answers.absent & 1 == 1);
        for answer in [printed, leaving] {
            let right = match answer {
                (Some(t), _) => row["hit2"] == "1" && (t - number(row, "t2")).abs() < 1e-5,
                (None, absent) => absent && row["hit2"] == "0",
            };
            if !right {
                faults.push(format!("{} {answer:?} {}", row["id"], row["t2"]));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// What answers say of a ray: found, absent, where, how many times, by what.
pub fn known(answers: &Answers, lane: usize) -> ([bool; 2], [u64; 3], u32, Tier) {
    let bits = [answers.found, answers.absent].map(|set| set >> lane & 1 == 1);
    let t = [answers.t, answers.low, answers.high].map(|t| t[lane].to_bits());
    let t = if bits[0] { t } else { [0; 3] };
    (bits, t, answers.multiplicity[lane], answers.tiers[lane])
}

/// Rays have the same answers in company as alone, on every instruction set.
#[test]
fn full_packets_agree_with_single_rays() {
    let sets = Instructions::all().into_iter();
    let mut workspaces: Vec<Workspace> = sets.map(Workspace::new).collect();
    let table = rows("implicit.csv");
    for (name, surface) in &surfaces(FinderChoice::Auto) {
        let certified = &surface.certified;
        let queries = table.iter().filter(|row| row["shape"] == *name).map(query);
        let queries: Vec<Query> = queries.collect();
        let efforts = |rays| [(rays, false), (rays, true)];
        for (rays, sharp) in queries.chunks(WIDTH).flat_map(efforts) {
            let effort = Effort { sharp, exact: true };
            let ask = |rays: &[Query], workspace: &mut Workspace| {
                certified.first_hits(&packet(rays.iter().copied()), effort, workspace)
            };
            let rays_alone = rays.chunks(1);
            let alone: Vec<_> = rays_alone
                .map(|ray| known(&ask(ray, &mut workspaces[0]), 0))
                .collect();
            for workspace in &mut workspaces {
                let together = ask(rays, workspace);
                for (lane, alone) in alone.iter().enumerate() {
                    let set = workspace.instructions.name();
                    assert_eq!(known(&together, lane), *alone, "{name}, {set} lane {lane}");
                }
            }
        }
    }
}

/// A finder that believes its arithmetic must be caught by this oracle.
#[test]
fn bounds_of_zero_are_noticed() {
    let surfaces = surfaces(FinderChoice::Auto).into_iter();
    let finders = surfaces.map(|(name, surface)| (name, without_bounds(surface.certified)));
    let finders: BTreeMap<String, Certified> = finders.collect();
    let mut workspace = Workspace::default();
    let table = rows("implicit.csv");
    let mut wrong = table.iter().filter(|row| {
        let finder = &finders[&row["shape"]];
        let answers = finder.first_hits(&packet([query(row)]), HITS, &mut workspace);
        (answers.found & 1 == 1) != (row["hit"] == "1")
    });
    assert!(wrong.next().is_some());
}
