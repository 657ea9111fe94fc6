//! Renders a scene with two samplers and asks whether noise explains how the pictures differ.
//!
//! Run it with `cargo run --release --example two_pictures`.

use std::error::Error;

use etalon::{Comparison, Picture, Render, Scene};

/// A ball in the light of a lamp, 256 paths a pixel.
fn picture(sampler: &str, albedo: f64) -> Result<Picture, Box<dyn Error>> {
    let scene = Scene::parse(&format!(
        r#"
        camera = {{ from = [0, 1, 6], to = [0, 0, 0], fov = 30 }}
        image = {{ size = [48, 48], spp = 256, sampler = "{sampler}" }}
        materials.ball = {{ diffuse = {albedo} }}
        materials.lamp = {{ emit = {{ blackbody = 5000, scale = 1e-3 }} }}

        [[object]]
        shape = "sphere"
        material = "ball"

        [[object]]
        shape = "disk"
        material = "lamp"
        transform = [{{ rotate_x = 90 }}, {{ translate = [1, 4, 2] }}]
        "#
    ))?;
    let render = Render::new(scene)?;
    Ok(render.picture(&render.run())?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let reference = picture("sobol", 0.5)?;
    for (what, other) in [
        ("another sampler", picture("independent", 0.5)?),
        ("a ball 2 % brighter", picture("independent", 0.51)?),
    ] {
        let comparison = Comparison::of(&other, &reference)?;
        let judgement = comparison.judgement.ok_or("no variances are known")?;
        let noise = if judgement.consistent { "" } else { "not " };
        println!("{what}: {noise}explained by noise");
        for channel in judgement.channels {
            println!(
                "  {}: {:+.2} % ± {:.2} % of the reference",
                channel.channel,
                100.0 * channel.relative_bias,
                100.0 * channel.standard_error
            );
        }
    }
    Ok(())
}
