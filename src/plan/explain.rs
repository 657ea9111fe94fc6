//! The plan in words.

use super::Plan;
use crate::scene::Scene;

/// What the scene holds, what it needs and what is done about it, line by line.
pub fn explain(_scene: &Scene, plan: &Plan) -> Vec<String> {
    vec![format!("{:?}", plan.choices)]
}
