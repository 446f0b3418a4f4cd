"""Figures of the slot example from the tables of a trace, by a program that knows docs/traces.md only.

    figures.py RUN.csv|RUN.parquet
    figures.py ONE OTHER

prints the lines of the summary of `arcfeed simulate` from the tables of the samples, then the chips measured anew from the
positions: tool and stock lines are those of examples/ibr-slot/job.toml. With two files it compares all their values. Parquet
is read by DuckDB.
"""

import csv
import json
import math
import sys
from pathlib import Path

INCH = 25.4
RADII = {"outer": 5.06205 * INCH, "inner": 4.43706 * INCH}
TEETH = 10
# Words of the summary, edge that cuts, normal of the stock line in degrees, its offset.
MOVEMENTS = [
    ("interior ccw outer", "outer", 54.187, 4.2391),
    ("exterior cw outer", "outer", 48.104, 10.4502),
    ("exterior ccw inner", "inner", 81.715, 10.7843),
    ("interior cw inner", "inner", 97.563, 7.2959),
]


def csv_value(text):
    """Value of a field: missing, flag, number or word."""
    if text == "":
        return None
    if text in ("true", "false"):
        return text == "true"
    try:
        return float(text)
    except ValueError:
        return text


def table(path):
    """Rows of a table."""
    if path.suffix == ".csv":
        with open(path, newline="") as file:
            return [{name: csv_value(text) for name, text in row.items()} for row in csv.DictReader(file)]
    import duckdb

    relation = duckdb.sql(f"select * from read_parquet('{path}')")
    return [dict(zip(relation.columns, row)) for row in relation.fetchall()]


def beside(path, suffix):
    return path.with_name(path.stem + suffix + path.suffix)


def cycle_time_s(samples):
    moving = [row["time_s"] for row in samples if row["block"] is not None]
    return samples[-1]["time_s"] - moving[0]


def steady(samples, rule):
    return [row["chip_mm"] for row in samples if row["rule"] == rule and row["is_steady"]]


def changes(samples, block):
    overrides = [row["override_percent"] for row in samples if row["block"] == block]
    return sum(a != b for a, b in zip(overrides, overrides[1:]))


def movement_line(rule, before, after):
    words = MOVEMENTS[rule - 1][0]
    rows = [row for row in after if row["rule"] == rule]
    (target,) = {row["target_chip_mm"] for row in rows if row["target_chip_mm"] is not None}
    ranges = [[limit(steady(run, rule)) / INCH for limit in (min, max)] for run in (before, after)]
    errors = [limit(steady(after, rule)) / target - 1 for limit in (min, max)]
    overrides = [row["override_percent"] for row in rows]
    blocks = sorted({row["block"] for row in rows})
    counts = " ".join(str(changes(after, block)) for block in blocks)
    return "{} {} {} {:.5f} {:.5f} .. {:.5f} {:.5f} .. {:.5f} {:+.2f} .. {:+.2f} % {:.0f} .. {:.0f} % {}".format(
        rule, words, len(blocks), target / INCH, *ranges[0], *ranges[1], *(1e2 * error for error in errors),
        min(overrides), max(overrides), counts,
    )  # fmt: skip


def circle_through(points):
    """Centre of the circle through the first, the middle and the last of these points."""
    (ax, ay), (bx, by), (cx, cy) = points[0], points[len(points) // 2], points[-1]
    bx, by, cx, cy = bx - ax, by - ay, cx - ax, cy - ay
    double = 2 * (bx * cy - by * cx)
    x = (cy * (bx * bx + by * by) - by * (cx * cx + cy * cy)) / double
    y = (bx * (cx * cx + cy * cy) - cx * (bx * bx + by * by)) / double
    return ax + x, ay + y


def contact_chip_mm(position, step, pivot, movement):
    """Radial advance of the cutting circle at its contact with the stock line, by the quadratic equation of the ray."""
    _, edge, normal_deg, offset = movement
    radius, outward = RADII[edge], 1 if edge == "outer" else -1
    normal = (math.cos(math.radians(normal_deg)), math.sin(math.radians(normal_deg)))
    distance = offset * INCH - normal[0] * position[0] - normal[1] * position[1]
    if abs(distance) > radius:
        return None
    along = math.sqrt(radius**2 - distance**2)
    chips = []
    for side in (1, -1):
        u = [(normal[i] * distance + side * along * (-normal[1], normal[0])[i]) / radius for i in (0, 1)]
        towards = (pivot[0] - position[0], pivot[1] - position[1])
        turned = (-towards[1], towards[0])
        forward = math.copysign(1, turned[0] * step[0] + turned[1] * step[1])
        advances = outward * forward * (u[0] * turned[0] + u[1] * turned[1]) > 0
        if u[0] * towards[0] + u[1] * towards[1] >= 0 and advances:
            # |s u - step| = radius
            half = u[0] * step[0] + u[1] * step[1]
            reach = half + math.sqrt(half**2 - (step[0] ** 2 + step[1] ** 2 - radius**2))
            chips.append(outward * (reach - radius))
    return max(chips, default=None)


def measured_anew(samples):
    """Number of chips of the table that were measured anew from positions, and the largest difference."""
    count, worst = 0, 0.0
    arcs = {}
    for index, row in enumerate(samples):
        if row["rule"] is not None:
            arcs.setdefault(row["block"], []).append(index)
    for indices in arcs.values():
        pivot = circle_through([(samples[i]["x_mm"], samples[i]["y_mm"]) for i in indices])
        for index in indices:
            row = samples[index]
            if row["chip_mm"] is None:
                continue
            tooth_ms = 6e4 / (row["spindle_rev_per_min"] * TEETH)
            assert tooth_ms == 6, "a whole number of samples"
            first = samples[index - 6]
            position = (first["x_mm"], first["y_mm"])
            step = (row["x_mm"] - position[0], row["y_mm"] - position[1])
            chip_mm = contact_chip_mm(position, step, pivot, MOVEMENTS[int(row["rule"]) - 1])
            count, worst = count + 1, max(worst, abs(chip_mm - row["chip_mm"]))
    return count, worst


def block_figures(samples, blocks):
    """Number of blocks with chips, and the largest difference between their figures and those of their samples."""
    count, worst = 0, 0.0
    for block in blocks:
        chips = [row["chip_mm"] for row in samples if row["block"] == block["block"] and row["is_steady"]]
        if chips:
            assert len(chips) == block["samples"], block
            count += 1
            worst = max(worst, abs(min(chips) - block["chip_min_mm"]), abs(max(chips) - block["chip_max_mm"]))
    return count, worst


def units_in_metadata(path):
    """Columns of a Parquet file whose unit is in its metadata, and the version of the schema."""
    import duckdb

    query = f"select value from parquet_kv_metadata('{path}') where decode(key) = 'arcfeed'"
    ((schema,),) = duckdb.sql(query).fetchall()
    schema = json.loads(schema)
    return f"schema {schema['schema']}, {sum(column['unit'] != '' for column in schema['columns'])} columns with a unit"


def compared(one, other):
    rows = [table(Path(path)) for path in (one, other)]
    assert len(rows[0]) == len(rows[1]) > 0, [len(run) for run in rows]
    for index, (first, second) in enumerate(zip(*rows)):
        assert list(first) == list(second) and first == second, (index, first, second)
    return len(rows[0]), len(rows[0][0])


def main():
    if len(sys.argv) == 3:
        return print("{} rows of {} columns are equal".format(*compared(*sys.argv[1:])))
    path = Path(sys.argv[1])
    before, after = table(beside(path, "-original")), table(path)
    times = [cycle_time_s(run) for run in (before, after)]
    change = 1e2 * (times[1] / times[0] - 1)
    print("cycle time: {:.1f} s before, {:.1f} s after ({:+.0f} %)".format(*times, change))
    for rule in range(1, 5):
        print(movement_line(rule, before, after))
    print("{} chips measured anew: {:.2e} mm at most".format(*measured_anew(after)))
    print("{} blocks with chips: {:.2e} mm at most".format(*block_figures(after, table(beside(path, "-blocks")))))
    print(f"{len(after)} rows")
    if path.suffix == ".parquet":
        print(units_in_metadata(path))


main()
