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

/// Mean display value of the picture that an example draws, 0 to 255.
fn brightness(name: &str, input: &str) -> f64 {
    if tests::gpu::device().is_none() {
        return f64::NAN;
    }
    let file: PathBuf =
        std::env::temp_dir().join(format!("candela-example-{}-{name}.png", std::process::id()));
    run(name, &[input, file.to_str().expect("a name")]);
    let picture = image::open(&file).expect("it writes a picture").into_luma8();
    std::fs::remove_file(file).expect("it is there");
    assert_eq!(picture.dimensions(), (640, 360));
    picture.pixels().map(|pixel| f64::from(pixel.0[0])).sum::<f64>() / f64::from(640 * 360)
}

/// Their exposure is automatic, so neither is dark or burnt out.
#[test]
fn pictures_are_drawn() {
    for (name, input) in [("hello", "knot"), ("many_lights", "3000")] {
        let mean = brightness(name, input);
        assert!(mean.is_nan() || (30.0..200.0).contains(&mean), "{name}: {mean}");
    }
}

/// Every mean within 4.5 standard errors of the sum that the example computes: five false alarms in a million, with a fixed seed.
#[test]
fn the_estimator_has_the_mean_of_the_sum() {
    let text = run("estimator", &[]);
    let number = |line: &str, after: &str| -> f64 {
        let rest = line.split(after).nth(1).unwrap_or_else(|| panic!("{line}"));
        rest.split_whitespace().next().unwrap().parse().unwrap()
    };
    let sum = number(text.lines().next().unwrap(), "lights:");
    let rows: Vec<(f64, f64)> = text
        .lines()
        .filter(|line| line.contains('±'))
        .map(|line| {
            let mean = line.split('±').next().unwrap().split_whitespace().last().unwrap();
            (mean.parse().unwrap(), number(line, "±"))
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
