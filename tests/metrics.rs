//! The error metrics on pixels few enough to work out by hand.

use etalon::inside::stats::metrics::{
    Metric, mean_error, mean_over_channels, mse, relative_mean_error, relmse, rmse, smape,
};

const X: [f64; 4] = [1.0, 2.0, 3.0, 2.0];
const R: [f64; 4] = [1.0, 1.0, 4.0, 2.0];

/// A few roundings.
#[track_caller]
fn close(found: f64, expected: f64) {
    let tolerance = 8.0 * f64::EPSILON * expected.abs().max(1.0);
    let off = (found - expected).abs();
    assert!(off <= tolerance, "{found} instead of {expected}");
}

#[test]
fn errors_of_four_pixels() {
    // Errors 0, 1, −1, 0; squares 0, 1, 1, 0 with the unbiased variance 1/3.
    for (found, value, square) in [
        (mean_error(&X, &R), 0.0, 2.0 / 3.0 / 4.0),
        (mse(&X, &R), 0.5, 1.0 / 3.0 / 4.0),
        (rmse(&X, &R), 0.5f64.sqrt(), 1.0 / 12.0 / (4.0 * 0.5)),
    ] {
        close(found.value, value);
        close(found.standard_error, f64::sqrt(square));
    }
    // mean(r) = 2, ε = 4e-4 and 2e-2.
    let expected = (1.0 / 1.0004 + 1.0 / 16.0004) / 4.0;
    close(relmse(&X, &R, None).value, expected);
    close(smape(&X, &R).value, (2.0 / 3.02 + 2.0 / 7.02) / 4.0);
}

#[test]
fn the_mean_error_has_a_sign_and_a_scale() {
    let doubled: Vec<f64> = R.iter().map(|r| 2.0 * r).collect();
    close(mean_error(&doubled, &R).value, 2.0);
    close(relative_mean_error(&doubled, &R).value, 1.0);
    close(relative_mean_error(&R, &doubled).value, -0.5);
}

/// The reference's own variance is what it adds to the square on average.
#[test]
fn a_reference_variance_is_taken_off() {
    let variance = [0.0, 1.0, 0.0, 0.0];
    let with = relmse(&X, &R, Some(&variance)).value;
    close(with, 1.0 / 16.0004 / 4.0);
}

/// Relative metrics do not depend on the unit of radiance.
#[test]
fn relative_metrics_have_no_unit() {
    // A power of two scales without rounding.
    let scale = |values: &[f64]| values.iter().map(|v| 1024.0 * v).collect::<Vec<_>>();
    let (x, r) = (scale(&X), scale(&R));
    assert_eq!(relmse(&x, &r, None), relmse(&X, &R, None));
    assert_eq!(smape(&x, &r), smape(&X, &R));
    close(rmse(&x, &r).value, 1024.0 * rmse(&X, &R).value);
}

#[test]
fn channels_are_averaged() {
    let channel = |value, standard_error| Metric {
        value,
        standard_error,
    };
    let mean = mean_over_channels(&[channel(1.0, 0.5), channel(3.0, 1.5)]);
    assert_eq!(mean, channel(2.0, 1.0));
}
