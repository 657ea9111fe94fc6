//! Pictures go to files and come back: bits, attributes, and nothing half-done.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use etalon::inside::film::spectral::{self, Bin};
use etalon::inside::film::{Error, exr, hash, names, png, whole};
use etalon::{Attribute, Channel, Picture, Values};

use crate::support::{Folder, assert_says, attribute, value_bits};

/// 19 × 37 pixels: neither is a multiple of ZIP's 16 lines, so that the last block is short.
const WIDTH: usize = 19;
const HEIGHT: usize = 37;

/// Bit patterns that go through NaN, infinities, subnormals and both signs.
fn bits(count: usize, seed: u32) -> Vec<f32> {
    let special = [0x7fc0_1234, 0x7f80_0000, 0xff80_0000, 1, 0x8000_0000];
    let mut state = seed;
    let random = std::iter::repeat_with(move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state
    });
    let all = special.into_iter().chain(random).map(f32::from_bits);
    all.take(count).collect()
}

fn triples(count: usize, seed: u32) -> Vec<[f32; 3]> {
    let planes = [0, 1, 2].map(|k| bits(count, seed + k));
    let triple = |i: usize| planes.each_ref().map(|plane| plane[i]);
    (0..count).map(triple).collect()
}

fn picture() -> Picture {
    let count = WIDTH * HEIGHT;
    let mut picture = Picture::new(WIDTH, HEIGHT);
    picture.push_triple(names::BEAUTY, names::RGB, &triples(count, 1));
    picture.push_triple(names::STANDARD_ERROR, names::RGB, &triples(count, 4));
    picture.push_triple(names::NORMAL, names::XYZ, &triples(count, 7));
    // Whole numbers beyond 2²⁴, which single precision cannot hold.
    let ids = (0..count as u32).map(|i| names::NOTHING - i).collect();
    picture.channels.extend([
        Channel::float(names::DEPTH, bits(count, 10)),
        Channel::integer(names::OBJECT_ID, ids),
    ]);
    picture.attributes = attributes();
    picture
}

/// Attributes of every type, as many as the provenance of a picture has.
fn attributes() -> Vec<(String, Attribute)> {
    let text = "# Würfel — λ = 550 nm → 人\n[camera]\n".repeat(400);
    let some = [
        ("sceneText", Attribute::Text(text)),
        ("plan", Attribute::Text(String::new())),
        ("spp", Attribute::whole_number(5_000_000_000)),
        ("nanCount", Attribute::whole_number(3)),
        ("seconds", Attribute::Double(0.1)),
        ("single", Attribute::Float(0.1)),
    ];
    let named = |(name, value): (&str, Attribute)| (name.to_owned(), value);
    let numbers = (0..15).map(|i| (format!("number{i}"), Attribute::Int(-i)));
    some.into_iter().map(named).chain(numbers).collect()
}

/// A folder and a place in it.
fn place(name: &str) -> (Folder, PathBuf) {
    let folder = Folder::empty();
    let path = folder.path(name);
    (folder, path)
}

/// Asserts that a folder holds these files alone.
#[track_caller]
fn assert_files<const N: usize>(folder: &Folder, names: [&str; N]) {
    assert_eq!(folder.files(), names.map(str::to_owned).into());
}

fn assert_same(written: &Picture, read: &Picture) {
    assert_eq!((written.width, written.height), (read.width, read.height));
    assert_eq!(written.channels.len(), read.channels.len());
    for channel in &written.channels {
        let back = read.channel(&channel.name).unwrap();
        let seen = |c: &Channel| (matches!(c.values, Values::F32(_)), value_bits(&c.values));
        assert_eq!(seen(channel), seen(back), "{}", channel.name);
    }
    let mut attributes = written.attributes.clone();
    attributes.sort_by(|a, b| a.0.cmp(&b.0));
    assert_eq!(attributes, read.attributes);
}

#[test]
fn exr_keeps_every_bit_and_attribute() {
    let (folder, path) = place("picture.exr");
    let picture = picture();
    exr::write(&path, &picture).unwrap();
    let read = exr::read(&path).unwrap();
    assert_same(&picture, &read);
    // Whole numbers beyond 32 bits are text.
    assert_eq!(attribute(&read, "spp"), "5000000000");
    assert_eq!(read.attribute("nanCount"), Some(&Attribute::Int(3)));
    assert_files(&folder, ["picture.exr"]);
}

#[test]
fn exr_is_a_single_part_of_sorted_scan_lines_compressed_by_zip() {
    use ::exr::meta::attribute::{Compression, LineOrder};
    let (_folder, path) = place("picture.exr");
    exr::write(&path, &picture()).unwrap();
    let meta = ::exr::meta::MetaData::read_from_file(&path, true).unwrap();
    assert_eq!(meta.headers.len(), 1, "parts");
    let header = &meta.headers[0];
    assert_eq!(header.compression, Compression::ZIP16);
    assert_eq!(header.line_order, LineOrder::Increasing);
    assert!(!header.blocks.has_tiles());
    let primaries = header.shared_attributes.chromaticities.unwrap();
    assert_eq!((primaries.green.x(), primaries.green.y()), (0.3, 0.6));
    assert_eq!((primaries.white.x(), primaries.white.y()), (0.3127, 0.329));
    let channels = &header.channels.list;
    assert!(channels.is_sorted_by_key(|c| c.name.to_string()));
}

/// The order of a hash map with a random seed must not show: two such orders of 21 attributes
/// agree by chance once in 21! ≈ 5e19.
#[test]
fn the_same_picture_is_the_same_bytes() {
    let (_folder, path) = place("picture.exr");
    let [first, second] = [(); 2].map(|()| {
        exr::write(&path, &picture()).unwrap();
        fs::read(&path).unwrap()
    });
    assert!(first == second);
}

#[test]
fn spectral_layout_follows_the_paper() {
    let [long, short] = ["S0.550,000000nm", "S0.387,500000nm"];
    assert_eq!([550.0, 387.5].map(spectral::channel_name), [long, short]);
    let found = [short, "T.387,500000nm", "R"].map(spectral::wavelength);
    assert_eq!(found, [Some(387.5), None, None]);

    let (_folder, path) = place("spectral.exr");
    let mut picture = Picture::new(2, 1);
    picture.push_triple(names::BEAUTY, names::RGB, &[[1.0; 3]; 2]);
    let bin = |nm: f64, standard_errors: Option<Vec<f32>>| Bin {
        nm,
        values: vec![nm as f32, 0.5],
        standard_errors,
    };
    picture.push_spectral([bin(387.5, None), bin(550.0, Some(vec![0.25, 0.125]))]);
    exr::write(&path, &picture).unwrap();

    let read = exr::read(&path).unwrap();
    assert_eq!(attribute(&read, "spectralLayoutVersion"), "1.0");
    assert_eq!(attribute(&read, "emissiveUnits"), "W.m^-2.sr^-1");
    let is_none = |name: &&str| read.attribute(name).is_none();
    assert!([short, long].iter().all(is_none));
    for (name, values) in [
        (long, [550.0, 0.5]),
        ("standard_error.S0.550,000000nm", [0.25, 0.125]),
    ] {
        assert_eq!(read.floats(name), Some(values.as_slice()));
    }
}

#[test]
fn contradictory_pictures_are_refused() {
    let (folder, path) = place("picture.exr");
    let named = |name: &str| Channel::float(name, vec![1.0; 2]);
    let good = || named("R");
    let faults = [
        ("no channels", vec![], &[][..]),
        ("values", vec![Channel::float("R", vec![1.0])], &[]),
        ("twice", vec![good(), good()], &[]),
        ("empty", vec![named("")], &[]),
        ("longer", vec![named(&"R".repeat(32))], &[]),
        ("twice", vec![good()], &["a", "a"]),
        ("reserved", vec![good()], &["compression"]),
    ];
    for (word, channels, attributes) in faults {
        let mut picture = Picture::new(2, 1);
        picture.channels = channels;
        let attribute = |name: &&str| ((*name).to_owned(), Attribute::Int(1));
        picture.attributes = attributes.iter().map(attribute).collect();
        let error = exr::write(&path, &picture).unwrap_err();
        assert!(is_write(&error, io::ErrorKind::InvalidInput), "{error}");
        assert!(error.to_string().contains(word), "{error}");
    }
    assert!(exr::write(&path, &Picture::new(0, 1)).is_err());
    assert_files(&folder, []);
}

/// Whether a file could be read, but not as a picture.
fn is_content(error: &Error) -> bool {
    matches!(error, Error::Read { source, .. } if source.kind() == io::ErrorKind::InvalidData)
}

fn is_write(error: &Error, kind: io::ErrorKind) -> bool {
    matches!(error, Error::Write { source, .. } if source.kind() == kind)
}

#[test]
fn damaged_and_foreign_files_are_errors_with_a_name() {
    let (_folder, path) = place("picture.exr");
    let missing = exr::read(&path).unwrap_err();
    assert!(matches!(missing, Error::Read { .. }) && !is_content(&missing));
    exr::write(&path, &picture()).unwrap();
    let bytes = fs::read(&path).unwrap();
    for length in [0, 3, 200, bytes.len() / 2, bytes.len() - 1] {
        fs::write(&path, &bytes[..length]).unwrap();
        let error = exr::read(&path).unwrap_err();
        assert!(is_content(&error), "{length}: {error}");
        assert!(error.to_string().contains("picture.exr"), "{error}");
    }
    fs::write(&path, "[camera]\nfov = 40\n").unwrap();
    assert!(is_content(&exr::read(&path).unwrap_err()));
}

/// An old file in a folder of its own.
fn with_old_file() -> (Folder, PathBuf) {
    let (folder, path) = place("old.exr");
    folder.write("old.exr", "old");
    (folder, path)
}

#[test]
fn a_write_that_fails_leaves_the_old_file_and_nothing_else() {
    let (folder, path) = with_old_file();
    let full = |file: &mut File| {
        file.write_all(b"half a picture").unwrap();
        Err(io::ErrorKind::StorageFull.into())
    };
    let error = whole::write(&path, full).unwrap_err();
    assert!(matches!(error, Error::Write { path: named, .. } if named == path));
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_files(&folder, ["old.exr"]);

    whole::write(&folder.path("new.exr"), full).unwrap_err();
    assert_files(&folder, ["old.exr"]);
}

/// Probes a place in a directory that takes no new file.
#[track_caller]
fn probe_refused(path: &Path) -> String {
    let error = whole::probe(path).unwrap_err();
    assert!(matches!(error, Error::Write { .. }), "{error}");
    let message = error.to_string();
    assert_says(&message, &["no file can be created in the directory"]);
    message
}

#[test]
fn probing_finds_bad_paths_and_touches_nothing() {
    let (folder, path) = with_old_file();
    let modified = || fs::metadata(&path).unwrap().modified().unwrap();
    let before = modified();
    whole::probe(&path).unwrap();
    whole::probe(&folder.path("new.exr")).unwrap();
    assert_eq!(modified(), before);
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_files(&folder, ["old.exr"]);

    let missing = folder.path("missing/new.exr");
    let message = probe_refused(&missing);
    assert_says(&message, &["missing/new.exr"]);
    assert!(!message.contains(".part"), "{message}");
    assert!(exr::write(&missing, &picture()).is_err());
    assert!(png::write_preview(&missing, 1, 1, &[[0.5; 3]]).is_err());

    let error = whole::probe(&folder.path("")).unwrap_err();
    assert!(error.to_string().ends_with("it is a directory"), "{error}");
    whole::probe(&path.join("below_a_file.exr")).unwrap_err();
    whole::probe(Path::new("")).unwrap_err();
}

#[test]
fn a_read_only_file_is_not_replaced() {
    let (folder, path) = with_old_file();
    let mut permissions = fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).unwrap();
    let error = whole::probe(&path).unwrap_err();
    assert!(error.to_string().ends_with("read-only"), "{error}");
    assert!(exr::write(&path, &picture()).is_err());
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_files(&folder, ["old.exr"]);
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn new_files_have_ordinary_permissions_and_replaced_ones_keep_theirs() {
        let (folder, path) = with_old_file();
        let new = folder.path("new.exr");
        exr::write(&new, &picture()).unwrap();
        assert_eq!(mode(&new), mode(&path));
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        exr::write(&path, &picture()).unwrap();
        assert_eq!(mode(&path), 0o640);
    }

    #[test]
    fn a_symbolic_link_is_followed() {
        let (folder, path) = with_old_file();
        let link = folder.path("link.exr");
        symlink("old.exr", &link).unwrap();
        exr::write(&link, &picture()).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_same(&picture(), &exr::read(&path).unwrap());
        let dangling = folder.path("dangling.exr");
        symlink("nowhere.exr", &dangling).unwrap();
        let error = whole::probe(&dangling).unwrap_err();
        assert!(error.to_string().ends_with("link to nothing"), "{error}");
    }

    /// A superuser may write anywhere, so that this can only be seen by others.
    #[test]
    fn a_directory_that_takes_no_files_is_an_error() {
        let (folder, path) = with_old_file();
        let locked = fs::Permissions::from_mode(0o555);
        fs::set_permissions(folder.path(""), locked).unwrap();
        let superuser = File::create(folder.path("trial")).is_ok();
        if !superuser {
            probe_refused(&path);
            assert!(exr::write(&path, &picture()).is_err());
            assert_eq!(fs::read(&path).unwrap(), b"old");
        }
        let unlocked = fs::Permissions::from_mode(0o755);
        fs::set_permissions(folder.path(""), unlocked).unwrap();
    }

    /// Linux's /proc takes no files from anybody, the superuser included.
    #[test]
    fn a_file_system_that_takes_no_files_is_an_error() {
        if Path::new("/proc/self").is_dir() {
            probe_refused(Path::new("/proc/picture.exr"));
        }
    }

    /// Devices are fed, not replaced; /dev/full says that no space is left.
    #[test]
    fn a_full_device_is_an_error() {
        let (full, null) = (Path::new("/dev/full"), Path::new("/dev/null"));
        if !full.exists() || !null.exists() {
            return;
        }
        exr::write(null, &picture()).unwrap();
        assert!(!fs::metadata(null).unwrap().is_file());
        let error = exr::write(full, &picture()).unwrap_err();
        assert!(is_write(&error, io::ErrorKind::StorageFull), "{error}");
        assert!(error.to_string().contains("/dev/full"), "{error}");
        assert!(png::write_preview(full, 1, 1, &[[0.5; 3]]).is_err());
    }
}

/// Values of the sRGB transfer function, IEC 61966-2-1: mid-grey 0.18 is 117.6 of 255, 0.5 is
/// 187.5 (0.735357 · 255), 0.002 is 6.6 (linear part).
#[test]
fn preview_encodes_srgb() {
    for (linear, byte) in [(0.0, 0), (0.002, 7), (0.18, 118), (0.5, 188)] {
        assert_eq!(png::encode([linear; 3], 1.0), [byte; 3], "{linear}");
    }
    // White lies at 0.9 of the tone curve: 255 · (1.055 · 0.9^(1/2.4) − 0.055) = 243.4.
    assert_eq!(png::encode([1.0; 3], 1.0), [243; 3]);
    assert_eq!(png::encode([f32::MAX; 3], 1.0), [255; 3]);
}

#[test]
fn preview_never_fails_on_odd_colours() {
    assert_eq!(png::encode([f32::NAN, 0.0, 0.0], 1.0), [255, 0, 255]);
    assert_eq!(png::encode([f32::INFINITY; 3], 1.0), [255, 0, 255]);
    assert_eq!(png::encode([-1.0; 3], 1.0), [0; 3]);
    assert_eq!(png::encode([f32::MIN; 3], 1.0), [0; 3]);
    // A spectral green: red becomes 0, the others are mixed with grey; the luminance
    // 0.2126 · (−0.3) + 0.7152 · 0.6 + 0.0722 · 0.1 = 0.37256 stays (to the 8-bit rounding,
    // half a level of at most 0.009 in linear light at its steepest).
    let encoded = png::encode([-0.3, 0.6, 0.1], 1.0);
    assert_eq!(encoded[0], 0);
    let linear = encoded.map(|byte| match f64::from(byte) / 255.0 {
        value if value <= 0.04045 => value / 12.92,
        value => ((value + 0.055) / 1.055).powf(2.4),
    });
    let luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
    assert!((luminance - 0.37256).abs() < 0.0045, "{luminance}");
}

#[test]
fn exposure_follows_the_bright_part_of_the_picture() {
    let with = |value: f32, outliers: usize| {
        let mut pixels = vec![[value; 3]; 200];
        pixels[..outliers].fill([1.0e6; 3]);
        pixels[199] = [f32::NAN; 3];
        png::exposure(&pixels)
    };
    // The luminance weights add up to 1 but for the rounding of their sum and of 1/x.
    let least = f32::from_bits(1);
    for (found, exposure) in [
        (with(4.0, 0), 0.25),
        (with(0.5, 0), 1.0),
        (with(0.018_f32, 0), 0.18 / f64::from(0.018_f32)),
        (with(0.0, 0), 1.0),
        (with(least, 0), 0.18 / f64::from(least)),
        // One pixel in a hundred may be an outlier (of 199 finite ones: 1), two may not.
        (with(0.5, 1), 1.0),
        (with(0.5, 2), 1.0e-6),
        (png::exposure(&[[f32::NAN; 3]]), 1.0),
    ] {
        let allowed = 8.0 * f64::EPSILON * exposure;
        assert!((found - exposure).abs() <= allowed, "{found} {exposure}");
    }
}

#[test]
fn preview_is_a_png_of_the_picture() {
    let (folder, path) = place("preview.png");
    let [red, green, blue] = [0, 1, 2].map(|k| [0, 1, 2].map(|i| if i == k { 0.5 } else { 0.0 }));
    let rgb = [red, green, blue, [0.5; 3], [0.0; 3], [0.18; 3]];
    let exposure = png::write_preview(&path, 3, 2, &rgb).unwrap();
    let decoded = image::open(&path).unwrap().into_rgb8();
    assert_eq!(decoded.dimensions(), (3, 2));
    for (pixel, linear) in decoded.pixels().zip(rgb) {
        assert_eq!(pixel.0, png::encode(linear, exposure));
    }
    assert!(png::write_preview(&path, 3, 3, &rgb).is_err());
    assert!(png::write_preview(&path, 0, 0, &[]).is_err());
    assert_files(&folder, ["preview.png"]);
}

#[test]
fn the_hash_of_scenes_is_sha_256() {
    // FIPS 180-4's example: SHA-256 of "abc".
    let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_eq!(hash("abc"), abc);
}
