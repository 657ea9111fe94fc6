//! What the eye resolves: contrast sensitivity, edges and points. All filters are separable, and
//! beyond the border the picture goes on as its outermost pixels.

/// Terms a √(π/b) exp(−π² x²/b) of the contrast sensitivity of the achromatic, the red–green and the
/// blue–yellow channel, x in degrees.
const SENSITIVITY: [&[(f64, f64)]; 3] = [
    &[(1.0, 0.0047)],
    &[(1.0, 0.0053)],
    &[(34.1, 0.04), (13.5, 0.025)],
];
/// The widest term, which all kernels are cut off by.
const WIDEST: f64 = 0.04;
/// Width of what is detected as an edge or point, degrees.
const FEATURE: f64 = 0.082;

/// Kernels of one resolution.
pub struct Filters {
    /// By channel: terms of 1D kernels, with the weight of their product.
    contrast: [Vec<(f64, Vec<f64>)>; 3],
    gaussian: Vec<f64>,
    first_derivative: Vec<f64>,
    second_derivative: Vec<f64>,
}

impl Filters {
    pub fn new(pixels_per_degree: f64) -> Self {
        let pi = std::f64::consts::PI;
        let radius = (3.0 * (WIDEST / (2.0 * pi * pi)).sqrt() * pixels_per_degree).ceil();
        let contrast = SENSITIVITY.map(|terms| {
            let mut kernels: Vec<(f64, Vec<f64>)> = terms
                .iter()
                .map(|&(a, b)| {
                    let value = |x: f64| {
                        let degrees = x / pixels_per_degree;
                        libm::exp(-pi * pi * degrees * degrees / b)
                    };
                    (a * (pi / b).sqrt(), sampled(radius, value))
                })
                .collect();
            let sums = kernels.iter();
            let sums = sums.map(|(weight, kernel)| weight * kernel.iter().sum::<f64>().powi(2));
            let total: f64 = sums.sum();
            for (weight, _) in &mut kernels {
                *weight /= total;
            }
            kernels
        });
        let deviation = 0.5 * FEATURE * pixels_per_degree;
        let radius = (3.0 * deviation).ceil();
        let bell = |x: f64| libm::exp(-x * x / (2.0 * deviation * deviation));
        Self {
            contrast,
            gaussian: balanced(sampled(radius, bell)),
            first_derivative: balanced(sampled(radius, |x| -x * bell(x))),
            second_derivative: balanced(sampled(radius, |x| {
                (x * x / (deviation * deviation) - 1.0) * bell(x)
            })),
        }
    }

    /// A channel of a picture as the eye resolves it, `width` pixels a row.
    pub fn contrast(&self, values: &[f64], width: usize, channel: usize) -> Vec<f64> {
        let mut sum = vec![0.0; values.len()];
        for (weight, kernel) in &self.contrast[channel] {
            for (sum, value) in sum.iter_mut().zip(filtered(values, width, kernel, kernel)) {
                *sum += weight * value;
            }
        }
        sum
    }

    /// Strength of edges and of points: lengths of the gradient and of the second derivatives along
    /// x and y.
    pub fn features(&self, grey: &[f64], width: usize) -> Vec<[f64; 2]> {
        let length = |kernel: &[f64]| {
            let across = filtered(grey, width, kernel, &self.gaussian);
            let down = filtered(grey, width, &self.gaussian, kernel);
            across.into_iter().zip(down).map(|(a, b)| a.hypot(b))
        };
        let edges = length(&self.first_derivative);
        let points = length(&self.second_derivative);
        edges
            .zip(points)
            .map(|(edge, point)| [edge, point])
            .collect()
    }
}

/// Filters along the rows by one kernel and along the columns by another.
fn filtered(values: &[f64], width: usize, along: &[f64], down: &[f64]) -> Vec<f64> {
    let height = values.len() / width;
    let pass = |values: &[f64], kernel: &[f64], step: [usize; 2]| -> Vec<f64> {
        let radius = kernel.len() as isize / 2;
        let at = |x: usize, y: usize, offset: isize| {
            let moved = |at: usize, step: usize, size: usize| {
                (at as isize + offset * step as isize).clamp(0, size as isize - 1) as usize
            };
            values[moved(y, step[1], height) * width + moved(x, step[0], width)]
        };
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        pixels
            .map(|(x, y)| {
                let terms = kernel.iter().zip(-radius..);
                terms.map(|(k, offset)| k * at(x, y, offset)).sum()
            })
            .collect()
    };
    pass(&pass(values, along, [1, 0]), down, [0, 1])
}

/// Values at −radius, …, radius.
fn sampled(radius: f64, value: impl Fn(f64) -> f64) -> Vec<f64> {
    let radius = radius as i32;
    (-radius..=radius).map(|x| value(f64::from(x))).collect()
}

/// Positive weights that sum to 1, and negative ones that sum to −1.
fn balanced(kernel: Vec<f64>) -> Vec<f64> {
    let positive: f64 = kernel.iter().filter(|k| **k > 0.0).sum();
    let negative: f64 = kernel.iter().filter(|k| **k < 0.0).sum();
    let scaled = |k: f64| if k > 0.0 { k / positive } else { -k / negative };
    kernel
        .into_iter()
        .map(|k| if k == 0.0 { 0.0 } else { scaled(k) })
        .collect()
}
