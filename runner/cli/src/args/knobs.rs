//! Every knob on the command line: an option, or a pair of flags, for each row of the table.

use candela::error::{Error, Result};
use candela::knobs::{self, Choice, Knob, Knobs, Value};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser, ValueParser};
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches, value_parser};
use std::path::PathBuf;

/// The knobs of `--settings`, changed by what else is said. See [`Knobs`].
#[derive(Clone, Debug, Default)]
pub struct KnobArgs {
    settings: Option<PathBuf>,
    changes: Vec<(&'static Knob, Value)>,
}

impl KnobArgs {
    /// The document, or the defaults, with the changes of the command line.
    pub fn knobs(&self) -> Result<Knobs> {
        let mut knobs = self.settings.as_deref().map(Knobs::read).transpose()?.unwrap_or_default();
        for &(knob, value) in &self.changes {
            knob.set(&mut knobs, value);
        }
        knobs.check().map_err(Error::Usage)?;
        Ok(knobs)
    }
}

const SETTINGS: &str = "settings";

impl Args for KnobArgs {
    fn augment_args(command: Command) -> Command {
        let settings =
            Arg::new(SETTINGS).long(SETTINGS).value_name("FILE").value_parser(value_parser!(PathBuf));
        let command = command.arg(settings.help("JSON document of knobs; the options below override it"));
        knobs::ALL.iter().fold(command, |command, knob| command.args(options(knob)))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for KnobArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut args = KnobArgs::default();
        args.update_from_arg_matches(matches)?;
        Ok(args)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        self.settings = matches.get_one(SETTINGS).cloned();
        let said = |knob: &Knob| match knob.is_flag() {
            true if matches.get_flag(knob.name) => Some(knob.flag(true)),
            true if matches.get_flag(&negated(knob.name)) => Some(knob.flag(false)),
            true => None,
            false => matches.get_one(knob.name).copied(),
        };
        self.changes = knobs::ALL.iter().filter_map(|&knob| Some((knob, said(knob)?))).collect();
        Ok(())
    }
}

fn negated(name: &str) -> String {
    format!("no_{name}")
}

fn options(knob: &'static Knob) -> Vec<Arg> {
    let long = knob.name.replace('_', "-");
    let arg = Arg::new(knob.name).help(help(knob)).long(long.clone());
    if knob.is_flag() {
        let flag = |arg: Arg| arg.action(ArgAction::SetTrue);
        let off = Arg::new(negated(knob.name)).long(format!("no-{long}")).overrides_with(knob.name);
        return vec![flag(arg.overrides_with(negated(knob.name))), flag(off)];
    }
    let parser = match knob.words() {
        [] => ValueParser::new(move |text: &str| knob.parse(text)),
        words => one_of(words).try_map(move |word| knob.parse(&word)).into(),
    };
    vec![arg.value_name(knob.name.to_uppercase()).value_parser(parser)]
}

/// What it is about, its unit and its default.
fn help(knob: &Knob) -> String {
    let unit = if knob.unit.is_empty() { String::new() } else { format!(", {}", knob.unit) };
    format!("{}{unit} [default: {}]", knob.about, knob.default_in_words())
}

/// A parser of words that `--help` lists with their meanings.
fn one_of(words: &'static [(&'static str, &'static str)]) -> PossibleValuesParser {
    words.iter().map(|&(word, about)| PossibleValue::new(word).help(about)).collect::<Vec<_>>().into()
}

/// A parser of a choice, for options that are no knobs.
pub fn choice<T: Choice + Send + Sync>() -> impl TypedValueParser<Value = T> {
    one_of(T::WORDS).try_map(|word| T::from_word(&word).ok_or("one of these words is expected"))
}
