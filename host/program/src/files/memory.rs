//! Files in memory, of a page in a browser. Folders are there with their files; a relative path begins in [`HOME`].

use std::collections::BTreeMap;
use std::io::{Cursor, ErrorKind, Read, Result};
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Folder in which relative paths begin.
pub const HOME: &str = "/in";

static FILES: Mutex<BTreeMap<PathBuf, Vec<u8>>> = Mutex::new(BTreeMap::new());

/// Content of a file.
///
/// # Errors
/// There is none.
pub fn read(path: impl AsRef<Path>) -> Result<Vec<u8>> {
    files().get(&absolute(path.as_ref())).cloned().ok_or_else(|| ErrorKind::NotFound.into())
}

/// Content of a file as text.
///
/// # Errors
/// There is none, or it is not UTF-8.
pub fn read_to_string(path: impl AsRef<Path>) -> Result<String> {
    String::from_utf8(read(path)?).map_err(|_| std::io::Error::new(ErrorKind::InvalidData, "the text is not UTF-8"))
}

/// File to be read from its beginning, and its size.
///
/// # Errors
/// There is none.
pub fn open(path: &Path) -> Result<(impl Read + use<>, u64)> {
    let bytes = read(path)?;
    let size = bytes.len() as u64;
    Ok((Cursor::new(bytes), size))
}

/// Whether this is a file.
///
/// # Errors
/// There is none.
pub fn is_file(path: &Path) -> Result<bool> {
    read(path).map(|_| true)
}

/// Path without `.` and `..`.
///
/// # Errors
/// There is no such file.
pub fn canonicalize(path: impl AsRef<Path>) -> Result<PathBuf> {
    is_file(path.as_ref()).map(|_| absolute(path.as_ref()))
}

/// Writes a file in place of the one before.
///
/// # Errors
/// None.
pub fn write(path: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> Result<()> {
    files().insert(absolute(path.as_ref()), bytes.as_ref().to_vec());
    Ok(())
}

/// Removes a file.
///
/// # Errors
/// There is none.
pub fn remove_file(path: impl AsRef<Path>) -> Result<()> {
    files().remove(&absolute(path.as_ref())).map(drop).ok_or_else(|| ErrorKind::NotFound.into())
}

/// Removes the files of a folder.
///
/// # Errors
/// None.
pub fn clear_folder(path: &Path) -> Result<()> {
    let folder = absolute(path);
    files().retain(|file, _| !file.starts_with(&folder));
    Ok(())
}

fn files() -> MutexGuard<'static, BTreeMap<PathBuf, Vec<u8>>> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

fn absolute(path: &Path) -> PathBuf {
    let mut whole = PathBuf::from("/");
    for component in Path::new(HOME).join(path).components() {
        match component {
            Component::Normal(name) => whole.push(name),
            Component::ParentDir => {
                whole.pop();
            }
            _ => {}
        }
    }
    whole
}
