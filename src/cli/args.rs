//! The commands and their arguments.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand};
use etalon::inside::chart::figures::USUAL_ERROR;
use etalon::inside::study::axis::Axis;
use etalon::inside::study::choice::Choice;
use etalon::{Instructions, Overrides, Scene, Window};

use super::values::{
    Layer, axis, crop, finite, instructions, layer, pixel, seconds, setting, share, size,
};
use super::{Failure, scene_words};

/// A physically based spectral renderer, and the instrument that proves its pictures right.
#[derive(Debug, Parser)]
#[command(
    name = "etalon",
    version,
    propagate_version = true,
    after_help = "Exit codes: 0 good, 1 the answer is no, 2 could not do it.\n\n\
                  Example: etalon render scenes/spheres.toml -o spheres.exr"
)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene to an OpenEXR file with its standard error and provenance.
    Render(Box<Render>),
    /// Show what is in a scene, what it needs, and how it will be rendered.
    Info(Info),
    /// Intersect given rays with a scene and print the hits as CSV.
    Trace(Trace),
    /// Follow one camera path of a rendering and print each of its steps.
    Replay(Replay),
    /// Compare a picture with another or with a number: metrics, and whether noise explains it.
    Compare(Compare),
    /// Measure how a scene's error falls with samples and seconds, for a grid of choices.
    Study(Box<Study>),
    /// Count how often the 95 % intervals of blocks of pixels hold what they should.
    Coverage(Coverage),
    /// Lay the tables of several studies, other programs' included, into one chart.
    Chart(Chart),
}

/// The scene and what is changed in it.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// The scene file (TOML).
    #[arg(value_name = "SCENE.toml")]
    pub scene: PathBuf,
    /// The panel (named variant) of the scene; `etalon render` takes `all` of them too.
    #[arg(long, value_name = "NAME")]
    pub panel: Option<String>,
    /// Lay this over the scene after the panel: a dotted key and a TOML value or a bare word.
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, String)>,
    /// Finder of all implicit surfaces, whatever the scene says: auto, sign-change, sphere-trace,
    /// interval, polynomial.
    #[arg(long, value_name = "NAME")]
    pub finder: Option<String>,
    /// Seed of all randomness.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub seed: Option<String>,
}

impl SceneArguments {
    /// What is laid over the file: the panel, each `--set` in order, then the options that stand
    /// for keys of `[image]`. Values are the scene's to check.
    pub fn overrides(&self, image: &[(&str, &Option<String>)]) -> Overrides {
        let mut set = self.set.clone();
        let own = ("seed", &self.seed);
        for (key, value) in image.iter().chain([&own]) {
            let option = |value: &String| (format!("image.{key}"), value.clone());
            set.extend(value.as_ref().map(option));
        }
        Overrides {
            panel: self.panel.clone(),
            set,
            finder: self.finder.clone(),
        }
    }

    /// Reads the scene with these overrides.
    pub fn load(&self) -> Result<Scene, Failure> {
        let scene = Scene::load_with(&self.scene, &self.overrides(&[]));
        Ok(scene.map_err(|error| scene_words(&error))?)
    }
}

#[derive(Debug, Args)]
#[command(after_help = "\
Beside the picture goes a PNG to look at, its exposure chosen for the eye. --time and Ctrl-C stop \
between passes; the file then holds the count of samples reached, and --spp with that count gives \
the same bits (not so with the sampler stratified, whose strata are cut for a planned count). A \
second Ctrl-C ends at once and leaves no file. A picture that needs more memory than the system \
has available is refused.

Examples:
  etalon render scenes/spheres.toml
  etalon render scenes/spheres.toml -o small.exr --size 200x150 --spp 64
  etalon render scenes/spheres.toml --panel all --layers depth,normal,spectral:400-700:10
  etalon render scenes/spheres.toml --time 60 --set materials.glass.glass=N-SF11
  etalon render scenes/spheres.toml --target-error 0.02 --target block")]
pub struct Render {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The picture to write; by default the scene's name, with the panel's, ending in .exr.
    #[arg(short, long, value_name = "OUT.exr")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub image: ImageOptions,
    /// Stop after this time, between passes.
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time: Option<Duration>,
    /// Take as many samples as this standard error over mean needs: pilots with seeds of their own
    /// choose the number and are thrown away, so that the choice does not bend the picture.
    #[arg(long, value_name = "SHARE", conflicts_with = "spp", value_parser = share)]
    pub target_error: Option<f64>,
    /// What --target-error is the error of: the mean luminance of the whole image, or of its worst
    /// block of 8x8 pixels.
    #[arg(
        long,
        value_name = "image|block",
        requires = "target_error",
        default_value = "image",
        value_parser = ["image", "block"]
    )]
    pub target: String,
    /// Render this part of the picture only: pixels from X0,Y0 up to but not including X1,Y1.
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = crop)]
    pub crop: Option<Window>,
    /// Threads to work with; by default one for each of the machine's.
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Further layers of the picture, separated by commas: depth, normal, object, material,
    /// spectral[:from-to:step] (wavelengths in nm).
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = layer)]
    pub layers: Vec<Layer>,
    /// Leave out of the loop what the scene does not need, or keep everything.
    #[arg(long, default_value = "auto", value_parser = ["auto", "full"])]
    pub plan: String,
    /// Instruction set; the picture's bits are the same with each.
    #[arg(long, default_value = "auto", value_parser = instructions())]
    pub instructions: Instructions,
    /// Say nothing on stderr but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

/// Options that stand for keys of `[image]`.
#[derive(Debug, Args)]
pub struct ImageOptions {
    /// Camera paths per pixel.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub spp: Option<String>,
    /// Width and height of the picture in pixels.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<String>,
    /// Longest path in segments: 1 is emitted light only, 2 direct light.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub max_depth: Option<String>,
    /// Which points the estimator uses: sobol, independent, stratified, center.
    #[arg(long, value_name = "S")]
    pub sampler: Option<String>,
    /// Independent scrambles per pixel, from which the standard error comes.
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    pub replicates: Option<String>,
    /// Arithmetic of the path loop: auto, f32, f64.
    #[arg(long, value_name = "auto|f32|f64")]
    pub precision: Option<String>,
    /// Wavelengths per path.
    #[arg(long, value_name = "4|8", allow_negative_numbers = true)]
    pub wavelengths: Option<String>,
}

impl ImageOptions {
    /// Keys of `[image]` and the values asked for.
    pub fn keys(&self) -> [(&'static str, &Option<String>); 7] {
        [
            ("spp", &self.spp),
            ("size", &self.size),
            ("max_depth", &self.max_depth),
            ("sampler", &self.sampler),
            ("replicates", &self.replicates),
            ("precision", &self.precision),
            ("wavelengths", &self.wavelengths),
        ]
    }
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  etalon info scenes/spheres.toml
  etalon info scenes/spheres.toml --panel a --set image.precision=f32")]
pub struct Info {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Leave out of the loop what the scene does not need, or keep everything.
    #[arg(long, default_value = "auto", value_parser = ["auto", "full"])]
    pub plan: String,
}

#[derive(Debug, Args)]
#[command(after_help = "\
The rays are CSV with a heading that names the columns ox,oy,oz,dx,dy,dz (origin and direction, \
world coordinates) and, if wanted, id, tmin and tmax, in any order. Numbers are read exactly as \
the f64 they round to; tmax may be inf. A direction need not be of unit length, and t is in units \
of it. A hit counts where tmin < t < tmax, and at t = 0 too where tmin is 0. Shapes are closed: \
touching counts, but a ray in the plane of a flat shape misses it.

The hits are CSV, one line a ray in the same order: id,hit,t,x,y,z,nx,ny,nz,object with enough \
digits to give back each f64. The normal is of unit length and points outward (+z of flat shapes); \
it is left empty where the surface has none, and everything after hit where nothing is hit. Of \
objects at the same t, opaque ones come before glass, then those earlier in the file.

Example:
  printf 'ox,oy,oz,dx,dy,dz\\n0,0,5,0,0,-1\\n' | etalon trace scenes/spheres.toml --rays -")]
pub struct Trace {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The CSV file of rays, or - for stdin.
    #[arg(long, value_name = "FILE|-")]
    pub rays: PathBuf,
    /// Say nothing on stderr but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  etalon replay scenes/spheres.toml --pixel 120,80 --sample 17")]
pub struct Replay {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The pixel, counted from 0,0 in the upper left corner.
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    pub pixel: [u32; 2],
    /// The camera path of this pixel, counted from 0.
    #[arg(long, value_name = "I")]
    pub sample: u32,
}

#[derive(Debug, Args)]
#[command(after_help = "\
B is the reference: its mean is what relative errors are relative to. Where both pictures know the \
variances of their pixels, a verdict follows: image means, blocks of pixels and the distribution of \
all blocks are tested at a family-wise level of 1e-3, and the smallest bias that would have been \
caught is printed.

Exit codes: 0 consistent, 1 not, 2 could not compare (other size, other scene, no common channel, \
values that are not numbers, no variances).

Examples:
  etalon compare picture.exr reference/cornell_box.exr --heatmap difference.png
  etalon compare furnace.exr --truth 2 --json")]
pub struct Compare {
    /// The picture.
    #[arg(value_name = "A.exr")]
    pub a: PathBuf,
    /// The picture it is compared with.
    #[arg(value_name = "B.exr", required_unless_present = "truth")]
    pub b: Option<PathBuf>,
    /// Compare the mean of each channel with this number instead.
    #[arg(long, value_name = "VALUE", conflicts_with = "b", allow_negative_numbers = true, value_parser = finite)]
    pub truth: Option<f64>,
    /// Print everything as JSON.
    #[arg(long)]
    pub json: bool,
    /// Paint where they differ: red where A is too bright, blue where it is too dark.
    #[arg(long, value_name = "OUT.png", conflicts_with = "truth")]
    pub heatmap: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Each point of the grid is rendered --replicates times with independent seeds and compared with the \
reference. The directory then holds study.csv with one row a render (its columns are explained in \
scenes/README.md), the charts error, speed and honesty as SVG, and report.html, which needs \
no other file. The same command goes on with a study that was interrupted.

Axes: spp, max_depth, wavelengths, scrambles (numbers: lists such as 4,8 and ranges such as \
1..4096x2), sampler, precision, finder (names). Without an axis that is a number, samples 1, 2, 4 … \
are planned from a pilot to fit into --budget; without any axis, over the samplers.

Examples:
  etalon study scenes/cornell_box.toml
  etalon study scenes/fig8_lens.toml --over spp=1..1024x4 --over sampler=sobol,stratified
  etalon study scenes/fig7_mirrors.toml --over max_depth=1..64x2 --set image.spp=256")]
pub struct Study {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Go over the values of this choice; may be given for several.
    #[arg(long, value_name = "KEY=VALUES", value_parser = axis)]
    pub over: Vec<Axis>,
    /// Independent renders of each point, at least 2.
    #[arg(long, value_name = "N", default_value_t = 16)]
    pub replicates: u32,
    /// What to compare with: a picture with its variance, a radiance or linear R,G,B that all pixels
    /// are known to have, or auto: a committed reference, the truth that the scene names, or one
    /// rendered for the purpose.
    #[arg(long, value_name = "FILE.exr|TRUTH|auto", default_value = "auto")]
    pub reference: Choice,
    /// Refuse what would take longer than this, the reference included.
    #[arg(long, value_name = "SECONDS", default_value = "150", value_parser = seconds)]
    pub budget: Duration,
    /// The directory to write to; by default the scene's name, with the panel's, ending in -study.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Threads to work with; by default one for each of the machine's.
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Instruction set; the pictures' bits are the same with each.
    #[arg(long, default_value = "auto", value_parser = instructions())]
    pub instructions: Instructions,
    /// Say nothing on stderr but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
The columns are explained in scenes/README.md; other programs can write them.

Example:
  etalon chart cornell_box-study/study.csv mitsuba.csv -o cornell_box")]
pub struct Chart {
    /// Tables of studies.
    #[arg(value_name = "FILE.csv", required = true)]
    pub tables: Vec<PathBuf>,
    /// The chart to write, as SVG.
    #[arg(short, long, value_name = "OUT", default_value = "chart")]
    pub output: PathBuf,
    /// The relative mean squared error at which the programs' times are compared.
    #[arg(long, value_name = "RELMSE", default_value_t = USUAL_ERROR)]
    pub at: f64,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Each scene is surveyed by independent samples, 16 times as many as are tested, and then rendered \
several times with each sampler; a block counts where its 95 % interval, widened by the survey's own \
error, holds the survey's mean. Blocks with fewer than 24 contributing samples are counted apart: from \
so few no interval is honest to a percentage point. Exit code 1 where blocks with enough hold in less \
than 93 % or more than 97 % of all cases.

Example:
  etalon coverage scenes/*.toml -o coverage.csv")]
pub struct Coverage {
    /// The scenes.
    #[arg(value_name = "SCENE.toml", required = true)]
    pub scenes: Vec<PathBuf>,
    /// Lay this over the scenes: a dotted key and a TOML value or a bare word.
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, String)>,
    /// Samplers to be tested.
    #[arg(
        long,
        value_name = "S,…",
        value_delimiter = ',',
        default_value = "independent,stratified,sobol"
    )]
    pub samplers: Vec<String>,
    /// Camera paths per pixel of a tested render, at least 2.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(2..))]
    pub spp: u32,
    /// Tested renders of each scene and sampler.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..))]
    pub renders: u32,
    /// Longer edge of the pictures in pixels.
    #[arg(long, value_name = "N", default_value_t = 96, value_parser = clap::value_parser!(u32).range(8..))]
    pub edge: u32,
    /// A CSV file to write the counts to.
    #[arg(short, long, value_name = "FILE.csv")]
    pub output: Option<PathBuf>,
    /// Threads to work with; by default one for each of the machine's.
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
}
