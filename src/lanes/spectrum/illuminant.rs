//! Standard illuminants.

use std::sync::LazyLock;

use super::{Spectrum, Table, observer};

static D65: LazyLock<Table> = LazyLock::new(|| {
    let published = Spectrum::Table(published_d65());
    let luminance = observer::spectrum_to_xyz(&published)[1];
    match published.scaled(1.0 / luminance) {
        Spectrum::Table(table) => table,
        _ => unreachable!("a scaled table is a table"),
    }
});

/// CIE standard illuminant D65 as published: 300–830 nm in 5 nm steps, 100 at 560 nm.
pub fn published_d65() -> Table {
    Table::from_csv(include_str!("data/cie_d65.csv"))
        .expect("the embedded table of D65 is well formed")
}

/// CIE standard illuminant D65 with luminance Y = 1 in the normalisation of [`observer`].
pub fn d65() -> &'static Table {
    &D65
}
