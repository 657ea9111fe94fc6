//! A checkerboard of two Lambertian surfaces, in cubes of the object's own coordinates.

use glam::DVec3;

use super::{Lanes, Material, MaterialKind, NUMBERS, SPECTRA, Vec3};
use crate::declare::{Declaration, Parameter, Quantity, Range, Role};
use crate::math::lanes::Real;

/// [`Diffuse`](super::diffuse::Diffuse), of the first albedo in cells whose numbers sum to an even one, else of the second.
pub struct Checkerboard;

impl Material for Checkerboard {
    const DECLARATION: Declaration = Declaration::new(
        "checkerboard",
        "albedos",
        Quantity::TwoSpectra(Role::Reflectance),
    )
    .beside(&[Parameter::new(
        "cell",
        "edge of a cell",
        Quantity::number("object coordinates", Range::POSITIVE),
    )]);
    const WORDS: &'static str = "checkerboard";
    const TEXTURE_OF: Option<MaterialKind> = Some(MaterialKind::Diffuse);
    const SPREAD: bool = true;

    /// Cells per canonical unit along each axis.
    fn numbers(numbers: &[f64], size: DVec3) -> [f64; NUMBERS] {
        let [cell, ..] = numbers else {
            return [0.0; NUMBERS];
        };
        size.to_array().map(|length| length / cell)
    }

    #[inline(always)]
    fn texture<L: Lanes>(
        l: L,
        numbers: [L::Real; NUMBERS],
        local: Vec3<L::Real>,
        [even, odd]: [L::Int; SPECTRA],
    ) -> [L::Int; SPECTRA] {
        let cell = inlined!(|x: L::Real, frequency: L::Real| (x * frequency).floor());
        let [fx, fy, fz] = numbers;
        let half = (cell(local.x, fx) + cell(local.y, fy) + cell(local.z, fz)) * l.real(0.5);
        [l.select_int(half.same(half.floor()), even, odd), odd]
    }
}
