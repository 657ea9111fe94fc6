//! Many objects for single rays: which of them a ray may meet.

use super::hierarchy::{Bounds, BoxRay, Child, Descent, Hierarchy, Item};
use crate::math::ray::Ray;
use crate::math::scalar_lane::One;

/// Boxes over the objects of a scene, in world coordinates.
#[derive(Debug, Clone)]
pub struct RayIndex {
    boxes: Hierarchy<f64>,
    unbounded: Vec<u32>,
}

impl RayIndex {
    /// Over objects with these boxes; `None` for one that has no end.
    pub fn new(bounds: impl IntoIterator<Item = Option<Bounds>>) -> Self {
        let mut items: Vec<Item> = Vec::new();
        let mut unbounded = Vec::new();
        for (object, bounds) in (0..).zip(bounds) {
            match bounds {
                Some(bounds) => items.push((object, bounds)),
                None => unbounded.push(object),
            }
        }
        // Without their shapes no objects are balls to be asked together.
        let boxes = Hierarchy::new(&items, &[]);
        Self { boxes, unbounded }
    }

    /// The objects that the ray may meet with 0 ≤ t ≤ `t_max`, in increasing order.
    pub fn candidates(&self, ray: &Ray, t_max: f64) -> Vec<u32> {
        let inverse = ray.direction.to_array().map(|d| 1.0 / d);
        let ray = BoxRay::new(One, ray.origin.to_array(), inverse);
        let mut descent = Descent::default();
        descent.restart();
        let mut objects = self.unbounded.clone();
        while let Some(child) = self.boxes.next::<_, false>(One, &mut descent, &ray, t_max) {
            match child {
                Child::Object(object) => objects.push(object),
                Child::Balls(balls) => objects.extend(&balls.objects[..balls.count]),
            }
        }
        objects.sort_unstable();
        objects
    }
}
