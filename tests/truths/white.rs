//! White furnaces: whatever loses nothing is invisible, whichever camera looks.

use glam::DVec3;

use super::harness::Case;
use super::scenes::Text;

const RADIANCE: f64 = 1.5;

fn cameras() -> Vec<(&'static str, Text)> {
    let from = DVec3::new(2.0, 3.0, 5.0);
    let lens = Text::lens(from, -from, DVec3::Y, 30.0, [0.3, 5.0]);
    vec![
        ("pinhole", Text::perspective(from, -from, 30.0)),
        ("lens", lens),
        ("orthographic", Text::orthographic(from, -from, 3.0)),
    ]
}

pub fn cases() -> Vec<Case> {
    let materials = [
        ("diffuse", "diffuse = 1"),
        ("mirror", "mirror = { ideal = 1 }"),
        ("glass", "glass = { ior = 1.6 }"),
        ("dispersive glass", "glass = \"N-SF11\""),
        ("checkerboard", "checkerboard = [1, 1], cell = 0.25"),
    ];
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let lying = [0.4 * x, 0.5 * z, -0.4 * y];
    let mut cases = Vec::new();
    for (camera, text) in cameras() {
        for (name, material) in materials {
            // Convex and, between the bodies, concave: light goes from one to the other.
            let scene = text
                .clone()
                .size([16, 16])
                .material("body", material)
                .object("cube = { side = 1 }", "body")
                .sphere("body", 0.6, DVec3::new(1.2, 0.1, 0.0))
                .placed("cylinder = {}", "body", lying, DVec3::new(0.0, 1.05, 0.1))
                .environment(RADIANCE);
            let name = format!("white {name}, {camera}");
            cases.push(Case::new(name, scene, RADIANCE));
        }
    }
    // A hollow: a tube of diffuse disks and squares seen from its mouth.
    for sampler in ["sobol", "stratified", "independent"] {
        let hollow = Text::perspective(DVec3::new(0.1, 0.2, 4.0), -z, 30.0)
            .image(&format!("sampler = \"{sampler}\""))
            .material("wall", "diffuse = 1")
            .rectangle("wall", x, z, y)
            .rectangle("wall", x, z, -y)
            .rectangle("wall", y, z, x)
            .rectangle("wall", y, z, -x)
            .rectangle("wall", x, y, -z)
            .environment(RADIANCE);
        let name = format!("white hollow, {sampler}");
        cases.push(Case::new(name, hollow, RADIANCE));
    }
    cases
}
