"""Failures are exceptions with their place."""

from __future__ import annotations

from pathlib import Path

import arcfeed
import pytest
from conftest import SLOT


def raised(job: Path, text: str) -> arcfeed.Error:
    job.write_text(text, encoding="utf-8")
    with pytest.raises(arcfeed.InputError) as raised:
        arcfeed.adapt(job)
    return raised.value


def test_a_fault_of_a_job_has_file_line_and_column(tmp_path: Path) -> None:
    job = tmp_path / "job.toml"
    error = raised(job, SLOT.read_text(encoding="utf-8").replace("number = 14", "number = 14\nflutes = 3"))
    assert (error.file, error.column) == (str(job), 1)
    assert job.read_text(encoding="utf-8").splitlines()[(error.line or 0) - 1] == "flutes = 3"
    assert "flutes" in error.message and str(error).startswith(f"{job}:{error.line}:1: ")


def test_a_remedy_is_apart_from_the_fault(tmp_path: Path) -> None:
    text = SLOT.read_text(encoding="utf-8").replace('preset = "fanuc-16i"', 'preset = "sinumerik"')
    error = raised(tmp_path / "job.toml", text)
    assert error.message == "no such control" and error.remedy.startswith("write \"fanuc-16i\"")


def test_a_fault_of_a_program_has_its_place(tmp_path: Path) -> None:
    program = tmp_path / "ibr-slot.nc"
    program.write_text("%\nO1\nG21 G90 G17 G94 G0 X0. Y0. Z0.\nG2 X2. Y0. I9. J0. F100.\nM30\n%\n", encoding="utf-8")
    error = raised(tmp_path / "job.toml", SLOT.read_text(encoding="utf-8"))
    assert (error.file, error.line) == (str(program), 4) and error.column


def test_a_missing_file_has_a_name(tmp_path: Path) -> None:
    with pytest.raises(arcfeed.InputError) as error:
        arcfeed.simulate(tmp_path / "none.toml")
    assert error.value.file == str(tmp_path / "none.toml") and error.value.line is None


def test_a_value_that_is_not_allowed_is_an_error_of_usage() -> None:
    with pytest.raises(arcfeed.UsageError, match="fanuc-16i"):
        arcfeed.check(text="%\n%\n", control="heidenhain")
    with pytest.raises(ValueError):
        arcfeed.adapt(SLOT, teeth=4)


def test_a_plan_that_is_refused_has_the_reason_as_result(tmp_path: Path) -> None:
    part = tmp_path / "PART.toml"
    part.write_text('units = "inch"\n', encoding="utf-8")
    with pytest.raises(arcfeed.InputError) as error:
        arcfeed.plan("cup-mill", part)
    assert error.value.result[0]["safe"] is False and error.value.line is not None
