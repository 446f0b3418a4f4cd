//! What is wrong with a `[cutting]` is told with its place in the job.

use crate::story::ran;

const JOB: &str = "units = \"mm\"\nprogram = \"program.nc\"\n\
    [tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 30\n\
    [workpiece]\nblock = { from = [-10, -10, -12], to = [50, 10, 0] }\nstep = 1\n\
    [cutting]\nmaterial = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 4\n\
    [spindle]\nrev_per_min = 3000\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n";

#[test]
fn every_mistake_has_a_place_and_says_what_to_do() {
    for (index, (from, to, expected)) in [
        (
            "[workpiece]\nblock = { from = [-10, -10, -12], to = [50, 10, 0] }\nstep = 1\n",
            "",
            ":8:1: [cutting] needs a [workpiece]",
        ),
        ("\"Ti-6Al-4V\"", "\"Ti\"", ":12:12: no coefficients are known of `Ti`; write one of \"Ti-6Al-4V\", "),
        ("radial = 0.4\n", "", ":11:1: give `radial` and `axial`"),
        ("radial = 0.4", "radial = -1", ":13:10: radial must be a number, 0 or more"),
        ("material = \"Ti-6Al-4V\"", "kc11 = 2000", ":11:1: give the coefficients as one of material"),
        ("material = \"Ti-6Al-4V\"", "kc11 = 2000\nmc = 1", ":13:6: mc must be 0 to less than 1"),
        (
            "material = \"Ti-6Al-4V\"",
            "cutting = [1, 1, 1]\nedge = [0, 0, 0]",
            ":14:10: `cutting` and `edge` have radial and axial values",
        ),
        ("axial_depth = 4", "axial_depth = 31", ":15:15: axial_depth must be at most the tool's height"),
        ("axial_depth = 4", "axial_depth = 4\nlayers = 0", ":16:10: layers must be 1 to 100"),
        ("axial_depth = 4", "axial_depth = 4\nhelix = 90", ":16:9: helix is that of an end-mill"),
        ("axial_depth = 4", "axial_depth = 4\npitch = [90, 90, 90]", ":11:1: 4 teeth need one value each, not 3"),
        ("axial_depth = 4", "axial_depth = 0.0001", ":11:1: "),
    ]
    .into_iter()
    .enumerate()
    {
        assert!(JOB.contains(from), "{from}");
        let (code, _, words) = ran(&format!("wrong-{index}"), &JOB.replace(from, to), "%\nG21\nM30\n%\n");
        println!("{}", words.trim_end());
        assert!(code == Some(1) && words.contains(expected), "{expected}: {words}");
    }
}
