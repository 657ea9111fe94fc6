//! What the plan would choose for a scene of a problem's bodies.

use super::families::Problem;
use super::{Precision, Subject};
use etalon::Scene;
use etalon::inside::plan::choose::choose;
use etalon::inside::scene::Shape;
use etalon::inside::shape::ShapeKind;

/// Pixels along the picture's height, which the object about fills.
const PIXELS: u32 = 256;

/// The precision of the path loop; double where there is no plan.
pub fn precision(subject: Subject, problem: &Problem) -> Precision {
    let object = "[[object]]\nshape = \"sphere\"\nmaterial = \"grey\"\n";
    let text = format!(
        "camera = {{ from = [0, 0, {:?}], to = [0, 0, 0], orthographic = {:?} }}\n\
         image = {{ size = [{PIXELS}, {PIXELS}], spp = 1 }}\nmaterials.grey = {{ diffuse = 0.5 }}\n{}",
        problem.camera.z,
        1.5 * problem.size,
        object.repeat(problem.bodies.len())
    );
    let Ok(mut scene) = Scene::parse(&text) else {
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
    choose(&scene, false).map_or(Precision::Double, |choices| choices.precision)
}
