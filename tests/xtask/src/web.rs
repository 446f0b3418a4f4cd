//! The start page with arcfeed inside it, in one file: the module is built for `wasm32-unknown-unknown`, and packed as the data
//! of a report are.

use std::fs;
use std::path::Path;

use miniz_oxide::deflate::compress_to_vec_zlib;

use crate::command::{Failure, announce, build_dir, cargo, run};
use crate::target::{PAGE, add};

const PACKAGE: &str = "arcfeed-wasm";
/// Profile of what is shipped.
pub const SHIPPED: &str = "dist";
const LEVEL: u8 = 9;

/// Nothing is loaded from elsewhere, and nothing can be sent: frames and workers of the page have its policy too.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval' blob:; style-src 'unsafe-inline'; \
                      img-src data: blob:; worker-src blob:; frame-src blob:";

/// Parts of the page, in `host/web`.
const STYLE: &str = include_str!("../../../host/web/viewer.css");
const BODY: &str = include_str!("../../../host/web/start.html");
const SCRIPT: &str = include_str!("../../../host/web/start.js");

/// Example in the page: a program, its name and its job.
const EXAMPLE: [&str; 3] = [
    include_str!("../../../examples/pocket/pocket.nc"),
    "pocket.nc",
    include_str!("../../../examples/pocket/job-contour.toml"),
];

/// Writes `index.html` into a folder, with the module as a profile builds it.
///
/// # Errors
/// The module does not build, or the folder cannot be written.
pub fn write(folder: &str, profile: &str) -> Result<(), Failure> {
    add(PAGE)?;
    announce("the module of the page: some minutes the first time");
    run(&mut cargo(&["build", "--locked", "--package", PACKAGE, "--target", PAGE, "--profile", profile]))?;
    let module = build_dir()?.join(PAGE).join(profile).join("arcfeed_wasm.wasm");
    let failed = |path: &Path, error: std::io::Error| Failure::new(format!("{}: {error}", path.display()));
    let module = fs::read(&module).map_err(|error| failed(&module, error))?;
    let folder = Path::new(folder);
    fs::create_dir_all(folder).map_err(|error| failed(folder, error))?;
    let (path, page) = (folder.join("index.html"), page(&module));
    fs::write(&path, &page).map_err(|error| failed(&path, error))?;
    announce(&format!(
        "{}: {} bytes, of which the module has {} before it is packed",
        path.display(),
        page.len(),
        module.len()
    ));
    Ok(())
}

fn page(module: &[u8]) -> String {
    let module = base64(&compress_to_vec_zlib(module, LEVEL));
    let [program, name, job] = EXAMPLE;
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>arcfeed</title>\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n<link rel=\"icon\" href=\"data:,\">\n<style>\n{STYLE}</style>\n\
         </head>\n<body class=\"start\">\n{BODY}<script type=\"text/plain\" id=\"arcfeed-wasm\">{module}</script>\n\
         <script type=\"text/plain\" id=\"example-program\" data-name=\"{name}\">{program}</script>\n\
         <script type=\"text/plain\" id=\"example-job\">{job}</script>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n"
    )
}

/// RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let bits = three.iter().fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - three.len()));
        let digit = |place: usize| char::from(DIGITS[(bits >> (18 - 6 * place)) as usize & 63]);
        text.extend((0..4).map(|place| if place <= three.len() { digit(place) } else { '=' }));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::base64;

    #[test]
    fn base64_is_that_of_the_rfc() {
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg==")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }
}
