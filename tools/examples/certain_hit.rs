//! Intersects rays with implicit surfaces, with certainty: enclosure, multiplicity, arithmetic.
//!
//! Run it with `cargo run --release --example certain_hit`.

use std::error::Error;

use etalon::{DVec3, First, Ray, Scene, Tracer};

/// A torus around z with radii 1 and 1/4, and beside it a wave that is no polynomial.
const SCENE: &str = r#"
camera = { from = [0, 0, 6], to = [0, 0, 0], fov = 30 }
image = { size = [16, 16], spp = 1 }
materials.grey = { diffuse = 0.5 }

[[object]]
name = "torus"
shape = { implicit = "torus" }
material = "grey"

[[object]]
name = "wave"
shape = { implicit = "z - sin(5*x)/10", inside = [[3, -1, -1], [5, 1, 1]] }
material = "grey"
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let tracer = Tracer::new(&Scene::parse(SCENE)?)?;
    let rays = [
        ("through the torus", [-3.0, 0.0, 0.125], DVec3::X),
        ("along the top of the torus", [-3.0, 0.0, 0.25], DVec3::X),
        ("over the torus", [-3.0, 0.0, 0.25 + 1e-16], DVec3::X),
        ("down to the wave", [4.0, 0.0, 3.0], DVec3::NEG_Z),
    ];
    for (what, origin, direction) in rays {
        let origin = DVec3::from_array(origin);
        match tracer.first(Ray { origin, direction }) {
            First::Nothing => println!("{what}: nothing, for certain"),
            First::Undecided(finder) => println!("{what}: the finder {finder} cannot tell"),
            First::Hit(hit) => {
                println!("{what}: {} at t = {}", tracer.name(hit.object), hit.t);
                if let Some(found) = hit.found {
                    let [low, high] = found.enclosure;
                    println!("  t is in [{low:?}, {high:?}], width {:.1e}", high - low);
                    println!("  multiplicity {:?}, {:?}", found.multiplicity, found.tier);
                }
            }
        }
    }
    Ok(())
}
