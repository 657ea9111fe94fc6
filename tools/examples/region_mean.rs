//! Renders a described scene and reads mean ± standard error of a region.
//!
//! The room's walls emit 1/2 and reflect 1/2, so every point of them shows 1/2 + 1/4 + … = 1.
//!
//! Run it with `cargo run --release --example region_mean`.

use std::error::Error;

use etalon::{Render, Scene, Window};

const SCENE: &str = r#"
camera = { from = [0, 0, 0], to = [0, 0, -1], fov = 60 }
image = { size = [64, 48], spp = 64 }
materials.wall = { diffuse = 0.5, emit = 0.5, sides = "back" }

[[object]]
shape = { cube = { size = [4, 3, 5] } }
material = "wall"
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let rendered = Render::new(Scene::parse(SCENE)?)?.run();
    let region = Window {
        x0: 24,
        y0: 16,
        x1: 40,
        y1: 32,
    };
    let mean = rendered.mean(region)?;
    println!("pixels {region}, {} samples each", rendered.samples);
    println!("luminance  {}", mean.luminance);
    for (name, value) in ["R", "G", "B"].into_iter().zip(mean.rgb) {
        println!("{name}          {value}");
    }
    let off = mean.luminance.score(1.0);
    println!("the luminance is {off:+.2} standard errors off 1");
    Ok(())
}
