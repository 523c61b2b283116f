//! Equations of GitHub's Markdown as MathML, which browsers show without a script, style sheet or font.

use anyhow::{Result, anyhow};
use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::mathml::push_mathml;
use pulldown_latex::{Parser, Storage};
use std::convert::Infallible;

/// Numbers stand at the right of their equations.
pub const STYLE: &str =
    ".equation { display: flex; align-items: center; overflow: auto hidden; padding: 0.3em 0; }
.equation math { flex: 1; }
";

/// A block of LaTeX, which may end with `\tag{N}`, as one line of HTML.
pub fn block(latex: &str) -> Result<String> {
    let (equation, number) = match latex.trim().rsplit_once("\\tag{") {
        Some((equation, rest)) => (equation, rest.trim_end_matches('}')),
        None => (latex, ""),
    };
    let number = if number.is_empty() { String::new() } else { format!("<span>({number})</span>") };
    Ok(format!("<div class=\"equation\">{}{number}</div>", mathml(equation, DisplayMode::Block)?))
}

/// `text`, outside of code, with what stands between dollars as MathML.
pub fn inline(text: &str) -> Result<String> {
    let mut parts = text.split('$');
    let mut html = parts.next().unwrap_or_default().to_owned();
    while let Some(latex) = parts.next() {
        let rest = parts.next().ok_or_else(|| anyhow!("a dollar without a second one: {text}"))?;
        html += &mathml(latex, DisplayMode::Inline)?;
        html += rest;
    }
    Ok(html)
}

fn mathml(latex: &str, display_mode: DisplayMode) -> Result<String> {
    let storage = Storage::new();
    let events: Result<Vec<_>, _> = Parser::new(latex, &storage).collect();
    let events = events.map_err(|error| anyhow!("{latex}: {error}"))?;
    let mut html = String::new();
    let config = RenderConfig { display_mode, ..Default::default() };
    push_mathml(&mut html, events.into_iter().map(Ok::<_, Infallible>), config)?;
    // A bar would end the cell of a table.
    Ok(html.replace('|', "&#124;"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_become_mathml() {
        let html = block("W=\\frac{1}{\\hat p(y)}\\sum_i w_i \\tag{9}\n").unwrap();
        assert!(html.starts_with("<div class=\"equation\"><math display=\"block\">"), "{html}");
        assert!(html.contains("<mfrac>") && html.ends_with("</math><span>(9)</span></div>"), "{html}");
        assert!(!html.contains('\n') && !html.contains("tag"));
        let html = inline("so $x$ and $\\lvert y\\rvert$.").unwrap();
        assert!(html.starts_with("so <math") && html.ends_with("</math>.") && !html.contains('|'), "{html}");
        assert_eq!(html.matches("<math").count(), 2);
        assert_eq!(inline("no equation").unwrap(), "no equation");
    }

    #[test]
    fn what_is_no_equation_is_an_error() {
        assert!(block("\\frac{1}{").is_err());
        assert!(block("\\nosuchcommand x").is_err());
        assert!(inline("5 $ are not $x$").is_err());
    }
}
