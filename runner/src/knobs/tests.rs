use super::*;

fn parse(text: &str) -> Result<Knobs, String> {
    let knobs: Knobs = serde_json::from_str(text).map_err(|e| e.to_string())?;
    knobs.check().map(|()| knobs)
}

#[test]
fn missing_knobs_have_their_defaults() {
    assert_eq!(parse("{}").unwrap(), Knobs::default());
    let one = parse(r#"{"candidates": 8}"#).unwrap();
    assert_eq!(one, Knobs { candidates: 8, ..Knobs::default() });
}

/// The defaults of the document are those of the shaders' settings, each written once; the document's one word more is
/// `auto`, which is off without lights.
#[test]
fn defaults_are_the_same_for_people_and_shaders() {
    assert_eq!(Knobs::default().settings(0), Settings::default());
    assert_eq!(Knobs::default().settings(4096).tiles, 1);
}

/// To the other value and through a document: every bit comes back, and only that knob's field has changed.
#[test]
fn every_knob_goes_through_a_document_to_its_own_field() {
    let default = Knobs::default();
    let words =
        |knobs: &Knobs| bytemuck::cast::<Settings, [u32; size_of::<Settings>() / 4]>(knobs.settings(0));
    for (i, &knob) in ALL.iter().enumerate() {
        let mut knobs = default.clone();
        // From auto up, to on.
        knob.step(&mut knobs, Step::Up);
        if knobs == default {
            knob.step(&mut knobs, Step::Down);
        }
        assert_eq!(parse(&knobs.to_json()).unwrap(), knobs);
        let changed: Vec<usize> =
            (0..words(&default).len()).filter(|&i| words(&knobs)[i] != words(&default)[i]).collect();
        let of_host = i == words(&default).len();
        assert_eq!(changed, if of_host { vec![] } else { vec![i] }, "{}", knob.name);
    }
}

#[test]
fn documents_know_the_words_of_the_command_line() {
    for knob in ALL {
        for (word, _) in knob.words() {
            let knobs = parse(&format!("{{\"{}\": \"{word}\"}}", knob.name)).unwrap();
            assert_eq!(knob.value(&knobs), Value::Word(word));
            assert_eq!(knob.parse(word), Ok(Value::Word(word)));
        }
    }
}

#[test]
fn tiles_come_with_many_lights() {
    let tiles = |tiles, lights| Knobs { tiles, ..Knobs::default() }.settings(lights).tiles;
    assert_eq!((tiles(Auto::Auto, 4095), tiles(Auto::Auto, 4096)), (0, 1));
    assert_eq!((tiles(Auto::On, 1), tiles(Auto::Off, 1_000_000)), (1, 0));
}

#[test]
fn mistakes_are_one_line_that_names_them() {
    for (text, word) in [
        (r#"{"candidate": 8}"#, "unknown field `candidate`"),
        (r#"{"candidates": 0}"#, "candidates: 0 is not in 1..=1024"),
        (r#"{"candidates": -3}"#, "-3"),
        (r#"{"bsdf_candidates": 5}"#, "bsdf_candidates: 5 is not in 0..=4"),
        (r#"{"iterations": 9}"#, "iterations"),
        (r#"{"radius": 0}"#, "radius: 0 is not a number above 0"),
        (r#"{"radius": 1e99}"#, "out of range"),
        (r#"{"normal_threshold": 181}"#, "normal_threshold: 181 is more than 180 degrees"),
        (r#"{"mode": "magic"}"#, "magic"),
        (r#"{"primary": "guess"}"#, "guess"),
        (r#"{"temporal": 1}"#, "boolean"),
        ("[1", "line 1"),
    ] {
        let error = parse(text).unwrap_err();
        assert!(error.contains(word) && !error.contains('\n'), "{text}: {error}");
    }
}

/// All the way down and up again: every value is allowed, and both ends are reached.
#[test]
fn knobs_stay_in_their_ranges() {
    for &knob in ALL {
        let mut knobs = Knobs::default();
        for step in [Step::Down, Step::Up, Step::Down] {
            for _ in 0..100 {
                knob.step(&mut knobs, step);
                knobs.check().unwrap();
            }
            let end = knobs.clone();
            knob.step(&mut knobs, step);
            assert_eq!(knobs, end, "{} has an end", knob.name);
        }
    }
}

#[test]
fn each_knob_changes_its_own_setting_only() {
    let default = Knobs::default();
    for &knob in ALL {
        let mut knobs = default.clone();
        knob.toggle(&mut knobs);
        let changed: Vec<_> = ALL.iter().copied().filter(|k| k.value(&knobs) != k.value(&default)).collect();
        assert_eq!(changed, [knob]);
    }
}

#[test]
fn light_samples_double_and_halve() {
    let mut knobs = Knobs::default();
    let mut down = Vec::new();
    for _ in 0..6 {
        by_name::candidates.step(&mut knobs, Step::Down);
        down.push(knobs.candidates);
    }
    assert_eq!(down, [16, 8, 4, 2, 1, 1]);
    for _ in 0..11 {
        by_name::candidates.step(&mut knobs, Step::Up);
    }
    assert_eq!(knobs.candidates, 1024);
}

#[test]
fn amounts_come_back_onto_their_grid() {
    let mut knobs = Knobs { radius: 32.0, normal_threshold: 33.5, ..Knobs::default() };
    by_name::radius.step(&mut knobs, Step::Up);
    assert_eq!(knobs.radius, 35.0);
    by_name::radius.step(&mut knobs, Step::Down);
    by_name::radius.step(&mut knobs, Step::Down);
    assert_eq!(knobs.radius, 25.0);
    by_name::normal_threshold.step(&mut knobs, Step::Down);
    assert_eq!(knobs.normal_threshold, 30.0);
}
