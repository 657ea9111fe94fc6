//! Smooth spectra for linear sRGB colours.
//!
//! The model is that of W. Jakob and J. Hanika, A low-dimensional function space for efficient
//! spectral upsampling, Computer Graphics Forum 38(2), 2019, eq. 5 and 6: S(z) = ½ + z/(2√(1 + z²))
//! of z = c₀ + c₁ t + c₂ t². It lies within 0…1 for every c. The three coefficients are fitted for
//! the one colour when the scene is loaded, by Levenberg's and Marquardt's method, with the
//! observer and the D65 of this crate.
//!
//! **What white means.** A reflectance has the colour (r, g, b) if under D65 its linear sRGB is
//! (r, g, b) times that of a reflectance of 1. So (1, 1, 1) is the constant reflectance 1 and
//! (c, c, c) the constant c, and the scene must be lit by D65 to look as specified. (The divisor
//! is (1, 1, 1) up to 6e-4: the standard's matrix is rounded.) The film adapts to no white:
//! under the equal-energy illuminant E a white surface has linear sRGB (1.2049, 0.9483, 0.9090).
//!
//! An emission has the colour (r, g, b) if its linear sRGB *is* (r, g, b): it is D65 of
//! luminance 1 times a scale times such a sigmoid.

use std::sync::LazyLock;

use glam::{DMat3, DVec3};
use thiserror::Error;

use super::observer::{self, Y_INTEGRAL};
use super::{NM_MAX, NM_MIN, Spectrum, illuminant};

/// Why a colour has no spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum RgbError {
    /// A reflectance outside 0…1 would not conserve energy.
    #[error("a reflectance's RGB components lie within 0…1, but one is {0}")]
    Reflectance(f64),
    /// An emission below zero or without bound.
    #[error("an emission's RGB components are finite and not negative, but one is {0}")]
    Emission(f64),
}

/// A fitted spectrum and what the fit left over.
#[derive(Debug, Clone, PartialEq)]
pub struct RgbFit {
    pub spectrum: Spectrum,
    /// The largest absolute difference between a component of its colour and the one asked for.
    pub residual: f64,
}

/// The smooth reflectance whose linear sRGB under D65 is `rgb`, relative to a reflectance of 1.
///
/// # Errors
/// If a component is not a number in 0…1.
pub fn fit_reflectance(rgb: [f64; 3]) -> Result<RgbFit, RgbError> {
    if let Some(&bad) = rgb.iter().find(|c| !(0.0..=1.0).contains(*c)) {
        return Err(RgbError::Reflectance(bad));
    }
    if rgb[0] == rgb[1] && rgb[1] == rgb[2] {
        return Ok(RgbFit {
            spectrum: Spectrum::Constant(rgb[0]),
            residual: 0.0,
        });
    }
    let (coefficients, residual) = fit(rgb.into(), DVec3::ONE / quadrature().white);
    Ok(RgbFit {
        spectrum: Spectrum::Sigmoid {
            coefficients,
            scale: 1.0,
            d65: false,
        },
        residual,
    })
}

/// The smooth emission, relative to D65, whose linear sRGB is `rgb`.
///
/// # Errors
/// If a component is negative or not finite.
pub fn fit_emission(rgb: [f64; 3]) -> Result<RgbFit, RgbError> {
    if let Some(&bad) = rgb.iter().find(|c| !(c.is_finite() && **c >= 0.0)) {
        return Err(RgbError::Emission(bad));
    }
    let largest = DVec3::from(rgb).max_element();
    if largest == 0.0 {
        return Ok(RgbFit {
            spectrum: Spectrum::Constant(0.0),
            residual: 0.0,
        });
    }
    // Twice the largest component, so that the sigmoid works about ½, where it is steepest.
    let scale = 2.0 * largest;
    let (coefficients, residual) = fit(DVec3::from(rgb) / scale, DVec3::ONE);
    Ok(RgbFit {
        spectrum: Spectrum::Sigmoid {
            coefficients,
            scale,
            d65: true,
        },
        residual: residual * scale,
    })
}

/// t of the polynomial: −1 at 360 nm, 1 at 830 nm.
fn centred(nm: f64) -> f64 {
    (nm - 0.5 * (NM_MIN + NM_MAX)) / (0.5 * (NM_MAX - NM_MIN))
}

fn polynomial([c0, c1, c2]: &[f64; 3], t: f64) -> f64 {
    c0 + t * (c1 + t * c2)
}

/// ½ + z/(2√(1 + z²)); never outside 0…1, because √(z²) rounds to |z|.
fn squash(z: f64) -> f64 {
    0.5 + 0.5 * (z / (1.0 + z * z).sqrt())
}

/// The sigmoid of the polynomial at wavelength `nm`.
pub fn sigmoid(coefficients: &[f64; 3], nm: f64) -> f64 {
    squash(polynomial(coefficients, centred(nm)))
}

/// Bounds of the sigmoid over 360–830 nm: its values at both ends and at the vertex.
pub fn sigmoid_range(coefficients: &[f64; 3]) -> [f64; 2] {
    let [c0, c1, c2] = *coefficients;
    let vertex = -c1 / (2.0 * c2);
    let candidates = [-1.0, 1.0, if vertex.abs() < 1.0 { vertex } else { 1.0 }];
    let values = candidates.map(|t| squash(polynomial(coefficients, t)));
    // Rounding of t and of the polynomial is below 8 ε Σ|c|, and the sigmoid's slope is at most ½.
    let margin = 4.0 * f64::EPSILON * (1.0 + c0.abs() + c1.abs() + c2.abs());
    let low = values.iter().copied().fold(1.0, f64::min);
    let high = values.iter().copied().fold(0.0, f64::max);
    [(low - margin).max(0.0), (high + margin).min(1.0)]
}

/// Nodes and weights that take a reflectance to linear sRGB under D65 of luminance 1.
struct Quadrature {
    nodes: Vec<(f64, DVec3)>,
    white: DVec3,
}

fn quadrature() -> &'static Quadrature {
    static QUADRATURE: LazyLock<Quadrature> = LazyLock::new(|| {
        let half = 0.5;
        let offset = half / 3.0_f64.sqrt();
        let nodes: Vec<(f64, DVec3)> = (NM_MIN as u32..NM_MAX as u32)
            .flat_map(|nm| {
                let middle = f64::from(nm) + half;
                [middle - offset, middle + offset]
            })
            .map(|nm| {
                let weight = half * illuminant::d65().value(nm) / Y_INTEGRAL;
                let rgb = observer::xyz_to_linear_srgb(observer::xyz_bar(nm));
                (centred(nm), weight * DVec3::from(rgb))
            })
            .collect();
        let white = nodes.iter().map(|&(_, weight)| weight).sum();
        Quadrature { nodes, white }
    });
    &QUADRATURE
}

/// Colour of the sigmoid times `gain`, minus `target`, and its derivative by the coefficients.
fn residual(c: DVec3, gain: DVec3, target: DVec3) -> (DVec3, DMat3) {
    let mut colour = DVec3::ZERO;
    let mut jacobian = DMat3::ZERO;
    for &(t, weight) in &quadrature().nodes {
        let z = polynomial(&c.to_array(), t);
        let slope = 0.5 / ((1.0 + z * z) * (1.0 + z * z).sqrt());
        colour += squash(z) * weight;
        let column = slope * weight;
        jacobian.x_axis += column;
        jacobian.y_axis += t * column;
        jacobian.z_axis += t * t * column;
    }
    let scale = DMat3::from_diagonal(gain);
    (colour * gain - target, scale * jacobian)
}

/// Coefficients for the colour `target`, and the largest component of the error.
///
/// Levenberg (1944) and Marquardt (1963), from the grey of the same mean, along the straight
/// line to the target: each stage starts where the last one ended, so that the fit stays on the
/// branch of broad spectra.
fn fit(target: DVec3, gain: DVec3) -> ([f64; 3], f64) {
    const STAGES: u32 = 8;
    let grey = (target.element_sum() / 3.0).clamp(0.01, 0.99);
    let mut c = DVec3::new((grey - 0.5) / (grey * (1.0 - grey)).sqrt(), 0.0, 0.0);
    let mut error = f64::INFINITY;
    for stage in 1..=STAGES {
        let aim = DVec3::splat(grey).lerp(target, f64::from(stage) / f64::from(STAGES));
        (c, error) = levenberg_marquardt(c, gain, aim);
    }
    (c.to_array(), error)
}

fn levenberg_marquardt(start: DVec3, gain: DVec3, target: DVec3) -> (DVec3, f64) {
    const STEPS: usize = 100;
    // Sums of 940 terms below 1 carry rounding of this size.
    const ENOUGH: f64 = 1e-13;
    let mut c = start;
    let (mut r, mut jacobian) = residual(c, gain, target);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        if r.abs().max_element() <= ENOUGH {
            break;
        }
        let normal = jacobian.transpose() * jacobian;
        let diagonal = DVec3::new(normal.x_axis.x, normal.y_axis.y, normal.z_axis.z);
        let damped = normal + DMat3::from_diagonal(damping * diagonal);
        let next = c - damped.inverse() * (jacobian.transpose() * r);
        let (next_r, next_jacobian) = residual(next, gain, target);
        if next.is_finite() && next_r.length_squared() < r.length_squared() {
            (c, r, jacobian) = (next, next_r, next_jacobian);
            damping *= 0.1;
        } else {
            damping = (damping * 10.0).max(1e-12);
        }
    }
    (c, r.abs().max_element())
}
