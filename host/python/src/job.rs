//! `JobText`: a job file whose values can be changed; comments and order stay.

use std::path::PathBuf;

use arcfeed::commands::outcome::{Failure, write_whole};
use arcfeed::job::JobFile;
use pyo3::exceptions::{PyKeyError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString};
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value};

use super::call::exception;

/// Text of a job file, by keys with dots: `tool.outer_radius`, `cut.0.n`.
#[pyclass(module = "arcfeed")]
pub struct JobText {
    path: PathBuf,
    document: DocumentMut,
}

#[pymethods]
impl JobText {
    /// Job of this text; the path is used in messages, and its folder for the names of files.
    #[new]
    fn new(py: Python<'_>, path: PathBuf, text: &str) -> PyResult<Self> {
        let document = text.parse::<DocumentMut>();
        // The program's own reader says where the fault is.
        let document = document.map_err(|error| match JobFile::parse(&path, text) {
            Err(fault) => exception(py, fault.into()),
            Ok(_) => exception(py, Failure::Input(format!("{}: {error}", path.display()))),
        })?;
        Ok(JobText { path, document })
    }

    /// Path of the file.
    #[getter]
    fn path(&self) -> PathBuf {
        self.path.clone()
    }

    /// Text of the file.
    #[getter]
    fn text(&self) -> String {
        self.document.to_string()
    }

    /// Value of a key.
    fn get(&self, py: Python<'_>, key: &str) -> PyResult<Py<PyAny>> {
        let mut item = self.document.as_item();
        for name in key.split('.') {
            item = child(item, name).ok_or_else(|| PyKeyError::new_err(key.to_owned()))?;
        }
        to_python(py, item)
    }

    /// Sets the value of a key; tables that are missing are added at the end.
    fn set(&mut self, key: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut value = from_python(value)?;
        let (tables, last) = key.rsplit_once('.').map_or((None, key), |(tables, last)| (Some(tables), last));
        let missing = || PyKeyError::new_err(key.to_owned());
        let mut item = self.document.as_item_mut();
        for name in tables.into_iter().flat_map(|tables| tables.split('.')) {
            if item.is_table() && item.get(name).is_none() {
                item[name] = Item::Table(Table::new());
            }
            item = child_mut(item, name).ok_or_else(missing)?;
        }
        if !(item.is_table_like() || child_mut(item, last).is_some()) {
            return Err(missing());
        }
        if let Some(before) = child_mut(item, last) {
            // What follows the value on its line stays.
            if let Some(decor) = before.as_value().map(|value| value.decor().clone()) {
                *value.decor_mut() = decor;
            }
            *before = Item::Value(value);
        } else {
            item[last] = Item::Value(value);
        }
        Ok(())
    }

    /// Removes a key and its value.
    fn remove(&mut self, key: &str) -> PyResult<()> {
        let (tables, last) = key.rsplit_once('.').map_or((None, key), |(tables, last)| (Some(tables), last));
        let missing = || PyKeyError::new_err(key.to_owned());
        let mut item = self.document.as_item_mut();
        for name in tables.into_iter().flat_map(|tables| tables.split('.')) {
            item = child_mut(item, name).ok_or_else(missing)?;
        }
        item.as_table_like_mut().and_then(|table| table.remove(last)).map(drop).ok_or_else(missing)
    }

    /// Checks the job as the program would read it.
    fn check(&self, py: Python<'_>) -> PyResult<()> {
        self.checked(&self.path).map_err(|failure| exception(py, failure))
    }

    /// Writes the job, completely or not at all, if it is valid there.
    #[pyo3(signature = (path=None))]
    fn write(&mut self, py: Python<'_>, path: Option<PathBuf>) -> PyResult<()> {
        let path = path.unwrap_or_else(|| self.path.clone());
        let written = self.checked(&path).and_then(|()| write_whole(&path, self.text().as_bytes()));
        written.map_err(|failure| exception(py, failure))?;
        self.path = path;
        Ok(())
    }
}

impl JobText {
    fn checked(&self, path: &std::path::Path) -> Result<(), Failure> {
        let file = JobFile::parse(path, &self.text())?;
        if file.program.is_file() {
            return Ok(());
        }
        let (job, program) = (path.display(), file.program.display());
        Err(Failure::Input(format!("{job}: there is no program {program}; names of files count from the job's folder")))
    }
}

/// Value of a key, or of a number in an array.
fn child<'d>(item: &'d Item, name: &str) -> Option<&'d Item> {
    match name.parse::<usize>() {
        Ok(index) => item.get(index),
        Err(_) => item.get(name),
    }
}

fn child_mut<'d>(item: &'d mut Item, name: &str) -> Option<&'d mut Item> {
    match name.parse::<usize>() {
        Ok(index) => item.get_mut(index),
        Err(_) => item.get_mut(name),
    }
}

fn to_python(py: Python<'_>, item: &Item) -> PyResult<Py<PyAny>> {
    let of_tables = |tables: &mut dyn Iterator<Item = (&str, &Item)>| -> PyResult<Py<PyAny>> {
        let dict = PyDict::new(py);
        for (key, item) in tables {
            dict.set_item(key, to_python(py, item)?)?;
        }
        Ok(dict.into_any().unbind())
    };
    match item {
        Item::None => Ok(py.None()),
        Item::Value(value) => value_to_python(py, value),
        Item::Table(table) => of_tables(&mut table.iter()),
        Item::ArrayOfTables(tables) => {
            let tables: PyResult<Vec<_>> = tables.iter().map(|table| of_tables(&mut table.iter())).collect();
            Ok(PyList::new(py, tables?)?.into_any().unbind())
        }
    }
}

fn value_to_python(py: Python<'_>, value: &Value) -> PyResult<Py<PyAny>> {
    Ok(match value {
        Value::String(text) => PyString::new(py, text.value()).into_any().unbind(),
        Value::Integer(number) => number.value().into_pyobject(py)?.into_any().unbind(),
        Value::Float(number) => PyFloat::new(py, *number.value()).into_any().unbind(),
        Value::Boolean(flag) => PyBool::new(py, *flag.value()).to_owned().into_any().unbind(),
        Value::Datetime(time) => PyString::new(py, &time.value().to_string()).into_any().unbind(),
        Value::Array(values) => {
            let values: PyResult<Vec<_>> = values.iter().map(|value| value_to_python(py, value)).collect();
            PyList::new(py, values?)?.into_any().unbind()
        }
        Value::InlineTable(table) => {
            let dict = PyDict::new(py);
            for (key, value) in table {
                dict.set_item(key, value_to_python(py, value)?)?;
            }
            dict.into_any().unbind()
        }
    })
}

fn from_python(value: &Bound<'_, PyAny>) -> PyResult<Value> {
    // A flag is an integer in Python, so it comes first.
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(flag.is_true().into());
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(text.to_cow()?.into_owned().into());
    }
    if value.is_instance_of::<PyInt>() {
        return Ok(value.extract::<i64>()?.into());
    }
    if let Ok(dict) = value.cast::<PyDict>() {
        let mut table = InlineTable::new();
        for (key, value) in dict {
            table.insert(key.extract::<String>()?, from_python(&value)?);
        }
        return Ok(table.into());
    }
    // Numbers of NumPy too.
    if let Ok(number) = value.extract::<f64>() {
        return Ok(number.into());
    }
    let items = value.try_iter().map_err(|_| {
        PyTypeError::new_err(
            "a value of a job is a text, a number, a flag, a list or a dict of such; found another type",
        )
    })?;
    let values: PyResult<Array> = items.map(|value| from_python(&value?)).collect();
    Ok(values?.into())
}
