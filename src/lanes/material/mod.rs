//! How surfaces scatter light: one file a material, and one list of them.
//!
//! A path asks in two ways. *Sample*: where does light go that comes from here, and what does it
//! weigh? *Evaluate*: how much goes from one given direction to another? Geometry is asked for a
//! packet of lanes at once; spectra have C values a lane, and are handed over lane by lane.

/// The materials: what stands here is read from scene files, planned, rendered and tested.
macro_rules! materials {
    ($define:ident) => {
        $define! {
            Diffuse in diffuse,
            Conductor in conductor,
            Mirror in mirror,
            Glass in glass,
            Checkerboard in checkerboard,
            Black in black,
            #[cfg(feature = "planted")]
            Phong in phong,
        }
    };
}

pub mod black;
pub mod checkerboard;
pub mod conductor;
pub mod diffuse;
pub mod fresnel;
pub mod glass;
pub mod interface;
pub mod kind;
pub mod mirror;
pub mod phong;
pub mod record;

pub use interface::{Densities, Event, Interface, Medium, Transport, Variates, Wavelengths};
pub use kind::{Material, MaterialJob, MaterialKind, MaterialKinds};
pub use record::{NUMBERS, Record, SPECTRA, Surface};

pub(crate) use kind::each_material;

use crate::math::lanes::Lanes;
use crate::math::vec3::Vec3;
