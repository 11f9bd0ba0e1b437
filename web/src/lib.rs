//! `magcomp replay` for a page: what a worker calls (`page/worker.js`). A call answers how it went, and leaves a text in `out`.
//!
//! The border is three kinds of numbers, so no generator is needed: memory that `reserve` hands out, a code, and `out`.

mod run;

use run::{Run, Settings};
use std::cell::RefCell;
use std::sync::Mutex;

#[derive(Default)]
struct State {
    files: Vec<(String, Vec<u8>)>,
    run: Option<Run>,
    out: Vec<u8>,
}

thread_local! {
    static STATE: RefCell<State> = RefCell::default();
}

/// What a panic said: it ends the module, whose memory can still be read.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// The call failed; `out` has the sentence.
const FAILED: i32 = -1;

fn answer<T>(action: impl FnOnce(&mut State) -> Result<(i32, T), String>) -> i32
where
    T: Into<Vec<u8>>,
{
    STATE.with_borrow_mut(|state| {
        let (code, out) = match action(state) {
            Ok((code, out)) => (code, out.into()),
            Err(why) => (FAILED, why.into_bytes()),
        };
        state.out = out;
        code
    })
}

/// Before all else.
#[unsafe(no_mangle)]
pub extern "C" fn begin() {
    std::panic::set_hook(Box::new(|panic| {
        if let Ok(mut text) = PANIC.lock() {
            *text = panic.to_string();
        }
    }));
}

/// Room for so many bytes of `file` or `open`; null where there is not as much memory.
#[unsafe(no_mangle)]
pub extern "C" fn reserve(bytes: usize) -> *mut u8 {
    let mut room = Vec::<u8>::new();
    if room.try_reserve_exact(bytes).is_err() {
        return std::ptr::null_mut();
    }
    room.resize(bytes, 0);
    Box::into_raw(room.into_boxed_slice()).cast()
}

/// What was written into the room that [`reserve`] handed out.
///
/// # Safety
/// `at` is of `reserve(bytes)`, and used once.
unsafe fn taken(at: *mut u8, bytes: usize) -> Vec<u8> {
    // SAFETY: as said
    unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(at, bytes)) }.into_vec()
}

/// One more file of the recording or session: name and content.
///
/// # Safety
/// Both are of [`reserve`], and used once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn file(name: *mut u8, name_bytes: usize, content: *mut u8, content_bytes: usize) {
    // SAFETY: as said
    let (name, content) = unsafe { (taken(name, name_bytes), taken(content, content_bytes)) };
    STATE.with_borrow_mut(|state| state.files.push((String::from_utf8_lossy(&name).into_owned(), content)));
}

/// Opens the files that were given, with settings as JSON. `out`: rows and warnings as JSON.
///
/// # Safety
/// `settings` is of [`reserve`], and used once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn open(settings: *mut u8, bytes: usize) -> i32 {
    // SAFETY: as said
    let settings = unsafe { taken(settings, bytes) };
    answer(|state| {
        let settings: Settings = serde_json::from_slice(&settings).map_err(|error| error.to_string())?;
        let run = state.run.insert(Run::open(std::mem::take(&mut state.files), settings)?);
        Ok((0, run.opened()))
    })
}

/// Plays some rows: how many, 0 at the end. `out`: their lines of CSV, the first time after a header.
#[unsafe(no_mangle)]
pub extern "C" fn play() -> i32 {
    answer(|state| state.run.as_mut().ok_or("nothing is open")?.play())
}

/// The last calibration. `out`: JSON, empty where none was found.
#[unsafe(no_mangle)]
pub extern "C" fn calibration() -> i32 {
    answer(|state| Ok((0, state.run.as_ref().ok_or("nothing is open")?.calibration())))
}

/// Ends the replay. `out`: the report as one page of HTML.
#[unsafe(no_mangle)]
pub extern "C" fn report() -> i32 {
    answer(|state| Ok((0, state.run.take().ok_or("nothing is open")?.report()?)))
}

/// Where `out` is.
#[unsafe(no_mangle)]
pub extern "C" fn out() -> *const u8 {
    STATE.with_borrow(|state| state.out.as_ptr())
}

/// Its bytes.
#[unsafe(no_mangle)]
pub extern "C" fn out_bytes() -> usize {
    STATE.with_borrow(|state| state.out.len())
}

/// Where the text of a panic is.
#[unsafe(no_mangle)]
pub extern "C" fn panicked() -> *const u8 {
    PANIC.lock().map_or(std::ptr::null(), |text| text.as_ptr())
}

/// Its bytes; 0 without a panic.
#[unsafe(no_mangle)]
pub extern "C" fn panicked_bytes() -> usize {
    PANIC.lock().map_or(0, |text| text.len())
}
