//! The pictures of a scene, as hashes of their bits.

use std::fmt;

use etalon::{Picture, Values};
use sha2::{Digest, Sha256};

use super::binary::Binary;
use super::scenes::Variant;
use super::table::Kind;

/// The table of all pictures, of whose columns the first four name the picture.
pub const TABLE: Kind = Kind {
    file: "pixels.csv",
    columns: &["scene", "panel", "rendering", "precision", "sha256"],
    keys: 4,
};

/// Pixels of the longer side.
const LONGEST: u32 = 40;
/// Camera paths a pixel.
const SAMPLES: &str = "8";
/// Ways of rendering each scene and their arguments: all that is known of first hits, spectra with
/// the smaller count of wavelengths, and everything in the loop.
const RENDERINGS: [(&str, &str); 3] = [
    (
        "first-hits",
        "--layers depth,normal,object,material --wavelengths 8",
    ),
    ("spectral", "--layers spectral:410-770:60 --wavelengths 4"),
    (
        "full",
        "--plan full --layers depth,normal,object,material --wavelengths 8",
    ),
];
/// Arithmetic of the loop.
const PRECISIONS: [&str; 2] = ["f32", "f64"];
/// Hexadecimal digits that are kept of a hash: 64 bits, against accidents.
const DIGITS: usize = 16;

#[derive(Debug)]
pub struct Job<'a> {
    variant: &'a Variant,
    rendering: &'static str,
    options: &'static str,
    precision: &'static str,
}

pub fn jobs(variant: &Variant) -> impl Iterator<Item = Job<'_>> {
    let job = move |(rendering, options)| {
        PRECISIONS.map(|precision| Job {
            variant,
            rendering,
            options,
            precision,
        })
    };
    RENDERINGS.into_iter().flat_map(job)
}

impl Job<'_> {
    /// The picture's hash with each instruction set.
    pub fn hashes(&self, binary: &Binary) -> Result<Hashes, String> {
        let [width, height] = self.variant.size;
        let longest = width.max(height);
        let small = |side: u32| (side * LONGEST.min(longest) / longest).max(1);
        let size = format!("{}x{}", small(width), small(height));
        let sets = binary.sets.iter().map(|&set| {
            let mut arguments = self.variant.arguments();
            let (options, precision) = (self.options, self.precision);
            let options = format!(
                "{options} --size {size} --spp {SAMPLES} --precision {precision} --instructions {set}"
            );
            arguments.extend(options.split(' ').map(str::to_owned));
            Ok((set, hash(&binary.render(&arguments)?)))
        });
        sets.collect::<Result<_, String>>().map(Hashes)
    }

    pub fn row(&self, hashes: &Hashes) -> Vec<String> {
        let ways = [self.rendering.to_owned(), self.precision.to_owned()];
        let key = self.variant.key().into_iter().chain(ways);
        key.chain([hashes.to_string()]).collect()
    }
}

/// Instruction sets and the picture's hash with each.
pub struct Hashes(Vec<(&'static str, String)>);

impl Hashes {
    /// Whether all are one.
    pub fn agree(&self) -> bool {
        self.0.iter().all(|(_, hash)| *hash == self.0[0].1)
    }
}

impl fmt::Display for Hashes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.agree() {
            return write!(f, "{}", self.0[0].1);
        }
        let each = self.0.iter().map(|(set, hash)| format!("{hash} ({set})"));
        write!(f, "{}", each.collect::<Vec<_>>().join(", "))
    }
}

/// Of the channels in the order of their names: the name, a line break, the type of the values, a
/// line break, and the bits of the values from the least significant byte.
fn hash(picture: &Picture) -> String {
    let mut channels: Vec<_> = picture.channels.iter().collect();
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    let mut digest = Sha256::new();
    for channel in channels {
        let (kind, bits): (_, Vec<u32>) = match &channel.values {
            Values::F32(values) => ("f32", values.iter().map(|v| v.to_bits()).collect()),
            Values::U32(values) => ("u32", values.clone()),
        };
        digest.update(format!("{}\n{kind}\n", channel.name));
        bits.iter()
            .for_each(|bits| digest.update(bits.to_le_bytes()));
    }
    let bytes = digest.finalize();
    let bytes = bytes.iter().take(DIGITS / 2);
    bytes.map(|byte| format!("{byte:02x}")).collect()
}
