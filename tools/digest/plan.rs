//! What the plan chooses for a scene as it stands, read from a picture of one pixel.

use std::collections::{BTreeMap, BTreeSet};

use etalon::{Attribute, Picture};

use super::binary::Binary;
use super::scenes::Variant;
use super::table::Kind;

/// The table of all plans, of whose columns the first two name the scene.
pub const TABLE: Kind = Kind {
    file: "plan.csv",
    columns: &[
        "scene",
        "panel",
        "precision",
        "wavelengths",
        "replicates",
        "lights_left_out",
        "index",
        "occluders",
        "finders",
        "needs",
    ],
    keys: 2,
};

/// What etalon calls the branches of its loop, and what the table calls them. These and the other
/// words here follow etalon's when they change; the table does not.
const NEEDS: [(&str, &str); 13] = [
    ("nothing but the environment", ""),
    ("diffuse reflection", "diffuse"),
    ("metals", "conductor"),
    ("ideal mirrors", "ideal_mirror"),
    ("glass", "glass"),
    ("dispersion", "dispersion"),
    ("emission from", "emission"),
    ("lens", "lens"),
    ("textures", "checker"),
    // How hits look, which the table leaves out.
    ("cubes", ""),
    ("balls", ""),
    ("other curved surfaces", ""),
    ("insides of closed shapes", ""),
];
/// How the account of a finder begins, and its name.
const FINDERS: [(&str, &str); 4] = [
    ("certified roots of polynomials", "polynomial"),
    ("interval enclosures", "interval"),
    ("steps as long as a proved Lipschitz bound", "sphere-trace"),
    ("equal steps and bisection", "sign-change"),
];

/// The scene's line in the table.
pub fn row(binary: &Binary, variant: &Variant) -> Result<Vec<String>, String> {
    let mut arguments = variant.arguments();
    arguments.extend(["--crop", "0,0,1,1"].map(str::to_owned));
    let picture = binary.render(&arguments)?;
    let text = |name| text(&picture, name);
    let words = text("plan")?;
    let line = |start: &str| {
        let mut lines = words.lines();
        let found = lines.find_map(|line| line.strip_prefix(start));
        found.ok_or_else(|| format!("the plan of {variant:?} has no line {start:?}"))
    };
    let left_out = match text("lightsLeftOut")?.as_str() {
        "none" => 0,
        names => names.split(", ").count(),
    };
    let needs = line("in the loop: ")?.split(", ");
    let needs = needs.map(|words| translated(&NEEDS, words));
    // A set: etalon may say it in any order.
    let mut needs: BTreeSet<_> = needs.collect::<Result<_, _>>()?;
    let [index, occluders, finders] = intersection(line("intersection: ")?)?;
    if !finders.is_empty() {
        needs.insert("implicit");
    }
    let needs: Vec<_> = needs.into_iter().filter(|need| !need.is_empty()).collect();
    let choices = [
        text("precision")?,
        text("wavelengths")?,
        text("replicates")?,
        left_out.to_string(),
        index,
        occluders,
        finders,
        needs.join(" "),
    ];
    Ok(variant.key().into_iter().chain(choices).collect())
}

/// List or hierarchy; how many objects shadow rays ask; how many implicit surfaces have which
/// finder.
fn intersection(words: &str) -> Result<[String; 3], String> {
    let index = ["list", "hierarchy"].into_iter();
    let index = index.filter(|index| words.contains(index));
    let [index] = index.collect::<Vec<_>>()[..] else {
        return Err(format!("neither a list nor a hierarchy: {words:?}"));
    };
    let mut occluders = "all";
    let mut finders = BTreeMap::new();
    for part in words.split("; ") {
        if let Some(rest) = part.strip_prefix("shadow rays ask ") {
            occluders = rest.split(',').next().unwrap_or(rest);
        } else if let Some((count, how)) = part.split_once(" implicit by ") {
            finders.insert(translated(&FINDERS, how)?, count);
        }
    }
    let finders = finders
        .iter()
        .map(|(name, count)| format!("{count} {name}"));
    let finders: Vec<_> = finders.collect();
    Ok([index.to_owned(), occluders.to_owned(), finders.join(" ")])
}

/// The second of the pair whose first is how `words` begin.
fn translated<'a>(pairs: &[(&str, &'a str)], words: &str) -> Result<&'a str, String> {
    let found = pairs.iter().find(|(theirs, _)| words.starts_with(theirs));
    found
        .map(|&(_, ours)| ours)
        .ok_or_else(|| format!("not known to tools/digest/plan.rs: {words:?}"))
}

fn text(picture: &Picture, name: &str) -> Result<String, String> {
    match picture.attribute(name) {
        Some(Attribute::Text(text)) => Ok(text.clone()),
        Some(Attribute::Int(number)) => Ok(number.to_string()),
        _ => Err(format!("the picture has no attribute {name}")),
    }
}
