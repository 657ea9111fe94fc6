//! `etalon info`: what a scene needs, in words.

use etalon::Plan;
use etalon::inside::plan::explain;

use super::args::Info;
use super::{Answer, Failure, say};

pub fn run(arguments: &Info) -> Result<Answer, Failure> {
    let scene = arguments.scene.load()?;
    let plan = Plan::new(&scene, arguments.plan == "full")?;
    say(&explain::explain(&scene, &plan).join("\n"))?;
    Ok(Answer::Good)
}
