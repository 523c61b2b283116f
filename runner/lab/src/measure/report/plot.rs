//! Plots with a logarithmic axis or two, as SVG that stands alone or inside a page.

use super::{significant, thousands};
use std::fmt::Write;

/// Points of one name and color.
pub struct Line {
    pub name: String,
    pub points: Vec<Point>,
    /// Joined by straight lines.
    pub joined: bool,
}

pub struct Point {
    pub x: f64,
    pub y: f64,
    /// Ends of the error bar.
    pub bar: (f64, f64),
    /// Shown when the pointer rests on it.
    pub title: String,
    /// Written beside it; may be empty.
    pub label: String,
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 400.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 48.0;

/// Okabe & Ito 2008: told apart by every eye. The yellow, too pale on white, is left out.
const COLORS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"];

/// A plot of all points with positive coordinates; `front`: the lower left border of all points is drawn too.
pub fn log_log(title: &str, x_name: &str, y_name: &str, lines: &[Line], front: bool) -> String {
    plot(title, x_name, y_name, lines, Scale::Logarithmic, front)
}

/// The same over a linear axis, which may have zero and negative values.
pub fn linear_log(title: &str, x_name: &str, y_name: &str, lines: &[Line]) -> String {
    plot(title, x_name, y_name, lines, Scale::Linear, false)
}

fn plot(title: &str, x_name: &str, y_name: &str, lines: &[Line], scale: Scale, front: bool) -> String {
    let all = || lines.iter().flat_map(|l| &l.points).filter(|p| scale.has(p.x) && p.y > 0.0);
    let x = Axis::over(scale, all().map(|p| p.x), LEFT, WIDTH - RIGHT);
    let heights = all().flat_map(|p| [p.y, p.bar.0.max(p.y / 3.0), p.bar.1]);
    let y = Axis::over(Scale::Logarithmic, heights, HEIGHT - BOTTOM, TOP);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"system-ui, sans-serif\" \
         font-size=\"11\" role=\"img\"><rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fff\"/>\
         <text x=\"{LEFT}\" y=\"18\" font-size=\"13\" font-weight=\"600\" fill=\"#222\">{}</text>\n",
        escaped(title)
    );
    axes(&mut svg, &x, &y, x_name, y_name);
    if front {
        let path = pareto(all().map(|p| (p.x, p.y)).collect());
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"#999\" stroke-dasharray=\"4 3\"/>",
            path.iter().map(|&(a, b)| format!("{:.1},{:.1}", x.at(a), y.at(b))).collect::<Vec<_>>().join(" ")
        );
    }
    let mut labels = Vec::new();
    for (i, line) in lines.iter().enumerate() {
        draw(&mut svg, line, COLORS[i % COLORS.len()], &x, &y, &mut labels);
    }
    legend(&mut svg, lines);
    svg + "</svg>\n"
}

fn axes(svg: &mut String, x: &Axis, y: &Axis, x_name: &str, y_name: &str) {
    let (bottom, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
    for (tick, named) in x.ticks() {
        let at = x.at(tick);
        let color = if named { "#ddd" } else { "#f2f2f2" };
        let _ = write!(svg, "<path d=\"M{at:.1} {TOP}V{bottom}\" stroke=\"{color}\"/>");
        if named {
            let y = bottom + 15.0;
            let _ = writeln!(
                svg,
                "<text x=\"{at:.1}\" y=\"{y}\" text-anchor=\"middle\" fill=\"#555\">{}</text>",
                label(tick)
            );
        }
    }
    for (tick, named) in y.ticks() {
        let at = y.at(tick);
        let color = if named { "#ddd" } else { "#f2f2f2" };
        let _ = write!(svg, "<path d=\"M{LEFT} {at:.1}H{right}\" stroke=\"{color}\"/>");
        if named {
            let (x, y) = (LEFT - 6.0, at + 4.0);
            let _ = writeln!(
                svg,
                "<text x=\"{x}\" y=\"{y:.1}\" text-anchor=\"end\" fill=\"#555\">{}</text>",
                label(tick)
            );
        }
    }
    let (middle_x, middle_y) = (0.5 * (LEFT + right), 0.5 * (TOP + bottom));
    let _ = writeln!(
        svg,
        "<path d=\"M{LEFT} {TOP}V{bottom}H{right}\" fill=\"none\" stroke=\"#888\"/>\
         <text x=\"{middle_x}\" y=\"{}\" text-anchor=\"middle\" fill=\"#222\">{}</text>\
         <text transform=\"translate(14 {middle_y}) rotate(-90)\" text-anchor=\"middle\" fill=\"#222\">{}</text>",
        HEIGHT - 12.0,
        escaped(x_name),
        escaped(y_name)
    );
}

/// `labels`: left, top, right, bottom of those already written; one that would cover another is left to its title.
fn draw(svg: &mut String, line: &Line, color: &str, x: &Axis, y: &Axis, labels: &mut Vec<[f64; 4]>) {
    let points: Vec<&Point> = line.points.iter().filter(|p| x.scale.has(p.x) && p.y > 0.0).collect();
    if line.joined {
        let path: Vec<_> = points.iter().map(|p| format!("{:.1},{:.1}", x.at(p.x), y.at(p.y))).collect();
        let path = path.join(" ");
        let _ = writeln!(
            svg,
            "<polyline points=\"{path}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"/>"
        );
    }
    for p in points {
        let (px, py) = (x.at(p.x), y.at(p.y));
        let (low, high) = (y.at(p.bar.0.max(p.y / 3.0)), y.at(p.bar.1.max(p.y)));
        let _ = writeln!(
            svg,
            "<g fill=\"{color}\"><title>{}</title><path d=\"M{px:.1} {low:.1}V{high:.1}\" stroke=\"{color}\"/>\
             <circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"3\"/></g>",
            escaped(&p.title)
        );
        if !p.label.is_empty() {
            // Away from the nearer side border.
            let (dx, anchor) = if px > 0.75 * WIDTH { (-6.0, "end") } else { (6.0, "start") };
            let (tx, ty) = (px + dx, py - 5.0);
            let width = 5.6 * p.label.chars().count() as f64;
            let left = if dx < 0.0 { tx - width } else { tx };
            let area = [left, ty - 9.0, left + width, ty + 2.0];
            let apart = |o: &[f64; 4]| area[2] < o[0] || area[0] > o[2] || area[3] < o[1] || area[1] > o[3];
            if !labels.iter().all(apart) {
                continue;
            }
            labels.push(area);
            let text = escaped(&p.label);
            let _ = writeln!(
                svg,
                "<text x=\"{tx:.1}\" y=\"{ty:.1}\" text-anchor=\"{anchor}\" font-size=\"10\" fill=\"#444\">{text}</text>"
            );
        }
    }
}

/// In the upper right corner, where errors that fall with time leave room.
fn legend(svg: &mut String, lines: &[Line]) {
    let longest = lines.iter().map(|l| l.name.chars().count()).max().unwrap_or(0) as f64;
    let x = WIDTH - RIGHT - 26.0 - 6.2 * longest;
    let height = 16.0 * lines.len() as f64 + 8.0;
    let _ = writeln!(
        svg,
        "<rect x=\"{x:.1}\" y=\"{}\" width=\"{:.1}\" height=\"{height}\" fill=\"#fff\" fill-opacity=\"0.85\" stroke=\"#ddd\"/>",
        TOP + 4.0,
        WIDTH - RIGHT - 4.0 - x
    );
    for (i, line) in lines.iter().enumerate() {
        let y = TOP + 20.0 + 16.0 * i as f64;
        let color = COLORS[i % COLORS.len()];
        let _ = writeln!(
            svg,
            "<circle cx=\"{:.1}\" cy=\"{}\" r=\"3.5\" fill=\"{color}\"/><text x=\"{:.1}\" y=\"{y}\" fill=\"#222\">{}</text>",
            x + 10.0,
            y - 4.0,
            x + 18.0,
            escaped(&line.name)
        );
    }
}

/// How values lie on an axis.
#[derive(Clone, Copy, PartialEq)]
enum Scale {
    Linear,
    Logarithmic,
}

impl Scale {
    fn of(self, value: f64) -> f64 {
        match self {
            Scale::Linear => value,
            Scale::Logarithmic => value.max(f64::MIN_POSITIVE).log10(),
        }
    }

    /// Has the axis a place for it?
    fn has(self, value: f64) -> bool {
        value.is_finite() && (self == Scale::Linear || value > 0.0)
    }

    /// Values that the axis shows at least, on its scale.
    fn least(self) -> f64 {
        match self {
            Scale::Linear => 1.0,
            Scale::Logarithmic => 0.3,
        }
    }
}

struct Axis {
    scale: Scale,
    /// The ends, on the scale.
    low: f64,
    high: f64,
    /// Places of the ends in the picture.
    from: f64,
    to: f64,
}

impl Axis {
    fn over(scale: Scale, values: impl Iterator<Item = f64>, from: f64, to: f64) -> Axis {
        let shown = values.filter(|v| scale.has(*v)).map(|v| scale.of(v));
        let (low, high) = shown.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        let margin = 0.06 * (high - low).max(scale.least());
        Axis { scale, low: low - margin, high: high + margin, from, to }
    }

    fn at(&self, value: f64) -> f64 {
        let t = (self.scale.of(value) - self.low) / (self.high - self.low);
        self.from + t.clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// (value, has it a number) of every grid line.
    fn ticks(&self) -> Vec<(f64, bool)> {
        match self.scale {
            Scale::Linear => self.even_ticks(),
            Scale::Logarithmic => self.decades(),
        }
    }

    /// Six of them or some more, at multiples of 1, 2 or 5.
    fn even_ticks(&self) -> Vec<(f64, bool)> {
        let rough = (self.high - self.low) / 6.0;
        let decade = 10f64.powf(rough.log10().floor());
        let step = [5.0, 2.0, 1.0].map(|digit| digit * decade).into_iter().find(|s| *s <= rough);
        let step = step.unwrap_or(decade);
        let range = (self.low / step).ceil() as i64..=(self.high / step).floor() as i64;
        range.map(|k| (k as f64 * step, true)).collect()
    }

    /// 1..9 of each decade; numbers at 1, also at 2 and 5 of short axes.
    fn decades(&self) -> Vec<(f64, bool)> {
        let decades = self.high - self.low;
        let named = |digit: i32| match digit {
            1 => true,
            2 | 5 => decades < 2.5,
            _ => decades < 0.5,
        };
        let range = self.low.floor() as i32..=self.high.ceil() as i32;
        let all = range.flat_map(|e| (1..10).map(move |d| (f64::from(d) * 10f64.powi(e), d)));
        let inside = all.filter(|(v, _)| (self.low..=self.high).contains(&v.log10()));
        inside.map(|(v, d)| (v, named(d))).collect()
    }
}

/// The points that no other point is below and left of, from left to right.
pub fn pareto(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for p in points {
        if front.last().is_none_or(|last| p.1 < last.1) {
            front.push(p);
        }
    }
    front
}

fn label(tick: f64) -> String {
    if tick >= 1000.0 {
        return thousands(tick.round() as usize);
    }
    let text = significant(tick);
    match text.contains('.') && !text.contains('e') {
        true => text.trim_end_matches('0').trim_end_matches('.').into(),
        false => text,
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_nothing_beats() {
        let points = vec![(2.0, 5.0), (1.0, 9.0), (3.0, 6.0), (2.0, 7.0), (4.0, 1.0), (5.0, 1.0)];
        assert_eq!(pareto(points), [(1.0, 9.0), (2.0, 5.0), (4.0, 1.0)]);
    }

    #[test]
    fn axes_are_logarithmic() {
        let axis = Axis { scale: Scale::Logarithmic, low: 0.0, high: 2.0, from: 100.0, to: 300.0 };
        assert_eq!((axis.at(1.0), axis.at(10.0), axis.at(100.0)), (100.0, 200.0, 300.0));
        let named: Vec<f64> = axis.ticks().into_iter().filter(|t| t.1).map(|t| t.0).collect();
        assert_eq!(named, [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
        assert_eq!(
            (label(0.05), label(1.0), label(3_000_000.0)),
            ("0.05".into(), "1".into(), "3,000,000".into())
        );
    }

    #[test]
    fn linear_axes_have_zero_and_less() {
        let axis = Axis { scale: Scale::Linear, low: -3.0, high: 57.0, from: 0.0, to: 600.0 };
        assert_eq!((axis.at(-3.0), axis.at(0.0), axis.at(27.0)), (0.0, 30.0, 300.0));
        let ticks: Vec<f64> = axis.ticks().into_iter().map(|t| t.0).collect();
        assert_eq!(ticks, (0..6).map(|k| 10.0 * f64::from(k)).collect::<Vec<_>>());
    }

    #[test]
    fn names_can_hold_anything() {
        let point = Point { x: 1.0, y: 1.0, bar: (0.0, 2.0), title: "<&>".into(), label: "\"".into() };
        let line = Line { name: "a<b".into(), points: vec![point], joined: true };
        let svg = log_log("t", "x", "y", &[line], true);
        assert!(svg.contains("a&lt;b") && svg.contains("&lt;&amp;&gt;") && !svg.contains("NaN"));
        assert!(!log_log("nothing", "x", "y", &[], true).contains("NaN"));
    }
}
