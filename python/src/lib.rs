//! The extension module `magcomp._magcomp`: the core's `Compensator`, `Calibration` and `fit_ellipsoid` over numpy arrays, recordings, and
//! many of them at once. Docs for users are in `magcomp/__init__.py` and `magcomp/_magcomp.pyi`; nothing is computed here.

mod arrays;
mod calibration;
mod compensator;
mod fit;
mod many;
mod session;

use pyo3::prelude::*;

pyo3::create_exception!(magcomp, MagcompError, pyo3::exceptions::PyValueError, "What magcomp refuses, and what to do.");
pyo3::create_exception!(magcomp, ConfigError, MagcompError, "A setting that is not known, or outside its range.");
pyo3::create_exception!(magcomp, CalibrationError, MagcompError, "M, b or |h| that no calibration can have.");
pyo3::create_exception!(magcomp, EventError, MagcompError, "A gyroscope or gravity sample that is left out.");
pyo3::create_exception!(magcomp, FitError, MagcompError, "Points that no ellipsoid fits.");
pyo3::create_exception!(magcomp, KeptError, MagcompError, "A kept calibration that cannot be read.");
pyo3::create_exception!(magcomp, SessionError, MagcompError, "A recording or session that cannot be read.");
pyo3::create_exception!(magcomp, PlaceError, MagcompError, "A place or day for which there is no field of the Earth.");

/// See `magcomp/__init__.py`.
#[pymodule]
fn _magcomp(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let python = module.py();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("MagcompError", python.get_type::<MagcompError>())?;
    module.add("ConfigError", python.get_type::<ConfigError>())?;
    module.add("CalibrationError", python.get_type::<CalibrationError>())?;
    module.add("EventError", python.get_type::<EventError>())?;
    module.add("FitError", python.get_type::<FitError>())?;
    module.add("KeptError", python.get_type::<KeptError>())?;
    module.add("SessionError", python.get_type::<SessionError>())?;
    module.add("PlaceError", python.get_type::<PlaceError>())?;
    module.add_class::<calibration::Calibration>()?;
    module.add_class::<compensator::Compensator>()?;
    module.add_class::<compensator::Reading>()?;
    module.add_class::<fit::EllipsoidFit>()?;
    module.add_class::<many::Many>()?;
    // for the package alone: not in `__all__`
    module.setattr("_compensator", wrap_pyfunction!(compensator::_compensator, module)?)?;
    module.setattr("_process_many", wrap_pyfunction!(many::_process_many, module)?)?;
    module.add_function(wrap_pyfunction!(session::read_session, module)?)?;
    module.add_function(wrap_pyfunction!(session::earth_field, module)?)?;
    module.add_function(wrap_pyfunction!(fit::fit_ellipsoid, module)?)
}
