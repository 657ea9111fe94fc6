//! Scene files: what is read, and what is said when something is wrong.

use std::path::Path;

use etalon::inside::declare::Value;
use etalon::inside::light::SourceKind;
use etalon::inside::material::MaterialKind;
use etalon::inside::math::affine::Affine;
use etalon::inside::scene::ProjectionKind::{Orthographic, Perspective};
use etalon::inside::scene::{self, Projection, ProjectionKind, Sides, Surface};
use etalon::inside::spectrum::Spectrum;
use etalon::inside::spectrum::ior::{RefractiveIndex, glass_names, metal_names, named_metal};
use etalon::{Diagnostic, Origin, Overrides, Scene, SceneError};
use glam::DVec3;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::implicit_expression::implicit_of;
use crate::support::{Folder, cube, files};

const GOOD: &str = r#"title = "a good file"
environment = { name = "D65", scale = 2 }

[camera]
from = [0, 1.2, 4]
to = [0, 0.8, 0]
fov = 40
lens = { radius = 0.1, focus = 10.77 }

[image]
size = [700, 500]
spp = 128
max_depth = 32
replicates = 16

[spectra]
paint = { table = [[400, 0.2], [500, 0.4], [700, 0.8]] }
pale = { name = "paint", scale = 0.5 }

[materials]
white = { diffuse = 0.75 }
painted = { diffuse = "paint" }
silver = { mirror = "Ag" }
lossless = { mirror = { ideal = 0.9 } }
measured = { mirror = { n = 0.2, k = 3 } }
glass = { glass = "N-BK7" }
lamp = { emit = { blackbody = 5000, scale = 10 }, sides = "both" }
floor = { checkerboard = [0.2, { rgb = [1, 0.5, 0] }], cell = 0.5 }

[[object]]
name = "box"
shape = { cube = { side = 2 } }
material = "white"
transform = [{ rotate_y = 30 }, { scale = [1, 2, 1] }, { translate = [0, 1, 0] }]

[[object]]
shape = { sphere = { radius = 0.5 } }
material = "glass"

[[light]]
point = [0, 5, 0]
intensity = 10

[[panel]]
name = "a"
size = [100, 100]
spp = 32

[[panel]]
name = "b"
camera = { fov = 20 }
materials = { white = { mirror = "Al" } }
"#;

fn parse(text: &str) -> Result<Scene, SceneError> {
    parse_with(text, None, &[])
}

fn parse_with(text: &str, panel: Option<&str>, set: &[(&str, &str)]) -> Result<Scene, SceneError> {
    let set = set
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
    let options = Overrides {
        panel: panel.map(str::to_owned),
        set: set.collect(),
        finder: None,
    };
    scene::parse("test.toml", text, Path::new(""), &options)
}

/// The good file with one passage replaced; the passage must occur exactly once.
fn changed(passage: &str, replacement: &str) -> String {
    assert_eq!(GOOD.matches(passage).count(), 1, "passage {passage:?}");
    GOOD.replace(passage, replacement)
}

fn diagnostic(result: Result<Scene, SceneError>, case: &str) -> Diagnostic {
    let error = result.err().unwrap_or_else(|| panic!("accepted: {case}"));
    error.diagnostic().expect(case).clone()
}

/// Parses a text in which `«…»` marks what the message must underline, and compares.
fn compare(marked: &str, message: &str, suggestion: Option<&str>) -> Result<(), String> {
    let (before, rest) = marked.split_once('«').unwrap();
    let (inside, after) = rest.split_once('»').unwrap();
    let text = format!("{before}{inside}{after}");
    let found = diagnostic(parse(&text), message);
    let line = before.matches('\n').count() + 1;
    let indent = before.rsplit('\n').next().unwrap().chars().count();
    let wanted = Diagnostic {
        message: message.to_owned(),
        origin: Origin::File("test.toml".to_owned()),
        line,
        column: indent + 1,
        excerpt: text.lines().nth(line - 1).unwrap_or("").to_owned(),
        indent,
        width: inside.lines().next().unwrap_or("").chars().count().max(1),
        expected: found.expected.clone(),
        suggestion: suggestion.map(str::to_owned),
    };
    let right = found == wanted && found.expected.is_some();
    right
        .then_some(())
        .ok_or_else(|| format!("found\n{found}\nwanted\n{wanted}\n"))
}

#[track_caller]
fn check(marked: &str, message: &str) {
    compare(marked, message, None).unwrap_or_else(|difference| panic!("{difference}"));
}

#[test]
fn every_kind_of_mistake_is_shown_with_its_place() {
    // Passage of the good file, its replacement with the place marked, message, suggestion.
    #[rustfmt::skip]
    let cases: &[(&str, &str, &str, Option<&str>)] = &[
        // Names.
        ("fov = 40", "«fvo» = 40", r#"unknown key "fvo" in camera"#, Some("fov")),
        ("[[light]]", "[[«lihgt»]]", r#"unknown key "lihgt""#, Some("light")),
        ("title =", "«tilte» =", r#"unknown key "tilte""#, Some("title")),
        ("radius = 0.1", "«aperture» = 0.1", r#"unknown key "aperture" in camera.lens"#, None),
        ("max_depth", "«maxdepth»", r#"unknown key "maxdepth" in image"#, Some("max_depth")),
        ("{ diffuse = 0.75", "{ «difuse» = 0.75", r#"unknown key "difuse" in materials.white"#, Some("diffuse")),
        ("{ cube = { side", "{ cube = { «sides»", r#"unknown key "sides" in object.shape.cube"#, Some("side")),
        ("{ cube = {", "{ «cueb» = {", r#"unknown key "cueb" in object.shape"#, Some("cube")),
        ("{ rotate_y", "{ «rotatey»", r#"unknown key "rotatey" in object.transform[0]"#, Some("rotate_y")),
        ("material = \"glass\"", "material = «\"glas\"»", r#"the material "glas" is not defined"#, Some("glass")),
        ("mirror = \"Ag\"", "mirror = «\"Agg\"»", r#"materials.silver.mirror names the unknown metal "Agg""#, Some("Ag")),
        ("glass = \"N-BK7\"", "glass = «\"N-BK8\"»", r#"materials.glass.glass names the unknown glass "N-BK8""#, Some("N-BK7")),
        ("diffuse = \"paint\"", "diffuse = «\"piant\"»", r#"materials.painted.diffuse names the unknown spectrum "piant""#, Some("paint")),
        ("name = \"D65\"", "name = «\"D56\"»", r#"environment.name names the unknown spectrum "D56""#, Some("D65")),
        ("name = \"paint\"", "name = «\"pale\"»", r#"spectra.pale.name names the unknown spectrum "pale""#, None),
        ("pale =", "«E» =", r#""E" is the name of a standard spectrum"#, None),
        ("spp = 128", "spp = 128\nsampler = «\"soboll\"»", r#"image.sampler is "soboll""#, Some("sobol")),
        ("sides = \"both\"", "sides = «\"bth\"»", r#"materials.lamp.sides is "bth""#, Some("both")),
        ("{ cube = { side = 2 } }", "«\"shpere\"»", r#"object.shape is "shpere""#, Some("sphere")),
        ("{ cube = { side = 2 } }", "{ implicit = «\"hart\"» }", r#"object.shape.implicit is "hart""#, Some("heart")),
        // Types.
        ("fov = 40", "fov = «\"40\"»", "camera.fov is a string", None),
        ("from = [0, 1.2, 4]", "from = «4»", "camera.from is an integer", None),
        ("from = [0, 1.2, 4]", "from = «[0, 1.2]»", "camera.from has 2 entries", None),
        ("from = [0, 1.2, 4]", "from = [0, «true», 4]", "camera.from[1] is a boolean", None),
        ("lens = { radius = 0.1, focus = 10.77 }", "lens = «1»", "camera.lens is an integer", None),
        ("size = [700, 500]", "size = [«700.5», 500]", "image.size[0] is 700.5", None),
        ("spp = 128", "spp = «1979-05-27»", "image.spp is a date", None),
        ("{ diffuse = 0.75 }", "{ diffuse = «[0.5, 0.5, 0.5]» }", "materials.white.diffuse is an array", None),
        ("title = \"a good file\"", "title = «3»", "title is an integer", None),
        // Missing.
        ("[camera]\nfrom = [0, 1.2, 4]", "«[camera]»", "camera.from is missing", None),
        ("[camera]\nfrom = [0, 1.2, 4]\nto = [0, 0.8, 0]", "«[camera]»\nfrom = [0, 1.2, 4]", "camera.to is missing", None),
        ("lens = { radius = 0.1, focus = 10.77 }", "lens = «{ radius = 0.1 }»", "camera.lens.focus is missing", None),
        ("[image]\nsize = [700, 500]", "«[image]»", "image.size is missing", None),
        ("[[object]]\nshape = { sphere = { radius = 0.5 } }\nmaterial = \"glass\"", "«[[object]]»\nshape = \"sphere\"", "object.material is missing", None),
        ("[[object]]\nshape = { sphere = { radius = 0.5 } }", "«[[object]]»", "object.shape is missing", None),
        ("{ cube = { side = 2 } }", "«{}»", "object.shape does not say what it is", None),
        ("mirror = { n = 0.2, k = 3 }", "mirror = «{ n = 0.2 }»", "materials.measured.mirror.k is missing", None),
        ("{ name = \"paint\", scale = 0.5 }", "«{ scale = 0.5 }»", "spectra.pale does not say what it is", None),
        ("[[light]]\npoint = [0, 5, 0]\nintensity = 10", "«[[light]]»\npoint = [0, 5, 0]", "light.intensity is missing", None),
        ("[[panel]]\nname = \"a\"", "«[[panel]]»", "panel.name is missing", None),
        // Contradictions.
        ("fov = 40", "fov = 40\n«orthographic» = 2", r#""orthographic" contradicts "fov" in camera"#, None),
        ("{ cube = { side = 2 } }", "{ cube = {}, «sphere» = {} }", r#""sphere" contradicts "cube" in object.shape"#, None),
        ("{ cube = { side = 2 } }", "{ cube = { side = 1, «size» = [1, 1, 1] } }", r#""size" contradicts "side" in object.shape.cube"#, None),
        ("{ diffuse = 0.75 }", "{ diffuse = 0.75, «mirror» = \"Ag\" }", r#""mirror" contradicts "diffuse" in materials.white"#, None),
        ("{ diffuse = 0.75 }", "{ diffuse = 0.75, «sides» = \"both\" }", "materials.white.sides without emit", None),
        ("{ diffuse = 0.75 }", "{ diffuse = 0.75, «cell» = 1 }", "materials.white.cell without a checkerboard", None),
        ("{ diffuse = 0.75 }", "{ black = «false» }", "materials.white.black is not true", None),
        ("{ ideal = 0.9 }", "{ ideal = 0.9, «k» = 1 }", r#""k" contradicts "ideal" in materials.lossless.mirror"#, None),
        ("{ blackbody = 5000, scale = 10 }", "{ blackbody = 5000, «constant» = 10 }", r#""constant" contradicts "blackbody" in materials.lamp.emit"#, None),
        ("intensity = 10", "«irradiance» = 10", r#""irradiance" contradicts "point" in light"#, None),
        ("{ rotate_y = 30 }", "{ rotate_y = 30, «scale» = 2 }", r#""scale" contradicts "rotate_y" in object.transform[0]"#, None),
        // Twice.
        ("shape = { sphere = { radius = 0.5 } }", "name = «\"box\"»\nshape = \"sphere\"", r#"the object name "box" is used twice"#, None),
        ("name = \"b\"", "name = «\"a\"»", r#"the panel name "a" is used twice"#, None),
        // Numbers.
        ("fov = 40", "fov = «nan»", "camera.fov is NaN", None),
        ("from = [0, 1.2, 4]", "from = [0, «-inf», 4]", "camera.from[1] is infinite", None),
        ("spp = 128", "spp = «nan»", "image.spp is NaN", None),
        ("spp = 128", "spp = «0»", "image.spp is 0", None),
        ("spp = 128", "spp = «16777217»", "image.spp is 16777217", None),
        ("fov = 40", "fov = «180»", "camera.fov is 180", None),
        ("fov = 40", "orthographic = «0»", "camera.orthographic is 0", None),
        ("focus = 10.77", "focus = «0»", "camera.lens.focus is 0", None),
        ("radius = 0.1,", "radius = «-0.1»,", "camera.lens.radius is -0.1", None),
        ("to = [0, 0.8, 0]", "to = «[0, 1.2, 4]»", "camera.to is the same point as camera.from", None),
        ("to = [0, 0.8, 0]", "to = «[0, 0.8, 4]»", "camera.up is parallel to the view direction", None),
        ("fov = 40", "up = «[0, 0.1, 1]»\nfov = 40", "camera.up is parallel to the view direction", None),
        ("fov = 40", "up = «[0, 0, 0]»\nfov = 40", "camera.up is the zero vector", None),
        ("to = [0, 0.8, 0]", "to = «[1e200, 0, 0]»", "the distance from camera.from to camera.to is beyond all measure", None),
        ("size = [700, 500]", "size = [«0», 500]", "image.size[0] is 0", None),
        ("size = [700, 500]", "size = [700, «65537»]", "image.size[1] is 65537", None),
        ("size = [700, 500]", "size = «[65536, 4097]»", "image.size is 65536 × 4097", None),
        ("size = [700, 500]", "size = «[700]»", "image.size has 1 entries", None),
        ("max_depth = 32", "max_depth = «0»", "image.max_depth is 0", None),
        ("replicates = 16", "replicates = «65»", "image.replicates is 65", None),
        ("spp = 128", "spp = 128\nwavelengths = «5»", "image.wavelengths is 5", None),
        ("spp = 128", "spp = 128\nseed = «-1»", "image.seed is -1", None),
        ("spp = 128", "spp = 128\nprecision = «\"f46\"»", r#"image.precision is "f46""#, Some("f64")),
        ("{ diffuse = 0.75 }", "{ diffuse = «1.01» }", "materials.white.diffuse is 1.01", None),
        ("{ diffuse = 0.75 }", "{ diffuse = «-0.1» }", "materials.white.diffuse is -0.1", None),
        ("{ diffuse = 0.75 }", "{ diffuse = «{ rgb = [0.5, 0.5, 1.5] }» }", "materials.white.diffuse has the colour component 1.5", None),
        ("{ diffuse = \"paint\" }", "{ diffuse = «{ name = \"paint\", scale = 2 }» }", "materials.painted.diffuse has the value 1.6", None),
        ("{ diffuse = \"paint\" }", "{ diffuse = «\"D65\"» }", "materials.painted.diffuse has the value 1.1913462151148917", None),
        ("{ ideal = 0.9 }", "{ ideal = «1.5» }", "materials.lossless.mirror.ideal is 1.5", None),
        ("[0.2, { rgb", "[«2», { rgb", "materials.floor.checkerboard[0] is 2", None),
        ("], cell = 0.5", "], cell = «0»", "materials.floor.cell is 0", None),
        ("n = 0.2", "n = «0»", "materials.measured.mirror.n is 0", None),
        ("k = 3", "k = «-3»", "materials.measured.mirror.k is -3", None),
        ("scale = 10", "scale = «inf»", "materials.lamp.emit.scale is infinite", None),
        ("blackbody = 5000", "blackbody = «0»", "materials.lamp.emit.blackbody is 0", None),
        ("emit = { blackbody = 5000, scale = 10 }", "emit = «-1»", "materials.lamp.emit is -1", None),
        ("{ name = \"D65\", scale = 2 }", "«{ name = \"D65\", scale = -2 }»", "environment has the value -2.3826924302297834", None),
        ("intensity = 10", "intensity = «-10»", "light.intensity is -10", None),
        ("point = [0, 5, 0]\nintensity = 10", "direction = «[0, 0, 0]»\nirradiance = 1", "light.direction is the zero vector", None),
        ("glass = { glass = \"N-BK7\" }", "glass = { glass = { ior = «0.9» } }", "materials.glass.glass.ior is 0.9", None),
        ("glass = { glass = \"N-BK7\" }", "glass = { glass = { ior = «nan» } }", "materials.glass.glass.ior is NaN", None),
        ("glass = { glass = \"N-BK7\" }", "glass = { glass = { cauchy = «[0.9, 0.01]» } }", "materials.glass.glass.cauchy has n = 0.9771604938271605 at 360 nm", None),
        ("glass = { glass = \"N-BK7\" }", "glass = { glass = { cauchy = «[1.5]» } }", "materials.glass.glass.cauchy has 1 entries", None),
        ("glass = { glass = \"N-BK7\" }", "glass = { glass = { sellmeier = «{ b = [1, 0, 0], c = [0.25, 0, 0] }» } }", "materials.glass.glass.sellmeier has a resonance at 500.0 nm", None),
        // Tables.
        ("[[400, 0.2], [500, 0.4], [700, 0.8]]", "«[]»", "spectra.paint.table is empty", None),
        ("[[400, 0.2], [500, 0.4], [700, 0.8]]", "«[[400, 0.2]]»", "spectra.paint.table has only one sample", None),
        ("[500, 0.4]", "«[400, 0.4]»", "spectra.paint.table[1]: the wavelength 400 nm follows 400 nm", None),
        ("[400, 0.2]", "«[-1, 0.2]»", "spectra.paint.table[0]: the wavelength -1 nm is not positive", None),
        ("[500, 0.4]", "[500, «nan»]", "spectra.paint.table[1][1] is NaN", None),
        ("[500, 0.4]", "«[500]»", "spectra.paint.table[1] has 1 entries", None),
        // Shapes and transforms.
        ("radius = 0.5", "radius = «-0.5»", "object.shape.sphere.radius is -0.5", None),
        ("{ cube = { side = 2 } }", "{ cube = { size = [1, «0», 1] } }", "object.shape.cube.size[1] is 0", None),
        ("{ cube = { side = 2 } }", "{ cylinder = { height = «-1» } }", "object.shape.cylinder.height is -1", None),
        ("{ cube = { side = 2 } }", "{ rectangle = { size = «[1]» } }", "object.shape.rectangle.size has 1 entries", None),
        ("{ cube = { side = 2 } }", "{ plane = { «radius» = 1 } }", r#"unknown key "radius" in object.shape.plane"#, None),
        ("{ cube = { side = 2 } }", "{ implicit = \"heart\", inside = «[[1, 0, 0], [1, 1, 1]]» }", "object.shape.inside is a box without inside", None),
        ("{ cube = { side = 2 } }", "{ implicit = \"heart\", steps = «0» }", "object.shape.steps is 0", None),
        ("{ cube = { side = 2 } }", "{ implicit = \"heart\", inside = «[[-1e308, 0, 0], [1e308, 1, 1]]» }", "object.shape.inside is a box beyond all measure", None),
        ("{ cube = { side = 2 } }", "{ implicit = \"heart\", inside = [[«nan», 0, 0], [1, 1, 1]] }", "object.shape.inside[0][0] is NaN", None),
        ("{ cube = { side = 2 } }", "{ implicit = \"heart\", inside = [[0, 0, 0], [1, «inf», 1]] }", "object.shape.inside[1][1] is infinite", None),
        ("{ cube = { side = 2 } }", "{ implicit = \"heart\", closed = «1» }", "object.shape.closed is an integer", None),
        ("{ cube = { side = 2 } }", "{ implicit = \"heart\", finder = «\"intervall\"» }", r#"object.shape.finder is "intervall""#, Some("interval")),
        ("{ cube = { side = 2 } }", "{ implicit = \"torus\", parameters = { «minr» = 0.1 } }", r#""minr" is no parameter of torus"#, Some("minor")),
        ("{ cube = { side = 2 } }", "{ implicit = \"torus\", parameters = { minor = «nan» } }", "object.shape.parameters.minor is NaN", None),
        ("{ cube = { side = 2 } }", "{ implicit = \"torus\", parameters = { minor = \"1/«x»\" } }", r#"the coordinate "x" in a constant"#, None),
        ("{ cube = { side = 2 } }", "{ implicit = \"x^2 - a\", parameters = { «pi» = 0.1 }, inside = [[0, 0, 0], [1, 1, 1]] }", r#"the name "pi" means something already"#, None),
        ("scale = [1, 2, 1]", "scale = [1, «0», 1]", "object.transform[1].scale[1] is 0", None),
        ("scale = [1, 2, 1]", "scale = «0»", "object.transform[1].scale is 0", None),
        ("scale = [1, 2, 1]", "shear = «{}»", "object.transform[1].shear is empty", None),
        ("scale = [1, 2, 1]", "shear = { «xx» = 1 }", r#"unknown key "xx" in object.transform[1].shear"#, Some("xy")),
        ("scale = [1, 2, 1]", "rotate = { axis = «[0, 0, 0]», angle = 1 }", "object.transform[1].rotate.axis is the zero vector", None),
        ("scale = [1, 2, 1]", "matrix = «[[1, 0, 0, 0]]»", "object.transform[1].matrix has 1 rows", None),
        ("scale = [1, 2, 1]", "matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], «[0, 0, 1, 1]»]", "the last row of object.transform[1].matrix is not [0, 0, 0, 1]", None),
        ("[{ rotate_y = 30 }, { scale = [1, 2, 1] }, { translate = [0, 1, 0] }]", "«[{ matrix = [[1, 2, 3, 0], [4, 5, 6, 0], [7, 8, 9, 0]] }]»", "the object's matrix is singular", None),
        ("[{ rotate_y = 30 }, { scale = [1, 2, 1] }, { translate = [0, 1, 0] }]", "«[{ scale = 1e-200 }, { scale = 1e-200 }]»", "the object's matrix is singular", None),
        ("[{ rotate_y = 30 }, { scale = [1, 2, 1] }, { translate = [0, 1, 0] }]", "«[{ scale = 1e200 }, { scale = 1e200 }]»", "the object's matrix has entries that are infinite", None),
        // Panels are checked although none was asked for.
        ("size = [100, 100]", "size = [100, «0»]", "image.size[1] is 0", None),
        ("spp = 32", "«ssp» = 32", r#"unknown key "ssp" in panel"#, Some("spp")),
        ("camera = { fov = 20 }", "camera = { «fovv» = 20 }", r#"unknown key "fovv" in camera"#, Some("fov")),
        ("{ white = { mirror = \"Al\" } }", "{ white = { mirror = «\"All\"» } }", r#"materials.white.mirror names the unknown metal "All""#, Some("Al")),
        // TOML itself.
        ("title = \"a good file\"", "title = \"a good file«»", "invalid basic string", None),
        ("fov = 40", "fov = 40\n«fov» = 41", "duplicate key", None),
    ];
    let difference = |(passage, replacement, message, suggestion): &(&str, &str, &str, _)| {
        compare(&changed(passage, replacement), message, *suggestion).err()
    };
    let differences: Vec<String> = cases.iter().filter_map(difference).collect();
    assert!(differences.is_empty(), "{}", differences.join("\n"));
    let floor = changed("{ checkerboard", "«{ checkerboard").replace("], cell = 0.5 }", "] }»");
    check(&floor, "materials.floor.cell is missing");
    let few = changed("spp = 128", "spp = 8").replace("replicates = 16", "replicates = «16»");
    check(&few, "image.replicates is 16, but image.spp is 8");
    check("«»", "camera is missing");
    check("a = [1,«»", "unclosed array");
    check("camera = «3»\n", "camera is an integer");
}

#[test]
fn the_first_mistake_in_the_file_is_the_one_shown() {
    let text = changed("spp = 128", "spp = 0").replace("radius = 0.5", "radius = -1");
    assert_eq!(diagnostic(parse(&text), "spp").message, "image.spp is 0");
    // The object stands before the materials here.
    let text = "[[object]]\nshape = \"spher\"\nmaterial = \"m\"\n[materials]\nm = { diffuse = 2 }";
    let text = format!("{text}\n[camera]\n[image]");
    assert_eq!(diagnostic(parse(&text), "order").line, 2);
}

#[test]
fn messages_look_like_those_of_rustc() {
    let text = changed("fov = 40", "\tfvo = 40 # degrees\r");
    assert_eq!(
        parse(&text).unwrap_err().to_string(),
        r#"unknown key "fvo" in camera
 --> test.toml:7:2
  |
7 |  fvo = 40 # degrees
  |  ^^^
  = expected: one of "from", "to", "up", "fov", "orthographic", "lens"
  = help: did you mean "fov"?"#
    );
}

#[test]
fn long_lines_are_cut_and_control_characters_are_not_shown() {
    let [title, key] = ["é", "y"].map(|letter| letter.repeat(9000));
    let text = format!("title = \"{title}\" # \u{9b}\nx{key} = 1");
    let found = diagnostic(parse(&text), "long");
    assert!(found.excerpt.chars().count() <= 160);
    assert!(found.indent + found.width <= 160);
    let text = "title = \"\" \u{1b}[31m";
    let shown = parse(text).unwrap_err().to_string();
    assert!(!shown.contains('\u{1b}'), "{shown:?}");
}

#[test]
fn a_good_file_is_read_as_written() {
    let scene = parse(GOOD).unwrap();
    assert_eq!(scene.camera.from, DVec3::new(0.0, 1.2, 4.0));
    assert_eq!(scene.camera.up, DVec3::Y);
    assert_eq!(scene.camera.projection, projection(Perspective, 40.0));
    assert_eq!(scene.camera.lens.unwrap().focus, 10.77);
    assert_eq!(scene.image.size, [700, 500]);
    assert_eq!(scene.image.max_depth, Some(32));
    assert_eq!(scene.image.seed, 0);
    assert_eq!(scene.environment, Some(Spectrum::d65(2.0)));
    assert_eq!(scene.materials[0].name, "white");
    assert_eq!(scene.materials.len(), 8);
    let lamp = &scene.materials[6].value;
    assert_eq!(lamp.surface.kind, MaterialKind::Black);
    assert_eq!(lamp.emission.as_ref().unwrap().sides, Sides::Both);
    let [n, k] = [0.2, 3.0].map(Spectrum::Constant);
    let measured = RefractiveIndex::Complex { n, k };
    for (place, index) in [(2, named_metal("Ag").unwrap()), (4, measured)] {
        assert_eq!(scene.materials[place].value.surface, conductor(index));
    }
    assert_eq!(scene.objects[0].name, "box");
    assert_eq!(scene.objects[1].name, "sphere #1");
    assert_eq!(scene.objects[1].value.material, 5);
    assert_eq!(scene.objects[1].value.size, DVec3::splat(0.5));
    assert_eq!(scene.lights[0].kind, SourceKind::Point);
    let point = Value::Point(DVec3::new(0.0, 5.0, 0.0));
    assert_eq!(scene.lights[0].values[0], point);
    assert_eq!(scene.source.text, GOOD);
    assert_eq!(scene.panel, None);
}

fn projection(kind: ProjectionKind, value: f64) -> Projection {
    Projection { kind, value }
}

fn surface(kind: MaterialKind, value: Value) -> Surface {
    let values = vec![value];
    Surface { kind, values }
}

fn conductor(index: RefractiveIndex) -> Surface {
    surface(MaterialKind::Conductor, Value::Index(index))
}

#[test]
fn panels_are_laid_over_the_file() {
    assert_eq!(scene::panel_names("test.toml", GOOD).unwrap(), ["a", "b"]);
    let a = parse_with(GOOD, Some("a"), &[]).unwrap();
    assert_eq!((a.image.size, a.image.spp), ([100, 100], 32));
    assert_eq!(a.image.max_depth, Some(32));
    assert_eq!(a.panel.as_deref(), Some("a"));
    // The mirror takes the place of the diffuse surface.
    let b = parse_with(GOOD, Some("b"), &[]).unwrap();
    assert_eq!(b.camera.projection, projection(Perspective, 20.0));
    assert!(b.camera.lens.is_some());
    let aluminium = conductor(named_metal("Al").unwrap());
    assert_eq!(b.materials[0].value.surface, aluminium);
    let wrong = diagnostic(parse_with(GOOD, Some("B1"), &[]), "panel");
    assert_eq!(wrong.message, r#"there is no panel "B1""#);
    assert_eq!(wrong.origin, Origin::Panel);
    assert_eq!(wrong.suggestion.as_deref(), Some("b"));
    // What a panel brings may be missing from the file's own scene, if a panel is asked for.
    let incomplete = changed("size = [700, 500]\n", "");
    assert!(parse_with(&incomplete, Some("a"), &[]).is_err(), "panel b");
    let incomplete = incomplete.replace("name = \"b\"\n", "name = \"b\"\nsize = [1, 1]\n");
    assert!(parse_with(&incomplete, Some("a"), &[]).is_ok());
    assert!(parse_with(&incomplete, None, &[]).is_err());
}

#[test]
fn set_lays_values_over_the_file_and_the_panel() {
    let set = [
        ("camera.lens.radius", "0.3"),
        ("image.sampler", "independent"),
        ("object.0.material", "silver"),
        ("materials.\"white\".mirror", "{ ideal = 0.5 }"),
        ("image.spp", "64"),
        ("panel.0.size", "[3, 4]"),
        ("environment", "0.25"),
    ];
    let scene = parse_with(GOOD, Some("a"), &set).unwrap();
    assert_eq!(scene.camera.lens.unwrap().radius, 0.3);
    assert_eq!(scene.image.spp, 64);
    assert_eq!(scene.image.size, [3, 4]);
    assert_eq!(scene.objects[0].value.material, 2);
    assert_eq!(scene.environment, Some(Spectrum::Constant(0.25)));
    let half = Value::Spectrum(Spectrum::Constant(0.5));
    let mirror = surface(MaterialKind::Mirror, half);
    assert_eq!(scene.materials[0].value.surface, mirror);
    let camera = |key, value| parse_with(GOOD, None, &[(key, value)]).unwrap().camera;
    assert_eq!(camera("camera.lens.radius", "0").lens, None);
    let parallel = projection(Orthographic, 2.0);
    assert_eq!(camera("camera.orthographic", "2").projection, parallel);

    #[rustfmt::skip]
    let cases = [
        ("camera.lens.radius", "-1", 20, "camera.lens.radius is -1", None),
        ("camera.lens.raduis", "1", 1, r#"unknown key "raduis" in camera.lens"#, Some("radius")),
        ("image.spp", "[1", 11, "not a value: unclosed array, expected `]`", None),
        ("image.spp", "1\nseed = 2", 11, "the argument holds more than one value", None),
        ("image.spp.more", "1", 1, "image.spp is an integer and has no keys", None),
        ("object.7.material", "white", 1, r#"object has no entry "7""#, None),
        ("object.0.material", "whit", 19, r#"the material "whit" is not defined"#, Some("white")),
        ("image..spp", "1", 1, r#""image..spp" is not a path"#, None),
        ("image.size", "[0, 1]", 13, "image.size[0] is 0", None),
    ];
    for (key, value, column, message, suggestion) in cases {
        let found = diagnostic(parse_with(GOOD, None, &[(key, value)]), message);
        assert_eq!(found.message, message);
        assert_eq!((found.line, found.column), (1, column), "{message}");
        assert_eq!(found.origin, Origin::Set);
        assert_eq!(found.suggestion.as_deref(), suggestion, "{message}");
    }
}

/// Where the box of the good file is.
const TRANSFORM: &str = "[{ rotate_y = 30 }, { scale = [1, 2, 1] }, { translate = [0, 1, 0] }]";

/// The matrix of an object with this shape and transform.
fn placed(shape: &str, transform: &str) -> Affine {
    let text = changed("{ cube = { side = 2 } }", shape).replace(TRANSFORM, transform);
    parse(&text).unwrap().objects[0].value.to_world
}

fn bits(affine: &Affine) -> [[u64; 4]; 3] {
    affine.rows.map(|row| row.map(f64::to_bits))
}

#[test]
fn quarter_turns_are_exact() {
    for turns in -9..=9_i32 {
        let degrees = 90 * turns;
        let (c, s) = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
            [usize::try_from(turns.rem_euclid(4)).unwrap()];
        // Adding 0 makes −0 to 0.
        let m = -s + 0.0;
        let x = [[1.0, 0.0, 0.0, 0.0], [0.0, c, m, 0.0], [0.0, s, c, 0.0]];
        let y = [[c, 0.0, s, 0.0], [0.0, 1.0, 0.0, 0.0], [m, 0.0, c, 0.0]];
        let z = [[c, m, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        for (name, axis, rows) in [
            ("x", [3, 0, 0], x),
            ("y", [0, 3, 0], y),
            ("z", [0, 0, 3], z),
        ] {
            for turn in [
                format!("rotate_{name} = {degrees}"),
                format!("rotate = {{ axis = {axis:?}, angle = {degrees}.0 }}"),
            ] {
                let turned = placed("\"cube\"", &format!("[{{ {turn} }}]"));
                assert_eq!(bits(&turned), bits(&Affine { rows }), "{turn}");
            }
        }
    }
    for (angle, row, half) in [(210, 1, -0.5), (-60, 0, 0.5)] {
        let third = placed("\"cube\"", &format!("[{{ rotate_z = {angle} }}]"));
        assert_eq!(third.rows[row][0], half);
    }
}

#[test]
fn a_lone_matrix_arrives_bit_for_bit() {
    let matrix = "[[0.1, -0.0, 5e-324, 1e300], [0.30000000000000004, 3, -0.0, -0.0], [1, 2, 7, 8]";
    for end in ["]", ", [0, 0, 0, 1]]"] {
        let affine = placed("\"cube\"", &format!("[{{ matrix = {matrix}{end} }}]"));
        let middle = [0.300_000_000_000_000_04, 3.0, -0.0, -0.0];
        let rows = [[0.1, -0.0, 5e-324, 1e300], middle, [1.0, 2.0, 7.0, 8.0]];
        assert_eq!(bits(&affine), bits(&Affine { rows }));
    }
}

#[test]
fn transforms_act_in_the_order_written_after_size_and_centre() {
    let affine = placed(
        "{ sphere = { radius = 2, center = [1, 0, 0] } }",
        "[{ rotate_z = 90 }, { translate = [0, 0, 5] }, { scale = [1, 1, -2] }, { shear = { xy = 3 } }]",
    );
    // Centre (1, 0, 0) → (0, 1, 0) → (0, 1, 5) → (0, 1, −10) → (3, 1, −10).
    assert_eq!(affine.point(DVec3::ZERO), DVec3::new(3.0, 1.0, -10.0));
    // Canonical x of radius 2 → 2 y → 6 x + 2 y.
    assert_eq!(affine.vector(DVec3::X), DVec3::new(6.0, 2.0, 0.0));
    assert_eq!(placed("\"sphere\"", "[]"), Affine::IDENTITY);
}

#[test]
fn singular_is_decided_exactly() {
    // Not singular: the determinant is 2^-52 · 2^-104.
    let near = "[[1, 1, 0, 0], [1, 1.0000000000000002, 0, 0], [0, 0, 4.930380657631324e-32, 0]]";
    placed("\"cube\"", &format!("[{{ matrix = {near} }}]"));
    // Entries whose products under- and overflow.
    let wide = "[[5e-324, 0, 0, 0], [0, 5e-324, 0, 0], [0, 0, 1.7e308, 0]]";
    placed("\"cube\"", &format!("[{{ matrix = {wide} }}]"));
    // Singular: proportional rows; and a third row that is the sum of the others, with products
    // beyond 2^53, so that they are rounded in floating point.
    for matrix in [
        "[[0.1, 0.2, 0.3, 0], [0.2, 0.4, 0.6, 0], [1, 5, 7, 0]]",
        "[[94906267, 94906265, 3, 0], [94906269, 94906264, 7, 0], [189812536, 189812529, 10, 0]]",
    ] {
        let text = changed(TRANSFORM, &format!("«[{{ matrix = {matrix} }}]»"));
        check(&text, "the object's matrix is singular");
    }
}

#[test]
fn sizes_and_defaults_of_shapes() {
    #[rustfmt::skip]
    let cases = [
        ("\"sphere\"", [1.0, 1.0, 1.0]),
        ("{ sphere = { radius = 3 } }", [3.0, 3.0, 3.0]),
        ("\"cube\"", [1.0, 1.0, 1.0]),
        ("{ cube = {} }", [1.0, 1.0, 1.0]),
        ("{ cube = { side = 3 } }", [1.5, 1.5, 1.5]),
        ("{ cube = { size = [1, 2, 4] } }", [0.5, 1.0, 2.0]),
        ("\"cylinder\"", [1.0, 1.0, 1.0]),
        ("{ cylinder = { radius = 2, height = 6 } }", [2.0, 2.0, 3.0]),
        ("{ disk = { radius = 4 } }", [4.0, 4.0, 1.0]),
        ("{ rectangle = { size = [4, 6] } }", [2.0, 3.0, 1.0]),
        ("{ plane = {} }", [1.0, 1.0, 1.0]),
        ("{ implicit = \"mitchell\" }", [1.0, 1.0, 1.0]),
    ];
    for (shape, size) in cases {
        let scene = parse(&changed("{ cube = { side = 2 } }", shape)).unwrap();
        assert_eq!(scene.objects[0].value.size.to_array(), size, "{shape}");
        let placed = placed(shape, "[]");
        assert_eq!(placed, Affine::scale(DVec3::from_array(size)), "{shape}");
    }
    let heart = "{ implicit = \"heart\", steps = 7 }";
    let mut scene = parse(&changed("{ cube = { side = 2 } }", heart)).unwrap();
    let heart = implicit_of(scene.objects.remove(0).value.shape);
    assert_eq!((heart.inside, heart.steps), (cube(1.5), 7));
}

#[test]
fn spectra_in_every_form() {
    let spectrum = |form: &str| {
        let text = changed("intensity = 10", &format!("intensity = {form}"));
        let scene = parse(&text).unwrap();
        scene.lights[0].spectrum().unwrap().clone()
    };
    let (kelvin, scale) = (3000.0, 1.0);
    let lamp = Spectrum::Blackbody { kelvin, scale };
    let rgb = Spectrum::rgb_emission([0.5, 1.0, 1.5]).unwrap();
    for (form, wanted) in [
        ("\"E\"", Spectrum::Constant(1.0)),
        ("{ constant = 0.5, scale = 4 }", Spectrum::Constant(2.0)),
        ("\"D65\"", Spectrum::d65(1.0)),
        ("{ blackbody = 3000 }", lamp),
        ("{ rgb = [1, 2, 3], scale = 0.5 }", rgb),
    ] {
        assert_eq!(spectrum(form), wanted, "{form}");
    }
    let (nm, values) = ([400.0, 500.0, 700.0], [0.1, 0.2, 0.4]);
    assert!(matches!(spectrum("\"pale\""), Spectrum::Table(t) if t.nm == nm && t.values == values));
    let day = "environment = { name = \"D65\", scale = 2 }";
    let day = parse(&changed(day, "environment.radiance = 3")).unwrap();
    assert_eq!(day.environment, Some(Spectrum::Constant(3.0)));
}

#[test]
fn data_files_are_found_beside_the_scene() {
    let table = "{ table = [[400, 0.2], [500, 0.4], [700, 0.8]] }";
    let folder = Folder::new(&changed(table, "{ csv = \"paint.csv\" }"));
    let csv = |text: &str| folder.write("paint.csv", text);
    let load = || Scene::load(folder.path("scene.toml"));

    csv("# source\nnm,value\n400,0.25\n700,0.5\n");
    let painted = &load().unwrap().materials[1].value.surface.values;
    assert!(
        matches!(&painted[..], [Value::Spectrum(Spectrum::Table(t))] if t.values == [0.25, 0.5])
    );
    for (bad, part) in [
        ("", "at least one sample"),
        ("400,0.5\n", "only one sample"),
        ("400,0.5\n300,0.5\n", "line 2"),
        ("400,0.5\n500,nan\n", "line 2"),
        ("0,0.5\n500,1\n", "not positive"),
    ] {
        csv(bad);
        let found = diagnostic(load(), bad);
        assert_eq!((found.line, found.column), (17, 17), "{bad:?}");
        assert!(found.message.contains(part), "{}", found.message);
    }
    // A file that is not there is shown where it is named.
    let pale = "{ name = \"paint\", scale = 0.5 }";
    let text = changed(pale, "{ csv = \"no/such.csv\" }");
    let found = diagnostic(parse(&text), "csv");
    assert_eq!((found.line, found.column), (18, 16));
    // The rest of the message is the operating system's.
    let words = "spectra.pale.csv: cannot read no/such.csv: ";
    assert!(found.message.starts_with(words), "{}", found.message);
}

#[test]
fn files_that_cannot_be_scenes() {
    let folder = Folder::empty();
    let load = |file: &str| Scene::load(folder.path(file)).unwrap_err();
    assert!(matches!(load(""), SceneError::Directory { .. }));
    assert!(matches!(load("s.toml"), SceneError::Unreadable { .. }));
    folder.write("s.toml", b"title = \"ok\"\nabout = \"\xff\"\n");
    let error = load("s.toml");
    let found = error.diagnostic().unwrap();
    assert_eq!((found.line, found.column), (2, 10));
    assert_eq!(found.message, "not UTF-8 text");
    let file = std::fs::File::create(folder.path("s.toml")).unwrap();
    file.set_len(scene::LARGEST_FILE + 1).unwrap();
    assert!(matches!(load("s.toml"), SceneError::TooLarge { .. }));
    // A byte order mark is no part of the first line.
    folder.write("s.toml", "\u{feff}titel = 1");
    assert_eq!(load("s.toml").diagnostic().unwrap().column, 1);
}

#[test]
fn the_scenes_that_come_with_the_project_are_valid() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut scenes = files(&folder);
    scenes.retain(|name| name.ends_with(".toml"));
    assert!(!scenes.is_empty());
    for name in scenes {
        Scene::load(folder.join(name)).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn the_format_reference_is_valid_and_names_every_medium() {
    let text = include_str!("../scenes/README.md");
    let (_, rest) = text.split_once("```toml\n").unwrap();
    let (example, _) = rest.split_once("```").unwrap();
    parse(example).unwrap_or_else(|error| panic!("{error}"));
    for name in glass_names().chain(metal_names()) {
        assert!(text.contains(&format!("`\"{name}\"`")), "{name}");
    }
}

/// Whatever the text, there is a scene or a message about a place inside the text.
fn survives(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    if let Err(error) = parse(&text) {
        let shown = error.to_string();
        let found = error.diagnostic().unwrap();
        assert!(shown.starts_with(&found.message), "{shown}");
        let lines = text.matches('\n').count() + 1;
        assert!((1..=lines).contains(&found.line), "{shown}");
        assert!(found.column >= 1 && found.width >= 1, "{shown}");
    }
}

#[test]
fn damaged_files_never_panic() {
    let bytes = GOOD.as_bytes();
    for length in 0..bytes.len() {
        survives(&bytes[..length]);
    }
    let mut random = Pcg64::seed_from_u64(1);
    let pieces = b"nan -inf { } [ ] \" \n = 1e308 -0 \xf0\x9f".split(|byte| *byte == b' ');
    let pieces: Vec<&[u8]> = pieces.collect();
    for _ in 0..3000 {
        let mut damaged = bytes.to_vec();
        for _ in 0..random.random_range(1..4) {
            let at = random.random_range(0..damaged.len());
            match random.random_range(0..4) {
                0 => damaged[at] = (random.next_u32() & 0xff) as u8,
                1 => drop(damaged.remove(at)),
                2 => {
                    let end = (at + random.random_range(1..20)).min(damaged.len());
                    damaged.drain(at..end);
                }
                _ => {
                    let piece = pieces[random.random_range(0..pieces.len())];
                    damaged.splice(at..at, piece.iter().copied());
                }
            }
        }
        survives(&damaged);
    }
}
