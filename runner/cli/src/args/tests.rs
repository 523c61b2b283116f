//! What can be said, and what is refused.

use super::*;
use crate::render::Frames;
use candela::knobs::{self, Auto, Knobs};

fn render(line: &str) -> Result<RenderArgs, clap::Error> {
    let cli = Cli::try_parse_from(["candela", "render"].into_iter().chain(line.split(' ')))?;
    match cli.command {
        Some(Command::Render(args)) => Ok(args),
        _ => unreachable!(),
    }
}

#[test]
fn defaults_are_the_documents_defaults() {
    let document = render("-o a.png").unwrap().knobs.knobs().unwrap();
    assert_eq!(document, Knobs::default());
}

/// Whatever the file says, the command line has the last word; what it does not mention stays.
#[test]
fn the_command_line_overrides_the_file() {
    let path = std::env::temp_dir().join(format!("candela-knobs-{}.json", std::process::id()));
    std::fs::write(&path, r#"{"candidates": 5, "temporal": false, "neighbors": 7, "tiles": "on"}"#).unwrap();
    let line = |rest: &str| format!("-o a.png --settings {} {rest}", path.display()).trim().to_owned();
    let document = |rest: &str| render(&line(rest)).unwrap().knobs.knobs();
    let file = document("").unwrap();
    assert_eq!((file.candidates, file.temporal, file.neighbors, file.tiles), (5, false, 7, Auto::On));
    let changed = document("--candidates 6 --temporal --no-tiles").unwrap();
    let expected = Knobs { candidates: 6, temporal: true, tiles: Auto::Off, ..file };
    assert_eq!(changed, expected);
    std::fs::write(&path, r#"{"candidates": 5000}"#).unwrap();
    let error = document("").unwrap_err().to_string();
    assert!(error.contains("candela-knobs") && error.contains("1..=1024"), "{error}");
    std::fs::remove_file(&path).unwrap();
}

/// What `options` says is what can be typed, and gives the same knobs again.
#[test]
fn every_knob_can_be_typed() {
    let base = Knobs::default();
    let typed = |line: &str| render(&format!("-o a.png {line}")).unwrap().knobs.knobs().unwrap();
    for knob in knobs::ALL {
        let mut other = base.clone();
        knob.toggle(&mut other);
        let line = other.options(&base).join(" ");
        assert_eq!(typed(&line), other, "{line}");
    }
    let other = Knobs { radius: 12.3, confidence_cap: 0.1, normal_threshold: 33.3, ..base.clone() };
    assert_eq!(typed(&other.options(&base).join(" ")), other);
    assert!(base.options(&base).is_empty());
    let off = Knobs { visibility: false, tiles: Auto::Off, ..base.clone() };
    assert_eq!(base.options(&Knobs { tiles: Auto::Auto, ..off.clone() }), ["--visibility"]);
    assert_eq!(off.options(&base), ["--no-visibility", "--no-tiles"]);
}

#[test]
fn the_last_of_two_flags_counts() {
    let temporal = |line: &str| render(line).unwrap().knobs.knobs().unwrap().temporal;
    assert!(!temporal("-o a.png --temporal --no-temporal"));
    assert!(temporal("-o a.png --no-temporal --temporal"));
}

#[test]
fn help_says_all_of_each_knob() {
    use clap::CommandFactory;
    let mut command = Cli::command();
    let help = command.find_subcommand_mut("render").unwrap().render_long_help().to_string();
    for knob in knobs::ALL {
        assert!(help.contains(&format!("--{}", knob.name.replace('_', "-"))), "{}", knob.name);
        assert!(help.contains(knob.about) && help.contains(&knob.default_in_words()), "{}", knob.name);
        assert!(
            knob.words().iter().all(|(word, about)| about.is_empty() || help.contains(&format!("{word}: ")))
        );
    }
}

#[test]
fn knobs_reach_the_settings() {
    let line = "a.glb 7 -o a.png --size 64x48 --candidates 8 --neighbors 3 --iterations 1 --radius 10 --reservoirs 2 \
                --no-temporal --no-spatial --spatial --no-visibility --depth-threshold 0.2 --normal-threshold 60";
    let args = render(&line.split_whitespace().collect::<Vec<_>>().join(" ")).unwrap();
    let s = args.knobs.knobs().unwrap().settings(7);
    assert_eq!((s.candidates, s.neighbors, s.spatial_iterations, s.reservoirs), (8, 3, 1, 2));
    assert_eq!((s.temporal, s.spatial, s.visibility_reuse), (0, 1, 0));
    assert_eq!((s.radius, s.depth_threshold), (10.0, 0.2));
    assert!((s.normal_threshold - 0.5).abs() < 1e-6);
    assert_eq!((args.scene.light_count(), args.picture.size), (7, UVec2::new(64, 48)));
}

#[test]
fn the_viewer_needs_no_command() {
    let parse = |line: &str| Cli::try_parse_from(line.split(' ')).unwrap();
    let cli = parse("candela");
    assert!(cli.command.is_none() && cli.view.scene.source() == SceneSource::Atrium);
    let cli = parse("candela a.glb 7 --candidates 8 --camera=-1,2,3,4,5,6");
    assert!(cli.command.is_none() && cli.view.knobs.knobs().unwrap().candidates == 8);
    assert_eq!((cli.view.scene.light_count(), cli.view.camera.as_deref()), (7, Some("-1,2,3,4,5,6")));
    let Some(Command::View(args)) = parse("candela view a.glb 7").command else { panic!("no view") };
    assert_eq!(args.scene.scene, PathBuf::from("a.glb"));
    assert!(matches!(parse("candela info a.glb").command, Some(Command::Info(_))));
}

#[test]
fn nonsense_is_refused() {
    for line in [
        "",
        "-o a.png --size 64",
        "-o a.png --size 0x5",
        "-o a.png --candidates 0",
        "-o a.png --candidates 2000",
        "-o a.png --radius nan",
        "-o a.png --radius -1",
        "-o a.png --mode magic",
        "a.glb 5 --lights 6 -o a.png",
        "-o a.png --frames 0",
        "-o a.png --frames 5..5",
        "-o a.png --frames 5..x",
        "-o a.png --frames 0..4294967295",
        "a.glb 16777217 -o a.png",
        "-o a.png --lights 99999999999999999999",
        "-o a.png --exposure nan",
        "-o a.png --exposure 1e30",
        "-o a.png --time -1",
        "-o a.png --time nan",
        "-o a.png --camera a --camera-path b",
    ] {
        assert!(render(line).is_err(), "{line}");
    }
}

#[test]
fn frames_are_a_number_or_a_range() {
    assert_eq!(render("-o a.png").unwrap().frames, Frames::Still(16));
    assert_eq!(render("-o a.png --frames 3").unwrap().frames, Frames::Still(3));
    assert_eq!(render("-o a.png --frames 10..20").unwrap().frames, Frames::Sequence(10..20));
    // As with every option, the last one counts.
    assert_eq!(render("-o a.png --frames 10..20 --frames 4").unwrap().frames, Frames::Still(4));
}

#[test]
fn pixels_are_two_counts() {
    for line in [["-1", "0"].as_slice(), &["5"]] {
        assert!(Cli::try_parse_from(["candela", "explain"].iter().chain(line)).is_err(), "{line:?}");
    }
}
