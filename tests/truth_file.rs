//! The closed-form truths of `tests/data/truths.json`.

#![allow(clippy::unwrap_used, reason = "the file is part of the tests")]

use serde_json::Value;

/// The entry of this id.
pub fn truth(id: &str) -> Value {
    let all: Value = serde_json::from_str(include_str!("data/truths.json")).unwrap();
    let found = all["tests"]
        .as_array()
        .unwrap()
        .iter()
        .find(|t| t["id"] == id);
    found.unwrap().clone()
}

/// A number of the file.
pub fn number(v: &Value) -> f64 {
    v.as_f64().unwrap()
}

/// A list of the file.
pub fn list(v: &Value) -> &[Value] {
    v.as_array().unwrap()
}
