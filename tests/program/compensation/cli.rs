//! Alarms of contours in `arcfeed check`.

use arcfeed_tests::{Scratch, run};
use serde_json::Value;

/// Line, column, alarm number.
type Place = (u64, u64, Option<u64>);

/// Exit code, errors and warnings of a check.
fn found(arguments: &[&str]) -> (Option<i32>, Vec<Place>, Vec<Place>) {
    let output = run(&[&["check", "--json"], arguments].concat());
    let report: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let place = |entry: &Value| {
        let number = |field: &str| entry[field].as_u64();
        (number("line").expect("a line"), number("column").expect("a column"), number("alarm"))
    };
    let places = |list: &str| report[list].as_array().expect("a list").iter().map(place).collect();
    (output.status.code(), places("errors"), places("warnings"))
}

#[test]
fn contours_are_checked_with_the_radius_of_the_settings_or_of_the_program() {
    let scratch = Scratch::new("contours");
    let program = "%\nG21G17G90G94\nG0X-10.Y0\nN4G41D7G1X0F100.\nX20.\nG3X25.Y5.J5.\nG1Y20.\nG40X0\nM30\n%\n";
    let path = scratch.write("contour.nc", program);
    assert_eq!(found(&[&path]), (Some(0), vec![], vec![(4, 1, None)]));
    let with_radius = |radius: &str| scratch.write("machine.toml", format!("unit = 'mm'\n[radius]\n7 = {radius}\n"));
    assert_eq!(found(&[&path, "--settings", &with_radius("5.0")]), (Some(0), vec![], vec![]));
    assert_eq!(found(&[&path, "--settings", &with_radius("5.5")]), (Some(1), vec![(6, 1, Some(41))], vec![]));
    for statement in ["G10L12P7R5.5", "#13007=5.5"] {
        let path = scratch.write("own.nc", program.replace("G0X-10.Y0", &format!("{statement}\nG0X-10.Y0")));
        assert_eq!(found(&[&path]), (Some(1), vec![(7, 1, Some(41))], vec![]), "{statement}");
    }
}
