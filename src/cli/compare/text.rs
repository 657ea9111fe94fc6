//! A comparison in words.

use std::fmt::Write as _;

use etalon::inside::stats::metrics::Metric;
use etalon::{Estimate, Judgement, Metrics};

use super::Report;

/// The report as tables and notes.
pub fn text(report: &Report) -> String {
    let ([width, height], a) = (report.size, report.a.display());
    let sides = match (&report.b, report.truth) {
        (Some(b), _) => format!("{a} against {}", b.display()),
        (None, truth) => format!("the mean of {a} against {}", truth.unwrap_or_default()),
    };
    let mut text = format!("{sides}, {width}x{height} pixels\n");
    push_metrics(&mut text, report);
    if let Some(judgement) = &report.comparison.judgement {
        push_judgement(&mut text, judgement);
    }
    if let Some(scale) = report.heatmap_scale {
        let _ = writeln!(
            text,
            "heat map: dark red and dark blue are {:+.2} % and {:+.2} % of the reference",
            100.0 * scale,
            -100.0 * scale
        );
    }
    for note in &report.notes {
        let _ = writeln!(text, "note: {note}");
    }
    text
}

fn push_metrics(text: &mut String, report: &Report) {
    if report.comparison.channels.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "\n{:<20} {:>12} {:>12} {:>12} {:>20} {:>18} {:>18} {:>18} {:>18}",
        "channel",
        "mean A",
        "mean B",
        "mean error",
        "relative",
        "RMSE",
        "relMSE",
        "relMSE - var B",
        "SMAPE"
    );
    for channel in &report.comparison.channels {
        let [a, b] = channel.means;
        let means = format!("{:<20} {a:>12.6} {b:>12.6}", channel.channel);
        let metrics = &channel.metrics;
        if [a, b, metrics.rmse.value] == [0.0; 3] && metrics.smape.value.is_nan() {
            let _ = writeln!(text, "{means} black in both pictures");
        } else {
            push_row(text, &means, metrics);
        }
    }
    if let Some(metrics) = &report.comparison.rgb {
        push_row(
            text,
            &format!("{:<20} {:>12} {:>12}", "R, G, B", "", ""),
            metrics,
        );
    }
    if let Some(flip) = &report.comparison.flip {
        let _ = writeln!(
            text,
            "HDR-FLIP {:.4} (0 looks the same, 1 is the worst)",
            flip.value
        );
    }
    text.push_str("± one standard error, from the spread over the pixels\n");
}

fn push_row(text: &mut String, start: &str, metrics: &Metrics) {
    let unbiased = metrics
        .relmse_without_reference_variance
        .map_or_else(|| "unknown".to_owned(), measured);
    let relative = metrics.relative_mean_error;
    let relative = if relative.value.is_nan() {
        UNDEFINED.to_owned()
    } else {
        format!(
            "{:+.4} % ± {:.4} %",
            100.0 * relative.value,
            100.0 * relative.standard_error
        )
    };
    let _ = writeln!(
        text,
        "{start} {:>+12.2e} {relative:>20} {:>18} {:>18} {unbiased:>18} {:>18}",
        metrics.mean_error.value,
        measured(metrics.rmse),
        measured(metrics.relmse),
        measured(metrics.smape),
    );
}

/// What a metric relative to 0 is.
const UNDEFINED: &str = "undefined";

fn measured(
    Metric {
        value,
        standard_error,
    }: Metric,
) -> String {
    if value.is_nan() {
        UNDEFINED.to_owned()
    } else if standard_error.is_nan() {
        // Of a single pixel, or the root of a mean square of 0.
        format!("{value:.2e}")
    } else {
        format!("{value:.2e} ± {standard_error:.0e}")
    }
}

fn push_judgement(text: &mut String, judgement: &Judgement) {
    let _ = writeln!(
        text,
        "\n{:<20} {:>12} {:>12} {:>7} {:>9} {:>22} {:>24} {:>9}",
        "channel",
        "bias",
        "± s.e.",
        "s.e.s",
        "p",
        "caught from a bias of",
        "worst of blocks",
        "all, p"
    );
    for channel in &judgement.channels {
        let blocks = channel.blocks.as_ref().map_or_else(String::new, |blocks| {
            let [x, y] = blocks.worst.unwrap_or_default();
            format!(
                "{:>24} {:>9.2e}",
                format!(
                    "{:+.1} s.e. of {} at {x},{y}",
                    blocks.worst_score, blocks.count
                ),
                blocks.distribution_p_value
            )
        });
        let bias = Estimate {
            value: channel.relative_bias,
            standard_error: channel.standard_error,
            freedom: channel.freedom,
        };
        let _ = writeln!(
            text,
            "{:<20} {:>10.4} % {:>10.4} % {:>+7.1} {:>9.2e} {:>20.4} % {blocks}",
            channel.channel,
            100.0 * channel.relative_bias,
            100.0 * channel.standard_error,
            bias.score(0.0),
            channel.p_value,
            100.0 * channel.smallest_caught,
        );
    }
    for channel in &judgement.channels {
        for words in &channel.rejected {
            let _ = writeln!(text, "{}: {words}", channel.channel);
        }
    }
    let not = if judgement.consistent { "" } else { "NOT " };
    let _ = writeln!(
        text,
        "{not}consistent (honest pictures are called inconsistent with probability {:.0e})",
        judgement.level
    );
}
