//! From radiance at a path's wavelengths to tristimulus values.

use super::pool::Results;
use crate::math::functions::ln;
use crate::math::lanes::{Lanes, Real};
use crate::spectrum::grid::{CELLS_PER_NM, SHORTEST, SpectrumBank};

/// Rate of the wavelength density 1/cosh²(a (λ − 538 nm)), nm⁻¹ (M. Radziszewski, K. Boryczko and
/// W. Alda 2009, in the form of pbrt-v4 section 4.5.4).
const RATE: f64 = 0.0072;
/// Wavelength of the density's maximum, nm.
const CENTRE: f64 = 538.0;

/// How hero wavelengths are drawn, and the observer that weighs them.
#[derive(Debug, Clone)]
pub struct Spectrometer<T> {
    /// x̄, ȳ, z̄ over ∫ȳ, as cell means.
    bank: SpectrumBank<T>,
    observer: [u32; 3],
    /// tanh(a (538 − 360)), and that plus tanh(a (830 − 538)).
    tanh_short: f64,
    tanh_span: f64,
}

impl<T: crate::math::lanes::Scalar> Spectrometer<T> {
    /// With the observer's cell means, each divided by the integral of ȳ.
    pub fn new(observer: [&[f64]; 3]) -> Self {
        let mut bank = SpectrumBank::new();
        let observer = observer.map(|values| bank.push(values));
        let tanh_short = libm::tanh(RATE * (CENTRE - SHORTEST));
        let tanh_long = libm::tanh(RATE * (crate::spectrum::grid::LONGEST - CENTRE));
        Self {
            bank,
            observer,
            tanh_short,
            tanh_span: tanh_short + tanh_long,
        }
    }

    /// Grid position and 1/pdf (nm) of wavelength j of C for a hero variate: the variate shifted
    /// by j/C and wrapped; λ = 538 − artanh(t)/a with t falling linearly, pdf ∝ 1 − t².
    #[inline(always)]
    pub fn wavelength<L: Lanes<Scalar = T>, const C: usize>(
        &self,
        l: L,
        hero: L::Real,
        j: usize,
    ) -> (L::Real, L::Real) {
        let one = l.real(1.0);
        let u = hero + l.real(j as f64 / C as f64);
        let u = l.select(u.ge(one), u - one, u);
        let t = u.mul_add(l.real(-self.tanh_span), l.real(self.tanh_short));
        let two_artanh = ln(l, (one + t) / (one - t));
        let from_shortest = two_artanh.mul_add(
            l.real(-0.5 * CELLS_PER_NM / RATE),
            l.real((CENTRE - SHORTEST) * CELLS_PER_NM),
        );
        let position = from_shortest
            .max(l.real(0.0))
            .min(l.real(crate::spectrum::grid::CELLS as f64));
        let inverse_pdf = l.real(self.tanh_span / RATE) / ((one - t) * (one + t));
        (position, inverse_pdf)
    }

    /// X, Y, Z of the samples in slots `at ..`: Σⱼ Lⱼ x̄(λⱼ)/(C pdf(λⱼ)) / ∫ȳ.
    #[inline(never)]
    pub fn tristimulus<L: Lanes<Scalar = T>, const C: usize>(
        &self,
        l: L,
        results: &Results<T, C>,
        at: usize,
    ) -> [L::Real; 3] {
        l.vectorize(
            #[inline(always)]
            || {
                let hero = l.load(&results.hero[at..]);
                let mut sum = [l.real(0.0); 3];
                for j in 0..C {
                    let (position, inverse_pdf) = self.wavelength::<L, C>(l, hero, j);
                    let radiance = l.load(&results.radiance[j * results.capacity + at..]);
                    let weighted = radiance * inverse_pdf * l.real(1.0 / C as f64);
                    for (sum, observer) in sum.iter_mut().zip(self.observer) {
                        let value = self.bank.mean(l, l.int(observer), position);
                        *sum = weighted.mul_add(value, *sum);
                    }
                }
                sum
            },
        )
    }

    /// Y of one path, in f64.
    pub fn luminance<const C: usize>(&self, radiance: [T; C], positions: [T; C]) -> f64 {
        let mut sum = 0.0;
        for (radiance, position) in radiance.into_iter().zip(positions) {
            let position = position.to_f64();
            let nm = SHORTEST + position / CELLS_PER_NM;
            let t = libm::tanh(RATE * (nm - CENTRE));
            let inverse_pdf = self.tanh_span / (RATE * (1.0 - t * t));
            let observer = self.bank.at(self.observer[1], position as usize).to_f64();
            sum += radiance.to_f64() * observer * inverse_pdf / C as f64;
        }
        sum
    }
}
