//! Writing: beside the name first, then moved into place, so that a failed run leaves no half file.

use crate::error::LabError;
use crate::simulate::Simulation;
use flate2::Compression;
use flate2::write::GzEncoder;
use magcomp::nalgebra::Vector3;
use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes `path` through `content`; gzipped when the name ends in `.gz`. On failure what was there before stays. A link
/// stays one, and what is no file (a device, a pipe) is written into.
///
/// # Errors
/// [`LabError::Write`] names the file and why.
pub fn write_atomically(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), LabError> {
    let zipped = path.extension().is_some_and(|extension| extension == "gz");
    let fill = |file: &fs::File| -> io::Result<()> {
        let mut writer = BufWriter::new(file);
        if zipped {
            let mut zipped = GzEncoder::new(&mut writer, Compression::default());
            content(&mut zipped)?;
            zipped.finish()?;
        } else {
            content(&mut writer)?;
        }
        writer.flush()
    };
    let write = || -> io::Result<()> {
        if fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir()) {
            return fill(&OpenOptions::new().write(true).open(path)?);
        }
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        builder.prefix(".magcomp-").suffix(".tmp");
        #[cfg(unix)]
        {
            // an ordinary file's permissions (less the umask), not a secret's
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let file = builder.tempfile_in(folder)?;
        fill(file.as_file())?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    };
    write().map_err(LabError::write(path))
}

/// Writes a simulation as a recording: the latest reading of each sensor beside every magnetometer sample, and the true
/// orientation and hard iron.
///
/// # Errors
/// [`LabError::Write`].
pub fn write_simulation(path: &Path, simulation: &Simulation) -> Result<(), LabError> {
    let (rates, ups) = (&simulation.rotation_rates, &simulation.ups);
    write_atomically(path, |out| {
        write!(out, "t_s,mx,my,mz")?;
        if !ups.is_empty() {
            write!(out, ",ax,ay,az")?;
        }
        if !rates.is_empty() {
            write!(out, ",gx,gy,gz")?;
        }
        writeln!(out, ",qw,qx,qy,qz,true_bx,true_by,true_bz")?;
        let (mut rate, mut up) = (0, 0);
        for (sample, truth) in simulation.magnetic.iter().zip(&simulation.truth) {
            write!(out, "{}", sample.time_ns as f64 / 1e9)?;
            vector(out, &sample.field_ut)?;
            if !ups.is_empty() {
                up = latest(ups, up, |event| event.time_ns <= sample.time_ns);
                vector(out, &ups[up].up_m_s2)?;
            }
            if !rates.is_empty() {
                rate = latest(rates, rate, |event| event.time_ns <= sample.time_ns);
                vector(out, &rates[rate].rate_rad_s)?;
            }
            let q = truth.attitude;
            write!(out, ",{:.9},{:.9},{:.9},{:.9}", q.w, q.i, q.j, q.k)?;
            vector(out, &truth.hard_iron_ut)?;
            writeln!(out)?;
        }
        Ok(())
    })
}

/// Micro-units: below the noise of every sensor.
fn vector(out: &mut dyn Write, v: &Vector3<f64>) -> io::Result<()> {
    write!(out, ",{:.6},{:.6},{:.6}", v.x, v.y, v.z)
}

/// The last event from `at` on that has happened.
fn latest<T>(events: &[T], at: usize, happened: impl Fn(&T) -> bool) -> usize {
    (at..events.len()).take_while(|k| happened(&events[*k])).last().unwrap_or(at)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::io::Read;
    use std::os::unix::fs::{FileTypeExt, symlink};

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
