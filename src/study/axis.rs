//! What a study varies: settings of the estimator and their values.

use crate::chart::Key;

/// A setting and the values it takes, in order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    pub key: Key,
    /// At least one, none twice.
    pub values: Vec<String>,
}

/// What is wrong with an axis.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AxisError {
    #[error(
        "\"{0}\" is no axis: expected KEY=VALUES, such as spp=1..4096x2 or sampler=sobol,independent"
    )]
    Form(String),
    #[error("a study cannot go over \"{0}\": it can go over {known}", known = Key::ALL.map(Key::column).join(", "))]
    Key(String),
    #[error(
        "\"{0}\" is no range: expected FROM..TOxFACTOR with whole numbers 1 ≤ FROM ≤ TO and a factor above 1, such as 1..64x2"
    )]
    Range(String),
    #[error("the axis {0} has no values")]
    Empty(&'static str),
    #[error("\"{text}\" is no whole number, as the axis {key} has")]
    Number { key: &'static str, text: String },
}

/// Most values of a range: more would be no study but a mistake.
const MOST_VALUES: usize = 1000;

impl std::str::FromStr for Axis {
    type Err = AxisError;

    /// Reads `KEY=VALUE,…`, where a value of a number's axis may be a range `FROM..TOxFACTOR`.
    fn from_str(text: &str) -> Result<Self, AxisError> {
        let (name, list) = text
            .split_once('=')
            .ok_or_else(|| AxisError::Form(text.to_owned()))?;
        let key = Key::ALL.into_iter().find(|key| key.column() == name.trim());
        let key = key.ok_or_else(|| AxisError::Key(name.trim().to_owned()))?;
        let mut values: Vec<String> = Vec::new();
        for item in list.split(',').map(str::trim).filter(|i| !i.is_empty()) {
            for value in items(key, item)? {
                if !values.contains(&value) {
                    values.push(value);
                }
            }
        }
        if values.is_empty() {
            return Err(AxisError::Empty(key.column()));
        }
        if key.is_number() {
            values.sort_by_key(|value| value.parse::<u64>().ok());
        }
        Ok(Self { key, values })
    }
}

/// The values that one item stands for.
fn items(key: Key, item: &str) -> Result<Vec<String>, AxisError> {
    if !key.is_number() {
        return Ok(vec![item.to_owned()]);
    }
    let numbers = if item.contains("..") {
        range(item).ok_or_else(|| AxisError::Range(item.to_owned()))?
    } else {
        vec![item.parse().map_err(|_| AxisError::Number {
            key: key.column(),
            text: item.to_owned(),
        })?]
    };
    Ok(numbers.iter().map(u64::to_string).collect())
}

/// `FROM..TOxFACTOR`: FROM, FROM·FACTOR … rounded to whole numbers, up to TO.
fn range(item: &str) -> Option<Vec<u64>> {
    let (from, rest) = item.split_once("..")?;
    let (to, factor) = rest.split_once('x')?;
    let from: u64 = from.trim().parse().ok().filter(|from| *from >= 1)?;
    let to: u64 = to.trim().parse().ok().filter(|to| *to >= from)?;
    let factor: f64 = factor.trim().parse().ok().filter(|f| *f > 1.0)?;
    let all = std::iter::successors(Some(from as f64), |value| Some(value * factor));
    let whole = all.map(|value| value.round() as u64);
    let kept = whole.take_while(|value| *value <= to);
    let mut values: Vec<u64> = kept.take(MOST_VALUES + 1).collect();
    values.dedup();
    (values.len() <= MOST_VALUES).then_some(values)
}

impl std::fmt::Display for Axis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}={}", self.key.column(), self.values.join(","))
    }
}
