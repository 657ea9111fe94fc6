//! etalon: a physically based spectral renderer, and the instrument that proves its pictures right.
//!
//! A scene is described in TOML; what comes back is a picture whose every pixel knows its standard
//! error, with all that it takes to make it again. The same scene gives the same bits, on any number
//! of threads and with every instruction set.
//!
//! # A picture and its error
//!
//! ```
//! use etalon::{Attribute, Picture, Render, Scene, Window};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let albedo = 0.5;
//! let scene = Scene::parse(&format!(
//!     r#"
//!     environment = 1                     # radiance from everywhere, W·m⁻²·sr⁻¹·nm⁻¹
//!     camera = {{ from = [0, 0, 6], to = [0, 0, 0], fov = 30 }}
//!     image = {{ size = [16, 16], spp = 64 }}
//!     materials.grey = {{ diffuse = {albedo} }}
//!
//!     [[object]]
//!     shape = "sphere"
//!     material = "grey"
//!     "#
//! ))?;
//! let render = Render::new(scene)?;
//! let rendered = render.run();
//!
//! // Light reaches a lone convex body once; all that the middle shows is albedo × radiance.
//! let middle = Window { x0: 6, y0: 6, x1: 10, y1: 10 };
//! let mean = rendered.mean(middle)?.luminance;
//! assert!(mean.score(albedo).abs() < 4.0, "{mean} is no {albedo}");
//!
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("ball.exr");
//! render.picture(&rendered)?.write(&path)?;
//!
//! // The file holds the scene, the seed, the plan in words …
//! let picture = Picture::read(&path)?;
//! assert_eq!(picture.attribute("spp"), Some(&Attribute::Int(64)));
//! assert!(picture.floats("standard_error.G").is_some());
//! # Ok(())
//! # }
//! ```
//!
//! [`Scene::load`] reads a scene file; every key of the format is listed in `scenes/README.md`.
//! [`Render`] takes a part of the picture, further [layers](Layer), spectral [bins](BinGrid), a limit
//! of time, and a [wanted error](Render::aim).
//!
//! # A ray and a proof
//!
//! ```
//! use etalon::{DVec3, First, Ray, Scene, Tier, Tracer};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = Scene::parse(
//!     r#"
//!     camera = { from = [0, 0, 6], to = [0, 0, 0], fov = 30 }
//!     image = { size = [16, 16], spp = 1 }
//!     materials.grey = { diffuse = 0.5 }
//!
//!     [[object]]
//!     shape = { implicit = "torus" }      # around z, radii 1 and 1/4
//!     material = "grey"
//!     "#,
//! )?;
//! // This ray lies in the plane that the torus stands on, and touches it at x = −1.
//! let tracer = Tracer::new(&scene)?;
//! let ray = Ray { origin: DVec3::new(-3.0, 0.0, 0.25), direction: DVec3::X };
//! let First::Hit(hit) = tracer.first(ray) else {
//!     panic!("the ray touches the torus");
//! };
//! let found = hit.found.ok_or("an implicit surface")?;
//! assert!(found.enclosure[0] <= 2.0 && 2.0 <= found.enclosure[1]);
//! assert_eq!((found.multiplicity, found.tier), (Some(2), Some(Tier::Exact)));
//! # Ok(())
//! # }
//! ```
//!
//! # Two pictures and a verdict
//!
//! ```
//! use etalon::{Comparison, Render, Scene};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let scene = Scene::parse(
//! #     r#"
//! #     environment = 1
//! #     camera = { from = [0, 0, 6], to = [0, 0, 0], fov = 30 }
//! #     image = { size = [16, 16], spp = 16 }
//! #     materials.grey = { diffuse = 0.5 }
//! #     [[object]]
//! #     shape = "sphere"
//! #     material = "grey"
//! #     "#,
//! # )?;
//! let mut render = Render::new(scene)?;
//! let first = render.picture(&render.run())?;
//! render.reseed(1);
//! let second = render.picture(&render.run())?;
//!
//! // Other random numbers, another picture: does noise explain all of the difference?
//! let comparison = Comparison::of(&second, &first)?;
//! let judgement = comparison.judgement.ok_or("both know their variances")?;
//! assert!(judgement.consistent, "{:?}", judgement.channels);
//! # Ok(())
//! # }
//! ```
//!
//! # Units
//!
//! Lengths are in scene units, angles in scene files in degrees, wavelengths in nm. Light is spectral
//! radiance, W·m⁻²·sr⁻¹·nm⁻¹. The picture's R, G, B are linear, with the primaries and the white
//! point of Rec. ITU-R BT.709; of light of constant spectral radiance, luminance Y is that radiance.
//! Pixels are counted from the upper left corner.
//!
//! # Words
//!
//! | word | meaning |
//! |---|---|
//! | sample, spp | a camera path of a pixel; how many there are |
//! | replicate | samples of a pixel under one scrambling; the spread of the replicates' means gives the standard error |
//! | standard error, variance | of a mean; of one sample |
//! | bias | expected value minus truth |
//! | reference, truth | a picture with its own variance; a closed form or exact arithmetic |
//! | throughput | product of bsdf · cos/pdf along a path |
//! | bsdf | f(wo, wi), sr⁻¹, without the cosine; both directions are unit vectors away from the surface |
//! | pdf, probability | a density; of a discrete choice |
//! | hero, secondary wavelengths | the first of a path's wavelengths, and the others, which end where glass disperses |
//! | t | length along a unit ray; elsewhere in units of the ray's direction |
//! | root, bracket, enclosure | a zero; an interval over which the sign changes; an interval proved to hold the zero |
//! | field | f(x, y, z) of an implicit surface, negative inside |
//! | plan | what is built for a scene: arithmetic, wavelengths, what can happen in it |
//!
//! # A sample's journey
//!
//! `scene` reads the text into plain, checked values: a [`Scene`] that exists is valid. `plan` decides
//! once what the scene needs ([`Plan`]): whether single precision is provably enough, how many
//! wavelengths a path carries, what cannot happen and is left out; it builds flat tables about the
//! camera's position, and can say why in words. `render` cuts the picture into tiles for the
//! threads and goes over all of it in passes.
//!
//! `sample` turns a pixel, the number of a sample and the seed into numbers, one for each named
//! decision of the path. `camera` makes a ray of them; `spectrum` draws its wavelengths. `integrate`
//! follows 16 paths (single precision) or 8 (double) at a time: `shape` finds the first surface,
//! with error bounds, and what they leave undecided climbs from f64 to double-double to exact
//! integers; for implicit surfaces `field` and `root` isolate the zeros along the ray. `material`
//! says what the surface does with light; `light` picks a lamp and a point on it, and the two ways
//! to reach a lamp are weighed against each other.
//!
//! `film` keeps one sum a pixel and replicate, in f64 and in the order of the samples. [`Rendered`]
//! holds these sums; the [`Picture`] made of them has channels with standard errors and the
//! attributes that say where it comes from. `compare` judges pictures, `study` measures how errors
//! fall with samples and seconds, `chart` draws that.
//!
//! # Rooms
//!
//! A room uses those after its arrow, and no others; the first twelve are the crate `etalon-lanes`.
//!
//! ```text
//! math →
//! root → math
//! field → math
//! sample → math
//! spectrum → math
//! declare → spectrum
//! planted → math
//! material → declare, planted, sample, spectrum, math
//! shape → field, root, math
//! camera → declare, sample, math
//! light → declare, shape, sample, spectrum, math
//! integrate → camera, light, material, planted, shape, sample, spectrum, math
//! stats →
//! film → sample, spectrum, math
//! scene → camera, declare, field, light, material, shape, sample, spectrum, math
//! plan → scene, integrate, film, camera, declare, light, shape, sample, spectrum, math
//! render → plan, scene, integrate, film, camera, shape, sample, spectrum, stats, math
//! compare → scene, film, spectrum, stats
//! chart → stats
//! study → chart, render, plan, scene, film, spectrum, stats
//! ```
//!
//! # Features
//!
//! `cli` (default) builds the program `etalon`, `study` (default) the rooms `study` and `chart`;
//! without them the library stands alone. `serde` lets comparisons be serialised.

#[cfg(feature = "study")]
#[allow(missing_docs, reason = "no name of this room is shown at the door")]
mod chart;
mod compare;
mod film;
mod plan;
mod render;
mod scene;
mod stats;
#[cfg(feature = "study")]
#[allow(missing_docs, reason = "no name of this room is shown at the door")]
mod study;

use etalon_lanes::{
    camera, declare, field, integrate, light, material, math, sample, shape, spectrum,
};

pub use compare::{
    ChannelJudgement, ChannelMetrics, CompareError, Comparison, Judgement, Metrics, Side,
};
pub use film::{Attribute, Channel, Error as PictureError, Picture, Values};
pub use glam::DVec3;
pub use math::instructions::Instructions;
pub use math::ray::Ray;
pub use plan::{Plan, PlanError};
pub use render::bins::{BinError, BinGrid};
pub use render::builder::{MOST_SAMPLES, Render};
pub use render::goal::{Chosen, Goal, Target};
pub use render::layers::Layer;
pub use render::memory::TooLarge;
pub use render::session::{Mean, Progress, Rendered};
pub use render::tile::{Outside, Window};
pub use render::trace::{First, FirstHit, Found, Singular, Tracer};
pub use scene::{Diagnostic, Origin, Overrides, Scene, SceneError};
pub use shape::Tier;
pub use stats::Estimate;

/// The rooms, for this repository's own tests, benchmarks and command line. Nothing is promised of
/// them.
#[doc(hidden)]
pub mod inside {
    macro_rules! rooms {
        ($($room:ident)*) => {
            $(pub mod $room {
                pub use crate::$room::*;
            })*
        };
    }
    rooms! { compare film plan render scene stats }
    #[cfg(feature = "study")]
    rooms! { chart study }

    pub use etalon_lanes::planted;
    pub use etalon_lanes::{
        camera, declare, field, integrate, light, material, math, root, sample, shape, spectrum,
    };
}
