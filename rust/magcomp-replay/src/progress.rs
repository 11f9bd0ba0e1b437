//! Progress on standard error of work that takes a while: a bar on a terminal, elsewhere a line each ten seconds.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Time between two lines.
const LINE: Duration = Duration::from_secs(10);

/// How far it is.
pub struct Progress {
    bar: ProgressBar,
    what: &'static str,
    /// When the latest line was written; none on a terminal.
    written: Option<Mutex<Instant>>,
}

/// Progress of so many steps.
pub fn bar(steps: usize, what: &'static str) -> Progress {
    let bar = ProgressBar::with_draw_target(Some(steps as u64), ProgressDrawTarget::stderr_with_hz(8));
    if let Ok(style) = ProgressStyle::with_template("{msg} [{bar:40}] {percent}% {eta} left") {
        bar.set_style(style.progress_chars("=> "));
    }
    let written = (!std::io::stderr().is_terminal()).then(|| Mutex::new(Instant::now()));
    Progress { bar: bar.with_message(what), what, written }
}

impl Progress {
    /// So many more steps are done.
    pub fn inc(&self, steps: u64) {
        self.bar.inc(steps);
        if let Some(Ok(mut written)) = self.written.as_ref().map(Mutex::lock)
            && written.elapsed() > LINE
        {
            *written = Instant::now();
            let (done, all) = (self.bar.position(), self.bar.length().unwrap_or_default());
            // where nobody reads it, it is not missed
            let _ = writeln!(std::io::stderr(), "{}: {done} of {all}", self.what);
        }
    }

    /// All is done: nothing of it stays on a terminal.
    pub fn finish_and_clear(&self) {
        self.bar.finish_and_clear();
    }
}
