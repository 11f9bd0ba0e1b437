//! Writing: beside the name first, then moved into place, so that a run that fails or is ended by a signal leaves no half file.

use crate::error::RunError;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::collections::BTreeSet;
use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};
use tempfile::NamedTempFile;

const PREFIX: &str = ".magcomp-";
const SUFFIX: &str = ".tmp";
/// Limit: a temporary file is locked well before it is so old.
const LOCKED_WITHIN: Duration = Duration::from_secs(60);

/// Removes what runs left that were killed. Whoever still writes a temporary file holds its lock, which ends with the process.
fn sweep(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if !(name.starts_with(PREFIX) && name.ends_with(SUFFIX) && entry.file_type()?.is_file()) {
            continue;
        }
        let age = SystemTime::now().duration_since(entry.metadata()?.modified()?).unwrap_or_default();
        if age > LOCKED_WITHIN && OpenOptions::new().write(true).open(entry.path())?.try_lock().is_ok() {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// Temporary files of this process that a signal must remove.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Lets SIGINT, SIGTERM and SIGHUP remove the temporary files before they end the process as usual. A signal that is ignored
/// from the start, such as SIGHUP under `nohup`, stays ignored where the system tells so (Linux).
#[cfg(unix)]
pub fn remove_unfinished_on_signals() -> io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    let heard = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| ignored.unwrap_or(0) >> (signal - 1) & 1 == 0);
    let mut signals = signal_hook::iterator::Signals::new(heard)?;
    std::thread::spawn(move || {
        for signal in signals.forever() {
            // held to the end, so that no other file is begun
            let unfinished = unfinished();
            for path in unfinished.iter() {
                let _ = fs::remove_file(path);
            }
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    });
    Ok(())
}

/// Elsewhere signals end the process as ever.
#[cfg(not(unix))]
pub fn remove_unfinished_on_signals() -> io::Result<()> {
    Ok(())
}

/// A file that appears under its name, whole, when it is finished; gzipped when the name ends in `.gz`. Until then, and when
/// it is dropped, what was there before stays. A link stays one. A device, a pipe or standard output is written into
/// directly.
pub struct AtomicFile {
    path: PathBuf,
    content: Content,
    temporary: Option<Temporary>,
}

/// A temporary file and the path that it gets in the end; a device or a pipe has none.
type Temporary = (NamedTempFile, PathBuf);
type Target = (Box<dyn Write>, Option<Temporary>);

enum Content {
    Plain(BufWriter<Box<dyn Write>>),
    Zipped(GzEncoder<BufWriter<Box<dyn Write>>>),
}

impl AtomicFile {
    /// Begins to write `path`.
    pub fn create(path: &Path) -> Result<Self, RunError> {
        let begin = || -> io::Result<Target> {
            match fs::metadata(path) {
                Ok(there) if there.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
                Ok(there) if !there.is_file() => {
                    return Ok((Box::new(OpenOptions::new().write(true).open(path)?), None));
                }
                // standard output that is redirected to a file
                Ok(_) if same_file::Handle::from_path(path)? == same_file::Handle::stdout()? => {
                    return Ok((Box::new(io::stdout()), None));
                }
                _ => {}
            }
            let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let mut builder = tempfile::Builder::new();
            builder.prefix(PREFIX).suffix(SUFFIX);
            #[cfg(unix)]
            {
                // an ordinary file's permissions (less the umask), not a secret's
                use std::os::unix::fs::PermissionsExt;
                builder.permissions(fs::Permissions::from_mode(0o666));
            }
            // what cannot be swept stays
            let _ = sweep(folder);
            let mut unfinished = unfinished();
            // an error of the temporary file's own name would help nobody
            let temporary = builder.tempfile_in(folder).map_err(|why| {
                if folder.is_dir() {
                    why
                } else {
                    io::Error::new(why.kind(), format!("there is no folder {}", folder.display()))
                }
            })?;
            // where the system has no locks nothing is swept either
            let _ = temporary.as_file().try_lock();
            unfinished.insert(temporary.path().to_owned());
            Ok((Box::new(temporary.as_file().try_clone()?), Some((temporary, path))))
        };
        let (target, temporary) = begin().map_err(RunError::write(path))?;
        let target = BufWriter::new(target);
        let content = if path.extension().is_some_and(|extension| extension == "gz") {
            Content::Zipped(GzEncoder::new(target, Compression::default()))
        } else {
            Content::Plain(target)
        };
        Ok(Self { path: path.to_owned(), content, temporary })
    }

    /// Writes through `content`.
    pub fn write(&mut self, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), RunError> {
        let written = match &mut self.content {
            Content::Plain(out) => content(out),
            Content::Zipped(out) => content(out),
        };
        written.map_err(RunError::write(&self.path))
    }

    /// Moves it into place.
    pub fn finish(self) -> Result<(), RunError> {
        let finish = || -> io::Result<()> {
            let mut target = match self.content {
                Content::Plain(target) => target,
                Content::Zipped(zipped) => zipped.finish()?,
            };
            target.flush()?;
            if let Some((temporary, path)) = self.temporary {
                let mut unfinished = unfinished();
                let name = temporary.path().to_owned();
                temporary.persist(path).map_err(|error| error.error)?;
                unfinished.remove(&name);
            }
            Ok(())
        };
        finish().map_err(RunError::write(&self.path))
    }
}

/// Writes `path` through `content`, as an [`AtomicFile`].
pub fn write_atomically(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), RunError> {
    let mut file = AtomicFile::create(path)?;
    file.write(content)?;
    file.finish()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::io::Read;
    use std::os::unix::fs::{FileTypeExt, symlink};

    #[test]
    fn what_a_killed_run_left_is_swept_and_what_is_being_written_stays() {
        let folder = tempfile::tempdir().unwrap();
        let there = || {
            let mut names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|it| it.unwrap().file_name()).collect();
            names.sort();
            names
        };
        let age = |name: &Path, s: u64| {
            let file = OpenOptions::new().write(true).open(name).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(s)).unwrap();
        };
        let [left, fresh, other] =
            [".magcomp-left.tmp", ".magcomp-fresh.tmp", "mine.tmp"].map(|it| folder.path().join(it));
        [&left, &fresh, &other].iter().for_each(|it| fs::write(it, "half").unwrap());
        let written = AtomicFile::create(&folder.path().join("a.csv")).unwrap();
        let (temporary, _) = written.temporary.as_ref().unwrap();
        let still = temporary.path().to_owned();
        [&left, &other, &still].iter().for_each(|it| age(it, 3600));
        write_atomically(&folder.path().join("b.csv"), |out| out.write_all(b"whole")).unwrap();
        assert!(!left.exists() && fresh.exists() && other.exists() && still.exists(), "{:?}", there());
        written.finish().unwrap();
        assert_eq!(there(), [".magcomp-fresh.tmp", "a.csv", "b.csv", "mine.tmp"]);
    }

    #[test]
    fn a_link_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("deep.csv"), folder.path().join("link.csv"));
        fs::write(&file, "before").unwrap();
        symlink("deep.csv", &link).unwrap();
        write_atomically(&link, |out| out.write_all(b"after")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), "after");
    }

    #[test]
    fn a_pipe_is_written_into() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        // for reading and writing: a pipe opened so waits for nobody
        let mut reader = OpenOptions::new().read(true).write(true).open(&pipe).unwrap();
        write_atomically(&pipe, |out| out.write_all(b"after")).unwrap();
        assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
        let mut text = [0; 5];
        reader.read_exact(&mut text).unwrap();
        assert_eq!(&text, b"after");
    }
}
