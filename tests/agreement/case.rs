//! A scene, and what is asked about its pictures.

use std::path::{Path, PathBuf};

use etalon::inside::compare::Channel;
use etalon::inside::film::names;
use etalon::inside::film::pixels::Estimate;
use etalon::inside::film::spectral::channel_name;
use etalon::inside::render::trace::first_hits;
use etalon::inside::render::{Request, Unwatched, render};
use etalon::inside::scene::load;
use etalon::{BinGrid, Instructions, Overrides, Plan, Rendered, Scene, Side, Singular, Window};

/// Independent scrambles per pixel: they cost little of the points' quality, and three degrees of
/// freedom in each pixel are many in a block.
const REPLICATES: u32 = 4;
/// Fewest pixels of a region.
const LEAST_PIXELS: usize = 16;

#[derive(Debug)]
pub struct Case {
    pub name: String,
    pub scene: Scene,
    /// Bands of wavelengths to be judged besides R, G, B.
    pub bands: Option<BinGrid>,
    /// Parts of the picture.
    pub regions: Vec<Region>,
}

/// The pixels whose centres show a material.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Region {
    pub name: String,
    pub pixels: Vec<usize>,
}

pub type CaseError = Box<dyn std::error::Error>;

impl Case {
    pub fn new(name: &str, mut scene: Scene, bands: Option<BinGrid>) -> Result<Self, Singular> {
        scene.image.replicates = Some(REPLICATES);
        let names = scene.materials.iter().map(|material| material.name.clone());
        let regions = names.map(|name| Region {
            name,
            pixels: Vec::new(),
        });
        let mut regions: Vec<Region> = regions.collect();
        let whole = Window::whole(scene.image.size);
        let hits = first_hits(&scene, whole, Instructions::best())?;
        for (pixel, hit) in hits.iter().enumerate() {
            if let Some(hit) = hit {
                let material = scene.objects[hit.object].value.material;
                regions[material].pixels.push(pixel);
            }
        }
        regions.retain(|region| region.pixels.len() >= LEAST_PIXELS);
        Ok(Self {
            name: name.to_owned(),
            scene,
            bands,
            regions,
        })
    }

    /// The case that a reference is of; its scene file is looked for from `root`.
    pub fn of_reference(name: &str, reference: &Side, root: &Path) -> Result<Self, CaseError> {
        let file = reference
            .text("sceneFile")
            .ok_or("no attribute sceneFile")?;
        let set = reference.text("overrides").unwrap_or("");
        let overrides = Overrides {
            panel: reference.text("panel").map(str::to_owned),
            set: Overrides::pairs(set),
            finder: None,
        };
        let scene = load(&root.join(file), &overrides)?;
        Ok(Self::new(name, scene, bands(reference)?)?)
    }

    /// Plans and renders it.
    pub fn render(&self, spp: u32, seed: u64) -> Result<Side, CaseError> {
        let mut scene = self.scene.clone();
        (scene.image.spp, scene.image.seed) = (spp, seed);
        let plan = Plan::new(&scene, false)?;
        self.rendered(&plan, spp)
    }

    /// Renders a plan made of its scene.
    pub fn rendered(&self, plan: &Plan, spp: u32) -> Result<Side, CaseError> {
        let request = Request {
            bins: self.bands.as_ref(),
            ..Request::whole(self.scene.image.size, spp)
        };
        let rendered = render(plan, &request, &mut Unwatched);
        match rendered.not_a_number {
            0 => Ok(self.side(&rendered)),
            count => Err(format!("{}: {count} samples are not numbers", self.name).into()),
        }
    }

    fn side(&self, rendered: &Rendered) -> Side {
        let rgb = rendered.rgb();
        let colours = names::RGB.iter().enumerate();
        let mut channels: Vec<Channel> = colours.map(|(i, name)| channel(name, &rgb, i)).collect();
        if let Some(grid) = &self.bands {
            for (bin, nm) in grid.centres().iter().enumerate() {
                let estimates = rendered.bin(bin).unwrap_or_default();
                channels.push(channel(&channel_name(*nm), &estimates, 0));
            }
        }
        let [width, height] = self.scene.image.size.map(|n| n as usize);
        Side {
            path: PathBuf::from(&self.name),
            width,
            height,
            channels,
            freedom: Some(f64::from(REPLICATES - 1)),
            attributes: Vec::new(),
        }
    }
}

fn channel<const N: usize>(name: &str, estimates: &[Estimate<N>], index: usize) -> Channel {
    let variance = |e: &Estimate<N>| e.standard_error[index] * e.standard_error[index];
    Channel {
        name: name.to_owned(),
        values: estimates.iter().map(|e| e.mean[index]).collect(),
        variances: Some(estimates.iter().map(variance).collect()),
    }
}

/// The bands of a reference, whose attribute lists the ends of each in nm; they must be neighbours
/// of equal width.
fn bands(reference: &Side) -> Result<Option<BinGrid>, CaseError> {
    let Some(text) = reference.text("bands") else {
        return Ok(None);
    };
    let ends: Vec<[f64; 2]> = serde_json::from_str(text)?;
    let ([low, high], [last_low, last_high]) = match (ends.first(), ends.last()) {
        (Some(first), Some(last)) => (*first, *last),
        _ => return Ok(None),
    };
    let width = high - low;
    let equal = ends.iter().all(|[low, high]| high - low == width);
    if !equal || ends.windows(2).any(|pair| pair[0][1] != pair[1][0]) {
        return Err("the bands are no neighbours of equal width".into());
    }
    let centres = [(low + high) / 2.0, (last_low + last_high) / 2.0];
    Ok(Some(BinGrid::new(centres[0], centres[1], width)?))
}
