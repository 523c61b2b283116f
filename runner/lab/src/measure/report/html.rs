//! report.html: one file without any other, to open anywhere.

use super::plot::{Line, Point, linear_log, log_log};
use super::tables::{self, COLUMNS, FILM_COLUMNS, Table};
use super::{Group, significant, thousands, verdict};
use crate::measure::heatmap;
use crate::measure::statistics::Interval;
use crate::measure::sweep::film::JudgedPicture;
use crate::measure::sweep::{Results, Row};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::collections::HashSet;

pub fn page(results: &Results) -> String {
    let (plan, about, device) = (&results.plan, &results.about, &results.about.device);
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { (plan.title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (plan.title) }
                dl {
                    dt { "device" } dd { (device.name) " (" (device.driver) ", Vulkan " (device.vulkan) ")" }
                    dt { "program" } dd { (about.program) ", commit " (about.commit) ", shaders " (about.shaders) }
                    dt { "command" } dd { (about.command) }
                    dt { "date" } dd { (about.date) }
                    dt { "runs" } dd {
                        (plan.size[0]) " x " (plan.size[1]) " pixels, " (plan.warm_up) " warm-up and " (plan.frames)
                        " timed frames, " (plan.replicas) " independent runs"
                    }
                }
                (figures(over_lights(results)))
                @for group in Group::all(results) { (section(results, &group)) }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    page.into_string()
}

fn figures(plots: impl IntoIterator<Item = String>) -> Markup {
    html! { @for plot in plots { figure.plot { (PreEscaped(plot)) } } }
}

fn section(results: &Results, group: &Group) -> Markup {
    let sentences = verdict::sentences(results, group);
    let to_an_error = results.plan.accumulate.as_ref().and_then(|a| tables::equal_time(group, &a.targets));
    html! {
        h2 { (group.title()) }
        p { (group.truth()) }
        @if let Some(text) = group.unsettled() { p { (text) } }
        @if !sentences.is_empty() {
            h3 { "Does reuse pay?" }
            ul { @for sentence in &sentences { li { (sentence) } } }
        }
        div.plots { (figures([equal_time(group), error_over_time(group)].into_iter().flatten().chain(over_pictures(group)))) }
        @if let Some(table) = to_an_error { (shown("Time to an error", &table)) }
        @if let Some(table) = tables::error_after(group) { (shown("Error after a time", &table)) }
        @for (name, rows) in group.series() {
            (shown(name, &tables::series(&rows)))
            @if let Some(table) = tables::films(&rows) { (shown(&format!("{name}: in motion"), &table)) }
        }
        p.note { (COLUMNS) }
        @if results.plan.motion.is_some() { p.note { (FILM_COLUMNS) } }
        (pictures(group))
        (strips(group))
    }
}

fn shown(name: &str, table: &Table) -> Markup {
    html! {
        h3 { (name) }
        div.wide {
            table {
                @if let Some((head, rows)) = table.split_first() {
                    tr { @for cell in head { th { (cell) } } }
                    @for row in rows { tr { @for cell in row { td { (cell) } } } }
                }
            }
        }
    }
}

/// Single frames: error over ms, the Pareto front through the best.
fn error_over_time(group: &Group) -> Option<String> {
    let mut seen = HashSet::new();
    let lines: Vec<Line> = group
        .series()
        .into_iter()
        .map(|(name, rows)| {
            let fresh = rows.iter().filter(|r| r.measured.as_ref().is_some_and(|m| seen.insert(&m.key)));
            Line { name: name.into(), points: fresh.filter_map(|r| frame_point(r)).collect(), joined: false }
        })
        .collect();
    let title = "One frame: error over time, dashed: the Pareto front";
    let empty = lines.iter().all(|line| line.points.is_empty());
    (!empty).then(|| log_log(title, "ms a frame", "relMSE", &lines, true))
}

fn frame_point(row: &Row) -> Option<Point> {
    let m = row.measured.as_ref()?;
    let e = &m.judged.as_ref()?.error.rel_mse;
    let title = format!("{}: {} ms, relMSE {}", row.label, significant(m.frame.median), significant(e.mean));
    Some(Point { x: m.frame.median, y: e.mean, bar: (e.low, e.high), title, label: row.label.clone() })
}

/// Accumulated frames: error over ms, a line an arm.
pub fn equal_time(group: &Group) -> Option<String> {
    let line = |row: &&Row| {
        let judged = row.measured.as_ref()?.judged.as_ref().filter(|j| !j.curve.is_empty())?;
        let points = judged.curve.iter().map(|p| {
            let title = format!(
                "{}: {} frames, {} ms, relMSE {}",
                row.label,
                p.frames,
                significant(p.ms),
                significant(p.rel_mse.mean)
            );
            let bar = (p.rel_mse.low, p.rel_mse.high);
            Point { x: p.ms, y: p.rel_mse.mean, bar, title, label: String::new() }
        });
        Some(Line { name: row.label.clone(), points: points.collect(), joined: true })
    };
    let lines: Vec<Line> = group.rows.iter().filter_map(line).collect();
    let title = "Accumulated frames: error over time";
    (!lines.is_empty()).then(|| log_log(title, "ms of all passes", "relMSE", &lines, false))
}

/// Films: errors over the pictures' numbers, a line an arm.
pub fn over_pictures(group: &Group) -> Vec<String> {
    let plot = |name: &str, value: fn(&JudgedPicture) -> Interval| {
        let line = |row: &&Row| {
            let film = row.measured.as_ref()?.film.as_ref()?;
            let points = film.pictures.iter().map(|p| {
                let i = value(p);
                let title = format!("{}: picture {}, {name} {}", row.label, p.number, significant(i.mean));
                Point { x: p.number.into(), y: i.mean, bar: (i.low, i.high), title, label: String::new() }
            });
            Some(Line { name: row.label.clone(), points: points.collect(), joined: true })
        };
        let lines: Vec<Line> = group.rows.iter().filter_map(line).collect();
        let title = format!("{name} of pictures; the motion begins at 0");
        (!lines.is_empty()).then(|| linear_log(&title, "picture", name, &lines))
    };
    [plot("SMAPE", |p| p.smape), plot("relMSE", |p| p.rel_mse)].into_iter().flatten().collect()
}

/// Pictures of films, one film a row.
fn strips(group: &Group) -> Markup {
    let films = group.rows.iter().filter_map(|row| Some((row, row.measured.as_ref()?.film.as_ref()?)));
    html! {
        @for (row, film) in films {
            h3 { (row.series) ": " (row.label) ", pictures of the film" }
            div.pictures {
                @for p in film.pictures.iter().filter(|p| !p.picture.is_empty()) {
                    figure {
                        div.view { img alt="" src={ "data:image/jpeg;base64," (p.picture) }; }
                        figcaption { "picture " (p.number) ", SMAPE " (significant(p.smape.mean)) }
                    }
                }
            }
        }
    }
}

/// A value and the ends of its error bar.
type Barred = (f64, (f64, f64));

/// Time and error over the number of lights, where a scene has several.
pub fn over_lights(results: &Results) -> Vec<String> {
    let mut plots = Vec::new();
    for scene in &results.plan.scenes {
        let rows: Vec<&Row> = results.rows.iter().filter(|r| r.scene == scene.name).collect();
        if rows.iter().map(|r| r.lights).collect::<HashSet<_>>().len() < 2 {
            continue;
        }
        let mut names: Vec<&str> = Vec::new();
        rows.iter().for_each(|r| {
            if !names.contains(&r.label.as_str()) {
                names.push(&r.label)
            }
        });
        let lines = |value: &dyn Fn(&Row) -> Option<Barred>| -> Vec<Line> {
            let line = |name: &&str| {
                let of_name = rows.iter().filter(|r| r.label == **name);
                let points = of_name.filter_map(|r| {
                    let (y, bar) = value(r)?;
                    let title = format!("{name}, {} lights: {}", thousands(r.lights), significant(y));
                    Some(Point { x: r.lights as f64, y, bar, title, label: String::new() })
                });
                Line { name: (*name).into(), points: points.collect(), joined: true }
            };
            names.iter().map(line).collect()
        };
        let times = lines(&|r| r.measured.as_ref().map(|m| (m.frame.median, (m.frame.median, m.frame.p95))));
        let errors = lines(&|r| {
            let error = &r.measured.as_ref()?.judged.as_ref()?.error.rel_mse;
            Some((error.mean, (error.low, error.high)))
        });
        let title = |what: &str| format!("{}: {what} over the number of lights", scene.name);
        plots.push(log_log(&title("time"), "lights", "ms a frame", &times, false));
        if errors.iter().any(|line| !line.points.is_empty()) {
            plots.push(log_log(&title("error"), "lights", "relMSE of one frame", &errors, false));
        }
    }
    plots
}

/// Side by side; wheel and drag move all of a section together.
fn pictures(group: &Group) -> Markup {
    let mut seen = HashSet::new();
    let mut figures = Vec::new();
    let mut add = |key: &str, pictures: [&str; 2], caption: &str| {
        if pictures[0].is_empty() || !seen.insert(key.to_owned()) {
            return;
        }
        figures.push(html! {
            figure {
                @for jpeg in pictures.into_iter().filter(|jpeg| !jpeg.is_empty()) {
                    div.view { img alt="" src={ "data:image/jpeg;base64," (jpeg) }; }
                }
                figcaption { (caption) }
            }
        });
    };
    for row in &group.rows {
        let Some(m) = &row.measured else { continue };
        let Some(judged) = &m.judged else { continue };
        add(&judged.truth.key, [&m.reference_picture, ""], "truth");
        let error = &judged.error;
        let numbers = format!(
            "{} ms, relMSE {}, FLIP {}",
            significant(m.frame.median),
            significant(error.rel_mse.mean),
            significant(error.flip)
        );
        let label = match row.label == row.series {
            true => row.label.clone(),
            false => format!("{}: {}", row.series, row.label),
        };
        add(&m.key, [&m.picture, &m.error_map], &format!("{label} ({numbers})"));
    }
    html! {
        @if !figures.is_empty() {
            h3 { "Pictures" }
            p.note {
                "One frame each, the middle of the picture, one exposure for all; below it where it differs from the truth: FLIP, "
                span.legend style=(legend()) {}
                " (0 to 1). The wheel zooms, dragging moves, a double click resets: all pictures of the section together."
            }
            div.pictures { @for figure in &figures { (figure) } }
        }
    }
}

/// The colors of error maps from 0 to 1.
fn legend() -> String {
    let colors: Vec<_> = heatmap::FLIP.colors.iter().map(|[r, g, b]| format!("rgb({r} {g} {b})")).collect();
    format!("background:linear-gradient(90deg,{})", colors.join(","))
}

const STYLE: &str = "
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, sans-serif; color: #222; background: #fff; max-width: 1340px; margin: 2rem auto; padding: 0 1.5rem; }
h1 { font-size: 1.7rem; margin: 0 0 1rem; }
h2 { font-size: 1.3rem; margin: 2.5rem 0 .3rem; border-bottom: 1px solid #ddd; padding-bottom: .3rem; }
h3 { font-size: 1.02rem; margin: 1.4rem 0 .4rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .1rem 1rem; margin: 0 0 1.5rem; color: #444; }
dt { color: #888; } dd { margin: 0; overflow-wrap: anywhere; }
ul { margin: .3rem 0 1rem; padding-left: 1.3rem; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(420px, 1fr)); gap: 1rem; }
.plot { margin: .5rem 0; border: 1px solid #e5e5e5; border-radius: 6px; max-width: 760px; } .plot svg { display: block; width: 100%; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .84rem; }
th, td { padding: .22rem .45rem; text-align: right; white-space: nowrap; border-bottom: 1px solid #eee; }
th { color: #666; font-weight: 600; white-space: normal; vertical-align: bottom; } th:first-child, td:first-child { text-align: left; }
tr:hover td { background: #f6f8fa; }
.note { color: #777; font-size: .84rem; max-width: 75em; }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(300px, 1fr)); gap: .8rem; }
.pictures figure { margin: 0; } .view { overflow: hidden; border-radius: 4px; background: #111; cursor: grab; }
.view img { display: block; width: 100%; transform-origin: 0 0; image-rendering: pixelated; user-select: none; }
.view + .view { margin-top: 2px; } .legend { display: inline-block; width: 7em; height: .8em; vertical-align: middle; border-radius: 2px; }
figcaption { font-size: .8rem; color: #555; padding-top: .2rem; }
";

const SCRIPT: &str = "
for (const set of document.querySelectorAll('.pictures')) {
  const images = [...set.querySelectorAll('img')];
  let scale = 1, x = 0, y = 0, drag = null;
  const show = () => {
    const box = images[0].parentElement.getBoundingClientRect();
    x = Math.min(0, Math.max(x, box.width * (1 - scale)));
    y = Math.min(0, Math.max(y, box.height * (1 - scale)));
    for (const image of images) image.style.transform = `translate(${x}px, ${y}px) scale(${scale})`;
  };
  for (const image of images) {
    const view = image.parentElement;
    image.draggable = false;
    view.addEventListener('wheel', event => {
      event.preventDefault();
      const box = view.getBoundingClientRect(), px = event.clientX - box.left, py = event.clientY - box.top;
      const next = Math.min(32, Math.max(1, scale * Math.exp(-event.deltaY * 0.002)));
      x = px - (px - x) * next / scale; y = py - (py - y) * next / scale; scale = next;
      show();
    }, { passive: false });
    view.addEventListener('pointerdown', event => { drag = [event.clientX - x, event.clientY - y]; view.setPointerCapture(event.pointerId); });
    view.addEventListener('pointermove', event => { if (drag) { x = event.clientX - drag[0]; y = event.clientY - drag[1]; show(); } });
    view.addEventListener('pointerup', () => { drag = null; });
    view.addEventListener('dblclick', () => { scale = 1; x = 0; y = 0; show(); });
  }
}
";
