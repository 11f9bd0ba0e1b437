//! Where the border's few messages go: Android's log, else stderr. The core never logs.

use crate::guarded::caught;
use std::sync::Once;

/// Least important message that is still written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum LogLevel {
    /// Nothing.
    Off,
    /// Defects: a caught panic.
    Error,
    /// What an app should know.
    Warn,
    /// What happened.
    Info,
    /// Details.
    Debug,
}

impl From<LogLevel> for log::LevelFilter {
    fn from(level: LogLevel) -> Self {
        match level {
            LogLevel::Off => Self::Off,
            LogLevel::Error => Self::Error,
            LogLevel::Warn => Self::Warn,
            LogLevel::Info => Self::Info,
            LogLevel::Debug => Self::Debug,
        }
    }
}

/// The hook of panics is set once, or each call would wrap the one before.
static HOOKED: Once = Once::new();

/// Starts writing messages under a tag, and sends a panic's place there too, before whatever heard of panics until then. The first call in a process sets the tag,
/// later ones the level.
#[uniffi::export]
pub fn start_logging(tag: String, level: LogLevel) {
    // nothing in here may end the app
    let _ = caught(|| {
        platform::start(tag);
        log::set_max_level(level.into());
        HOOKED.call_once(|| {
            // the app's own, such as a crash reporter's, or the standard one
            let before = std::panic::take_hook();
            std::panic::set_hook(Box::new(move |panic| {
                log::error!("{panic}");
                before(panic);
            }));
        });
    });
}

#[cfg(target_os = "android")]
mod platform {
    pub(super) fn start(tag: String) {
        let config = android_logger::Config::default().with_tag(tag).with_max_level(log::LevelFilter::Trace);
        android_logger::init_once(config);
    }
}

#[cfg(not(target_os = "android"))]
mod platform {
    use std::io::Write;

    struct Stderr {
        tag: String,
    }

    impl log::Log for Stderr {
        fn enabled(&self, metadata: &log::Metadata<'_>) -> bool {
            metadata.level() <= log::max_level()
        }

        fn log(&self, record: &log::Record<'_>) {
            if self.enabled(record.metadata()) {
                // a closed stderr is no reason to panic, as eprintln! would
                let _ = writeln!(std::io::stderr(), "{} {}: {}", record.level(), self.tag, record.args());
            }
        }

        fn flush(&self) {}
    }

    pub(super) fn start(tag: String) {
        // fails when a logger was set before, which then stays
        let _ = log::set_boxed_logger(Box::new(Stderr { tag }));
    }
}
