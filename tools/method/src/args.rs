//! What can be asked for on the command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

/// Instruments about methods of etalon.
#[derive(Debug, Parser)]
#[command(
    name = "etalon-method",
    version,
    propagate_version = true,
    after_help = "Exit codes: 0 good, 1 the answer is no, 2 could not do it."
)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Compare the root finders of implicit surfaces over rays whose first hits are known.
    Finders(Finders),
}

/// Arguments of `etalon-method finders`.
#[derive(Debug, Args)]
#[command(after_help = "\
Without --map, every finder runs over the rays, one after the other on one thread, and \
finders.csv and finders.svg in the output directory say by class of ray how often it was wrong, how \
often undecided, and how long a ray took. The rays are CSV with the columns shape, class, ox, oy, \
oz, dx, dy, dz, tmin, hit, t and gap; the shapes are lines name;half_width;degree;expression below a \
heading. With --map, a PNG shows for each finder which pixels of one surface it gets wrong (red) or \
leaves undecided (amber), where auto is the truth.

Exit code 1 if a finder that proves its answers was wrong.

Examples:
  etalon-method finders -o charts
  etalon-method finders --map heart --size 400")]
pub struct Finders {
    /// The CSV file of rays; by default those that come with the program.
    #[arg(long, value_name = "FILE")]
    pub rays: Option<PathBuf>,
    /// The file of surfaces; by default those that come with the program.
    #[arg(long, value_name = "FILE")]
    pub shapes: Option<PathBuf>,
    /// The directory to write to.
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub output: PathBuf,
    /// Paint the pixels of this surface instead.
    #[arg(long, value_name = "SURFACE")]
    pub map: Option<String>,
    /// Map where each method fails instead: all shapes and precisions over families of rays that grow
    /// harder.
    #[arg(long, conflicts_with_all = ["map", "rays", "shapes"])]
    pub failures: bool,
    /// Rays a shape, family and difficulty of the failure maps.
    #[arg(long, value_name = "RAYS", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub count: u32,
    /// Width and height of each map in pixels.
    #[arg(long, value_name = "PIXELS", default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub size: u32,
    /// Say nothing on stderr but errors.
    #[arg(short, long)]
    pub quiet: bool,
}
