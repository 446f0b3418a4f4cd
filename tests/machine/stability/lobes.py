"""Critical depths of linear regenerative milling against speed, by an independent program: standard library only.

    python3 -B lobes.py SET      a parameter set's table, as in sld_SET.csv, 2000 to 20000 rev/min
    python3 -B lobes.py check    by how much the tables beside this file differ, ten minutes

The critical depth is the first one, going up by three hundredths, at which the largest eigenvalue mu of the map from tooth to
tooth (monodromy.py) passes 1. The frequency reported is that of (arg mu / 2 pi + k) / T at which the tool moves farthest. Beside
it stands the zeroth-order approximation (zeroth_order.py).
"""
import csv
import pathlib
import sys

from monodromy import Cut, Milling, Mode, X, Y
from zeroth_order import ZerothOrder

RISE = 1.03
EXACTNESS = 1e-7
SPEEDS_REV_PER_MIN = range(2000, 20001, 500)


def mode_a(axis):
    return Mode(922.0, 0.011, 1340.049648, axis)


B_MODES = [
    Mode(456.78, 0.111705, 7933.1, X),
    Mode(1448.89, 0.017037, 14691.8, X),
    Mode(516.52, 0.024580, 9374.6, Y),
    Mode(1408.45, 0.031358, 12406.4, Y),
]
C_MODES = [Mode(900.0, 0.03, 9000.0, axis) for axis in (X, Y)]
SETS = {
    "A1_down_aD1.00": Milling([mode_a(X)], 2, 600.0, 200.0, 1.0, False),
    "A1_down_aD0.50": Milling([mode_a(X)], 2, 600.0, 200.0, 0.5, False),
    "A1_down_aD0.10": Milling([mode_a(X)], 2, 600.0, 200.0, 0.1, False),
    "A2_down_aD1.00": Milling([mode_a(X), mode_a(Y)], 2, 600.0, 200.0, 1.0, False),
    "B_down_aD0.50": Milling(B_MODES, 2, 1319.4, 788.8, 0.5, False),
    "C_up_aD0.50": Milling(C_MODES, 3, 1879.385, 684.040, 0.5, True),
}


def boundary(cut, start_mm):
    """Critical depth and the multiplier there."""
    low_mm = start_mm
    while abs(cut.multiplier(RISE * low_mm)) < 1.0:
        low_mm *= RISE
    high_mm = RISE * low_mm
    while high_mm - low_mm > EXACTNESS * high_mm:
        middle_mm = (low_mm + high_mm) / 2
        if abs(cut.multiplier(middle_mm)) < 1.0:
            low_mm = middle_mm
        else:
            high_mm = middle_mm
    return high_mm, cut.multiplier(high_mm)


def line(milling, zeroth, rev_per_min):
    """The columns of a table."""
    cut = Cut(milling, rev_per_min)
    depth_mm, mu = boundary(cut, zeroth.lowest()[0] / 4)
    kind = "flip" if abs(mu.imag) < 1e-6 and mu.real < 0.0 else "Hopf"
    approximate_mm, approximate_hz = zeroth.at(cut.tooth_s)
    hz = cut.frequency_hz(depth_mm, mu)
    return f"{rev_per_min:.0f},{depth_mm:.5f},{kind},{hz:.2f},{approximate_mm:.5f},{approximate_hz:.2f}"


NAMES = "rpm,alim_ref_mm,bifurcation,f_chatter_ref_Hz,alim_zoa_mm,f_chatter_zoa_Hz"


TITLE = (
    "# Critical depth by collocation of the monodromy operator, its kind and frequency; zeroth-order approximation beside it. "
    "By lobes.py."
)


def write(name):
    milling = SETS[name]
    zeroth = ZerothOrder(milling)
    print(TITLE, NAMES, sep="\n")
    for rev_per_min in SPEEDS_REV_PER_MIN:
        print(line(milling, zeroth, rev_per_min), flush=True)


def check():
    for name, milling in SETS.items():
        zeroth = ZerothOrder(milling)
        with pathlib.Path(__file__).with_name(f"sld_{name}.csv").open() as file:
            rows = list(csv.DictReader(row for row in file if not row.startswith("#")))
        made = [dict(zip(NAMES.split(","), line(milling, zeroth, float(row["rpm"])).split(","))) for row in rows]
        other = [row["rpm"] for row, own in zip(rows, made) if row["bifurcation"] != own["bifurcation"]]
        depth_mm, hz = zeroth.lowest()
        print(f"{name}: {len(rows)} rows, of another kind {other}; zeroth order at least {depth_mm:.6f} mm, at {hz:.1f} Hz")
        for column in ("alim_ref_mm", "alim_zoa_mm"):
            off = [(abs(float(own[column]) / float(row[column]) - 1.0), row["rpm"]) for row, own in zip(rows, made)]
            worst = ", ".join(f"{relative:.1e} at {rpm}" for relative, rpm in sorted(off)[:-4:-1])
            print(f"  {column} differs by {worst}", flush=True)


if __name__ == "__main__":
    if sys.argv[1:] == ["check"]:
        check()
    elif len(sys.argv) == 2 and sys.argv[1] in SETS:
        write(sys.argv[1])
    else:
        sys.exit(f"usage: lobes.py check | {' | '.join(SETS)}")
