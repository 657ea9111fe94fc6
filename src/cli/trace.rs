//! `etalon trace`: given rays to hits.

mod rays;

use std::fmt::Write as _;
use std::io::{self, Write};

use etalon::inside::render::trace::Decided;
use etalon::inside::shape::implicit::certified::Workspace;
use etalon::{First, FirstHit, Tier, Tracer};
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
        let pieces = batch.par_chunks(PIECE);
        let pieces = pieces.map(|lines| trace(&tracer, &table, lines));
        for (text, own, traced) in pieces.collect::<Vec<_>>() {
            output.write_all(text.as_bytes())?;
            decided = decided.joined(own);
            traced?;
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

/// Some rows of the output, up to the first line that is no ray, which ends the table.
fn trace(tracer: &Tracer, table: &Table, lines: &[Line]) -> (String, Decided, Result<(), Failure>) {
    let (mut text, mut decided) = (String::new(), Decided::default());
    let mut workspace = Workspace::default();
    for line in lines {
        let (id, query) = match table.ray(line) {
            Ok(ray) => ray,
            Err(error) => return (text, decided, Err(error)),
        };
        let first = tracer.first_hit(&query, &mut workspace, &mut decided);
        push_field(&mut text, &id);
        match first {
            First::Hit(hit) => push_hit(&mut text, tracer, &hit),
            First::Nothing => text.push_str(",0,,,,,,,,,,,,,\n"),
            First::Undecided(finder) => {
                let _ = writeln!(text, ",undecided,,,,,,,,,{finder},,,,");
            }
        }
    }
    (text, decided, Ok(()))
}

/// Appends what follows the id of a ray that hits, numbers with the shortest digits that give back the
/// same f64.
fn push_hit(text: &mut String, tracer: &Tracer, hit: &FirstHit) {
    let [x, y, z] = hit.point.to_array();
    // Writing to a string cannot fail.
    let _ = write!(text, ",1,{:?},{x:?},{y:?},{z:?},", hit.t);
    let _ = match hit.normal.map(|normal| normal.to_array()) {
        Some([x, y, z]) => write!(text, "{x:?},{y:?},{z:?},"),
        None => write!(text, ",,,"),
    };
    push_field(text, tracer.name(hit.object));
    let Some(found) = &hit.found else {
        text.push_str(",,,,,\n");
        return;
    };
    let [low, high] = found.enclosure;
    let _ = write!(text, ",{},{low:?},{high:?},", found.finder);
    if let Some(multiplicity) = found.multiplicity {
        let _ = write!(text, "{multiplicity}");
    }
    text.push_str(match found.tier {
        Some(Tier::Double) => ",f64\n",
        Some(Tier::DoubleDouble) => ",double-double\n",
        Some(Tier::Exact) => ",exact\n",
        None => ",uncertified\n",
    });
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
