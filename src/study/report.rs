//! The report of a study: one HTML page that needs nothing else.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder as _};

use super::reference::{Reference, pixels};
use super::run::{Request, Study};
use super::work::picture_name;
use crate::chart::{Curve, Figure, Point, best};
use crate::film::{exr, png};
use crate::stats::Estimate;
use crate::stats::metrics::{RELMSE_EPSILON, mean};

const PAGE: &str = include_str!("report.html");

/// The page of a study; `charts` are SVG.
pub fn html(request: &Request, study: &Study, curves: &[Curve], charts: &[String]) -> String {
    let pictures = Pictures::of(request, study, curves);
    let name = super::choice::stem(&request.subject.path);
    let panel = request.subject.overrides.panel.iter();
    let panel: String = panel.map(|panel| format!(", panel {panel}")).collect();
    let charts: String = charts
        .iter()
        .map(|svg| format!("<div class=\"chart\">\n{svg}\n</div>\n"))
        .collect();
    let title = escaped(&format!("{name}{panel}: error over samples and seconds"));
    let part = |name: &str| match name {
        "title" => title.clone(),
        "summary" => summary(study, curves),
        "charts" => charts.clone(),
        "about_pictures" => escaped(&pictures.about),
        "pairs" => pictures.pairs.clone(),
        "table" => table(curves, study.grid.abscissa.key.column()),
        "settings" => settings(request, study),
        "command" => escaped(&request.command),
        "data" => pictures.data.clone(),
        _ => String::new(),
    };
    // One pass, so that braces within a part are not replaced.
    let mut pieces = PAGE.split("{{");
    let mut page = pieces.next().unwrap_or_default().to_owned();
    for (name, rest) in pieces.filter_map(|piece| piece.split_once("}}")) {
        page.push_str(&part(name));
        page.push_str(rest);
    }
    page
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

fn summary(study: &Study, curves: &[Curve]) -> String {
    let mut text = String::new();
    if !study.complete {
        text.push_str("<p><strong>Interrupted: not all points are there yet.</strong></p>\n");
    }
    let reference = &study.reference;
    let best = best(curves);
    let own = reference.rmse();
    let known = if own > 0.0 {
        format!(
            "Its own root mean squared standard error is {own:.2e}, {:.1} times below the best point's; its \
             variance has been taken off all measured errors.",
            best / own
        )
    } else {
        "It is exact.".to_owned()
    };
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "<p>Compared with {}. {}</p>\n<p>Errors are means over R, G, B; intervals are 95 % intervals over the \
         independent renders of a point.</p>\n",
        escaped(&study.about_reference),
        escaped(&known)
    );
    text
}

/// The table of the page, one row a point.
fn table(curves: &[Curve], abscissa: &str) -> String {
    let heads = [
        "curve",
        abscissa,
        "renders",
        "seconds",
        "relmse",
        "rmse",
        "bias / mean",
        "estimated / actual",
        "",
    ];
    let cells = |tag: &str, cells: &[String]| -> String {
        let cells = cells
            .iter()
            .map(|c| format!("<{tag}>{}</{tag}>", escaped(c)));
        format!("<tr>{}</tr>\n", cells.collect::<String>())
    };
    let points = curves.iter().flat_map(|curve| {
        let points = curve.points.iter();
        points.map(|point| cells("td", &numbers(curve, point)))
    });
    let head = cells("th", &heads.map(str::to_owned));
    format!("<table>\n{head}{}</table>", points.collect::<String>())
}

fn numbers(curve: &Curve, point: &Point) -> [String; 9] {
    let with = |m: Estimate| match m.half_width(0.05) {
        half if half.is_nan() => format!("{:.3e}", m.value),
        half => format!("{:.3e} ± {half:.1e}", m.value),
    };
    let ratio = Some(point.estimated_over_actual()).filter(|ratio| !ratio.is_nan());
    let floor = "reference's floor";
    [
        curve.label.clone(),
        Figure::number(point.x),
        point.rows.len().to_string(),
        format!("{:.4}", point.mean(|row| row.seconds).value),
        with(point.mean(|row| row.relmse)),
        with(point.rmse()),
        with(point.mean(|row| row.bias)),
        ratio.map_or_else(String::new, |ratio| format!("{ratio:.3}")),
        if point.at_floor() { floor } else { "" }.to_owned(),
    ]
}

/// The table of the study's request and its settings.
fn settings(request: &Request, study: &Study) -> String {
    let overrides = &request.subject.overrides;
    let [seconds, rendering] = study.seconds;
    let curves: Vec<String> = study.grid.others.iter().map(ToString::to_string).collect();
    let threads = study.rows.first().map_or(0, |row| row.threads);
    let pairs = [
        ("scene", request.subject.path.display().to_string()),
        ("panel", overrides.panel.clone().unwrap_or_default()),
        ("laid over it", request.subject.settings()),
        ("abscissa", study.grid.abscissa.to_string()),
        ("curves", curves.join(" ")),
        ("renders of each point", request.replicates.to_string()),
        ("reference", study.about_reference.clone()),
        ("threads", threads.to_string()),
        (
            "instruction set",
            request.subject.instructions.name().to_owned(),
        ),
        ("etalon", env!("CARGO_PKG_VERSION").to_owned()),
        (
            "time of the last run",
            format!(
                "{seconds:.1} s, {:.1} % of them outside rendering",
                100.0 * (seconds - rendering) / seconds
            ),
        ),
    ];
    let said = pairs.iter().filter(|(_, value)| !value.is_empty());
    let rows =
        said.map(|(name, value)| format!("<tr><td>{name}</td><td>{}</td></tr>\n", escaped(value)));
    format!("<table>\n{}</table>", rows.collect::<String>())
}

/// The pictures of a report.
struct Pictures {
    about: String,
    pairs: String,
    /// JSON: names and PNG files in base64.
    data: String,
}

impl Pictures {
    fn of(request: &Request, study: &Study, curves: &[Curve]) -> Self {
        let reference = &study.reference;
        let rgb = pixels(&reference.channels);
        let exposure = png::exposure(&rgb);
        let scale = scale(curves);
        let entry = |name: &str, bytes: &[u8]| entry(name, bytes, reference.size);
        let encoded = |rgb: &[[f32; 3]]| -> Vec<u8> {
            rgb.iter().flat_map(|p| png::encode(*p, exposure)).collect()
        };
        let mut data = vec![entry("reference", &encoded(&rgb))];
        let mut pairs = String::new();
        for (i, curve) in curves.iter().enumerate() {
            let path = request.directory.join(picture_name(i));
            let rgb = exr::read(&path).ok().and_then(|picture| picture.rgb());
            let fits = |rgb: &Vec<_>| rgb.len() == reference.size[0] * reference.size[1];
            let Some(rgb) = rgb.filter(fits) else {
                continue;
            };
            let difference = differences(&rgb, reference, scale);
            data.push(entry(&format!("difference-{i}"), &difference));
            data.push(entry(&format!("curve-{i}"), &encoded(&rgb)));
            pairs.push_str(&pair(i, curve));
        }
        let about = format!(
            "The first render of each curve's last point, left of the slider, and the reference, right of it; beside \
             them their difference over the reference: red is too bright, blue too dark, full colour is {:.2} %. \
             Drag to move the slider, or, when magnified, the pictures; the wheel, two fingers or a double click magnify.",
            100.0 * scale
        );
        Self {
            about,
            pairs,
            data: format!("{{{}}}", data.join(",")),
        }
    }
}

/// The relative error of full colour: three times the geometric mean of the errors at the curves'
/// ends, as no other scale shows the best and the worst curve alike.
fn scale(curves: &[Curve]) -> f64 {
    let last = curves.iter().filter_map(|curve| curve.points.last());
    let logarithms: Vec<f64> = last
        .map(|point| point.mean(|row| row.relmse).value)
        .filter(|error| *error > 0.0)
        .map(f64::ln)
        .collect();
    if logarithms.is_empty() {
        return 1.0;
    }
    3.0 * (mean(&logarithms) / 2.0).exp()
}

/// A picture in the page's data.
fn entry(name: &str, bytes: &[u8], size: [usize; 2]) -> String {
    let mut file = Vec::new();
    let encoder = PngEncoder::new(&mut file);
    let [width, height] = size.map(|n| n as u32);
    // A vector takes everything, and the sizes agree.
    let _ = encoder.write_image(bytes, width, height, ExtendedColorType::Rgb8);
    format!("\"{name}\":\"{}\"", STANDARD.encode(file))
}

/// The viewers of a curve.
fn pair(i: usize, curve: &Curve) -> String {
    let label = escaped(&curve.label);
    let last = curve.points.last();
    let at = last.map_or_else(String::new, |point| {
        let relmse = point.mean(|row| row.relmse).value;
        format!(", at {}: relmse {relmse:.2e}", Figure::number(point.x))
    });
    format!(
        "<section class=\"pair\"><h3>{label}{at}</h3>\n\
         <div class=\"view\"><img data-picture=\"reference\" alt=\"reference\" draggable=\"false\">\
         <div class=\"over\"><img data-picture=\"curve-{i}\" alt=\"{label}\" draggable=\"false\"></div>\
         <div class=\"bar\"></div><small class=\"left\">{label}</small><small class=\"right\">reference</small></div>\n\
         <div class=\"view\"><img data-picture=\"difference-{i}\" alt=\"difference\" draggable=\"false\">\
         <div class=\"bar\"></div><small class=\"left\">difference</small></div></section>\n"
    )
}

/// Relative differences of luminance-like means of R, G, B as colours: white is none.
fn differences(rgb: &[[f32; 3]], reference: &Reference, scale: f64) -> Vec<u8> {
    let channels = &reference.channels;
    let grey = |i: usize| channels.iter().map(|c| c[i]).sum::<f64>() / 3.0;
    let average = channels.iter().map(|c| mean(c)).sum::<f64>() / 3.0;
    let epsilon = RELMSE_EPSILON.sqrt() * average;
    let colour = |(i, pixel): (usize, &[f32; 3])| {
        let own = pixel.iter().map(|v| f64::from(*v)).sum::<f64>() / 3.0;
        let r = grey(i);
        diverging((own - r) / (r * r + epsilon * epsilon).sqrt() / scale)
    };
    rgb.iter().enumerate().flat_map(colour).collect()
}

/// From blue at −1 over white to red at 1.
fn diverging(x: f64) -> [u8; 3] {
    const RED: [f64; 3] = [178.0, 24.0, 43.0];
    const BLUE: [f64; 3] = [33.0, 102.0, 172.0];
    if x.is_nan() {
        return [255, 0, 255];
    }
    let end = if x > 0.0 { RED } else { BLUE };
    let share = x.abs().min(1.0);
    end.map(|end| (255.0 + share * (end - 255.0)) as u8)
}
