//! As much of TOML as the checks of `Cargo.toml` files need: one key a line, arrays of strings.

/// A key with its value, and the section it stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry<'a> {
    /// `dependencies` of `[dependencies]`, `test` of `[[test]]`.
    pub section: &'a str,
    /// As written, with its dots.
    pub key: &'a str,
    /// As written, with its quotes.
    pub value: &'a str,
}

/// All keys of a manifest.
pub fn entries(manifest: &str) -> Vec<Entry<'_>> {
    let mut section = "";
    let mut entries = Vec::new();
    for line in manifest.lines() {
        let line = line.split(" #").next().unwrap_or(line).trim();
        if line.starts_with('[') && line.ends_with(']') {
            section = line.trim_matches(['[', ']']).trim();
        } else if let Some((key, value)) = line.split_once('=').filter(|_| !line.starts_with('#')) {
            entries.push(Entry { section, key: key.trim(), value: value.trim() });
        }
    }
    entries
}

/// The string of a key, without quotes.
pub fn string<'a>(manifest: &'a str, section: &str, key: &str) -> Option<&'a str> {
    let entry = entries(manifest).into_iter().find(|entry| entry.section == section && entry.key == key)?;
    quoted(entry.value).into_iter().next()
}

/// The strings of the array `name = [...]`, wherever it stands, over as many lines as it takes.
pub fn array<'a>(manifest: &'a str, name: &str) -> Vec<&'a str> {
    let start = manifest.split_once(&format!("\n{name} = [")).map_or("", |(_, rest)| rest);
    quoted(start.split(']').next().unwrap_or(""))
}

/// Names of all dependencies, for all platforms, for tests and build scripts too; renamed ones under both names.
pub fn dependencies(manifest: &str) -> Vec<&str> {
    let mut names = Vec::new();
    for Entry { section, key, value } in entries(manifest) {
        let single = section.split_once("dependencies.").map(|(_, name)| name);
        if !section.ends_with("dependencies") && single.is_none() {
            continue;
        }
        names.push(single.unwrap_or_else(|| key.split('.').next().unwrap_or(key)).trim_matches('"'));
        let renamed = if key == "package" { Some(value) } else { value.split_once("package").map(|(_, rest)| rest) };
        names.extend(renamed.and_then(|rest| quoted(rest).into_iter().next()));
    }
    names
}

/// Texts between pairs of quotes.
fn quoted(text: &str) -> Vec<&str> {
    text.split('"').skip(1).step_by(2).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dependency_is_found_however_it_is_written() {
        let manifest = r#"
[package]
name = "x"
[dependencies]
a.workspace = true # why
b = { path = "b" }
c = { package = "real-c", version = "1" }
[target.'cfg(unix)'.dev-dependencies]
d = "1"
[build-dependencies.e]
version = "1"
"#;
        assert_eq!(dependencies(manifest), ["a", "b", "c", "real-c", "d", "e"]);
    }

    #[test]
    fn arrays_may_take_several_lines() {
        assert_eq!(array("[workspace]\nmembers = [\n  \"a\",\n  \"b/c\",\n]\n", "members"), ["a", "b/c"]);
    }
}
