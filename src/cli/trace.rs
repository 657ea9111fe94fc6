//! `etalon trace`: given rays to hits.

mod rays;

use std::fmt::Write as _;
use std::io::{self, Write};

use etalon::inside::render::trace::Decided;
use etalon::inside::shape::implicit::certified::Workspace;
use etalon::{First, FirstHit, Found, Tier, Tracer};
use rayon::prelude::*;

use super::args::Trace;
use super::{Answer, Failure, tell};
use rays::{Line, Lines, Table};

const HEADING: &str = "id,hit,t,x,y,z,nx,ny,nz,object,\
     finder,enclosure_low,enclosure_high,multiplicity,tier\n";

/// Rays of one piece of work: some milliseconds of it.
const PIECE: usize = 1 << 10;
/// Pieces read before they are worked on, enough for the threads of a large machine.
const PIECES: usize = 256;

pub fn run(arguments: &Trace) -> Result<Answer, Failure> {
    let tracer = Tracer::new(&arguments.scene.load()?)?;
    let mut lines = Lines::open(&arguments.rays)?;
    let table = lines.heading()?;
    if !arguments.quiet && !table.ignored.is_empty() {
        let names = table.ignored.join(", ");
        tell(&format!("note: ignored columns: {names}"));
    }
    let mut decided = Decided::default();
    let mut output = io::stdout().lock();
    output.write_all(HEADING.as_bytes())?;
    loop {
        let (batch, end) = read_batch(&mut lines);
        let pieces: Vec<Piece> = batch
            .par_chunks(PIECE)
            .map(|lines| trace(&tracer, &table, lines))
            .collect();
        for piece in pieces {
            output.write_all(piece.text.as_bytes())?;
            decided = decided.joined(piece.decided);
            piece.end?;
        }
        if end? {
            break;
        }
    }
    output.flush()?;
    if !arguments.quiet {
        tell(&summary(&decided));
    }
    Ok(Answer::Good)
}

/// The next lines, and whether they are the last ones; those before an unreadable one count.
fn read_batch(lines: &mut Lines) -> (Vec<Line>, Result<bool, Failure>) {
    let mut batch = Vec::with_capacity(PIECE);
    while batch.len() < PIECE * PIECES {
        match lines.next_line() {
            Ok(Some(line)) => batch.push(line),
            Ok(None) => return (batch, Ok(true)),
            Err(error) => return (batch, Err(error)),
        }
    }
    (batch, Ok(false))
}

/// Some rows of the output.
struct Piece {
    text: String,
    decided: Decided,
    /// The first line that is no ray ends the table.
    end: Result<(), Failure>,
}

fn trace(tracer: &Tracer, table: &Table, lines: &[Line]) -> Piece {
    let mut piece = Piece {
        text: String::new(),
        decided: Decided::default(),
        end: Ok(()),
    };
    let mut workspace = Workspace::default();
    for line in lines {
        let (id, query) = match table.ray(line) {
            Ok(ray) => ray,
            Err(error) => {
                piece.end = Err(error);
                break;
            }
        };
        let first = tracer.first_hit(&query, &mut workspace, &mut piece.decided);
        push_field(&mut piece.text, &id);
        match first {
            First::Hit(hit) => push_hit(&mut piece.text, tracer, &hit),
            First::Nothing => piece.text.push_str(",0,,,,,,,,,,,,,\n"),
            First::Undecided(finder) => {
                let _ = writeln!(piece.text, ",undecided,,,,,,,,,{finder},,,,");
            }
        }
    }
    piece
}

fn push_hit(text: &mut String, tracer: &Tracer, hit: &FirstHit) {
    text.push_str(",1");
    push_numbers(text, &[hit.t]);
    push_numbers(text, &hit.point.to_array());
    match hit.normal {
        Some(normal) => push_numbers(text, &normal.to_array()),
        None => text.push_str(",,,"),
    }
    text.push(',');
    push_field(text, tracer.name(hit.object));
    match &hit.found {
        Some(found) => push_found(text, found),
        None => text.push_str(",,,,,"),
    }
    text.push('\n');
}

/// Finder, enclosure, multiplicity and tier.
fn push_found(text: &mut String, found: &Found) {
    text.push(',');
    text.push_str(found.finder);
    push_numbers(text, &found.enclosure);
    text.push(',');
    if let Some(multiplicity) = found.multiplicity {
        // Writing to a string cannot fail.
        let _ = write!(text, "{multiplicity}");
    }
    text.push(',');
    text.push_str(match found.tier {
        Some(Tier::Double) => "f64",
        Some(Tier::DoubleDouble) => "double-double",
        Some(Tier::Exact) => "exact",
        None => "uncertified",
    });
}

/// The shortest digits that give back the same f64.
fn push_numbers(text: &mut String, numbers: &[f64]) {
    for number in numbers {
        // Writing to a string cannot fail.
        let _ = write!(text, ",{number:?}");
    }
}

/// A field, in quotes where it has to be (RFC 4180).
fn push_field(text: &mut String, field: &str) {
    if field.contains(['"', ',', '\n', '\r']) {
        let _ = write!(text, "\"{}\"", field.replace('"', "\"\""));
    } else {
        text.push_str(field);
    }
}

/// How many rays and questions each arithmetic has decided, for stderr.
fn summary(decided: &Decided) -> String {
    let Decided {
        rays,
        hits,
        ladder,
        undecided,
        implicit,
    } = decided;
    let mut text = format!(
        "{rays} rays, {hits} hits; questions decided in f64: {}, in double-double: {}, exactly: {}",
        ladder.double, ladder.double_double, ladder.exact
    );
    if implicit.rays() > 0 {
        let _ = write!(
            text,
            "; implicit surfaces in f64: {}, in double-double: {}, exactly: {}, undecided: {}",
            implicit.double, implicit.double_double, implicit.exact, implicit.undecided
        );
    }
    if implicit.uncertified > 0 {
        let _ = write!(text, ", not certified: {}", implicit.uncertified);
    }
    if *undecided > 0 {
        let _ = write!(text, "; {undecided} rays undecided");
    }
    text
}
