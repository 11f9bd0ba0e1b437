//! `magcomp-bindings` writes what every language says of a status, and the settings, from the tables `bindings/*.toml` and
//! `bindings/templates`, into the repository that is the current directory; `magcomp-bindings --check` fails where a file is not what it would write.

mod config;
mod made;
mod names;
mod placeholders;
mod reading;
mod table;
mod texts;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_check = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => false,
        ["--check"] => true,
        _ => {
            eprintln!("usage: magcomp-bindings [--check], in the repository's folder");
            return ExitCode::from(2);
        }
    };
    match made::files(Path::new(".")).and_then(|files| made::kept(Path::new("."), &files, is_check)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("bindings: {why}");
            ExitCode::FAILURE
        }
    }
}
