//! Where a picture comes from: enough to make it again, and what is known about its error.

use sha2::{Digest, Sha256};

use super::Attribute;

/// What is written into every picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Provenance {
    /// Version of etalon.
    pub version: String,
    /// Path of the scene file as given.
    pub scene_path: String,
    /// The scene file's whole text.
    pub scene_text: String,
    /// The panel that was chosen.
    pub panel: Option<String>,
    /// Seed of all randomness.
    pub seed: u64,
    /// Camera paths per pixel that were reached.
    pub spp: u64,
    /// Name of the sampler.
    pub sampler: String,
    /// Independent scrambles per pixel.
    pub replicates: u32,
    /// Arithmetic of the path loop.
    pub precision: String,
    /// Wavelengths per path.
    pub wavelengths: u32,
    /// The plan in words.
    pub plan: String,
    /// Longest path in segments; `None` is no limit.
    pub max_depth: Option<u32>,
    /// Time spent rendering, seconds.
    pub seconds: f64,
    /// Camera paths per second.
    pub samples_per_second: f64,
    /// Samples that were not a number and were left out.
    pub nan_count: u64,
    /// Standard error of the picture's mean luminance, in the unit of the picture.
    pub standard_error: Option<f64>,
    /// Share of the energy that `max_depth` cut off, in [0, 1], as far as it is known.
    pub energy_cut: Option<f64>,
    /// Names of lights that were left out.
    pub lights_left_out: Vec<String>,
}

impl Provenance {
    /// The attributes of a file. What is `None` is absent, but an absent limit of the path length
    /// is said as the text "unlimited"; whole numbers that need more than 31 bits, and the seed
    /// always, are decimal text.
    #[must_use]
    pub fn attributes(&self) -> Vec<(String, Attribute)> {
        let mut list = List::default();
        list.text("etalonVersion", &self.version);
        list.text("sceneFile", &self.scene_path);
        list.text("sceneHash", &hash(&self.scene_text));
        list.text("sceneText", &self.scene_text);
        if let Some(panel) = &self.panel {
            list.text("panel", panel);
        }
        list.text("seed", &self.seed.to_string());
        list.count("spp", self.spp);
        list.text("sampler", &self.sampler);
        list.count("replicates", self.replicates.into());
        list.text("precision", &self.precision);
        list.count("wavelengths", self.wavelengths.into());
        list.text("plan", &self.plan);
        match self.max_depth {
            Some(depth) => list.count("maxDepth", depth.into()),
            None => list.text("maxDepth", "unlimited"),
        }
        list.double("seconds", Some(self.seconds));
        list.double("samplesPerSecond", Some(self.samples_per_second));
        list.count("nanCount", self.nan_count);
        list.double("standardError", self.standard_error);
        list.double("energyCutByMaxDepth", self.energy_cut);
        // Some readers drop empty texts, and "none" is an answer.
        let none = self.lights_left_out.is_empty();
        let lights = if none {
            "none".to_owned()
        } else {
            self.lights_left_out.join(", ")
        };
        list.text("lightsLeftOut", &lights);
        list.0
    }
}

/// SHA-256 (FIPS 180-4) of a text's UTF-8 bytes, 64 hexadecimal digits.
#[must_use]
pub fn hash(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Attributes in the making.
#[derive(Default)]
struct List(Vec<(String, Attribute)>);

impl List {
    fn text(&mut self, name: &str, value: &str) {
        let value = Attribute::Text(value.to_owned());
        self.0.push((name.to_owned(), value));
    }

    fn count(&mut self, name: &str, value: u64) {
        self.0
            .push((name.to_owned(), Attribute::whole_number(value)));
    }

    fn double(&mut self, name: &str, value: Option<f64>) {
        let value = value.map(Attribute::Double);
        self.0.extend(value.map(|value| (name.to_owned(), value)));
    }
}
