//! The verbs of the command.

mod common;
mod compare;
mod demo;
mod evaluate;
mod paper;
mod sensitivity;
mod simulate;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;
use magcomp_replay::command::{Check, Import, Replay};
use magcomp_replay::error::RunError;
use std::io::{self, Write};

/// A compass library for phones: it keeps pointing north when a magnet is put on the phone, and says how far off it may be.
///
/// This command plays recordings through it, checks and judges them, and sets it beside other methods.
#[derive(Debug, Parser)]
#[command(
    name = "magcomp",
    version,
    after_help = "Exit codes: 0 all went well; 1 the input or the run failed (one line on standard error says where and \
                  why; no output file is left half written); 2 wrong usage, or several recordings where one is wanted; \
                  3 something is wrong with the recording (units, axes, signs, or against its reference), and the first line of the\n                  summary says what."
)]
pub struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

// each verb's own documentation is its help
#[derive(Debug, Subcommand)]
enum Verb {
    Demo(demo::Demo),
    Import(Import),
    Check(Check),
    Replay(Box<Replay>),
    /// The paper's experiments, simulated (docs/dev/PAPER.md)
    #[command(subcommand)]
    Paper(paper::Paper),
    Compare(compare::Compare),
    Evaluate(evaluate::Evaluate),
    Sensitivity(sensitivity::Sensitivity),
    Simulate(simulate::Simulate),
    /// Print a script that completes this command in a shell; bash: source <(magcomp completions bash)
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Print the manual page; magcomp manual | man -l -
    Manual,
}

impl Cli {
    /// Runs the verb.
    pub fn run(self) -> Result<(), RunError> {
        match self.verb {
            Verb::Demo(verb) => verb.run(),
            Verb::Import(verb) => verb.run(),
            Verb::Check(verb) => verb.run(),
            Verb::Replay(verb) => verb.run(),
            Verb::Paper(verb) => verb.run(),
            Verb::Compare(verb) => verb.run(),
            Verb::Evaluate(verb) => verb.run(),
            Verb::Sensitivity(verb) => verb.run(),
            Verb::Simulate(verb) => verb.run(),
            Verb::Completions { shell } => {
                let mut script = Vec::new();
                clap_complete::generate(shell, &mut Self::command(), "magcomp", &mut script);
                Ok(io::stdout().write_all(&script)?)
            }
            Verb::Manual => Ok(manual(&mut io::stdout())?),
        }
    }
}

/// One page: the command, then each verb with its options.
fn manual(out: &mut dyn Write) -> io::Result<()> {
    let mut command = Cli::command();
    command.build();
    let page = clap_mangen::Man::new(command.clone());
    page.render_title(out)?;
    page.render_name_section(out)?;
    page.render_synopsis_section(out)?;
    page.render_description_section(out)?;
    page.render_subcommands_section(out)?;
    let verbs = command.get_subcommands().flat_map(|verb| std::iter::once(verb).chain(verb.get_subcommands()));
    for verb in verbs.filter(|verb| verb.get_name() != "help") {
        let name = verb.get_bin_name().unwrap_or_default().trim_start_matches("magcomp ");
        writeln!(out, ".SH {}", name.to_uppercase())?;
        let page = clap_mangen::Man::new(verb.clone());
        let mut text = Vec::new();
        page.render_description_section(&mut text)?;
        page.render_options_section(&mut text)?;
        // sections of a verb are parts of its own
        out.write_all(String::from_utf8_lossy(&text).replace(".SH ", ".SS ").as_bytes())?;
    }
    page.render_extra_section(out)?;
    page.render_version_section(out)
}
