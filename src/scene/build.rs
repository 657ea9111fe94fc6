//! From the merged tree to a scene.

use std::path::Path;

use glam::DVec3;

use super::fields::{Fields, Item, Report, every, one_of};
use super::implicit::DefaultFinder;
use super::spectra::{self, Spectra};
use super::tree::{Place, Table};
use super::{
    Camera, FinderChoice, Image, Light, PrecisionChoice, Projection, ProjectionKind, SamplerKind,
    Scene, Source, materials, objects, quantities,
};
use crate::declare::{Declaration, Role};
use crate::light::SourceKind;

const TOP_KEYS: &[&str] = &[
    "title",
    "about",
    "camera",
    "image",
    "spectra",
    "materials",
    "object",
    "light",
    "environment",
    "truth",
    "panel",
];

/// Keys of `[image]`, which panels have too.
pub(super) const IMAGE_KEYS: &[&str] = &[
    "size",
    "spp",
    "max_depth",
    "sampler",
    "replicates",
    "seed",
    "precision",
    "wavelengths",
    "finder",
];

/// Reads the whole tree; `None` only if the report has a complaint.
pub(super) fn scene(
    report: &Report,
    base_dir: &Path,
    root: &Table,
    source: Source,
    panel: Option<String>,
) -> Option<Scene> {
    // What is missing from the file as a whole is missing at its end.
    let end = Place::new(0, usize::MAX..usize::MAX);
    let top = Fields::of(report, String::new(), end, root, TOP_KEYS);
    for key in ["title", "about"] {
        top.optional(key, "", |item| item.text());
    }
    let spectra = Spectra::read(report, base_dir, top.get("spectra"));
    let camera = top.required("camera", "a [camera] table", |item| camera(&spectra, item));
    let image = top.required("image", "an [image] table", image);
    let materials = materials::read(&spectra, top.item("materials"));
    let environment = top.maybe("environment", |item| spectra::environment(&spectra, item));
    let truth = top.maybe("truth", |item| spectra.spectrum(&item, Role::Emission));
    // Without a readable table of materials every use of one would be a further complaint.
    let hidden = materials.is_none() || (top.get("materials").is_none() && top.misspelt());
    let materials = materials.unwrap_or_default();
    let (image, finder) = image.unwrap_or((None, (FinderChoice::Auto, None)));
    let objects = objects::read(top.item("object"), &materials.names, hidden, &finder);
    let lights = top.optional("light", Vec::new(), |item| lights(&spectra, &item));
    Some(Scene {
        source,
        panel,
        camera: camera?,
        image: image?,
        materials: materials.checked?,
        objects: objects?,
        lights: lights?,
        environment: environment?,
        truth: truth?,
    })
}

fn camera(spectra: &Spectra<'_>, item: Item<'_>) -> Option<Camera> {
    let view = Camera::VIEW.map(|own| own.key);
    let keys = [&view, ProjectionKind::KEYS, &[Camera::LENS.key]].concat();
    let fields = Fields::open(item, &keys)?;
    let values = quantities::all(spectra, &fields, Camera::VIEW.iter().chain([&Camera::LENS]));
    let projection = projection(spectra, &fields);
    let camera = Camera::new(&values?, projection?)?;
    check_view(&fields, &camera)?;
    Some(camera)
}

fn projection(spectra: &Spectra<'_>, fields: &Fields<'_>) -> Option<Projection> {
    let parameters = || ProjectionKind::ALL.iter().map(|kind| kind.parameter());
    let Some((key, item)) = fields.at_most_one(ProjectionKind::KEYS)? else {
        let ways: Vec<String> = parameters().map(|own| quantities::assigned(&own)).collect();
        let message = format!("camera has neither {}", ProjectionKind::KEYS.join(" nor "));
        return fields.missing(message, &ways.join(", or "));
    };
    let kind = *ProjectionKind::ALL
        .iter()
        .find(|kind| kind.parameter().key == key)?;
    let values = quantities::read(spectra, item, kind.parameter().quantity, &[])?;
    let value = values.first()?.number()?;
    Some(Projection { kind, value })
}

/// The view direction must exist and must not be parallel to `up`.
fn check_view(fields: &Fields<'_>, camera: &Camera) -> Option<()> {
    let Camera { from, to, up, .. } = *camera;
    let fail = |key: &str, message: &str, expected: &str| {
        let place = fields.get(key).map_or(fields.place, |node| node.place);
        fields.report.fail(place, message, expected)
    };
    let view = to - from;
    if view == DVec3::ZERO {
        let expected = "a point that the camera looks at";
        return fail("to", "camera.to is the same point as camera.from", expected);
    }
    if !view.length_squared().is_normal() {
        let message = "the distance from camera.from to camera.to is beyond all measure";
        return fail("to", message, "a distance between 1e-150 and 1e150");
    }
    // Each entry carries a relative rounding error of u = 2^-53 from its decimal form. With
    // m_j = |from_j| + |to_j| the difference view_j is off by 2 u m_j at most, each product of
    // the cross product by 2 u more for `up` (rounded when read and when normalised) and the
    // rounding of product and difference by 2 u: (2 + 2 + 2) u (m_j |up_k| + m_k |up_j|).
    // A cross product within that bound cannot be told from zero.
    let unit = f64::EPSILON / 2.0;
    let size = from.abs() + to.abs();
    let upright = up.abs();
    let bound = DVec3::new(
        size.y * upright.z + size.z * upright.y,
        size.z * upright.x + size.x * upright.z,
        size.x * upright.y + size.y * upright.x,
    ) * (6.0 * unit);
    if view.cross(up).abs().cmple(bound).all() {
        let written = fields.get("up").map_or("to", |_| "up");
        let message = "camera.up is parallel to the view direction";
        return fail(
            written,
            message,
            "up = [x, y, z] that is not along to − from",
        );
    }
    Some(())
}

/// `[image]`: the image, and the finder of objects that name none.
fn image(item: Item<'_>) -> Option<(Option<Image>, DefaultFinder)> {
    let fields = Fields::open(item, IMAGE_KEYS)?;
    let size = fields.required("size", "size = [width, height]", |item| image_size(&item));
    let spp = fields.required("spp", "spp = camera paths per pixel", |item| {
        item.integer(1..=1 << 24)
    });
    let max_depth = fields.maybe("max_depth", |item| item.integer(1..=u32::MAX));
    let sampler = fields.optional("sampler", SamplerKind::Sobol, |item| {
        item.choice(SamplerKind::ALL, SamplerKind::name)
    });
    let replicates = fields.maybe("replicates", |item| item.integer(1..=64));
    let seed = fields.optional("seed", 0, |item| item.integer(0..=i64::MAX as u64));
    let precision = fields.optional("precision", PrecisionChoice::Auto, |item| {
        item.choice(&PrecisionChoice::ALL, PrecisionChoice::name)
    });
    let wavelengths = fields.maybe("wavelengths", |item| match item.integer(1..=64)? {
        count @ (4 | 8) => Some(count),
        count => item.wrong(count, "4 or 8"),
    });
    if let (Some(spp), Some(Some(replicates))) = (spp, replicates)
        && replicates > spp
    {
        // Of the two, the one that was written later broke the rule.
        let places = ["spp", "replicates"].map(|key| fields.get(key).map(|node| node.place));
        let place = places.into_iter().flatten().max().unwrap_or(fields.place);
        let message = format!("image.replicates is {replicates}, but image.spp is {spp}");
        fields
            .report
            .fail::<()>(place, message, "at least one camera path in each replicate");
    }
    let none = (FinderChoice::Auto, None);
    let finder = fields.optional("finder", none, |item| item.finder());
    let image = || {
        Some(Image {
            size: size?,
            spp: spp?,
            max_depth: max_depth?,
            sampler: sampler?,
            replicates: replicates?,
            seed: seed?,
            precision: precision?,
            wavelengths: wavelengths?,
        })
    };
    Some((image(), finder.unwrap_or(none)))
}

fn image_size(item: &Item<'_>) -> Option<[u32; 2]> {
    let [width, height] = item.array("[width, height] in pixels, each from 1 to 65536")?;
    let [width, height] = [width.integer(1..=65536)?, height.integer(1..=65536)?];
    if u64::from(width) * u64::from(height) > 1 << 28 {
        return item.wrong(
            format!("{width} × {height}"),
            "at most 2^28 = 268435456 pixels",
        );
    }
    Some([width, height])
}

fn lights(spectra: &Spectra<'_>, item: &Item<'_>) -> Option<Vec<Light>> {
    let nodes = item.nodes("[[light]] tables")?.iter();
    let items = nodes.map(|node| Item {
        node,
        ..item.clone()
    });
    every(items.map(|item| light(spectra, item)))
}

fn light(spectra: &Spectra<'_>, item: Item<'_>) -> Option<Light> {
    let declarations = || SourceKind::ALL.iter().map(|kind| kind.declaration());
    let main: Vec<&str> = declarations().map(|own| own.main.key).collect();
    let of_kind = |own: Declaration| {
        let beside = own.beside.iter().map(|other| other.key);
        [own.main.key].into_iter().chain(beside)
    };
    let keys: Vec<&str> = declarations().flat_map(of_kind).collect();
    let fields = Fields::open(item, &keys)?;
    let (key, place) = fields.exactly_one(&main)?;
    let of_key = |kind: &&SourceKind| kind.declaration().main.key == key;
    let kind = *SourceKind::ALL.iter().find(of_key)?;
    let own = kind.declaration();
    let own_keys: Vec<&str> = own.beside.iter().map(|own| own.key).collect();
    let allowed = |other: &&&str| main.contains(other) || own_keys.contains(other);
    for other in keys.iter().filter(|other| !allowed(other)) {
        if let Some(entry) = fields.table.entry(other) {
            let message = format!("\"{other}\" contradicts \"{key}\" in light");
            return spectra
                .report
                .fail(entry.key_place, message, one_of(&own_keys));
        }
    }
    let main = quantities::read(spectra, place, own.main.quantity, &[]);
    let beside = quantities::all(spectra, &fields, own.beside);
    let values = [main?, beside?].concat();
    Some(Light { kind, values })
}
