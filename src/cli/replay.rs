//! `etalon replay`: one camera path, step by step.

use etalon::inside::integrate::chunk::Request;
use etalon::inside::integrate::replay::{LightVertex, Replayed, Vertex};
use etalon::inside::render::replay;
use etalon::{Instructions, Plan, Scene};
use glam::DVec3;

use super::args::Replay;
use super::{Answer, Failure, say};

pub fn run(arguments: &Replay) -> Result<Answer, Failure> {
    let scene = arguments.scene.load()?;
    let [x, y] = arguments.pixel;
    let [width, height] = scene.image.size;
    if x >= width || y >= height {
        return Err(format!("pixel {x},{y} is outside of the {width}x{height} picture").into());
    }
    if arguments.sample >= scene.image.spp {
        return Err(format!(
            "sample {} is not below the scene's {} samples a pixel: say --set image.spp=N as the \
             render did",
            arguments.sample, scene.image.spp
        )
        .into());
    }
    let plan = Plan::new(&scene, false)?;
    let request = Request {
        x,
        y,
        sample: arguments.sample,
    };
    let path = replay(&plan, Instructions::best(), request);
    say(&describe(&scene, request, &path))?;
    Ok(Answer::Good)
}

fn describe(scene: &Scene, request: Request, path: &Replayed) -> String {
    let mut lines = vec![
        format!(
            "pixel {},{} sample {} seed {}",
            request.x, request.y, request.sample, scene.image.seed
        ),
        format!("wavelengths (nm)  {}", numbers(&path.wavelengths)),
        format!("hero              {:?} nm", path.wavelengths[path.hero]),
    ];
    for (i, vertex) in path.vertices.iter().enumerate() {
        lines.push(String::new());
        lines.push(format!("vertex {}", i + 1));
        let rows = rows(scene, vertex).into_iter();
        lines.extend(rows.map(|(name, value)| format!("  {name:<18}{value}")));
    }
    lines.push(String::new());
    lines.push(format!("X Y Z             {}", numbers(&path.tristimulus)));
    lines.join("\n")
}

fn rows(scene: &Scene, vertex: &Vertex) -> Vec<(&'static str, String)> {
    let world = |p: DVec3| point(p + scene.camera.from);
    let mut rows = vec![
        ("from", world(vertex.origin)),
        ("direction", point(vertex.direction)),
        ("pdf (1/sr)", density(vertex.arrival_pdf)),
        ("throughput", numbers(&vertex.throughput)),
    ];
    match vertex.object {
        Some(index) => {
            let object = &scene.objects[index as usize];
            let side = if vertex.front { "front" } else { "back" };
            rows.extend([
                ("object", format!("{} ({side})", object.name)),
                (
                    "material",
                    scene.materials[object.value.material].name.clone(),
                ),
                ("distance", format!("{:?}", vertex.distance)),
                ("point", world(vertex.point)),
                ("normal", point(vertex.normal)),
            ]);
        }
        None => rows.push(("object", "none: the ray leaves the scene".to_owned())),
    }
    if let Some(weight) = vertex.emission_weight {
        rows.push(("emits, mis weight", format!("{weight:?}")));
    }
    if let Some(light) = &vertex.light {
        rows.push(("light", describe_light(scene, light)));
    }
    rows.push(("radiance so far", numbers(&vertex.radiance)));
    match &vertex.scattered {
        Some(next) => rows.extend([
            ("goes on", point(next.direction)),
            ("pdf (1/sr)", density(next.pdf)),
            ("throughput", numbers(&next.throughput)),
        ]),
        None => rows.push(("ends", "here".to_owned())),
    }
    rows
}

fn describe_light(scene: &Scene, light: &LightVertex) -> String {
    let name = match light.object {
        Some(index) => scene.objects[index as usize].name.as_str(),
        None => "without a surface",
    };
    let seen = if light.blocked { "hidden" } else { "seen" };
    format!(
        "{name} {seen}, direction {}, distance {:?}, cos/π · mis weight / pdf {:?}",
        point(light.direction),
        light.distance,
        light.weight
    )
}

fn density(pdf: Option<f64>) -> String {
    pdf.map_or_else(
        || "none: the only direction".to_owned(),
        |p| format!("{p:?}"),
    )
}

fn point(p: DVec3) -> String {
    numbers(&p.to_array())
}

fn numbers(values: &[f64]) -> String {
    let texts: Vec<String> = values.iter().map(|v| format!("{v:?}")).collect();
    texts.join(" ")
}
