//! A picture for each finder of which pixels of a surface it gets wrong.

use glam::DVec3;
use image::{Rgb, RgbImage};

use super::{Answer, CONTESTANTS, Contestant, OracleShape, Score};
use etalon::inside::scene::FinderChoice;
use etalon::inside::shape::Ray;
use etalon::inside::shape::implicit::certified::Workspace;

/// Right hit, right miss, wrong, undecided, and where the truth itself is not known.
const RIGHT_HIT: Rgb<u8> = Rgb([150, 165, 180]);
const RIGHT_MISS: Rgb<u8> = Rgb([245, 245, 245]);
const WRONG: Rgb<u8> = Rgb([210, 30, 40]);
const UNDECIDED: Rgb<u8> = Rgb([240, 170, 0]);
const UNKNOWN: Rgb<u8> = Rgb([120, 0, 160]);
const FRAME: u32 = 4;
/// Pixels of the first look.
const COARSE: u32 = 64;

/// Paints the maps side by side, each `size` pixels wide and high, with the wrong and undecided pixels
/// of each finder; `None` where the surface cannot be placed.
///
/// The camera looks along parallel rays from (2, −3, 1) at the surface within its clip cube. The
/// truth is that of `auto`.
pub fn map(shape: &OracleShape, size: u32) -> Option<(RgbImage, Vec<(Contestant, Score)>)> {
    let truth_finder = Contestant::Proved(FinderChoice::Auto).ready(shape)?;
    let mut workspace = Workspace::default();
    let mut look = |reach: f64, size: u32| -> (Vec<Ray>, Vec<Answer>) {
        let rays = rays(shape.half_width, reach, size);
        let answer = |ray: &Ray| truth_finder.first_hit(ray, 0.0, &mut workspace);
        let answers = rays.iter().map(answer).collect();
        (rays, answers)
    };
    // A first look at the whole cube tells how large the surface is in the picture.
    let (_, coarse) = look(1.0, COARSE);
    let (rays, truth) = look(filled(&coarse), size);
    let count = CONTESTANTS.len() as u32;
    let columns = 4;
    let rows = count.div_ceil(columns);
    let step = size + FRAME;
    let mut picture = RgbImage::from_pixel(columns * step, rows * step, Rgb([255, 255, 255]));
    let mut counts = Vec::new();
    for (place, contestant) in (0..).zip(CONTESTANTS) {
        let ready = contestant.ready(shape)?;
        let mut tally = Score::default();
        let corner = [place % columns * step, place / columns * step];
        for (i, (ray, truth)) in (0..).zip(rays.iter().zip(&truth)) {
            let answer = ready.first_hit(ray, 0.0, &mut workspace);
            let colour = judged(answer, *truth, shape.half_width);
            tally.wrong += u32::from(colour == WRONG);
            tally.undecided += u32::from(colour == UNDECIDED);
            picture.put_pixel(corner[0] + i % size, corner[1] + i / size, colour);
        }
        counts.push((contestant, tally));
    }
    Some((picture, counts))
}

/// The colour of an answer: hits may differ by a thousandth of the cube's edge.
fn judged(answer: Answer, truth: Answer, half_width: f64) -> Rgb<u8> {
    match (answer, truth) {
        (_, Answer::Undecided) => UNKNOWN,
        (Answer::Undecided, _) => UNDECIDED,
        (Answer::Miss, Answer::Miss) => RIGHT_MISS,
        (Answer::Hit(a), Answer::Hit(b)) if (a - b).abs() <= 2e-3 * half_width => RIGHT_HIT,
        _ => WRONG,
    }
}

/// The share of the first look's half width that the surface fills, and a margin of two pixels.
fn filled(coarse: &[Answer]) -> f64 {
    let half = f64::from(COARSE) / 2.0;
    let distance = |i: u32| (f64::from(i) + 0.5 - half).abs();
    let pixels = (0..).zip(coarse);
    let hits = pixels.filter(|(_, answer)| matches!(answer, Answer::Hit(_)));
    let distances = hits.map(|(i, _)| distance(i % COARSE).max(distance(i / COARSE)));
    let farthest = distances.reduce(f64::max);
    farthest.map_or(1.0, |farthest| ((farthest + 2.0) / half).min(1.0))
}

/// Parallel rays through the pixels, row by row from the top; `reach` is the half width of the
/// picture in half diagonals of the clip cube.
fn rays(half_width: f64, reach: f64, size: u32) -> Vec<Ray> {
    let forward = -DVec3::new(2.0, -3.0, 1.0).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    // The cube's half diagonal is √3 half widths.
    let diagonal = 3f64.sqrt() * half_width;
    let reach = reach * diagonal;
    let pixel = |i: u32| (f64::from(i) + 0.5) / f64::from(size) * 2.0 - 1.0;
    let ray = |x: u32, y: u32| Ray {
        origin: reach * (right * pixel(x) - up * pixel(y)) - 2.0 * diagonal * forward,
        direction: forward,
    };
    (0..size * size).map(|i| ray(i % size, i / size)).collect()
}
