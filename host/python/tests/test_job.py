"""`Job`: read, change, write."""

from __future__ import annotations

from pathlib import Path

import arcfeed
import numpy as np
import pytest
from conftest import SLOT


@pytest.fixture()
def job(tmp_path: Path) -> arcfeed.Job:
    for file in (SLOT, SLOT.with_name("ibr-slot.nc")):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    return arcfeed.Job(tmp_path / "job.toml")


def test_a_job_that_is_not_changed_stays_as_it_is(job: arcfeed.Job) -> None:
    before = job.path.read_bytes()
    job.write()
    assert job.path.read_bytes() == before


def test_values_are_those_of_the_file(job: arcfeed.Job) -> None:
    assert (job["units"], job["tool.active_teeth"], job["law.feed_per_tooth"]) == ("inch", 10, 0.004)
    assert job["cut.0.z"] == [-28.35, -27.56] and job["cut.1"]["direction"] == "cw"
    assert len(job["cut"]) == 4 and "tool.outer_radius" in job and "tool.flutes" not in job
    with pytest.raises(KeyError, match=r"tool\.flutes"):
        job["tool.flutes"]


def test_a_change_keeps_comments_and_is_what_the_program_reads(job: arcfeed.Job) -> None:
    before = job.text.splitlines()
    job["law.feed_per_tooth"] = np.float64(0.0036)
    job["cut.0.z"] = [-28.35, np.float64(-27.5)]
    job["override.max"] = 150
    path = job.write(job.path.with_name("other.toml"))
    after = path.read_text(encoding="utf-8").splitlines()
    assert len(after) == len(before) and sum(one != other for one, other in zip(before, after, strict=True)) == 3
    job["spindle.rev_per_min"] = np.int64(900)
    assert job["spindle.rev_per_min"] == 900
    faster = arcfeed.adapt(job.path.with_name("job.toml"))
    slower = arcfeed.adapt(path)
    pairs = [(a["feed_max"], b["feed_max"]) for a, b in zip(faster, slower, strict=True) if a["reason"] == "law"]
    assert pairs and all(b == pytest.approx(0.9 * a, rel=1e-3) for a, b in pairs)


def test_keys_can_be_added_and_removed(job: arcfeed.Job) -> None:
    job["machine.max_feed_x"] = 1
    assert job["machine"] == {"max_feed_x": 1}
    with pytest.raises(arcfeed.InputError, match="max_feed_x"):
        job.check()
    del job["machine.max_feed_x"]
    job.check()
    with pytest.raises(KeyError):
        del job["machine.max_feed_x"]
    with pytest.raises(KeyError):
        job["cut.9.n"] = 1
    with pytest.raises(TypeError):
        job["units"] = object()


def test_an_invalid_job_is_not_written(job: arcfeed.Job) -> None:
    before = job.path.read_bytes()
    job["tool.outer_radius"] = -1
    with pytest.raises(arcfeed.InputError) as error:
        job.write()
    line = job.text.splitlines()[(error.value.line or 0) - 1]
    assert "outer_radius = -1" in line and job.path.read_bytes() == before


def test_a_job_finds_its_program_from_where_it_is_written(job: arcfeed.Job, tmp_path: Path) -> None:
    (tmp_path / "below").mkdir()
    with pytest.raises(arcfeed.InputError, match="no program"):
        job.write(tmp_path / "below/job.toml")
    job["program"] = "../ibr-slot.nc"
    job.write(tmp_path / "below/job.toml")


def test_text_that_is_no_toml_has_its_place() -> None:
    with pytest.raises(arcfeed.InputError) as error:
        arcfeed.Job.parse('units = "mm"\nprogram = \n', "a/job.toml")
    assert (error.value.file, error.value.line) == ("a/job.toml", 2)
