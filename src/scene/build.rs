//! From the merged tree to the parts of a scene.

use std::path::Path;

use glam::DVec3;

use super::fields::{Complaint, Fields, Report};
use super::spectra::{self, Spectra};
use super::tree::{Node, Place, Table, Value};
use super::{
    Camera, FinderChoice, Image, Lens, Light, Material, Named, Object, PrecisionChoice, Projection,
    SamplerKind, materials, objects,
};
use crate::declare::Role;
use crate::spectrum::Spectrum;

/// What panels can change.
pub(super) struct Look {
    pub camera: Camera,
    pub image: Image,
    pub materials: Vec<Named<Material>>,
    pub environment: Option<Spectrum>,
    pub truth: Option<Spectrum>,
}

/// A scene but for its source.
pub(super) struct Parts {
    pub look: Look,
    pub objects: Vec<Named<Object>>,
    pub lights: Vec<Light>,
}

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

const VECTOR: &str = "an array of 3 finite numbers";

/// Reads the whole tree; `None` only if the report has a complaint.
pub(super) fn scene(report: &Report, base_dir: &Path, root: &Table) -> Option<Parts> {
    // What is missing from the file as a whole is missing at its end.
    let end = Place {
        origin: 0,
        start: usize::MAX,
        end: usize::MAX,
    };
    let top = Fields::of(report, String::new(), end, root, TOP_KEYS);
    for key in ["title", "about"] {
        top.optional(key, "", |what, node| report.text(what, node));
    }
    let spectra = Spectra::read(report, base_dir, top.get("spectra"));
    let camera = top.required("camera", "a [camera] table", |_, node| camera(report, node));
    let image = top.required("image", "an [image] table", |_, node| image(report, node));
    let materials = materials::read(&spectra, top.get("materials"));
    let environment = spectra::environment(&spectra, root);
    let truth = top.optional("truth", None, |what, node| {
        spectra.spectrum(what, node, Role::Emission).map(Some)
    });
    // Without a readable table of materials every use of one would be a further complaint.
    let hidden = materials.is_none() || (top.get("materials").is_none() && top.misspelt());
    let materials = materials.unwrap_or_default();
    let finder = finder(top.get("image"));
    let objects = objects::read(report, top.get("object"), &materials.names, hidden, &finder);
    let lights = lights(&spectra, top.get("light"));
    Some(Parts {
        look: Look {
            camera: camera?,
            image: image?,
            materials: materials.checked?,
            environment: environment?,
            truth: truth?,
        },
        objects: objects?,
        lights: lights?,
    })
}

fn camera(report: &Report, node: &Node) -> Option<Camera> {
    let keys = ["from", "to", "up", "fov", "orthographic", "lens"];
    let fields = Fields::open(report, "camera", node, &keys)?;
    let from = fields.required("from", VECTOR, |what, node| report.vector(what, node));
    let to = fields.required("to", VECTOR, |what, node| report.vector(what, node));
    let up = fields.optional("up", DVec3::Y, |what, node| report.direction(what, node));
    let projection = projection(&fields);
    let lens = fields.optional("lens", None, |_, node| lens(report, node));
    let camera = Camera {
        from: from?,
        to: to?,
        up: up?,
        projection: projection?,
        lens: lens?,
    };
    check_view(&fields, &camera)?;
    Some(camera)
}

fn projection(fields: &Fields<'_>) -> Option<Projection> {
    let report = fields.report;
    match fields.at_most_one(&["fov", "orthographic"])? {
        Some(("fov", node)) => {
            let expected = "an angle between 0 and 180 degrees";
            let inside = |angle| angle > 0.0 && angle < 180.0;
            let fov = report.number_that("camera.fov", node, expected, inside)?;
            Some(Projection::Perspective { fov })
        }
        Some((_, node)) => {
            let height = report.positive("camera.orthographic", node)?;
            Some(Projection::Orthographic { height })
        }
        None => fields.missing(
            "camera has neither fov nor orthographic".to_owned(),
            "fov = degrees, or orthographic = height",
        ),
    }
}

fn lens(report: &Report, node: &Node) -> Option<Option<Lens>> {
    let fields = Fields::open(report, "camera.lens", node, &["radius", "focus"])?;
    let radius = fields.required("radius", "radius = number", |what, node| {
        report.number_that(what, node, "a number of at least 0", |x| x >= 0.0)
    });
    let focus = fields.required("focus", "focus = distance", |what, node| {
        report.positive(what, node)
    });
    let (radius, focus) = (radius?, focus?);
    Some((radius > 0.0).then_some(Lens { radius, focus }))
}

/// The view direction must exist and must not be parallel to `up`.
fn check_view(fields: &Fields<'_>, camera: &Camera) -> Option<()> {
    let Camera { from, to, up, .. } = *camera;
    let place = |key: &str| fields.get(key).map_or(fields.place, |node| node.place);
    let view = to - from;
    if view == DVec3::ZERO {
        let complaint = Complaint::new(place("to"), "camera.to is the same point as camera.from");
        return fields
            .report
            .fail(complaint.expected("a point that the camera looks at"));
    }
    if !view.length_squared().is_normal() {
        let message = "the distance from camera.from to camera.to is beyond all measure";
        let complaint = Complaint::new(place("to"), message);
        return fields
            .report
            .fail(complaint.expected("a distance between 1e-150 and 1e150"));
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
        let written = if fields.get("up").is_some() {
            "up"
        } else {
            "to"
        };
        let message = "camera.up is parallel to the view direction";
        let complaint = Complaint::new(place(written), message);
        return fields
            .report
            .fail(complaint.expected("up = [x, y, z] that is not along to − from"));
    }
    Some(())
}

fn image(report: &Report, node: &Node) -> Option<Image> {
    let fields = Fields::open(report, "image", node, IMAGE_KEYS)?;
    let size = fields.required("size", "size = [width, height]", |what, node| {
        image_size(report, what, node)
    });
    let spp = fields.required("spp", "spp = camera paths per pixel", |what, node| {
        report.count(what, node, 1..=1 << 24)
    });
    let max_depth = fields.optional("max_depth", None, |what, node| {
        report.count(what, node, 1..=u32::MAX).map(Some)
    });
    let sampler = fields.optional("sampler", SamplerKind::Sobol, |what, node| {
        let choices = SamplerKind::ALL
            .iter()
            .map(|kind| (kind.name(), *kind))
            .collect::<Vec<_>>();
        report.choice(what, node, &choices)
    });
    let replicates = fields.optional("replicates", None, |what, node| {
        report.count(what, node, 1..=64).map(Some)
    });
    let seed = fields.optional("seed", 0, |what, node| {
        let seed = report.integer(what, node, 0..=i64::MAX)?;
        u64::try_from(seed).ok()
    });
    let precision = fields.optional("precision", PrecisionChoice::Auto, |what, node| {
        let choices = [
            ("auto", PrecisionChoice::Auto),
            ("f32", PrecisionChoice::F32),
            ("f64", PrecisionChoice::F64),
        ];
        report.choice(what, node, &choices)
    });
    let wavelengths = fields.optional("wavelengths", None, |what, node| {
        let count = report.count(what, node, 1..=64)?;
        if count == 4 || count == 8 {
            return Some(Some(count));
        }
        report.fail(Complaint::new(node.place, format!("{what} is {count}")).expected("4 or 8"))
    });
    if let (Some(spp), Some(Some(replicates))) = (spp, replicates)
        && replicates > spp
    {
        // Of the two, the one that was written later broke the rule.
        let places = ["spp", "replicates"].map(|key| fields.get(key).map(|node| node.place));
        let place = places.into_iter().flatten().max().unwrap_or(fields.place);
        let message = format!("image.replicates is {replicates}, but image.spp is {spp}");
        report.add(
            Complaint::new(place, message).expected("at least one camera path in each replicate"),
        );
    }
    // Objects have it; here it only must be one.
    fields.optional("finder", FinderChoice::Auto, |what, node| {
        report.choice(what, node, FinderChoice::NAMES)
    })?;
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
}

/// The finder of objects that name none, and where the file says so.
fn finder(image: Option<&Node>) -> (FinderChoice, Option<Place>) {
    let written = match image.map(|node| &node.value) {
        Some(Value::Table(table)) => table.get("finder"),
        _ => None,
    };
    let known = |node: &Node| match &node.value {
        Value::Text(text) => FinderChoice::NAMES.iter().find(|(name, _)| name == text),
        _ => None,
    };
    match written.and_then(|node| Some((known(node)?.1, node.place))) {
        Some((finder, place)) => (finder, Some(place)),
        None => (FinderChoice::Auto, None),
    }
}

fn image_size(report: &Report, what: &str, node: &Node) -> Option<[u32; 2]> {
    let expected = "[width, height] in pixels, each from 1 to 65536";
    let nodes = report.list(what, node, expected)?;
    let [width, height] = nodes else {
        let message = format!("{what} has {} entries", nodes.len());
        return report.fail(Complaint::new(node.place, message).expected(expected));
    };
    let width = report.count(&format!("{what}[0]"), width, 1..=65536)?;
    let height = report.count(&format!("{what}[1]"), height, 1..=65536)?;
    if u64::from(width) * u64::from(height) > 1 << 28 {
        let message = format!("{what} is {width} × {height}");
        return report
            .fail(Complaint::new(node.place, message).expected("at most 2^28 = 268435456 pixels"));
    }
    Some([width, height])
}

fn lights(spectra: &Spectra<'_>, node: Option<&Node>) -> Option<Vec<Light>> {
    let Some(node) = node else {
        return Some(Vec::new());
    };
    let nodes = spectra.report.list("light", node, "[[light]] tables")?;
    let lights: Vec<Option<Light>> = nodes.iter().map(|node| light(spectra, node)).collect();
    lights.into_iter().collect()
}

fn light(spectra: &Spectra<'_>, node: &Node) -> Option<Light> {
    let report = spectra.report;
    let keys = ["point", "intensity", "direction", "irradiance"];
    let fields = Fields::open(report, "light", node, &keys)?;
    let (kind, place) = fields.exactly_one(&["point", "direction"])?;
    let (amount, other) = if kind == "point" {
        ("intensity", "irradiance")
    } else {
        ("irradiance", "intensity")
    };
    if let Some(entry) = fields.table.entry(other) {
        let message = format!("\"{other}\" contradicts \"{kind}\" in light");
        report.add(Complaint::new(entry.key_place, message).expected(format!("\"{amount}\"")));
        return None;
    }
    let spectrum = fields.required(amount, &format!("{amount} = spectrum"), |what, node| {
        spectra.spectrum(what, node, Role::Emission)
    });
    if kind == "point" {
        let at = report.vector("light.point", place);
        Some(Light::Point {
            at: at?,
            intensity: spectrum?,
        })
    } else {
        let direction = report.direction("light.direction", place);
        Some(Light::Directional {
            direction: direction?,
            irradiance: spectrum?,
        })
    }
}
