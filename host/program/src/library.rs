//! Folder of subprograms (library).

use std::io::Read;
use std::path::PathBuf;

use arcfeed_nc_macro::program::Library;
use arcfeed_nc_macro::stack::Bounds;

use crate::files;

/// Folder with subprograms, one per file: `O9010`, with `.nc` or without, or `9010.nc`.
#[derive(Clone, Debug)]
pub struct Folder(pub PathBuf);

impl Folder {
    /// Path of the file with the program of this O number; `None` if there is none.
    pub fn file(&self, number: u32) -> Option<PathBuf> {
        let names = [format!("O{number:04}"), format!("O{number}"), format!("{number:04}"), format!("{number}")];
        let paths =
            names.iter().flat_map(|name| ["", ".nc", ".NC"].map(|ending| self.0.join(format!("{name}{ending}"))));
        paths.into_iter().find(|path| files::is_file(path).unwrap_or(false))
    }
}

impl Library for Folder {
    fn load(&mut self, number: u32) -> Option<Vec<u8>> {
        let mut text = Vec::new();
        // One byte more than all programs may have is enough to reject it.
        let most = Bounds::default().memory as u64 + 1;
        files::open(&self.file(number)?).ok()?.0.take(most).read_to_end(&mut text).ok()?;
        Some(text)
    }
}
