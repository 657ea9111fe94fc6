//! Densities of wavelengths on 360–830 nm with their inverses: that of the renderer, and others to
//! compare it with.
//!
//! A hero set of C wavelengths comes from one random number u: wavelength j uses frac(u + j/C)
//! (Wilkie et al. 2014, Hero Wavelength Spectral Sampling). Every wavelength of the set then has
//! the same density, and the mean over the set of f(λⱼ)/p(λⱼ) estimates ∫ f dλ.

use etalon::inside::spectrum::grid::visible_wavelength;
use etalon::inside::spectrum::observer::{Y_INTEGRAL, spectrum_to_xyz, xyz_bar};
use etalon::inside::spectrum::{NM_MAX, NM_MIN, Spectrum};

/// A density of wavelengths on 360–830 nm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WavelengthPdf {
    /// p = A/cosh²(a (λ − 538 nm)), a = 0.0072 nm⁻¹ (Radziszewski, Boryczko and Alda 2009, with the
    /// parameters of pbrt-v4 and Mitsuba 3). A = a/(tanh(292 a) + tanh(178 a)).
    Visible,
    /// p = 1/470 nm⁻¹.
    Uniform,
}

/// a, nm⁻¹.
const STEEPNESS: f64 = 0.0072;
/// Wavelength of the density's peak, nm.
const PEAK: f64 = 538.0;

impl WavelengthPdf {
    /// The wavelength in nm at `u` in 0…1: the inverse of the cumulative distribution.
    pub fn sample(self, u: f64) -> f64 {
        let nm = match self {
            Self::Visible => visible_wavelength(u),
            Self::Uniform => NM_MIN + u * (NM_MAX - NM_MIN),
        };
        nm.clamp(NM_MIN, NM_MAX)
    }

    /// The density at `nm`, nm⁻¹; zero outside 360–830 nm.
    pub fn pdf(self, nm: f64) -> f64 {
        if !(NM_MIN..=NM_MAX).contains(&nm) {
            return 0.0;
        }
        match self {
            Self::Visible => {
                let span = libm::tanh(STEEPNESS * (NM_MAX - PEAK))
                    + libm::tanh(STEEPNESS * (PEAK - NM_MIN));
                let cosh = libm::cosh(STEEPNESS * (nm - PEAK));
                STEEPNESS / (span * cosh * cosh)
            }
            Self::Uniform => 1.0 / (NM_MAX - NM_MIN),
        }
    }

    /// The C wavelengths that one `u` in [0, 1) gives, nm; the first is the hero.
    pub fn sample_set<const C: usize>(self, u: f64) -> [f64; C] {
        std::array::from_fn(|j| self.sample(rotated(u, j, C)))
    }
}

/// frac(u + j/count).
fn rotated(u: f64, j: usize, count: usize) -> f64 {
    let sum = u + j as f64 / count as f64;
    if sum >= 1.0 { sum - 1.0 } else { sum }
}

/// Relative variance, per path, of the estimates of X, Y and Z of the equal-energy spectrum from
/// hero sets of `count` ≥ 1 wavelengths: Var(mean of x̄(λⱼ)/p(λⱼ)) / (∫ x̄ dλ)².
///
/// The estimate has the period 1/count in u; its variance is the mean over one period, taken
/// at the midpoints of 2¹⁸/count parts, good to about 6 digits.
///
/// # Panics
/// If `count` is 0 or above 2¹⁸.
pub fn hero_relative_variance(pdf: WavelengthPdf, count: usize) -> [f64; 3] {
    let steps = (1 << 18) / count;
    assert!(steps > 0, "a set of {count} wavelengths is too large");
    let integral = spectrum_to_xyz(&Spectrum::Constant(1.0)).map(|x| x * Y_INTEGRAL);
    let mut sum = [0.0; 3];
    for step in 0..steps {
        let u = (step as f64 + 0.5) / (steps * count) as f64;
        let mut estimate = [0.0; 3];
        for j in 0..count {
            let nm = pdf.sample(rotated(u, j, count));
            let weight = 1.0 / (pdf.pdf(nm) * count as f64);
            for (total, bar) in estimate.iter_mut().zip(xyz_bar(nm)) {
                *total += bar * weight;
            }
        }
        for i in 0..3 {
            let deviation = estimate[i] / integral[i] - 1.0;
            sum[i] += deviation * deviation;
        }
    }
    sum.map(|total| total / steps as f64)
}
