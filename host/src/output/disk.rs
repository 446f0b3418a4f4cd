//! Output files on the disk.
//!
//! A regular file is written in the same folder, under an unpredictable name, and renamed: a reader finds the old
//! content or the new one. A symbolic link stays, and the file that it leads to is replaced. Devices and FIFOs are
//! written to directly. Folders, sockets and files without write permission are rejected.

use std::fs::{File, Metadata, OpenOptions, Permissions};
use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// Permissions of a new file, less the umask.
#[cfg(unix)]
const NEW_MODE: u32 = 0o666;

/// Destination of an output.
enum Target {
    /// A device or a FIFO.
    Stream,
    /// Regular file, links followed, with the metadata of an existing one.
    File(PathBuf, Option<Metadata>),
}

/// File that appears under its name only when it is finished; if it is dropped before, it leaves nothing behind.
/// Devices and FIFOs are written to directly.
#[derive(Debug)]
pub struct PendingFile(Pending);

#[derive(Debug)]
enum Pending {
    Stream(File, PathBuf),
    /// New file beside its place, the place, and the metadata of the file that is there.
    Beside(NamedTempFile, PathBuf, Option<Box<Metadata>>),
}

/// Rejects output files that are also input files, or that are the same file twice, also through links and other spellings of a path.
///
/// # Errors
/// Describes the first such output.
pub fn refuse_inputs(outputs: &[&Path], inputs: &[PathBuf]) -> std::result::Result<(), String> {
    for (index, output) in outputs.iter().enumerate() {
        let advice = "give another name";
        if let Some(input) = inputs.iter().find(|input| is_same(output, input)) {
            let (output, input) = (output.display(), input.display());
            return Err(format!("{output}: this is the input {input}, which is not written over; {advice}"));
        }
        if outputs[..index].iter().any(|other| is_same(output, other)) {
            return Err(format!("{}: two outputs would go there; {advice}", output.display()));
        }
    }
    Ok(())
}

/// Writes a file completely, or leaves everything unchanged.
///
/// # Errors
/// It cannot be written; the message gives the reason.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut file = PendingFile::begin(path)?;
    file.write_all(bytes)?;
    file.finish()
}

impl PendingFile {
    /// Begins a file for this path; nothing is at the path until [`PendingFile::finish`].
    ///
    /// # Errors
    /// It cannot be written; the message gives the reason.
    pub fn begin(path: &Path) -> Result<Self> {
        Ok(PendingFile(match target(path)? {
            Target::Stream => Pending::Stream(stream(path)?, path.to_owned()),
            Target::File(real, before) => Pending::Beside(beside(&real)?, real, before.map(Box::new)),
        }))
    }

    /// Gives the finished file its name, in one step.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn finish(self) -> Result<()> {
        let Pending::Beside(file, real, before) = self.0 else { return Ok(()) };
        let kept = before.map_or(Ok(()), |before| keep_owner_and_mode(file.as_file(), &before));
        kept.and_then(|()| file.as_file().sync_all()).map_err(|error| explained(error, &real))?;
        file.persist(&real).map(drop).map_err(|error| explained(error.error, &real))
    }
}

impl Write for PendingFile {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        match &mut self.0 {
            Pending::Stream(file, path) => file.write(bytes).map_err(|error| explained(error, path)),
            Pending::Beside(file, real, _) => file.write(bytes).map_err(|error| explained(error, real)),
        }
    }

    fn flush(&mut self) -> Result<()> {
        match &mut self.0 {
            Pending::Stream(file, _) => file.flush(),
            Pending::Beside(file, ..) => file.flush(),
        }
    }
}

/// Writes a file completely, or leaves everything unchanged; the file must not exist yet.
///
/// # Errors
/// The file exists ([`ErrorKind::AlreadyExists`]), or cannot be written.
pub fn write_new(path: &Path, bytes: &[u8]) -> Result<()> {
    if path.symlink_metadata().is_ok() {
        return Err(ErrorKind::AlreadyExists.into());
    }
    let mut file = beside(path)?;
    file.write_all(bytes).and_then(|()| file.as_file().sync_all()).map_err(|error| explained(error, path))?;
    file.persist_noclobber(path).map(drop).map_err(|error| explained(error.error, path))
}

/// Creates a file that grows while the command runs; an existing one is overwritten.
///
/// # Errors
/// It cannot be written; the message gives the reason.
pub fn create(path: &Path) -> Result<File> {
    match target(path)? {
        Target::Stream => stream(path),
        Target::File(real, _) => {
            let opened = OpenOptions::new().write(true).create(true).truncate(true).open(&real);
            opened.map_err(|error| explained(error, &real))
        }
    }
}

/// Whether the path leads to a regular file, without a link.
pub fn is_plain_file(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|found| found.is_file())
}

/// The error of a write, with a remedy in its message.
pub fn explained(error: Error, path: &Path) -> Error {
    let folder = parent(path);
    let what = match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "the disk is full, or a limit of size is reached: make room, or write elsewhere".to_owned()
        }
        ErrorKind::ReadOnlyFilesystem => "the file system is read-only: write elsewhere".to_owned(),
        ErrorKind::PermissionDenied if folder.metadata().is_ok_and(|found| found.permissions().readonly()) => {
            format!("the folder {} is read-only: write elsewhere", folder.display())
        }
        ErrorKind::PermissionDenied => {
            format!("the folder {} is locked for this user: write elsewhere, or ask its owner", folder.display())
        }
        ErrorKind::NotFound => format!("there is no folder {}: make it first", folder.display()),
        _ => return error,
    };
    Error::new(error.kind(), format!("{what} ({error})"))
}

fn target(path: &Path) -> Result<Target> {
    let found = match path.metadata() {
        Ok(found) => found,
        Err(error) if error.kind() == ErrorKind::NotFound && !path.is_symlink() => {
            return Ok(Target::File(path.to_owned(), None));
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return Err(Error::new(
                error.kind(),
                "a symbolic link to a file that is not there: remove it, or give another name",
            ));
        }
        Err(error) => return Err(error),
    };
    if found.is_dir() {
        return Err(Error::new(ErrorKind::IsADirectory, "this is a folder: give the name of a file"));
    }
    if !found.is_file() {
        return Ok(Target::Stream);
    }
    if found.permissions().readonly() {
        let message = "the file is read-only: change its permissions, or give another name";
        return Err(Error::new(ErrorKind::PermissionDenied, message));
    }
    // Renaming needs only the folder's permissions: check the file's own permissions here.
    let opened = OpenOptions::new().write(true).open(path);
    opened.map_err(|error| Error::new(error.kind(), format!("the file is locked for this user ({error})")))?;
    Ok(Target::File(path.canonicalize()?, Some(found)))
}

fn stream(path: &Path) -> Result<File> {
    OpenOptions::new().write(true).open(path)
}

/// New file in the folder of `path`, which is removed unless it is renamed.
fn beside(path: &Path) -> Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".arcfeed-").suffix(".part");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(NEW_MODE));
    builder.tempfile_in(parent(path)).map_err(|error| explained(error, path))
}

fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn keep_owner_and_mode(file: &File, before: &Metadata) -> Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        // Only root may give a file away, and only root needs to.
        let _whose_it_was = fchown(file, Some(before.uid()), Some(before.gid()));
    }
    let mode: Permissions = before.permissions();
    file.set_permissions(mode)
}

/// Both paths lead to the same regular file, or would.
fn is_same(one: &Path, other: &Path) -> bool {
    match (one.metadata(), other.metadata()) {
        (Ok(one_found), Ok(other_found)) => {
            one_found.is_file() && other_found.is_file() && is_one(one, &one_found, other, &other_found)
        }
        (Err(_), Err(_)) => {
            let place = |path: &Path| Some(parent(path).canonicalize().ok()?.join(path.file_name()?));
            place(one).is_some_and(|place_of_one| Some(place_of_one) == place(other))
        }
        _ => false,
    }
}

#[cfg(unix)]
fn is_one(_: &Path, one: &Metadata, _: &Path, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

#[cfg(not(unix))]
fn is_one(one: &Path, _: &Metadata, other: &Path, _: &Metadata) -> bool {
    one.canonicalize().ok() == other.canonicalize().ok()
}
