//! Spectra against published points and closed forms.

use std::path::Path;

use etalon::inside::spectrum::cells::means;
use etalon::inside::spectrum::ior::{
    RefractiveIndex, glass_names, metal_names, named_glass, named_metal,
};
use etalon::inside::spectrum::observer::{
    XYZ_TO_LINEAR_SRGB, Y_INTEGRAL, spectrum_to_xyz, xyz_bar, xyz_to_linear_srgb,
};
use etalon::inside::spectrum::rgb::{fit_emission, fit_reflectance};
use etalon::inside::spectrum::{NM_MAX, NM_MIN, RgbError, Spectrum, Table, TableError, illuminant};

use crate::truth_file::{number, numbers, truth};

use crate::wavelength_pdfs::{WavelengthPdf, hero_relative_variance};

/// Luminous efficacy that belongs to ȳ, lm/W (CIE 018:2019: 683 lm/W at 540 THz, in air 555.017 nm).
const LUMINOUS_EFFICACY: f64 = 683.002;

/// Chromaticities x, y of the red, green and blue primary and the white of Rec. ITU-R BT.709-6.
const REC_709: [[f64; 2]; 4] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], [0.3127, 0.3290]];

/// Fraunhofer lines d, F and C in nm.
const LINE_D: f64 = 587.5618;
const LINE_F: f64 = 486.1327;
const LINE_C: f64 = 656.2725;

#[track_caller]
fn assert_relative(got: f64, want: f64, tolerance: f64) {
    let error = (got - want).abs() / want.abs().max(f64::MIN_POSITIVE);
    assert!(error <= tolerance, "{got} is not {want}: off by {error:e}");
}

#[track_caller]
fn assert_absolute(got: f64, want: f64, tolerance: f64) {
    let error = (got - want).abs();
    assert!(error <= tolerance, "{got} is not {want}: off by {error:e}");
}

fn whole_nm() -> impl Iterator<Item = f64> {
    (NM_MIN as u32..=NM_MAX as u32).map(f64::from)
}

/// The 1 nm trapezoid sum, which the truths integrate by.
fn trapezoid(f: impl Fn(f64) -> [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for nm in whole_nm() {
        let weight = if nm == NM_MIN || nm == NM_MAX {
            0.5
        } else {
            1.0
        };
        for (sum, f) in sum.iter_mut().zip(f(nm)) {
            *sum += weight * f;
        }
    }
    sum
}

fn table(nm: &[f64], values: &[f64]) -> Spectrum {
    Spectrum::Table(Table::new(nm.to_vec(), values.to_vec()).unwrap())
}

fn blackbody(kelvin: f64, scale: f64) -> Spectrum {
    Spectrum::Blackbody { kelvin, scale }
}

/// Ten digits are what the truths promise.
const TEN_DIGITS: f64 = 1e-10;

// ---- tables

#[test]
fn tables_reject_what_is_no_table() {
    let table = |nm: &[f64], values: &[f64]| Table::new(nm.to_vec(), values.to_vec());
    assert_eq!(table(&[], &[]), Err(TableError::Empty));
    let uneven = TableError::Length { nm: 2, values: 1 };
    assert_eq!(table(&[400.0, 500.0], &[1.0]), Err(uneven));
    assert!(matches!(
        table(&[400.0, 400.0], &[1.0, 1.0]),
        Err(TableError::NotIncreasing { number: 2, .. })
    ));
    for (nm, value) in [(500.0, f64::NAN), (f64::INFINITY, 1.0)] {
        assert!(matches!(
            table(&[400.0, nm], &[1.0, value]),
            Err(TableError::NotFinite { number: 2, .. })
        ));
    }
}

#[test]
fn csv_errors_name_the_line() {
    let line = |text: &str| match Table::from_csv(text) {
        Err(TableError::Line { line, .. }) => line,
        other => panic!("expected the error of a line, got {other:?}"),
    };
    for (text, number) in [
        ("# head\nnm,value\n400,1\n390,2\n", 4),
        ("400,1\n\n500,one\n", 3),
        ("400,1\n# note\n500,1,2\n", 3),
        ("400,1\n500,inf\n", 2),
        ("400,1\nnm,value\n500,2\n", 2),
        ("400,1\r\n500 2\r\n", 2),
    ] {
        assert_eq!(line(text), number, "{text}");
    }
    let nothing = Table::from_csv("# nothing\nnm,value\n");
    assert_eq!(nothing, Err(TableError::Empty));
}

#[test]
fn csv_reads_what_it_should() {
    let text = "\u{feff}# source\r\nnm, value\r\n 400 , 0.5 \r\n500,1e-1\r\n";
    let want = Table::new(vec![400.0, 500.0], vec![0.5, 0.1]).unwrap();
    assert_eq!(Table::from_csv(text).unwrap(), want);
}

#[test]
fn tables_are_linear_inside_and_zero_outside() {
    let spectrum = table(&[400.0, 500.0, 600.0], &[1.0, 3.0, 2.0]);
    for (nm, want) in [
        (399.999, 0.0),
        (400.0, 1.0),
        (450.0, 2.0),
        (500.0, 3.0),
        (575.0, 2.25),
        (600.0, 2.0),
        (600.001, 0.0),
    ] {
        assert_eq!(spectrum.value(nm), want, "at {nm} nm");
    }
}

#[test]
fn bounds_hold_everywhere_and_are_attained() {
    let cases = [
        (Spectrum::Constant(0.3), 0.3, 0.3),
        // Samples beyond the visible range do not count, the values at its ends do.
        (table(&[340.0, 380.0, 900.0], &[9.0, 1.0, 1.0]), 1.0, 5.0),
        // Missing ends are zero.
        (table(&[400.0, 500.0], &[0.2, 0.4]), 0.0, 0.4),
        (table(&[300.0, 350.0], &[0.2, 0.4]), 0.0, 0.0),
    ];
    for (spectrum, min, max) in cases {
        assert_eq!(spectrum.min_value(), min, "{spectrum:?}");
        assert_eq!(spectrum.max_value(), max, "{spectrum:?}");
    }
    let smooth = [
        blackbody(1000.0, 1.0),
        blackbody(5000.0, 2.0),
        blackbody(5000.0, -2.0),
        blackbody(20000.0, 1.0),
        Spectrum::rgb_reflectance([0.8, 0.3, 0.1]).unwrap(),
        Spectrum::rgb_reflectance([0.1, 0.9, 0.2]).unwrap(),
        Spectrum::rgb_emission([0.1, 3.0, 0.2]).unwrap(),
        Spectrum::d65(1.0),
    ];
    for spectrum in smooth {
        let (min, max) = (spectrum.min_value(), spectrum.max_value());
        let values = (0..=47_000).map(|step| spectrum.value(NM_MIN + f64::from(step) * 0.01));
        let low = values.clone().fold(f64::INFINITY, f64::min);
        let high = values.fold(f64::NEG_INFINITY, f64::max);
        let within = min <= low && high <= max;
        assert!(within, "{spectrum:?}: {min} {low} {high} {max}");
        if !matches!(spectrum, Spectrum::Sigmoid { d65: true, .. }) {
            // Steps of 0.01 nm miss an extremum of these curves by less than this.
            assert_absolute(max, high, 1e-7 * high.abs());
            assert_absolute(min, low, 1e-7 * high.abs());
        }
    }
}

#[test]
fn only_constant_spectra_are_constant() {
    let grey = |blue| Spectrum::rgb_reflectance([0.2, 0.2, blue]).unwrap();
    for (spectrum, constant) in [
        (Spectrum::Constant(2.0), true),
        (table(&[360.0, 830.0], &[0.5, 0.5]), true),
        (table(&[361.0, 830.0], &[0.5, 0.5]), false),
        (table(&[300.0, 400.0, 900.0], &[0.5, 0.6, 0.5]), false),
        (grey(0.2), true),
        (grey(0.3), false),
        (Spectrum::d65(1.0), false),
    ] {
        assert_eq!(spectrum.is_constant(), constant, "{spectrum:?}");
    }
}

// ---- observer

#[test]
fn observer_has_the_published_points() {
    // CIE 018:2019 at the first, last and some inner wavelengths.
    for (nm, want) in [
        (360.0, [0.000_129_9, 0.000_003_917, 0.000_606_1]),
        (450.0, [0.3362, 0.038, 1.77211]),
        (555.0, [0.512_050_1, 1.0, 0.005_749_999]),
        (600.0, [1.0622, 0.631, 0.0008]),
        (830.0, [1.251_141e-6, 4.5181e-7, 0.0]),
    ] {
        assert_eq!(xyz_bar(nm), want, "at {nm} nm");
    }
    assert_eq!(xyz_bar(359.9), [0.0; 3]);
    assert_eq!(xyz_bar(830.1), [0.0; 3]);
    let [_, y, _] = xyz_bar(555.5);
    assert_eq!(y, 0.5 * (xyz_bar(555.0)[1] + xyz_bar(556.0)[1]));
}

#[test]
fn the_constant_of_y_is_the_trapezoid_sum() {
    let want = number(&truth("equal_energy_xyz")["exact"]["int_ybar_1nm"]);
    assert_eq!(Y_INTEGRAL, want);
    assert_relative(trapezoid(xyz_bar)[1], want, 1e-14);
    // The plain sum is another number.
    let sum: f64 = whole_nm().map(|nm| xyz_bar(nm)[1]).sum();
    assert!((sum / want - 1.0).abs() > 1e-8);
}

#[test]
fn equal_energy_has_luminance_one() {
    for value in [1.0, 0.18, 1e6] {
        // A thousand additions of positive numbers.
        let [_, y, _] = spectrum_to_xyz(&Spectrum::Constant(value));
        assert_relative(y, value, 1e-14);
    }
}

#[test]
fn box_spectra_have_their_xyz_and_rgb() {
    let truth = truth("equal_energy_xyz");
    for row in truth.rows("rows") {
        let xyz = spectrum_to_xyz(&table(&numbers(&row["box"]), &[1.0, 1.0]));
        let rgb = xyz_to_linear_srgb(xyz);
        for i in 0..3 {
            assert_relative(xyz[i], numbers(&row["XYZ"])[i], TEN_DIGITS);
            assert_absolute(rgb[i], numbers(&row["linear_sRGB"])[i], TEN_DIGITS);
        }
    }
}

#[test]
fn the_product_of_two_linear_pieces_is_integrated_exactly() {
    // A triangle with its corners between the observer's nodes: x̄ȳz̄ are linear in each of the
    // pieces, so Simpson's rule on every piece is exact as well.
    let corners = [500.3, 555.75, 600.6];
    let spectrum = table(&corners, &[0.0, 2.0, 0.0]);
    let mut nodes: Vec<f64> = (501..=600).map(f64::from).chain(corners).collect();
    nodes.sort_by(f64::total_cmp);
    let mut want = 0.0;
    for pair in nodes.windows(2) {
        let f = |nm: f64| spectrum.value(nm) * xyz_bar(nm)[1];
        let (a, b) = (pair[0], pair[1]);
        want += (b - a) / 6.0 * (f(a) + 4.0 * f(0.5 * (a + b)) + f(b));
    }
    assert_relative(spectrum_to_xyz(&spectrum)[1], want / Y_INTEGRAL, 1e-13);
}

/// The matrix from XYZ to linear RGB for primaries and white given as chromaticities, Y of the
/// white being 1 (SMPTE RP 177-1993). For [`REC_709`] its first element is 3.2409699.
fn xyz_to_rgb_from_chromaticities(chromaticities: [[f64; 2]; 4]) -> [[f64; 3]; 3] {
    let xyz = chromaticities.map(|[x, y]| glam::DVec3::new(x / y, 1.0, (1.0 - x - y) / y));
    let primaries = glam::DMat3::from_cols(xyz[0], xyz[1], xyz[2]);
    let weights = primaries.inverse() * xyz[3];
    let to_xyz = primaries * glam::DMat3::from_diagonal(weights);
    to_xyz.inverse().transpose().to_cols_array_2d()
}

#[test]
fn the_matrix_is_the_rounded_standard_one() {
    let derived = xyz_to_rgb_from_chromaticities(REC_709);
    // Known digits of the matrix of the exact chromaticities.
    assert_absolute(derived[0][0], 3.240_969_94, 1e-8);
    assert_absolute(derived[1][1], 1.875_967_50, 1e-8);
    assert_absolute(derived[2][2], 1.056_971_51, 1e-8);
    let difference = (0..9)
        .map(|i| (derived[i / 3][i % 3] - XYZ_TO_LINEAR_SRGB[i / 3][i % 3]).abs())
        .fold(0.0, f64::max);
    assert!((1e-4..5e-4).contains(&difference), "{difference}");
}

// ---- blackbody and illuminants

#[test]
fn blackbodies_have_planck_s_radiance() {
    let truth = truth("blackbody");
    let wavelengths = numbers(&truth["setup"]["nm"]);
    for row in truth.rows("rows") {
        let kelvin = number(&row["T"]);
        let spectrum = blackbody(kelvin, 1.0);
        for (nm, want) in wavelengths.iter().zip(numbers(&row["L"])) {
            assert_relative(spectrum.value(*nm), want, 1e-13);
        }
        let sum = trapezoid(|nm| xyz_bar(nm).map(|bar| bar * spectrum.value(nm)));
        let all: f64 = sum.iter().sum();
        assert_relative(sum[1], number(&row["Y_integral"]), TEN_DIGITS);
        let luminance = number(&row["luminance_cd_m2"]);
        assert_relative(LUMINOUS_EFFICACY * sum[1], luminance, TEN_DIGITS);
        assert_absolute(sum[0] / all, number(&row["x"]), TEN_DIGITS);
        assert_absolute(sum[1] / all, number(&row["y"]), TEN_DIGITS);
        // A curve f times a polygon g, integrated exactly, exceeds the trapezoid sum by h²/12 ∫ f″ g
        // up to higher orders in h = 1 nm (partial integration of Euler and Maclaurin's h² term).
        let bend = |nm: f64| {
            let f = |offset: f64| spectrum.value(nm + offset);
            xyz_bar(nm)[1] * (f(-1.0) - 2.0 * f(0.0) + f(1.0))
        };
        let curvature: f64 = whole_nm().map(bend).sum();
        let [x, y, z] = spectrum_to_xyz(&spectrum);
        assert_relative(y * Y_INTEGRAL, sum[1] + curvature / 12.0, 1e-9);
        // The same excess, about 1e-6, in x.
        assert_absolute(x / (x + y + z), number(&row["x"]), 1e-6);
    }
}

#[test]
fn a_cold_body_is_dark() {
    for kelvin in [-1.0, 0.0, 1.0] {
        assert_eq!(blackbody(kelvin, 1.0).value(555.0), 0.0, "{kelvin} K");
    }
}

#[test]
fn d65_has_the_published_points_and_its_white() {
    let published = illuminant::published_d65();
    for (nm, want) in [
        (300.0, 0.0341),
        (380.0, 49.9755),
        (435.0, 95.7736),
        (560.0, 100.0),
        (700.0, 71.6091),
        (780.0, 63.3828),
        (830.0, 60.3125),
    ] {
        assert_eq!(published.value(nm), want);
    }
    let [x, y, z] = spectrum_to_xyz(&Spectrum::d65(3.0));
    assert_relative(y, 3.0, 1e-13);
    // CIE 15:2018: X = 95.047, Z = 108.883 for Y = 100, from 5 nm steps on 380–780 nm.
    assert_absolute(x / y, 0.950_47, 2e-5);
    assert_absolute(z / y, 1.088_83, 2e-5);
    assert_eq!(Spectrum::named("d65"), Some(Spectrum::d65(1.0)));
    assert_eq!(Spectrum::named("E"), Some(Spectrum::Constant(1.0)));
    assert_eq!(Spectrum::named("D50"), None);
}

// ---- RGB

fn reflected_rgb(reflectance: &Spectrum) -> [f64; 3] {
    let (mut colour, mut white) = ([0.0; 3], [0.0; 3]);
    // 0.05 nm midpoints: an independent and coarser quadrature than the fit's.
    for step in 0..9400 {
        let nm = NM_MIN + (f64::from(step) + 0.5) * 0.05;
        let light = illuminant::d65().value(nm) * 0.05;
        let bar = xyz_bar(nm).map(|bar| bar * light);
        colour = std::array::from_fn(|i| colour[i] + bar[i] * reflectance.value(nm));
        white = std::array::from_fn(|i| white[i] + bar[i]);
    }
    let [colour, white] = [colour, white].map(xyz_to_linear_srgb);
    std::array::from_fn(|i| colour[i] / white[i])
}

#[test]
fn greys_reflect_the_same_at_every_wavelength() {
    for c in [0.0, 0.18, 0.5, 1.0] {
        assert_eq!(Spectrum::rgb_reflectance([c; 3]), Ok(Spectrum::Constant(c)));
    }
}

#[test]
fn reflectances_return_their_colour() {
    let grid =
        (0..216).map(|index| [index / 36, index / 6 % 6, index % 6].map(|i| f64::from(i) / 5.0));
    let extreme = [
        [1.0, 1.0, 0.999],
        [0.999, 1.0, 1.0],
        [1e-6, 0.0, 0.0],
        [0.0, 0.0, 1e-3],
        [1.0, 0.999_999, 1.0],
        [0.5, 0.5, 0.500_001],
    ];
    // Every colour of the cube is attainable. What is left is rounding; close to the cube's black
    // and white corners, where the sigmoid is flat, the fit ends earlier.
    for (rgb, rounding) in grid
        .map(|rgb| (rgb, 1e-12))
        .chain(extreme.map(|rgb| (rgb, 1e-7)))
    {
        let fit = fit_reflectance(rgb).unwrap();
        assert!(fit.spectrum.min_value() >= 0.0 && fit.spectrum.max_value() <= 1.0);
        assert!(fit.residual <= rounding, "{rgb:?}: {}", fit.residual);
        let back = reflected_rgb(&fit.spectrum);
        for i in 0..3 {
            // The error of this test's midpoints: h²/24 times a mean second derivative of at most
            // 1e-3 nm⁻².
            assert_absolute(back[i], rgb[i], rounding + 1e-7);
        }
    }
}

#[test]
fn emissions_display_as_their_colour() {
    let mixed = [[5.0, 1.0, 0.2], [0.0, 100.0, 50.0], [0.3, 0.3, 2.0]];
    for rgb in [[1.0; 3]].into_iter().chain(mixed) {
        let fit = fit_emission(rgb).unwrap();
        let back = xyz_to_linear_srgb(spectrum_to_xyz(&fit.spectrum));
        for i in 0..3 {
            assert_absolute(back[i], rgb[i], fit.residual + 1e-12 * 100.0);
        }
    }
    // White is attainable, to rounding.
    assert!(fit_emission([1.0; 3]).unwrap().residual < 1e-12);
    let black = Spectrum::rgb_emission([0.0; 3]);
    assert_eq!(black, Ok(Spectrum::Constant(0.0)));
}

#[test]
fn impossible_colours_are_refused() {
    let reflectance = |green| Spectrum::rgb_reflectance([0.5, green, 0.0]);
    assert_eq!(reflectance(1.1), Err(RgbError::Reflectance(1.1)));
    assert!(reflectance(f64::NAN).is_err());
    let emission = |green| Spectrum::rgb_emission([0.5, green, 0.0]);
    assert_eq!(emission(-1.0), Err(RgbError::Emission(-1.0)));
    assert!(emission(f64::INFINITY).is_err());
}

// ---- refractive indices

#[test]
fn glasses_have_their_catalogue_index_and_abbe_number() {
    // n_d and Abbe number of Schott's data sheets (5 and 4 digits).
    for (name, n_d, abbe) in [
        ("N-BK7", 1.51680, 64.17),
        ("N-SF10", 1.72828, 28.53),
        ("N-SF11", 1.78472, 25.68),
        ("F2", 1.62004, 36.37),
        ("SF10", 1.72825, 28.41),
        ("SF11", 1.78472, 25.76),
        // Malitson 1965.
        ("fused-silica", 1.45846, 67.82),
    ] {
        let index = named_glass(name).unwrap();
        let n = index.n(LINE_D);
        assert_absolute(n, n_d, 0.6e-5);
        let got = (n - 1.0) / (index.n(LINE_F) - index.n(LINE_C));
        assert_absolute(got, abbe, 0.006);
    }
    // Handbook values of water at 20 °C and of diamond, 4 digits.
    assert_absolute(named_glass("water").unwrap().n(LINE_D), 1.3334, 1e-4);
    assert_absolute(named_glass("diamond").unwrap().n(LINE_D), 2.4176, 5e-4);
    assert_eq!(named_glass("Water"), named_glass("water"));
    assert_eq!(named_glass("SF-11"), None);
}

#[test]
fn n_sf11_follows_its_dispersion() {
    let glass = named_glass("n-sf11").unwrap();
    for row in truth("prism").rows("rows") {
        assert_relative(glass.n(number(&row["nm"])), number(&row["n"]), 1e-14);
    }
}

#[test]
fn every_glass_is_usable_over_the_whole_range() {
    for name in glass_names() {
        let glass = named_glass(name).unwrap();
        assert!(glass.disperses() && glass.check().is_ok(), "{name}");
        let mut before = f64::INFINITY;
        for nm in whole_nm() {
            let (n, k) = glass.n_k(nm);
            assert!(n >= 1.0 && n < before && k == 0.0, "{name} at {nm} nm: {n}");
            before = n;
        }
    }
}

#[test]
fn metals_have_their_published_points() {
    // Johnson and Christy 1972 at 1.88 and 2.38 eV; Rakić 1995 at 2.0 eV.
    for (name, nm, want) in [
        ("Ag", 659.5, (0.05, 4.483)),
        ("Ag", 520.9, (0.05, 3.324)),
        ("Au", 659.5, (0.14, 3.697)),
        ("Au", 520.9, (0.62, 2.081)),
        ("Cu", 659.5, (0.22, 3.747)),
        ("Cu", 520.9, (1.18, 2.608)),
        ("Al", 619.93, (1.366, 7.4052)),
    ] {
        let found = named_metal(name).unwrap().n_k(nm);
        assert_eq!(found, want, "{name} at {nm} nm");
    }
    // Normal reflectances, roughly: silver white, gold and copper dark in the blue, aluminium near
    // 91 %. Measurements on different films scatter by 2 % or so.
    for (name, nm, want) in [
        ("Ag", 550.0, 0.98),
        ("Au", 450.0, 0.39),
        ("Cu", 450.0, 0.54),
        ("Al", 550.0, 0.915),
    ] {
        let (n, k) = named_metal(name).unwrap().n_k(nm);
        let reflectance = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
        assert_absolute(reflectance, want, 0.03);
    }
    for name in metal_names() {
        let metal = named_metal(name).unwrap();
        assert!(metal.check().is_ok() && metal.disperses(), "{name}");
        for nm in [NM_MIN, NM_MAX].into_iter().chain(whole_nm()) {
            let (n, k) = metal.n_k(nm);
            let sane = n > 0.0 && k > 1.0 && n.is_finite() && k.is_finite();
            assert!(sane, "{name} at {nm} nm");
        }
    }
    assert_eq!(named_metal("Fe"), None);
}

#[test]
fn formulas_by_hand() {
    let cauchy = RefractiveIndex::Cauchy(vec![1.5, 0.004, 0.0001]);
    assert_relative(cauchy.n(500.0), 1.5 + 0.004 / 0.25 + 0.0001 / 0.0625, 1e-15);
    assert!(cauchy.disperses());
    assert!(!RefractiveIndex::Cauchy(vec![1.5, 0.0]).disperses());
    assert!(!RefractiveIndex::Constant(1.5).disperses());
    let resonant = RefractiveIndex::sellmeier([1.0, 0.0, 0.0], [0.25, 0.0, 0.0]);
    let negative_k = RefractiveIndex::Complex {
        n: Spectrum::Constant(1.0),
        k: Spectrum::Constant(-1.0),
    };
    // There is no index on the resonance at 500 nm.
    for wrong in [resonant, RefractiveIndex::Constant(-1.5), negative_k] {
        assert!(wrong.check().is_err(), "{wrong:?}");
    }
}

// ---- wavelengths

#[test]
fn the_visible_pdf_is_the_published_one() {
    let truth = truth("wavelength_pdf");
    let pdf = WavelengthPdf::Visible;
    assert_relative(pdf.pdf(538.0), truth.exact("A"), 1e-14);
    let us = numbers(&truth["setup"]["u"]).into_iter();
    for (u, nm) in us.zip(numbers(&truth["exact"]["lam"])) {
        assert_relative(pdf.sample(u), nm, 1e-12);
    }
}

#[test]
fn one_wavelength_has_the_known_variance() {
    let truth = truth("wavelength_pdf");
    for (pdf, key) in [
        (WavelengthPdf::Visible, "relvar_visible"),
        (WavelengthPdf::Uniform, "relvar_uniform"),
    ] {
        let square = trapezoid(|nm| xyz_bar(nm).map(|bar| bar * bar / pdf.pdf(nm)));
        let plain = trapezoid(xyz_bar);
        for i in 0..3 {
            let got = square[i] / (plain[i] * plain[i]) - 1.0;
            assert_relative(got, numbers(&truth["exact"][key])[i], 1e-9);
        }
    }
}

#[test]
fn hero_sets_have_the_known_variance() {
    let truth = truth("wavelength_pdf");
    for count in [1, 2, 4, 8, 16, 32] {
        let got = hero_relative_variance(WavelengthPdf::Visible, count);
        let want = numbers(&truth["exact"]["relvar_hero_flat_spectrum"][count.to_string()]);
        for i in 0..3 {
            // Six digits are given.
            assert_relative(got[i], want[i], 5e-6);
        }
    }
}

#[test]
fn densities_integrate_to_one_and_invert_their_distribution() {
    for pdf in [WavelengthPdf::Visible, WavelengthPdf::Uniform] {
        assert_eq!(pdf.sample(0.0), NM_MIN);
        assert_relative(pdf.sample(1.0), NM_MAX, 1e-13);
        assert_eq!(pdf.pdf(NM_MIN - 1e-9), 0.0);
        assert_eq!(pdf.pdf(NM_MAX + 1e-9), 0.0);
        // Simpson per nm is good to 1e-10.
        let mut cumulative = 0.0;
        for nm in whole_nm().take_while(|&nm| nm < NM_MAX) {
            let (a, m, b) = (pdf.pdf(nm), pdf.pdf(nm + 0.5), pdf.pdf(nm + 1.0));
            cumulative += (a + 4.0 * m + b) / 6.0;
            // u carries an error of 1e-10 at most, which the density's inverse magnifies.
            assert_absolute(pdf.sample(cumulative.min(1.0)), nm + 1.0, 1e-10 / b);
        }
        assert_absolute(cumulative, 1.0, 1e-10);
    }
}

#[test]
fn hero_sets_rotate_one_number() {
    let pdf = WavelengthPdf::Visible;
    let set: [f64; 4] = pdf.sample_set(0.6);
    for (j, u) in [0.6, 0.85, 0.1, 0.35].into_iter().enumerate() {
        assert_absolute(set[j], pdf.sample(u), 1e-9);
    }
}

// ---- cells

/// Width of the cells tried, nm.
const CELL_NM: f64 = 0.25;

fn cells(spectrum: &Spectrum) -> Vec<f64> {
    let edges = (0..=1880).map(|i| NM_MIN + f64::from(i) * CELL_NM);
    means(spectrum, &edges.collect::<Vec<_>>())
}

#[test]
fn cells_hold_exact_means() {
    // A ramp that begins inside cell 162 and ends inside cell 562, with a kink at a cell's edge.
    let spectrum = table(&[400.6, 450.0, 500.7], &[1.0, 2.0, 4.0]);
    let means = cells(&spectrum);
    assert_eq!(means.len(), 1880);
    assert_eq!(means[161], 0.0);
    assert_eq!(means[563], 0.0);
    // Covered part of the cell [400.5, 400.75] times the value at its middle.
    assert_relative(means[162], 0.15 / CELL_NM * spectrum.value(400.675), 1e-12);
    assert_relative(means[562], 0.2 / CELL_NM * spectrum.value(500.6), 1e-12);
    assert_relative(means[200], spectrum.value(410.125), 1e-14);
    let area = 0.5 * (3.0 * 49.4 + 6.0 * 50.7);
    assert_relative(means.iter().sum::<f64>() * CELL_NM, area, 1e-13);
    let lamp = blackbody(3000.0, 1.0);
    let [a, m, b] = [385.0, 385.125, 385.25].map(|nm| lamp.value(nm));
    assert_relative(cells(&lamp)[100], (a + 4.0 * m + b) / 6.0, 1e-13);
}

// ---- data beside the scenes

#[test]
fn the_cornell_box_s_spectra_can_be_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/data");
    for (name, nm, want) in [
        ("white", 400.0, 0.343),
        ("red", 632.0, 0.62),
        ("green", 532.0, 0.462),
        ("lamp", 600.0, 15.6),
    ] {
        let file = folder.join(format!("cornell_{name}.csv"));
        let table = Table::from_csv(&std::fs::read_to_string(file).unwrap()).unwrap();
        assert_eq!(table.value(nm), want, "{name}");
        assert_eq!((table.nm[0], *table.nm.last().unwrap()), (400.0, 700.0));
    }
}
