//! Native part of the Python package `arcfeed`: commands as functions, laws, stocks and job files.
//!
//! The package's Python part (`python/arcfeed`) has the functions with their options; this one has what must be fast or is
//! written in Rust already. The interpreter is free for other threads while anything here computes.

mod table;

mod call;

mod law;

mod stock;

mod job;

use pyo3::prelude::*;

/// Native part of `arcfeed`; use the package instead.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(call::run, module)?)?;
    module.add_class::<law::Law>()?;
    module.add_class::<table::Table>()?;
    module.add_class::<stock::Tool>()?;
    module.add_class::<stock::Stock>()?;
    module.add_class::<job::JobText>()
}
