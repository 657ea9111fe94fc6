//! Dispersion of named glasses and other clear media.

use super::ior::RefractiveIndex;

/// The media by name.
///
/// * N-BK7 … SF11: Schott's Zemax catalogue of 2017-01-20, relative to air at 20 °C, 1013 hPa, as
///   reproduced in the refractiveindex.info database (CC0 1.0). Fitted ranges begin at 300 nm
///   (N-BK7), 320 (F2), 370 (N-SF11), 380 (SF10, N-SF10) and 390 nm (SF11); down to 360 nm the
///   formula extrapolates smoothly. SF10 and SF11 contain lead; N-SF10 and N-SF11 are their
///   successors with nearly the same n at 587.6 nm, and different coefficients.
/// * fused-silica: I. H. Malitson, J. Opt. Soc. Am. 55, 1205 (1965), 20 °C, 0.21–3.71 µm.
/// * water: M. Daimon and A. Masumura, Appl. Opt. 46, 3811 (2007), distilled, 20.0 °C,
///   0.182–1.129 µm.
/// * diamond: F. Peter, Z. Phys. 15, 358 (1923), 0.226–0.76 µm, extrapolated up to 0.83 µm.
///
/// Schott's and Malitson's indices count relative to air; against vacuum n is larger by a factor of
/// 1.00027. Water's formula gives 1.33335 at 589.3 nm, which is the handbook's value against vacuum
/// (relative to air it is 1.3330). All are used as they stand.
const GLASSES: [(&str, RefractiveIndex); 9] = [
    (
        "N-BK7",
        RefractiveIndex::sellmeier(
            [1.039_612_12, 0.231_792_344, 1.010_469_45],
            [0.006_000_698_67, 0.020_017_914_4, 103.560_653],
        ),
    ),
    (
        "N-SF10",
        RefractiveIndex::sellmeier(
            [1.621_539_02, 0.256_287_842, 1.644_475_52],
            [0.012_224_145_7, 0.059_573_677_5, 147.468_793],
        ),
    ),
    (
        "N-SF11",
        RefractiveIndex::sellmeier(
            [1.737_596_95, 0.313_747_346, 1.898_781_01],
            [0.013_188_707, 0.062_306_814_2, 155.236_29],
        ),
    ),
    (
        "F2",
        RefractiveIndex::sellmeier(
            [1.345_333_59, 0.209_073_176, 0.937_357_162],
            [0.009_977_438_71, 0.047_045_076_7, 111.886_764],
        ),
    ),
    (
        "SF10",
        RefractiveIndex::sellmeier(
            [1.616_259_77, 0.259_229_334, 1.077_623_17],
            [0.012_753_455_9, 0.058_198_395_4, 116.607_68],
        ),
    ),
    (
        "SF11",
        RefractiveIndex::sellmeier(
            [1.738_484_03, 0.311_168_974, 1.174_908_71],
            [0.013_606_860_4, 0.061_596_046_3, 121.922_711],
        ),
    ),
    (
        "fused-silica",
        RefractiveIndex::sellmeier(
            [0.696_166_3, 0.407_942_6, 0.897_479_4],
            [
                0.068_404_3 * 0.068_404_3,
                0.116_241_4 * 0.116_241_4,
                9.896_161 * 9.896_161,
            ],
        ),
    ),
    (
        "water",
        RefractiveIndex::Sellmeier {
            b: [
                0.568_402_756_5,
                0.172_617_739_1,
                0.020_861_895_78,
                0.113_074_868_8,
            ],
            c: [
                0.005_101_829_712,
                0.018_211_539_36,
                0.026_207_222_93,
                10.697_927_21,
            ],
        },
    ),
    (
        "diamond",
        RefractiveIndex::sellmeier([0.330_6, 4.335_6, 0.0], [0.175 * 0.175, 0.106 * 0.106, 0.0]),
    ),
];

/// The refractive index of a named clear medium, any letter case; see [`glass_names`].
pub fn named_glass(name: &str) -> Option<RefractiveIndex> {
    let mut glasses = GLASSES.into_iter();
    let (_, index) = glasses.find(|(known, _)| known.eq_ignore_ascii_case(name))?;
    Some(index)
}

/// The names that [`named_glass`] knows.
pub fn glass_names() -> impl Iterator<Item = &'static str> {
    GLASSES.into_iter().map(|(name, _)| name)
}
