//! `magcomp.process_many`: recordings on all cores, each by itself. Threads of Rust read and answer them; none holds Python's lock.

use crate::arrays::{times, vectors};
use crate::compensator::{Others, UNINTERRUPTED, config, events, stream};
use crate::session::doubts;
use crate::{ConfigError, MagcompError};
use arrow_array::builder::StringDictionaryBuilder;
use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::{Float64Type, Int32Type, Int64Type};
use arrow_array::{ArrayRef, Float64Array, Int64Array, RecordBatch, RecordBatchIterator};
use arrow_ipc::reader::FileReader;
use arrow_ipc::writer::FileWriter;
use arrow_schema::{DataType, Field, Schema};
use magcomp::nalgebra::Vector3;
use magcomp_recordings::import::{ImportOptions, load};
use magcomp_recordings::recording::Events;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyCapsule, PyDict};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, UNIX_EPOCH};

/// Choice: between two looks whether Ctrl-C was pressed.
const LOOK: Duration = Duration::from_millis(100);
/// The key of [`Told`] among a file's metadata.
const TOLD: &str = "magcomp";

/// One recording to answer.
struct Job {
    name: String,
    /// A file or a folder, or a table; or why it is none of them.
    input: Result<Input, String>,
}

enum Input {
    Path(PathBuf),
    Table(Events),
}

/// What is told of a recording beside its answers.
#[derive(Clone, Default, Serialize, Deserialize)]
struct Told {
    /// Of input, settings and version: an answer of another stamp is not taken from a folder.
    stamp: u64,
    warnings: Vec<String>,
    events: Vec<(String, i64, i64)>,
    left_out: usize,
}

type Answered = (RecordBatch, Told);

/// What all threads share.
struct Run {
    config: magcomp::Config,
    results: Option<PathBuf>,
    stop: AtomicBool,
}

impl Run {
    fn answer(&self, job: Job) -> Result<Answered, String> {
        let input = job.input?;
        let kept = self.results.as_deref().map(|folder| folder.join(file_name(&job.name)));
        let stamp = if kept.is_some() { self.stamp(&input)? } else { 0 };
        if let Some(found) = kept.as_deref().and_then(|path| read(path, stamp)) {
            return Ok(found);
        }
        let (input, warnings) = match input {
            Input::Path(path) => {
                let mut loaded = load(&[path], &ImportOptions::default()).map_err(|why| why.to_string())?;
                let warnings = doubts(&mut loaded);
                (loaded.events, warnings)
            }
            Input::Table(events) => (events, Vec::new()),
        };
        let mut compensator = magcomp::Compensator::new(self.config.clone()).map_err(|why| why.to_string())?;
        let mut others = Others::new(&input.rate, &input.up);
        let mut readings = Vec::with_capacity(input.field.len());
        for samples in input.field.chunks(UNINTERRUPTED) {
            if self.stop.load(Ordering::Relaxed) {
                return Err("interrupted".to_owned());
            }
            let answers = samples.iter().map(|(time_ns, field)| others.answer(&mut compensator, *time_ns, *field));
            readings.extend(answers);
        }
        let told = Told { stamp, warnings, events: events(&readings), left_out: others.left_out };
        let batch = table(&job.name, &readings);
        if let Some(path) = kept {
            write(&path, &batch, &told).map_err(|why| format!("{}: cannot be written: {why}", path.display()))?;
        }
        Ok((batch, told))
    }

    fn stamp(&self, input: &Input) -> Result<u64, String> {
        let mut hasher = DefaultHasher::new();
        env!("CARGO_PKG_VERSION").hash(&mut hasher);
        serde_json::to_string(&self.config).expect("numbers under names").hash(&mut hasher);
        match input {
            Input::Path(path) => {
                hash_file(path, &mut hasher).map_err(|why| format!("{}: cannot be read: {why}", path.display()))?;
            }
            Input::Table(Events { field, rate, up, .. }) => {
                for (time_ns, value) in [field, rate, up].into_iter().flatten() {
                    (time_ns, value.map(f64::to_bits).as_slice()).hash(&mut hasher);
                }
                (field.len(), rate.len()).hash(&mut hasher);
            }
        }
        Ok(hasher.finish())
    }
}

/// A file's size and date; a folder's files'.
fn hash_file(path: &Path, hasher: &mut DefaultHasher) -> std::io::Result<()> {
    let about = fs::metadata(path)?;
    if about.is_dir() {
        let mut paths: Vec<PathBuf> =
            fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
        paths.sort();
        return paths.iter().filter(|path| path.is_file()).try_for_each(|path| {
            path.hash(hasher);
            hash_file(path, hasher)
        });
    }
    let modified = about.modified()?.duration_since(UNIX_EPOCH).unwrap_or_default();
    (about.len(), modified.as_nanos()).hash(hasher);
    Ok(())
}

/// The file of a recording's answers: its name, with what no file's name may have as %2F and so on.
fn file_name(name: &str) -> String {
    let escaped = |letter: char| match letter {
        '%' | '/' | '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|' | '\0'..='\x1f' => format!("%{:02X}", letter as u32),
        other => other.to_string(),
    };
    name.chars().map(escaped).collect::<String>() + ".arrow"
}

fn schema() -> Schema {
    let number = |name: &str| Field::new(name, DataType::Float64, true);
    let word = |name: &str| {
        let kind = DataType::Dictionary(Box::new(DataType::Int32), Box::new(DataType::Utf8));
        Field::new(name, kind, true)
    };
    let mut fields = vec![word("recording"), Field::new("time_ns", DataType::Int64, true)];
    for stem in ["field", "filtered_field"] {
        fields.extend(["x", "y", "z"].map(|axis| number(&format!("{stem}_{axis}_ut"))));
    }
    let more = ["field_sigma_ut", "heading_deg", "heading_sigma_deg", "true_heading_deg", "direction_sigma_deg"];
    fields.extend(more.map(number));
    fields.push(word("status"));
    Schema::new(fields)
}

/// The answers of one recording.
fn table(name: &str, readings: &[magcomp::Reading]) -> RecordBatch {
    let of = |value: &dyn Fn(&magcomp::Reading) -> Option<f64>| -> ArrayRef {
        Arc::new(readings.iter().map(value).collect::<Float64Array>())
    };
    let words = |words: &mut dyn Iterator<Item = &str>| -> ArrayRef {
        let mut builder = StringDictionaryBuilder::<Int32Type>::new();
        words.for_each(|word| builder.append_value(word));
        Arc::new(builder.finish())
    };
    let time_ns: Int64Array = readings.iter().map(|it| Some(it.time_ns)).collect();
    let mut columns: Vec<ArrayRef> = vec![words(&mut readings.iter().map(|_| name)), Arc::new(time_ns)];
    columns.extend((0..3).map(|axis| of(&|it| it.field_ut.map(|field: Vector3<f64>| field[axis]))));
    columns.extend((0..3).map(|axis| of(&|it| it.filtered_field_ut.map(|field: Vector3<f64>| field[axis]))));
    columns.extend([
        of(&|it| it.field_sigma_ut),
        of(&|it| Some(it.heading?.heading_deg)),
        of(&|it| it.heading?.heading_sigma_deg),
        of(&|it| it.heading?.true_heading_deg),
        of(&|it| it.direction_sigma_deg),
        words(&mut readings.iter().map(|it| it.status.label())),
    ]);
    RecordBatch::try_new(Arc::new(schema()), columns).expect("as many columns as the schema has, of its kinds")
}

/// Answers that an earlier run wrote, if they are of this stamp.
fn read(path: &Path, stamp: u64) -> Option<Answered> {
    let mut reader = FileReader::try_new_buffered(File::open(path).ok()?, None).ok()?;
    let told: Told = serde_json::from_str(reader.schema().metadata().get(TOLD)?).ok()?;
    let batch = reader.next().filter(|_| told.stamp == stamp)?.ok()?;
    let batch = RecordBatch::try_new(Arc::new(schema()), batch.columns().to_vec()).ok()?;
    Some((batch, told))
}

/// Beside its name first, so that a run that is ended leaves no half file under it.
fn write(path: &Path, batch: &RecordBatch, told: &Told) -> Result<(), Box<dyn std::error::Error>> {
    let beside = path.with_extension("part");
    let told = serde_json::to_string(told)?;
    let schema = schema().with_metadata([(TOLD.to_owned(), told)]);
    let mut writer = FileWriter::try_new_buffered(File::create(&beside)?, &schema)?;
    writer.write(batch)?;
    writer.finish()?;
    drop(writer);
    Ok(fs::rename(beside, path)?)
}

/// Lets the threads end when nobody waits for them any more.
struct Ending(Arc<Run>);

impl Drop for Ending {
    fn drop(&mut self) {
        self.0.stop.store(true, Ordering::Relaxed);
    }
}

fn table_of(value: &Bound<'_, PyAny>) -> PyResult<Input> {
    let item = |name: &str| value.get_item(name);
    let (time_ns, fields) = (times(&item("time_ns")?, "time_ns")?, vectors(&item("field_ut")?, "field_ut")?);
    if time_ns.len() != fields.len() {
        let (have, of) = (time_ns.len(), fields.len());
        return Err(MagcompError::new_err(format!("time_ns has {have} times for {of} samples of field_ut")));
    }
    Ok(Input::Table(Events {
        field: time_ns.into_iter().zip(fields).collect(),
        rate: stream(item("rotation_rate")?.extract()?, "rotation_rate")?,
        up: stream(item("up")?.extract()?, "up")?,
        ..Events::default()
    }))
}

/// See `magcomp/_many.py`: names, each with a path, a table as of `read_session`, or an exception.
#[pyfunction]
pub(crate) fn _process_many(
    python: Python<'_>,
    recordings: Vec<(String, Bound<'_, PyAny>)>,
    settings: &Bound<'_, PyDict>,
    workers: usize,
    results: Option<PathBuf>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Many> {
    let config = config(Some(settings))?;
    magcomp::Compensator::new(config.clone()).map_err(|error| ConfigError::new_err(error.to_string()))?;
    if let Some(folder) = &results {
        fs::create_dir_all(folder)?;
    }
    let names: Vec<String> = recordings.iter().map(|(name, _)| name.clone()).collect();
    let jobs = recordings.into_iter().map(|(name, value)| {
        let input = if let Ok(path) = value.extract::<PathBuf>() {
            Ok(Input::Path(path))
        } else if value.is_instance_of::<pyo3::exceptions::PyException>() {
            Err(value.to_string())
        } else {
            table_of(&value).map_err(|why| why.value(python).to_string())
        };
        Job { name, input }
    });
    let jobs: Vec<Job> = jobs.collect();
    let queue = Arc::new(Mutex::new(jobs.into_iter().enumerate()));
    let run = Arc::new(Run { config, results, stop: AtomicBool::new(false) });
    let _ending = Ending(Arc::clone(&run));
    let (send, mut receive) = channel();
    for _ in 0..workers {
        let (queue, run, send) = (Arc::clone(&queue), Arc::clone(&run), send.clone());
        std::thread::spawn(move || {
            while !run.stop.load(Ordering::Relaxed) {
                let next = queue.lock().unwrap_or_else(PoisonError::into_inner).next();
                let Some((number, job)) = next else { return };
                let answered = catch_unwind(AssertUnwindSafe(|| run.answer(job)));
                let answered =
                    answered.unwrap_or_else(|_| Err("magcomp stopped within it; please report it".to_owned()));
                if send.send((number, answered)).is_err() {
                    return;
                }
            }
        });
    }
    drop(send);
    let mut found: BTreeMap<usize, Result<Answered, String>> = BTreeMap::new();
    let mut failed = 0;
    loop {
        let (next, back) = python.detach(move || (receive.recv_timeout(LOOK), receive));
        receive = back;
        python.check_signals()?;
        match next {
            Ok((number, answered)) => {
                failed += usize::from(answered.is_err());
                found.insert(number, answered);
                if let Some(progress) = &progress {
                    progress.call1((found.len(), names.len(), failed))?;
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    let mut many = Many::default();
    for (name, (_, answered)) in names.into_iter().zip(found) {
        match answered {
            Ok((batch, told)) => {
                many.batches.push(batch);
                many.told.push((name, told));
            }
            Err(why) => many.errors.push((name, why)),
        }
    }
    Ok(many)
}

/// See `_magcomp.pyi`.
#[pyclass(frozen, module = "magcomp")]
#[derive(Default)]
pub(crate) struct Many {
    batches: Vec<RecordBatch>,
    /// Of the same recordings.
    told: Vec<(String, Told)>,
    errors: Vec<(String, String)>,
}

#[pymethods]
impl Many {
    #[getter]
    fn recordings(&self) -> Vec<&str> {
        self.told.iter().map(|(name, _)| name.as_str()).collect()
    }

    #[getter]
    fn errors<'py>(&self, python: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.errors.iter().map(|(name, why)| (name, why)).into_py_dict(python)
    }

    #[getter]
    fn warnings<'py>(&self, python: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.told.iter().map(|(name, told)| (name, told.warnings.clone())).into_py_dict(python)
    }

    #[getter]
    fn events<'py>(&self, python: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.told.iter().map(|(name, told)| (name, told.events.clone())).into_py_dict(python)
    }

    #[getter]
    fn left_out<'py>(&self, python: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.told.iter().map(|(name, told)| (name, told.left_out)).into_py_dict(python)
    }

    /// Arrow's PyCapsule interface: what pyarrow, polars and pandas read.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        python: Python<'py>,
        requested_schema: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // another schema is the caller's wish; the interface lets us give our own
        let _ = requested_schema;
        let batches: Vec<_> = self.batches.iter().cloned().map(Ok).collect();
        let reader = RecordBatchIterator::new(batches, Arc::new(schema()));
        PyCapsule::new_with_value(python, FFI_ArrowArrayStream::new(Box::new(reader)), c"arrow_array_stream")
    }

    fn to_pandas<'py>(&self, python: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let pandas = python.import("pandas")?;
        let columns = PyDict::new(python);
        for (k, field) in schema().fields().iter().enumerate() {
            let parts = || self.batches.iter().map(move |batch| batch.column(k));
            let column = match field.data_type() {
                DataType::Float64 => {
                    let numbers = parts().flat_map(|part| part.as_primitive::<Float64Type>().iter());
                    let numbers = numbers.map(|number| number.unwrap_or(f64::NAN)).collect();
                    PyArray1::from_vec(python, numbers).into_any()
                }
                DataType::Int64 => {
                    let numbers =
                        parts().flat_map(|part| part.as_primitive::<Int64Type>().values().iter()).copied().collect();
                    PyArray1::<i64>::from_vec(python, numbers).into_any()
                }
                _ => {
                    let (codes, words) = coded(parts());
                    let kind = pandas.getattr("Categorical")?;
                    kind.call_method1("from_codes", (PyArray1::from_vec(python, codes), words))?
                }
            };
            columns.set_item(field.name(), column)?;
        }
        pandas.call_method1("DataFrame", (columns,))
    }

    fn __len__(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }

    fn __repr__(&self) -> String {
        let (answered, failed, rows) = (self.told.len(), self.errors.len(), self.__len__());
        format!("Many({answered} recordings, {rows} rows, {failed} errors)")
    }
}

/// Words of several parts by their number in one list.
fn coded<'a>(parts: impl Iterator<Item = &'a ArrayRef>) -> (Vec<i32>, Vec<String>) {
    let (mut codes, mut words) = (Vec::new(), Vec::<String>::new());
    for part in parts {
        let part = part.as_dictionary::<Int32Type>();
        let of_part: Vec<i32> = (part.values().as_string::<i32>().iter())
            .map(|word| {
                let word = word.unwrap_or_default();
                let known = words.iter().rposition(|known| known == word);
                known.unwrap_or_else(|| {
                    words.push(word.to_owned());
                    words.len() - 1
                }) as i32
            })
            .collect();
        codes.extend(part.keys().values().iter().map(|key| of_part[*key as usize]));
    }
    (codes, words)
}
