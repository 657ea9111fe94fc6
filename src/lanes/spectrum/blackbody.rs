//! Planck's law with the exact constants of the SI of 2019.

use super::{NM_MAX, NM_MIN};

/// Planck constant h, J·s (exact, SI 2019).
pub const PLANCK: f64 = 6.626_070_15e-34;
/// Speed of light in vacuum c, m·s⁻¹ (exact, SI 2019).
pub const LIGHT_SPEED: f64 = 299_792_458.0;
/// Boltzmann constant k, J·K⁻¹ (exact, SI 2019).
pub const BOLTZMANN: f64 = 1.380_649e-23;

/// The solution of x = 5 (1 − e⁻ˣ): hc/(λ k T) where radiance per wavelength peaks (Wien 1893).
const WIEN_X: f64 = 4.965_114_231_744_276;

/// Spectral radiance of a black body, W·m⁻²·sr⁻¹·nm⁻¹: 2hc²/λ⁵ / (exp(hc/(λkT)) − 1)
/// (Planck 1901), `kelvin` the temperature, `nm` the wavelength in vacuum. Zero at 0 K or below.
pub fn radiance(kelvin: f64, nm: f64) -> f64 {
    if kelvin <= 0.0 {
        return 0.0;
    }
    let metres = nm * 1e-9;
    let x = PLANCK * LIGHT_SPEED / (metres * BOLTZMANN * kelvin);
    let squared = metres * metres;
    let per_metre =
        2.0 * PLANCK * LIGHT_SPEED * LIGHT_SPEED / (squared * squared * metres * libm::expm1(x));
    per_metre * 1e-9
}

/// Bounds of the radiance over 360–830 nm: it rises to Wien's peak and falls after it.
pub fn range(kelvin: f64) -> [f64; 2] {
    if kelvin <= 0.0 {
        return [0.0; 2];
    }
    let peak_nm = PLANCK * LIGHT_SPEED / (WIEN_X * BOLTZMANN * kelvin) * 1e9;
    let (violet, red) = (radiance(kelvin, NM_MIN), radiance(kelvin, NM_MAX));
    let peak = radiance(kelvin, peak_nm.clamp(NM_MIN, NM_MAX));
    // `radiance` makes about 12 roundings, and those of x are magnified by x in the exponential.
    let x = PLANCK * LIGHT_SPEED / (NM_MIN * 1e-9 * BOLTZMANN * kelvin);
    let margin = (12.0 + 4.0 * x) * f64::EPSILON;
    [violet.min(red) * (1.0 - margin), peak * (1.0 + margin)]
}
