//! What the plan would choose for a scene of a problem's bodies.

use std::path::Path;

use super::families::Problem;
use super::{Precision, Subject};
use etalon::Overrides;
use etalon::inside::plan::choose::{self, choose};
use etalon::inside::scene::{Shape, parse};
use etalon::inside::shape::ShapeKind;

/// Pixels along the picture's height, which the object about fills.
const PIXELS: u32 = 256;

/// The precision of the path loop; double where there is no plan.
pub fn precision(subject: Subject, problem: &Problem) -> Precision {
    let object = "[[object]]\nshape = \"sphere\"\nmaterial = \"grey\"\n";
    let text = format!(
        "[camera]\nfrom = [0, 0, {:?}]\nto = [0, 0, 0]\northographic = {:?}\n\
         [image]\nsize = [{PIXELS}, {PIXELS}]\nspp = 1\n[materials]\ngrey = {{ diffuse = 0.5 }}\n{}",
        problem.camera.z,
        1.5 * problem.size,
        object.repeat(problem.bodies.len())
    );
    let Ok(mut scene) = parse("failures", &text, Path::new(""), &Overrides::default()) else {
        return Precision::Double;
    };
    for (object, body) in scene.objects.iter_mut().zip(&problem.bodies) {
        object.value.to_world = body.to_world;
        object.value.shape = match (subject, &body.implicit) {
            (Subject::Canonical(kind), _) => Shape::Canonical(kind),
            (_, Some(implicit)) => Shape::Implicit(implicit.clone()),
            (_, None) => Shape::Canonical(ShapeKind::Sphere),
        };
    }
    match choose(&scene, false).map(|choices| choices.precision) {
        Ok(choose::Precision::Single) => Precision::Single,
        _ => Precision::Double,
    }
}
