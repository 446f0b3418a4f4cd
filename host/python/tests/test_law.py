"""`Law` against the thesis's equations, the program and the published table."""

from __future__ import annotations

import math
import threading
from typing import Literal

import arcfeed
import numpy as np
import pytest
from conftest import SLOT
from thesis import step_per_tooth

INCH = 25.4
# The published tool, outer and inner radius, and a feed per tooth of 0.004 in.
R, r, A = 5.06205 * INCH, 4.43706 * INCH, 0.004 * INCH


@pytest.mark.parametrize(
    ("edge", "k", "rho", "r0"), [("outer", 1, r, R), ("outer", 1, R, R), ("inner", -1, R, r), ("inner", -1, r, r)]
)
@pytest.mark.parametrize("turn", [1, -1])
def test_the_law_is_the_thesis_s(edge: Literal["outer", "inner"], k: int, rho: float, r0: float, turn: int) -> None:
    normal_deg, offset = 35.0, 110.0
    part = np.linspace(0.0, 1.0, 20_001)
    law = arcfeed.Law.circumference(
        path_radius=rho, edge_radius=r0, feed_per_tooth=A, normal_deg=normal_deg, offset=offset, edge=edge,
        start_deg=12.0, sweep_deg=turn * 360.0,
    )  # fmt: skip
    angle = math.radians(12.0) + turn * 2.0 * math.pi * part
    expected, contact = step_per_tooth(angle, turn, (rho, r0), k, A, (math.radians(normal_deg), offset))
    found, found_deg = law.feed_per_tooth(part), law.contact_deg(part)
    # At the ends of validity the two round to different sides.
    both = np.isfinite(found) & np.isfinite(expected)
    assert np.mean(np.isfinite(found) != np.isfinite(expected)) < 5e-4 and both.sum() > 2_000
    # Away from grazing contacts, where D / h^2 < 0.05 (docs/laws.md): there small errors of the contact grow.
    clear = both & (contact > math.radians(10.0)) & (contact < math.radians(89.9))
    error = np.abs(found[clear] / expected[clear] - 1.0)
    print(f"{edge} {turn:+d}: median {np.median(error):.1e}, largest {error.max():.1e} of {clear.sum()}")
    assert np.median(error) < 1e-7 and error.max() < 1e-6
    assert np.abs(found_deg[clear] - np.degrees(contact[clear])).max() < 1e-3


def test_the_published_rows_come_from_the_lines_of_the_example() -> None:
    part = np.linspace(0.0, 1.0, 2_001)
    blocks = {block["line"]: block for block in arcfeed.adapt(SLOT)}
    for line in (19, 20, 22, 23):
        law = arcfeed.Law.of_line(SLOT, line)
        assert law.kind == "circumference"
        # Feed in in/min with 10 teeth at 1000 rev/min: eq. 30.
        feed = law.feed_per_tooth(part) / INCH * 10 * 1000
        block = blocks[line]
        assert feed.min() == pytest.approx(block["feed_min"], rel=2e-6)
        assert feed.max() == pytest.approx(block["feed_max"], rel=2e-6)
        assert law.contact_deg(part[:1])[0] == pytest.approx(block["contact_deg_start"], abs=1e-3)


def test_positions_outside_the_move_and_without_contact_are_nan() -> None:
    law = arcfeed.Law.circumference(path_radius=10, edge_radius=5, feed_per_tooth=0.1, normal_deg=0, offset=100)
    assert np.isnan(law.feed_per_tooth(np.array([-0.1, 0.5, 1.1, np.nan, np.inf]))).all()
    assert law.no_demand(0.5) == "NoContact" and law.length == pytest.approx(20 * math.pi)
    assert law.feed_per_tooth(np.array([])).shape == (0,)


def test_a_line_without_a_law_is_refused_with_its_place() -> None:
    rapid = next(block["line"] for block in arcfeed.adapt(SLOT) if block["reason"] == "rapid")
    for line, words in [(1, "no block with a move"), (10_000, "no block with a move"), (rapid, "no law governs")]:
        with pytest.raises(arcfeed.InputError, match=words) as error:
            arcfeed.Law.of_line(SLOT, line)
        assert error.value.line == line


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("path_radius", -1.0),
        ("edge_radius", math.nan),
        ("feed_per_tooth", 0.0),
        ("sweep_deg", 0.0),
        ("sweep_deg", 361.0),
        ("offset", math.inf),
        ("edge", "rim"),
    ],
)
def test_values_that_make_no_law_are_refused(name: str, value: object) -> None:
    values = {"path_radius": 10.0, "edge_radius": 5.0, "feed_per_tooth": 0.1, "normal_deg": 0.0, "offset": 12.0}
    with pytest.raises(ValueError, match=name):
        arcfeed.Law.circumference(**(values | {name: value}))  # type: ignore[arg-type]


def test_slices_are_read_where_they_lie() -> None:
    law = arcfeed.Law.of_line(SLOT, 19)
    part = np.linspace(0.0, 1.0, 1_001)
    assert np.array_equal(law.feed_per_tooth(part[::-2]), law.feed_per_tooth(part)[::-2])


def test_other_threads_run_while_the_law_is_evaluated() -> None:
    law = arcfeed.Law.of_line(SLOT, 19)
    part = np.linspace(0.0, 1.0, 4_000_000)
    threads = [threading.Thread(target=law.feed_per_tooth, args=(part,)) for _ in range(2)]
    counted = 0
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        counted += 1
    assert counted > 1_000
