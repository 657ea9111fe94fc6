//! Where light meets a surface, what becomes of it there, and what it may do.

use super::{NUMBERS, SPECTRA};
use crate::math::lanes::{Int, Lanes, Real, Scalar, WIDEST};
use crate::math::packet::int_array;
use crate::math::vec3::Vec3;
use crate::planted::Planted;

/// What a path carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transport {
    /// Radiance towards a camera, along a path that starts there.
    Radiance,
    /// Importance, along a path that starts at a lamp.
    Importance,
}

/// What fills the space on one side of a surface.
#[derive(Clone, Copy)]
pub enum Medium<L: Lanes> {
    Vacuum,
    /// Something of index n + ik: where the nodes of n and k stand in the bank of spectra.
    Index([L::Int; 2]),
}

/// The wavelengths that the paths of a packet carry, and spectra there.
#[derive(Clone, Copy)]
pub struct Wavelengths<'a, L: Lanes, const C: usize> {
    /// The rows of the bank of spectra.
    pub bank: &'a [[L::Scalar; C]],
    /// Which row of every spectrum holds the path's wavelengths.
    pub row: L::Int,
    /// Where `hero` and `fraction` of each lane are.
    pub slots: &'a [u32; WIDEST],
    /// Which of the wavelengths is the hero.
    pub hero: &'a [u32],
    /// How far into its cell each wavelength lies, [0, 1).
    pub fraction: &'a [L::Scalar],
    /// All but the hero have ended.
    pub ended: L::Mask,
}

impl<L: Lanes, const C: usize> Wavelengths<'_, L, C> {
    /// Numbers of the bank's rows that hold a spectrum at each lane's wavelengths.
    #[inline(always)]
    pub fn rows(&self, l: L, spectrum: L::Int) -> [u32; WIDEST] {
        int_array(l, spectrum.plus(self.row))
    }

    /// Number of lane i's hero among its wavelengths.
    #[inline(always)]
    pub fn hero(&self, i: usize) -> usize {
        self.hero[self.slots[i] as usize] as usize % C
    }

    /// A spectrum of nodes, linear between, at lane i's wavelengths; `row` is that of
    /// [`Self::rows`].
    #[inline(always)]
    pub fn between_nodes(&self, i: usize, row: u32) -> [L::Scalar; C] {
        let fraction = self.fraction[self.slots[i] as usize];
        let (low, high) = (self.bank[row as usize], self.bank[row as usize + 1]);
        let mut values = low;
        for c in 0..C {
            values[c] = fraction.fused(high[c] - low[c], low[c]);
        }
        values
    }
}

/// A packet of points where light meets surfaces of one material.
#[derive(Clone, Copy)]
pub struct Interface<'a, L: Lanes, const C: usize> {
    /// The lanes that are asked.
    pub lanes: L::Mask,
    /// Unit normal of the shape on the side of wo.
    pub geometric: Vec3<L::Real>,
    /// Unit normal that cosines are measured from, on the side of wo.
    pub shading: Vec3<L::Real>,
    /// wo is on the outward side (+z of flat shapes).
    pub front: L::Mask,
    /// What fills the space on the outward side.
    pub outside: Medium<L>,
    /// What fills the space on the other side.
    pub inside: Medium<L>,
    /// Refraction disperses.
    pub disperses: L::Mask,
    /// The material's spectra: where they stand in the bank.
    pub spectra: [L::Int; SPECTRA],
    /// The material's numbers, see [`Material::numbers`](super::Material::numbers).
    pub numbers: [L::Real; NUMBERS],
    pub wavelengths: Wavelengths<'a, L, C>,
    /// A deliberate mistake, for builds that make it.
    pub planted: Option<Planted>,
}

impl<L: Lanes, const C: usize> Interface<'_, L, C> {
    /// The values of spectra at lane i's wavelengths; `rows` are those of [`Wavelengths::rows`].
    #[inline(always)]
    pub fn values(&self, i: usize, rows: &[u32; WIDEST]) -> &[L::Scalar; C] {
        &self.wavelengths.bank[rows[i % WIDEST] as usize]
    }

    /// The bank's rows that hold the refractive index of a medium at each lane's wavelengths; `None` for
    /// the vacuum.
    #[inline(always)]
    pub fn index_rows(&self, l: L, medium: Medium<L>) -> Option<[u32; WIDEST]> {
        match medium {
            Medium::Vacuum => None,
            Medium::Index([n, _]) => Some(self.wavelengths.rows(l, n)),
        }
    }

    /// The refractive index of a medium at lane i's wavelengths; `rows` are those of
    /// [`Self::index_rows`].
    #[inline(always)]
    pub fn index(&self, i: usize, rows: &Option<[u32; WIDEST]>) -> [L::Scalar; C] {
        match rows {
            None => [L::Scalar::from_f64(1.0); C],
            Some(rows) => self.wavelengths.between_nodes(i, rows[i]),
        }
    }

    /// The cosine of incidence, and the direction of mirror reflection.
    #[inline(always)]
    pub fn mirrored(&self, l: L, wo: Vec3<L::Real>) -> (L::Real, Vec3<L::Real>) {
        let cosine = wo.dot(self.shading).max(l.real(0.0)).min(l.real(1.0));
        let mirrored = (-wo).along(self.shading, cosine + cosine);
        (cosine, mirrored)
    }
}

/// Random numbers of an event, in [0, 1).
#[derive(Clone, Copy)]
pub struct Variates<L: Lanes> {
    /// Which of the things that a surface may do.
    pub choice: L::Real,
    pub direction: [L::Real; 2],
}

/// What light does at a surface. Densities are in solid angle, sr⁻¹, of the whole part that is not
/// delta; of a delta event, they are the probabilities of its choice.
#[derive(Clone, Copy)]
pub struct Event<L: Lanes> {
    /// wi: unit direction in which the path goes on.
    pub direction: Vec3<L::Real>,
    /// Density with which wi was chosen.
    pub pdf: L::Real,
    /// Density with which wo would be chosen by a path that comes from wi.
    pub reverse: L::Real,
    /// The direction was the only one possible.
    pub delta: L::Mask,
    /// wi is on the other side than wo.
    pub transmitted: L::Mask,
    /// All wavelengths but the hero end.
    pub ends: L::Mask,
}

impl<L: Lanes> Event<L> {
    /// A delta event on the side of wo that has no alternative.
    #[inline(always)]
    pub fn reflection(l: L, direction: Vec3<L::Real>) -> Self {
        let one = l.real(1.0);
        Self {
            direction,
            pdf: one,
            reverse: one,
            delta: l.mask(true),
            transmitted: l.mask(false),
            ends: l.mask(false),
        }
    }
}

/// Densities of a direction, sr⁻¹, as in [`Event`].
#[derive(Clone, Copy)]
pub struct Densities<L: Lanes> {
    /// With which wi is chosen.
    pub pdf: L::Real,
    /// With which wo would be chosen by a path that comes from wi.
    pub reverse: L::Real,
}

/// One Newton step towards length 1: keeps mirrored and refracted directions unit however many
/// there are.
#[inline(always)]
pub fn unit_again<L: Lanes>(l: L, direction: Vec3<L::Real>) -> Vec3<L::Real> {
    let correction = direction
        .length_squared()
        .mul_add(l.real(-0.5), l.real(1.5));
    direction.scale(correction)
}
