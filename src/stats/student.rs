//! Student's t distribution (Student 1908) and, for infinitely many degrees of freedom, the normal.

use statrs::distribution::{Continuous, ContinuousCDF, Normal, StudentsT};

/// P(T ≤ t) for `freedom` degrees of freedom, more than 0 and possibly infinite; NaN otherwise.
#[must_use]
pub fn cumulative(t: f64, freedom: f64) -> f64 {
    if freedom.is_infinite() {
        return Normal::standard().cdf(t);
    }
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |student| student.cdf(t))
}

/// P(|T| > |t|).
#[must_use]
pub fn two_sided(t: f64, freedom: f64) -> f64 {
    2.0 * cumulative(-t.abs(), freedom)
}

/// The t that |T| exceeds with probability `level` in (0, 1).
///
/// Newton's method on the logarithm of the tail, from the normal quantile: the tail is log-concave
/// in log t, so that steps from below stay below, and a handful of steps gives all digits.
#[must_use]
pub fn critical(level: f64, freedom: f64) -> f64 {
    let mut t = -Normal::standard().inverse_cdf(level / 2.0);
    let Ok(student) = StudentsT::new(0.0, 1.0, freedom) else {
        return if freedom.is_infinite() { t } else { f64::NAN };
    };
    const STEPS: usize = 60;
    for _ in 0..STEPS {
        let tail = 2.0 * student.cdf(-t);
        // d ln(tail)/d ln(t) = −2 t pdf(t)/tail
        let slope = -2.0 * t * student.pdf(t) / tail;
        let step = libm::log(level / tail) / slope;
        let next = t * libm::exp(step);
        if (next - t).abs() <= 4.0 * f64::EPSILON * t {
            break;
        }
        t = next;
    }
    t
}
