//! The closed-form truths of `tests/data/truths.json`, or of the file that the environment variable
//! `ETALON_TRUTHS` names.

#![allow(clippy::unwrap_used, reason = "the file is part of the tests")]

use std::sync::OnceLock;

use serde_json::Value;

/// The entry of this id.
pub fn truth(id: &str) -> Value {
    static ALL: OnceLock<Value> = OnceLock::new();
    let all = ALL.get_or_init(|| {
        let text = match std::env::var_os("ETALON_TRUTHS") {
            Some(path) => std::fs::read_to_string(path).unwrap(),
            None => include_str!("data/truths.json").to_owned(),
        };
        serde_json::from_str(&text).unwrap()
    });
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
