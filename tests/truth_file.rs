//! The closed-form truths of `tests/data/truths.json`, or of the file that the environment variable
//! `ETALON_TRUTHS` names.

use std::ops::Deref;
use std::sync::OnceLock;

use glam::DVec3;
use serde_json::Value;

/// An entry of the file, with a set-up and exact answers.
pub struct Truth(Value);

impl Deref for Truth {
    type Target = Value;

    fn deref(&self) -> &Value {
        &self.0
    }
}

impl Truth {
    pub fn of(&self, key: &str) -> f64 {
        number(&self.0["setup"][key])
    }

    /// Several numbers of the set-up.
    pub fn all<const N: usize>(&self, keys: [&str; N]) -> [f64; N] {
        keys.map(|key| self.of(key))
    }

    pub fn exact(&self, key: &str) -> f64 {
        number(&self.0["exact"][key])
    }

    /// A list of the exact answers.
    pub fn rows(&self, key: &str) -> &[Value] {
        list(&self.0["exact"][key])
    }
}

pub fn truth(id: &str) -> Truth {
    static ALL: OnceLock<Value> = OnceLock::new();
    let all = ALL.get_or_init(|| {
        let text = match std::env::var_os("ETALON_TRUTHS") {
            Some(path) => std::fs::read_to_string(path).unwrap(),
            None => include_str!("data/truths.json").to_owned(),
        };
        serde_json::from_str(&text).unwrap()
    });
    let found = list(&all["tests"]).iter().find(|t| t["id"] == id);
    Truth(found.unwrap().clone())
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

pub fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

pub fn numbers(value: &Value) -> Vec<f64> {
    list(value).iter().map(number).collect()
}

pub fn vector(value: &Value) -> DVec3 {
    DVec3::from_slice(&numbers(value))
}
