//! Machines built into the program: those of `host/adapt/machines`, under their files' names.

use std::path::Path;

use super::MachineFile;
use crate::key_values::{KeyValue, with_values};

const PRESETS: [(&str, &str); 3] = [
    ("ferrari-rtttr", include_str!("../../machines/ferrari-rtttr.toml")),
    ("mikron-ucp710", include_str!("../../machines/mikron-ucp710.toml")),
    ("mitsui-seiki-hu80a-5x", include_str!("../../machines/mitsui-seiki-hu80a-5x.toml")),
];

impl MachineFile {
    /// The built-in machine with this name, if there is one.
    pub fn preset(name: &str) -> Option<Result<Self, String>> {
        Self::preset_with(name, &[])
    }

    /// Built-in machine with this name, in which `values` replace the values of its file; `None` if there is none.
    pub fn preset_with(name: &str, values: &[KeyValue]) -> Option<Result<Self, String>> {
        let (name, text) = PRESETS.iter().find(|(known, _)| *known == name)?;
        let changed = with_values(text, values).map_err(|error| format!("{name}: {error}"));
        Some(changed.and_then(|text| Self::parse(&text).map_err(|error| format!("{name}:{error}"))))
    }

    /// Names of all presets, for messages.
    pub fn preset_names() -> String {
        PRESETS.map(|(name, _)| format!("\"{name}\"")).join(", ")
    }

    /// Machine with this name of a preset, or from the file of this path. `./NAME` is always a file.
    ///
    /// # Errors
    /// See [`MachineFile::load`].
    pub fn named(word: &Path) -> Result<Self, String> {
        let preset = word.to_str().and_then(Self::preset);
        preset.unwrap_or_else(|| Self::load(word))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_a_machine_and_the_file_of_its_name() {
        for (name, text) in PRESETS {
            let file = MachineFile::named(Path::new(name)).unwrap();
            assert_eq!(Ok(file), MachineFile::parse(text));
        }
        let missing = MachineFile::named(Path::new("./mikron-ucp710")).unwrap_err();
        assert!(missing.starts_with("./mikron-ucp710: "), "{missing}");
    }
}
