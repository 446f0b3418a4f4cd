"""The functions give the figures of the program."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import arcfeed
import pytest
from conftest import ROOT, SLOT

Program = Callable[..., list[Any]]


def test_check_has_the_counts_and_alarms_of_the_program(program: Program) -> None:
    path = str(ROOT / "tests/corpus/cam-2003.nc")
    assert [arcfeed.check(path)] == program("check", path)
    assert [arcfeed.check(path, strict=True, control="fanuc-31i")] == program(
        "check", path, "--strict", "--control=fanuc-31i"
    )


def test_errors_of_a_program_are_in_the_result_with_their_places() -> None:
    found = arcfeed.check(text="%\nO1\nG21 G90 G17 G94 G0 X0. Y0. Z0.\nG2 X2. Y0. I9. J0. F100.\nM30\n%\n")
    assert found["program"] == "text"
    assert [(error["line"], error["alarm"]) for error in found["errors"]] == [(4, 20)]


def test_check_takes_a_path_or_a_text() -> None:
    with pytest.raises(TypeError):
        arcfeed.check()
    with pytest.raises(TypeError):
        arcfeed.check("a.nc", text="%")


def test_init_writes_the_job_of_the_program(program: Program, tmp_path: Path) -> None:
    source = str(ROOT / "examples/pocket/pocket.nc")
    mine, other = tmp_path / "mine.toml", tmp_path / "other.toml"
    found = arcfeed.init(source, mine, tool={1: "10 mm"}, teeth=4, spindle=8000)
    (expected,) = program("init", source, "-o", str(other), "--tool=T1=10 mm", "--teeth=4", "--spindle=8000")
    assert mine.read_bytes() == other.read_bytes()
    assert found == expected | {"job": str(mine)}
    with pytest.raises(arcfeed.InputError, match="mine.toml"):
        arcfeed.init(source, mine)


def test_adapt_has_the_blocks_and_writes_the_text_of_the_program(program: Program, tmp_path: Path) -> None:
    mine, other = tmp_path / "mine.nc", tmp_path / "other.nc"
    blocks = arcfeed.adapt(SLOT, mine)
    assert blocks == program("adapt", str(SLOT), "-o", str(other))
    assert mine.read_bytes() == other.read_bytes()
    assert sum(block["reason"] == "law" for block in blocks) == 20


def test_adapt_without_a_job_takes_its_values(program: Program) -> None:
    source = str(ROOT / "examples/pocket/pocket.nc")
    assert arcfeed.adapt(source, tool="10 mm", teeth=4, mode="rewrite-only") == program(
        "adapt", source, "--tool=10 mm", "--teeth=4", "--mode=rewrite-only"
    )


def test_simulate_has_the_figures_of_the_program(program: Program) -> None:
    seen: list[tuple[int, float]] = []
    mine = arcfeed.simulate(SLOT, progress=lambda blocks, time_s: seen.append((blocks, time_s)))
    (expected,) = program("simulate", str(SLOT))
    # The one figure of the wall clock.
    assert mine.pop("real_time_factor") > 0 and expected.pop("real_time_factor") > 0
    assert mine == expected
    assert seen == sorted(seen) and len(seen) > 0
    assert all(0 <= blocks <= mine["blocks_executed"] and time_s > 0 for blocks, time_s in seen)


def test_a_broken_assertion_raises_with_the_result() -> None:
    job = ROOT / "examples/pocket/job-contour.toml"
    result = arcfeed.simulate(job, asserts=["chip<=1.05"])
    time_s = result["cycle_time_s"]
    with pytest.raises(arcfeed.InputError) as raised:
        arcfeed.simulate(job, asserts=[f"time<={time_s / 2:.3f}s"])
    assert raised.value.result[0]["cycle_time_s"] == time_s


def test_plan_has_the_figures_of_the_program(program: Program, tmp_path: Path) -> None:
    part = str(ROOT / "examples/repaired-blade/REPAIR.toml")
    mine = arcfeed.plan("repair", part, tmp_path)
    assert [mine] == program("plan", "repair", part)
    assert {"allowance.csv", "contacts.csv"} <= {file.name for file in tmp_path.iterdir()}


def test_warnings_are_warnings_of_python(tmp_path: Path) -> None:
    text = SLOT.read_text(encoding="utf-8").replace("ibr-slot.nc", str(SLOT.with_name("ibr-slot.nc")))
    job = tmp_path / "job.toml"
    job.write_text(text.replace("z = [-28.35, -27.56]", "z = [-1.0, 1.0]"), encoding="utf-8")
    with pytest.warns(arcfeed.ArcfeedWarning, match=r"job.toml:\d+:\d+: warning: "):
        arcfeed.adapt(job)


def test_numbers_of_results_are_finite() -> None:
    blocks = arcfeed.adapt(SLOT)
    feeds = [block["feed_max"] for block in blocks if block["feed_max"] is not None]
    assert feeds and all(math.isfinite(feed) for feed in feeds)
