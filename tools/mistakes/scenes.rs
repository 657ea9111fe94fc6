//! Small scenes in which small mistakes are large: a closed room multiplies what is wrong with its
//! walls, a blurred spot shows the square of the lens's radius, and so on. Each takes a few
//! hundredths of a second.

use etalon::Scene;

/// Name and text of each scene; `image` has no samples, which are planned.
pub const SCENES: &[(&str, &str)] = &[
    ("closed room", CLOSED_ROOM),
    ("slanting sun", SLANTING_SUN),
    ("metal at 60 degrees", METAL),
    ("metal balls", METAL_BALLS),
    ("blurred spot", BLURRED_SPOT),
    ("five segments", FIVE_SEGMENTS),
    ("sheared cards", SHEARED_CARDS),
    ("two lamps", TWO_LAMPS),
];

/// L = E/(1 − ρ): half a per cent more of the walls' ρ = 0.8 is two per cent more light.
const CLOSED_ROOM: &str = r#"
camera = { from = [0, 0, 0.9], to = [0.2, 0.1, 0], fov = 70 }
image = { size = [24, 24], spp = 1 }
materials.wall = { diffuse = 0.8, emit = 0.2, sides = "back" }
materials.ball = { diffuse = 0.6 }
object = [
    { shape = "cube", material = "wall" },
    { shape = { sphere = { radius = 0.3, center = [0.2, 0.1, -0.3] } }, material = "ball" },
]
"#;

/// Radiance is ρ/π · E · cos 60°.
const SLANTING_SUN: &str = r#"
camera = { from = [0, 3, 0], to = [0, 0, 0], up = [0, 0, 1], orthographic = 2 }
image = { size = [24, 24], spp = 1, max_depth = 2 }
materials.floor = { diffuse = { rgb = [0.6, 0.4, 0.3] } }
object = [{ shape = { rectangle = { size = [9, 9] } }, material = "floor", transform = [{ rotate_x = -90 }] }]
[[light]]
direction = [0.8660254037844386, -0.5, 0]
irradiance = "D65"
"#;

/// All rays meet the mirror at 60°.
const METAL: &str = r#"
environment = "D65"
camera = { from = [0, 0, 5], to = [0, 0, 0], orthographic = 1 }
image = { size = [24, 24], spp = 1 }
materials.metal = { mirror = "Al" }
object = [{ shape = { rectangle = { size = [10, 10] } }, material = "metal", transform = [{ rotate_y = 60 }] }]
"#;

/// Metal under all angles.
const METAL_BALLS: &str = r#"
environment = "D65"
camera = { from = [0, 0, 6], to = [0, 0, 0], fov = 24 }
image = { size = [24, 24], spp = 1, max_depth = 3 }
materials.aluminium = { mirror = "Al" }
materials.copper = { mirror = "Cu" }
object = [
    { shape = { sphere = { radius = 0.6, center = [-0.6, 0, 0] } }, material = "aluminium" },
    { shape = { sphere = { radius = 0.6, center = [0.6, 0, 0] } }, material = "copper" },
]
"#;

/// A lamp far behind the plane of focus: a spot whose area grows as the radius squared. The picture
/// lies where all of the lamp is seen.
const BLURRED_SPOT: &str = r#"
camera = { from = [0, 0, 0], to = [0, 0, 1], fov = 0.5, lens = { radius = 0.2, focus = 2 } }
image = { size = [24, 24], spp = 1 }
materials.lamp = { emit = { blackbody = 4000, scale = 1e-3 }, sides = "both" }
object = [{ shape = { disk = { radius = 0.15 } }, material = "lamp", transform = [{ translate = [0, 0, 4] }] }]
"#;

/// E (1 + ρ + ρ² + ρ³ + ρ⁴) inside a closed sphere.
const FIVE_SEGMENTS: &str = r#"
camera = { from = [0, 0, 0], to = [0, 0, 1], fov = 60 }
image = { size = [24, 24], spp = 1, max_depth = 5 }
materials.wall = { diffuse = 0.7, emit = 0.3, sides = "back" }
object = [{ shape = "sphere", material = "wall" }]
"#;

/// Cards and a block under shear, lit by a lamp.
const SHEARED_CARDS: &str = r#"
camera = { from = [0, 2, 6], to = [0, 0.3, 0], fov = 30 }
image = { size = [24, 24], spp = 1, max_depth = 3 }
materials.paper = { diffuse = 0.7 }
materials.block = { diffuse = { rgb = [0.7, 0.4, 0.2] } }
materials.lamp = { emit = 3, sides = "front" }
[[object]]
shape = { rectangle = { size = [3, 3] } }
material = "paper"
transform = [{ shear = { zx = 0.4, zy = 0.2 } }, { rotate_x = -60 }]
[[object]]
shape = { cube = { side = 0.8 } }
material = "block"
transform = [{ shear = { xy = 0.5, zx = 0.3 } }, { translate = [0, 0.9, 0.3] }]
[[object]]
shape = { rectangle = { size = [2, 2] } }
material = "lamp"
transform = [{ rotate_x = 90 }, { translate = [0.5, 4, 2] }]
"#;

/// Two lamps of unequal power, each over its own half of the floor.
const TWO_LAMPS: &str = r#"
camera = { from = [0, 5, 0], to = [0, 0, 0], up = [0, 0, 1], orthographic = 4 }
image = { size = [24, 24], spp = 1, max_depth = 2 }
materials.left = { diffuse = 0.5 }
materials.right = { diffuse = 0.5 }
[[object]]
shape = { rectangle = { size = [4, 8] } }
material = "left"
transform = [{ rotate_x = -90 }, { translate = [-2, 0, 0] }]
[[object]]
shape = { rectangle = { size = [4, 8] } }
material = "right"
transform = [{ rotate_x = -90 }, { translate = [2, 0, 0] }]
[[light]]
point = [-1.2, 1.5, 0]
intensity = 1
[[light]]
point = [1.2, 1.5, 0]
intensity = 1.5
"#;

pub fn scene(text: &str) -> Scene {
    Scene::parse(text).unwrap_or_else(|error| panic!("{error}"))
}
