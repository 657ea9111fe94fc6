//! Fresnel reflectances against published formulas, over both kinds of interface and to the edges.

use etalon::inside::light::{DirectionalLight, LightShape, PointLight};
use etalon::inside::material::fresnel::{conductor, dielectric_reflectance};
use etalon_doors::functions::dielectric;
use serde_json::Value;

use crate::lanes_support::{PRECISIONS, Precision, everywhere};
use crate::truth_file::{list, number, truth};

/// Reflectance of one value in a precision.
fn scalar(precision: Precision, cosine: f64, eta: f64) -> f64 {
    match precision {
        Precision::Single => dielectric_reflectance(cosine as f32, eta as f32).into(),
        Precision::Double => dielectric_reflectance(cosine, eta),
    }
}

fn metal(precision: Precision, cosine: f64, n: f64, k: f64) -> f64 {
    match precision {
        Precision::Single => conductor(cosine as f32, n as f32, k as f32).into(),
        Precision::Double => conductor(cosine, n, k),
    }
}

#[test]
fn dielectrics_match_the_table() {
    let truth = truth("fresnel_dielectric");
    for precision in PRECISIONS {
        for index in truth.rows("per_index") {
            let n = number(&index["n"]);
            let rows = list(&index["rows"]);
            let cosine = |row: &Value| libm::cos(number(&row["theta_deg"]).to_radians());
            let cosines: Vec<f64> = rows.iter().map(cosine).collect();
            let etas = vec![n; cosines.len()];
            let [transmitted, reflectance] =
                everywhere(|set| dielectric(set, precision, [&cosines, &etas]));
            for (i, row) in rows.iter().enumerate() {
                let (found, want) = (reflectance[i], number(&row["R"]));
                // Rounding cos θ and η, enlarged by |dR/dcos θ| ≤ 10 (steepest at 41°, just below
                // total reflection).
                let allowed = 40.0 * precision.roundoff();
                assert!((found - want).abs() < allowed, "{row}: {found}");
                let single = scalar(precision, cosines[i], n);
                assert!((single - want).abs() < allowed);
                let sine = 1.0 - cosines[i] * cosines[i];
                let expect = (1.0 - sine / (n * n)).max(0.0).sqrt();
                assert!((transmitted[i] - expect).abs() < allowed);
                // Planted: an index one per cent off shows, except under total reflection.
                if want < 1.0 {
                    let wrong = scalar(precision, cosines[i], 1.01 * n);
                    assert!((wrong - want).abs() > allowed);
                }
            }
            // Diffuse average 2 ∫ R c dc, by the midpoint rule in θ, where the root at the
            // critical angle costs steps^(−3/2).
            let steps = 200_000;
            let step = std::f64::consts::FRAC_PI_2 / f64::from(steps);
            let part = |i: i32| {
                let (sine, cosine) = libm::sincos((f64::from(i) + 0.5) * step);
                2.0 * scalar(Precision::Double, cosine, n) * cosine * sine * step
            };
            let average: f64 = (0..steps).map(part).sum();
            let want = number(&index["F_diffuse"]);
            assert!((average - want).abs() < 1e-6, "{average} {want}");
        }
    }
}

#[test]
fn dielectrics_are_sane_at_the_edges() {
    let (mut cosines, mut etas) = (Vec::new(), Vec::new());
    let from_glass = 1.0 / 1.5;
    for eta in [
        1e-3, 0.5, from_glass, 0.999_999, 1.0, 1.000_001, 1.5, 2.4, 1e3,
    ] {
        cosines.extend((0..=400).map(|i| f64::from(i) / 400.0));
        cosines.extend((1..60).map(|k| libm::exp2(-f64::from(k))));
        etas.resize(cosines.len(), eta);
    }
    for precision in PRECISIONS {
        let [transmitted, reflectance] =
            everywhere(|set| dielectric(set, precision, [&cosines, &etas]));
        for i in 0..cosines.len() {
            let (c, eta) = (precision.rounded(cosines[i]), precision.rounded(etas[i]));
            let (t, r) = (transmitted[i], reflectance[i]);
            // η² − sin² is a difference from η² − 1 when η is small.
            let slack = 8.0 * precision.roundoff() * (1.0 + 1.0 / (eta * eta));
            let within = |x: f64| (0.0..=1.0 + slack).contains(&x);
            assert!(within(t) && within(r), "{c} {eta}: {t} {r}");
            // Grazing light is reflected whole, except by nothing.
            if c == 0.0 {
                assert!((r - 1.0).abs() < 1e-6, "{eta}: {r}");
            } else if eta == 1.0 {
                assert!(r < 8.0 * precision.roundoff(), "{c}: {r}");
                assert!((t / c - 1.0).abs() < 8.0 * precision.roundoff());
            }
            // The scalar form decides total reflection alike, which the loop relies on.
            let whole = scalar(precision, c, eta) == 1.0;
            assert!(whole || t != 0.0, "{c} {eta}");
            if c == 1.0 {
                let normal = (eta - 1.0) / (eta + 1.0);
                assert!((r - normal * normal).abs() < slack, "{eta}: {r}");
            }
            // Reversing the ray: the same reflectance, away from where R is steep: rounding t by u
            // moves the other cosine by t/(η² c) u ≤ 40 u there.
            if t > 0.1 && c > 0.1 && (0.5..=2.5).contains(&eta) {
                let back = scalar(Precision::Double, t, 1.0 / eta);
                let off = (back - r).abs() / precision.roundoff();
                assert!(off < 500.0, "{c} {eta}: {back} {r}");
            }
        }
    }
}

#[test]
fn conductors_match_the_table() {
    let truth = truth("fresnel_conductor");
    for precision in PRECISIONS {
        for row in truth.rows("rows") {
            let (n, k) = (number(&row["n"]), number(&row["k"]));
            let cosine = libm::cos(number(&row["theta_deg"]).to_radians());
            let got = metal(precision, cosine, n, k);
            let error = (got - number(&row["R"])).abs();
            assert!(error < 16.0 * precision.roundoff(), "{row}: {error:e}");
            let wrong = metal(precision, cosine, 1.01 * n, k);
            assert!((wrong - number(&row["R"])).abs() > 16.0 * precision.roundoff());
        }
        for n in [1e-3, 0.05, 1.0, 1.5, 8.0] {
            for k in [0.0, 1e-6, 0.1, 3.0, 30.0] {
                for i in 0..=200 {
                    let cosine = f64::from(i) / 200.0;
                    let r = metal(precision, cosine, n, k);
                    let slack = 8.0 * precision.roundoff();
                    // Nothing at all in the way of grazing light: n = 1, k = 0 has 0/0 there.
                    let nothing = (n, k, i) == (1.0, 0.0, 0);
                    let within = (-slack..=1.0 + slack).contains(&r);
                    assert!(nothing || within, "{n} {k} {cosine}: {r}");
                    if i == 0 && !nothing {
                        assert!((r - 1.0).abs() < 1e-5);
                    }
                    // Without absorption a conductor is a dielectric.
                    if k == 0.0 && n >= 1.0 && i > 0 {
                        let off = (r - scalar(precision, cosine, n)).abs();
                        assert!(off < 200.0 * precision.roundoff(), "{n} {cosine}");
                    }
                }
            }
        }
    }
}

/// Lights that scattered rays cannot hit need no weight; surfaces do.
#[test]
fn only_lights_with_extent_are_weighted() {
    assert!(!LightShape::Point(PointLight([0.0f32; 3])).has_extent());
    assert!(!LightShape::Directional(DirectionalLight([0.0f64, 0.0, 1.0])).has_extent());
}
