//! The wavelength grid: the cumulative density against its closed form, and what the observer's
//! weights make of flat spectra.

#![allow(
    clippy::unwrap_used,
    reason = "the tests' own tables are right, and a panic says where"
)]

use etalon::inside::integrate::develop::Spectrometer;
use etalon::inside::integrate::pool::Rows;
use etalon::inside::math::lanes::Scalar;
use etalon::inside::spectrum::cells::means;
use etalon::inside::spectrum::grid::{CELLS, SpectrumBank, WavelengthGrid, visible_wavelength};

use etalon::inside::spectrum::{Spectrum, Table};

use crate::truth_file::{list, number, truth};

#[test]
fn the_cumulative_density_is_the_published_one() {
    let truth = truth("wavelength_pdf");
    let grid = WavelengthGrid::default();
    let us = list(&truth["setup"]["u"]);
    for (u, nm) in us.iter().zip(list(&truth["exact"]["lam"])) {
        let (u, nm) = (number(u), number(nm));
        let got = visible_wavelength(u);
        assert!((got - nm).abs() < 1e-9, "{got} {nm}");
        // The chord of a cell is off by at most w²/8 of the second derivative −2 a tanh λ'² of
        // λ(u), where λ' is w a cell, below 1.1 nm.
        let got = grid.wavelength(u);
        let slack = 1.1 * 1.1 * 2.0 * 0.0072 / 8.0;
        assert!((got - nm).abs() < slack, "{got} {nm}");
    }
    // The density between two edges is A/cosh²: cells of equal probability.
    let a = number(&truth["exact"]["A"]);
    for cell in 0..CELLS {
        let (low, high) = grid.cell(cell);
        let middle = 0.5 * (low + high);
        let density = |nm: f64| {
            let c = libm::cosh(0.0072 * (nm - 538.0));
            a / (c * c)
        };
        // Simpson's rule over cells of at most 1.1 nm: error far below 1e-9 of the cell.
        let simpson = (density(low) + 4.0 * density(middle) + density(high)) / 6.0;
        let probability = simpson * (high - low) * CELLS as f64;
        assert!((probability - 1.0).abs() < 1e-8, "{cell}: {probability}");
        assert!(high > low);
    }
    assert_eq!((grid.edges()[0], grid.edges()[CELLS]), (360.0, 830.0));
}

/// Known between two wavelengths, flat there, zero elsewhere.
fn step(from: f64, to: f64) -> Spectrum {
    Spectrum::Table(Table::new(vec![from, to], vec![1.0, 1.0]).unwrap())
}

/// ∫ of a product of spectra over the band, each averaged over cells on its own as paths have it.
fn product(grid: &WavelengthGrid, spectra: &[Spectrum]) -> f64 {
    let means: Vec<Vec<f64>> = spectra.iter().map(|s| means(s, grid.edges())).collect();
    let of_cell = |cell: usize| {
        let (low, high) = grid.cell(cell);
        means.iter().map(|m| m[cell]).product::<f64>() * (high - low)
    };
    (0..CELLS).map(of_cell).sum()
}

#[test]
fn where_spectra_jump_cells_end() {
    let jumps = [401.3, 500.0, 500.001, 555.55, 700.0, 829.9];
    let spectra: Vec<Spectrum> = jumps[1..].iter().map(|to| step(jumps[0], *to)).collect();
    let grid = WavelengthGrid::new(&spectra);
    assert!(grid.edges().windows(2).all(|e| e[0] < e[1]));
    for jump in jumps {
        assert!(grid.edges().contains(&jump), "{jump}");
    }
    let even = WavelengthGrid::default();
    let moved = grid
        .edges()
        .iter()
        .zip(even.edges())
        .filter(|(a, b)| a != b);
    assert_eq!(moved.count(), jumps.len());
    // Light, and three walls: lit up to the jump, whatever the number of factors.
    for (spectrum, to) in spectra.iter().zip(&jumps[1..]) {
        let factors = vec![spectrum.clone(); 4];
        let got = product(&grid, &factors);
        assert!((got / (to - jumps[0]) - 1.0).abs() < 1e-12, "{to}: {got}");
    }
    // Without it a share of a cell is lost, 0.1 nm or so at 700 nm.
    let lost = 298.7 - product(&WavelengthGrid::default(), &vec![step(401.3, 700.0); 4]);
    assert!(lost > 0.01, "{lost}");
}

#[test]
fn steep_flanks_are_jumps_and_flat_tables_are_none() {
    let nm = vec![450.0, 450.002, 600.0, 600.003];
    let band = Spectrum::Table(Table::new(nm, vec![0.0, 2.0, 2.0, 0.0]).unwrap());
    let grid = WavelengthGrid::new([&band]);
    for edge in [450.0, 450.002, 600.0, 600.003] {
        assert!(grid.edges().contains(&edge), "{edge}");
    }
    // On the flanks f² has another integral than f: 1/3 of its square for 1/2.
    let exact = 4.0 * (149.998 + 0.005 / 3.0);
    let got = product(&grid, &[band.clone(), band]);
    assert!(
        (got - exact).abs() < 4.0 * 0.005 / 12.0 * 1.01,
        "{got} {exact}"
    );
    let smooth = [
        Spectrum::d65(1.0),
        Spectrum::Constant(0.5),
        step(300.0, 900.0),
    ];
    assert_eq!(WavelengthGrid::new(&smooth), WavelengthGrid::default());
}

#[test]
fn a_hundred_jumps_in_one_cell_leave_a_grid() {
    let spectra: Vec<Spectrum> = (0..100)
        .map(|i| step(500.0 + 1e-4 * f64::from(i), 640.0))
        .collect();
    let grid = WavelengthGrid::new(&spectra);
    assert!(grid.edges().windows(2).all(|e| e[0] < e[1]));
}

#[test]
fn banks_hold_each_cell_once_for_every_set_size() {
    fn check<const C: usize>() {
        let mut bank = SpectrumBank::<f64>::new(C);
        let first: Vec<f64> = (0..CELLS).map(|c| c as f64).collect();
        let other: Vec<f64> = (0..=CELLS).map(|c| -(c as f64)).collect();
        let (a, b) = (bank.push(&first), bank.push(&other));
        let rows = (CELLS / C) as u32;
        for row in 0..rows {
            for j in 0..C {
                let cell = f64::from(j as u32 * rows + row);
                assert_eq!(bank.rows::<C>()[(a + row) as usize][j], cell);
                assert_eq!(bank.rows::<C>()[(b + row) as usize][j], -cell);
                // Nodes: the row after holds the cells' upper ends.
                assert_eq!(bank.rows::<C>()[(b + row + 1) as usize][j], -cell - 1.0);
            }
        }
    }
    check::<1>();
    check::<4>();
    check::<8>();
    check::<16>();
}

/// Mean, and relative variance over Y-normalised truth, of X, Y, Z of a flat spectrum over all
/// rows, which are equally likely.
fn flat<T: Scalar, const C: usize>() -> ([f64; 3], [f64; 3]) {
    let spectrometer = Spectrometer::<T>::new(&WavelengthGrid::default(), C);
    let rows = CELLS / C;
    let mut samples = Rows::<T, C>::new(rows);
    for row in 0..rows {
        samples.row[row] = row as u32;
        samples.paths[row].radiance = [T::from_f64(1.0); C];
    }
    let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
    for row in 0..rows {
        let xyz = spectrometer.tristimulus(&samples, row).map(Scalar::to_f64);
        for i in 0..3 {
            sum[i] += xyz[i];
            squares[i] += xyz[i] * xyz[i];
        }
    }
    let n = rows as f64;
    let mean = sum.map(|s| s / n);
    let variance = std::array::from_fn(|i| (squares[i] / n / (mean[i] * mean[i]) - 1.0).max(0.0));
    (mean, variance)
}

#[test]
fn the_equal_energy_spectrum_has_luminance_one() {
    fn check<T: Scalar, const C: usize>(bound: f64) {
        let ([x, y, z], _) = flat::<T, C>();
        assert!((y - 1.0).abs() < bound, "{C}: {y}");
        // The 1 nm table's own white: X and Z of the equal-energy spectrum.
        let white = etalon::inside::spectrum::observer::spectrum_to_xyz(
            &etalon::inside::spectrum::Spectrum::Constant(1.0),
        );
        assert!(
            (x - white[0]).abs() < bound && (z - white[2]).abs() < bound,
            "{C}: {x} {z}"
        );
    }
    // Rounded weights err at random: 2⁻²⁵/√4096 in the mean and half as much again in the sums.
    check::<f32, 1>(1e-7);
    check::<f32, 4>(1e-7);
    check::<f32, 8>(1e-7);
    check::<f64, 1>(1e-12);
    check::<f64, 4>(1e-12);
    check::<f64, 8>(1e-12);
    check::<f64, 16>(1e-12);
}

#[test]
fn colour_noise_is_what_hero_sets_have() {
    let truth = truth("wavelength_pdf");
    let table = &truth["exact"]["relvar_hero_flat_spectrum"];
    fn check<T: Scalar, const C: usize>(want: [f64; 3]) {
        let (_, variance) = flat::<T, C>();
        for i in 0..3 {
            // The table has six digits of the variance of continuous sets; cell means take away
            // what varies within a cell, which is below 1e-4 of it at this number of cells, and
            // the second difference of numbers near 1 leaves 1e-15/variance (1e-7 in f32).
            let slack = 5e-3 * want[i] + 10.0 * T::ROUNDOFF;
            assert!(
                (variance[i] - want[i]).abs() < slack,
                "{C} {i}: {} {}",
                variance[i],
                want[i]
            );
        }
    }
    let want = |c: &str| {
        let row = list(&table[c]);
        [number(&row[0]), number(&row[1]), number(&row[2])]
    };
    check::<f64, 1>(want("1"));
    check::<f64, 4>(want("4"));
    check::<f64, 8>(want("8"));
    check::<f32, 4>(want("4"));
    check::<f32, 8>(want("8"));
    // Planted: the set of another size is told apart.
    let (_, four) = flat::<f64, 4>();
    assert!((four[2] - want("8")[2]).abs() > 0.1);
}
