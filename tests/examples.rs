//! The examples run, and what they make is right.

use std::path::PathBuf;
use std::process::Command;

/// Standard output of an example; `cargo test --workspace` has built it beside the tests.
fn run(name: &str, arguments: &[&str]) -> String {
    let test = std::env::current_exe().expect("tests are files");
    let example = test.parent().expect("in a folder").with_file_name("examples").join(name);
    assert!(example.exists(), "{} is not built: cargo build --examples", example.display());
    let output = Command::new(example).args(arguments).output().expect("it starts");
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("it prints text")
}

/// Display values of the picture that an example draws, 0 to 255, and what it prints; none without a device.
fn drawn(name: &str, input: &str) -> Option<(image::GrayImage, String)> {
    // One after the other: two tests draw the same example into the same file.
    let _turn = tests::gpu::device()?;
    let file: PathBuf =
        std::env::temp_dir().join(format!("candela-example-{}-{name}.png", std::process::id()));
    let text = run(name, &[input, file.to_str().expect("a name")]);
    let picture = image::open(&file).expect("it writes a picture").into_luma8();
    std::fs::remove_file(file).expect("it is there");
    assert_eq!(picture.dimensions(), (640, 360));
    Some((picture, text))
}

fn picture(name: &str, input: &str) -> Option<image::GrayImage> {
    drawn(name, input).map(|(picture, _)| picture)
}

/// The number after `label` in `text`.
fn number(text: &str, label: &str) -> f64 {
    let rest = text.split(label).nth(1).unwrap_or_else(|| panic!("no '{label}' in {text}"));
    rest.split_whitespace().next().unwrap_or_default().parse().expect("a number")
}

fn mean(values: impl Iterator<Item = u8>) -> f64 {
    values.map(f64::from).sum::<f64>() / f64::from(640 * 360)
}

/// Their exposure is automatic, so neither is dark or burnt out.
#[test]
fn pictures_are_drawn() {
    for (name, input) in [("hello", "knot"), ("many_lights", "3000")] {
        let Some(picture) = picture(name, input) else { return };
        let mean = mean(picture.pixels().map(|pixel| pixel.0[0]));
        assert!((30.0..200.0).contains(&mean), "{name}: {mean}");
    }
}

/// On the application's own device, queue and allocator a frame is what it is on Candela's: exposures differ by a frame's noise.
#[test]
fn an_embedded_frame_is_the_same_frame() {
    let (Some(own), Some((embedded, text))) = (picture("hello", "knot"), drawn("embed_ash", "knot")) else {
        return;
    };
    let reservoirs = f64::from(640 * 360) * 16.0;
    assert!(number(&text, "by Candela:") > reservoirs && number(&text, "after Candela:") == 0.0, "{text}");
    let difference = |a: &image::GrayImage, b: &image::GrayImage| {
        mean(a.pixels().zip(b.pixels()).map(|(a, b)| a.0[0].abs_diff(b.0[0])))
    };
    assert!(difference(&own, &embedded) < 1.0, "{}", difference(&own, &embedded));
    // Negative control: upside down.
    assert!(difference(&own, &image::imageops::flip_vertical(&embedded)) > 5.0);
}

/// Every mean within 4.5 standard errors of the sum that the example computes: five false alarms in a million, with a fixed seed.
#[test]
fn estimates_have_the_mean_of_the_sum() {
    for example in ["estimator", "custom_light"] {
        has_the_mean_of_the_sum(example);
    }
}

fn has_the_mean_of_the_sum(example: &str) {
    let text = run(example, &[]);
    let sum = number(text.lines().next().expect("a line"), "lights:");
    let rows: Vec<(f64, f64)> = text
        .lines()
        .filter(|line| line.contains('±'))
        .map(|line| {
            let mean = line.split('±').next().unwrap_or_default().split_whitespace().last().expect("a mean");
            (mean.parse().expect("a number"), number(line, "±"))
        })
        .collect();
    assert_eq!(rows.len(), 5, "{text}");
    let agrees = |sum: f64| rows.iter().all(|(mean, error)| (mean - sum).abs() < 4.5 * error);
    assert!(agrees(sum), "{text}");
    assert!(rows[..4].windows(2).all(|pair| pair[1].1 < pair[0].1), "more candidates, less spread: {text}");
    assert!(rows[4].1 < rows[2].1, "a merge has less spread than its parts: {text}");
    // The planted error: a sum that leaves a hundredth out.
    assert!(!agrees(0.99 * sum), "{text}");
}
