"""Tables of a run are read by pandas, polars, DuckDB and pyarrow, and have the figures of the run."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import arcfeed
import duckdb
import numpy as np
import pandas
import polars
import pyarrow.parquet
import pytest
from conftest import ROOT, SLOT

INCH = 25.4


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], dict[str, Path]]:
    trace = tmp_path_factory.mktemp("trace") / "run.parquet"
    return arcfeed.simulate(SLOT, trace=trace), arcfeed.trace_files(trace)


def test_all_readers_see_the_same_table(run: tuple[dict[str, Any], dict[str, Path]]) -> None:
    path = run[1]["samples"]
    of_pandas, of_polars = pandas.read_parquet(path), polars.read_parquet(path)
    of_arrow = pyarrow.parquet.read_table(path)
    of_duckdb = duckdb.read_parquet(str(path)).df()
    assert of_arrow.column_names == list(of_pandas.columns) == of_polars.columns == list(of_duckdb.columns)
    assert len(of_pandas) == len(of_polars) == of_arrow.num_rows == len(of_duckdb) > 10_000
    for column in ("time_s", "x_mm", "override_percent", "chip_mm"):
        values = of_pandas[column].to_numpy(dtype=float, na_value=np.nan)
        others = of_polars[column].cast(polars.Float64).to_numpy(), of_duckdb[column].to_numpy(dtype=float, na_value=np.nan)
        assert all(np.array_equal(values, other, equal_nan=True) for other in others), column
    units = {column["name"]: column["unit"] for column in json.loads(of_arrow.schema.metadata[b"arcfeed"])["columns"]}
    assert units["time_s"] == "s" and units["feed_mm_per_min"] == "mm/min"


def test_the_samples_have_the_figures_of_the_result(run: tuple[dict[str, Any], dict[str, Path]]) -> None:
    result, files = run
    samples = pandas.read_parquet(files["samples"])
    steady = samples[samples["is_steady"].fillna(False).astype(bool)]
    chip = result["chip_load"]
    assert steady["chip_mm"].min() / INCH == pytest.approx(chip["min"], rel=1e-9)
    assert steady["chip_mm"].max() / INCH == pytest.approx(chip["max"], rel=1e-9)
    assert len(steady) == chip["samples"] > 10_000


def test_tables_in_memory_are_those_of_the_files(run: tuple[dict[str, Any], dict[str, Path]]) -> None:
    result = arcfeed.simulate(SLOT, tables=True)
    tables, files = result.pop("tables"), run[1]
    assert {**result, "real_time_factor": 0} == {**run[0], "real_time_factor": 0}
    # This job has no [cutting], so it has no passes of teeth.
    assert sorted(tables) == ["blocks", "original_blocks", "original_samples", "samples"]
    for key, table in tables.items():
        of_file, of_memory = pyarrow.parquet.read_table(files[key]), pyarrow.table(table)
        assert len(table) == of_file.num_rows and table.columns == of_file.column_names
        assert of_memory.cast(of_file.schema).equals(of_file)
        assert json.loads(of_memory.schema.metadata[b"arcfeed"]) == json.loads(of_file.schema.metadata[b"arcfeed"])
    samples = tables["samples"]
    chips = pandas.read_parquet(files["samples"])["chip_mm"]
    assert pandas.DataFrame.from_arrow(samples)["chip_mm"].equals(chips)
    assert polars.DataFrame(samples)["chip_mm"].to_list() == polars.read_parquet(files["samples"])["chip_mm"].to_list()
    assert duckdb.execute("select max(chip_mm) from samples").fetchall() == [(chips.max(),)]


def test_tables_in_memory_are_read_where_they_lie() -> None:
    samples = arcfeed.simulate(SLOT, tables=True)["tables"]["samples"]
    columns = [pyarrow.table(samples)["time_s"].chunk(0) for _ in range(2)]
    assert len({column.buffers()[1].address for column in columns}) == 1
    # NumPy refuses where it would have to copy.
    times = columns[0].to_numpy(zero_copy_only=True)
    assert times.dtype == np.float64 and len(times) == len(samples)
    del samples, columns
    assert np.all(np.diff(times) > 0)
    with pytest.raises(TypeError):
        arcfeed.simulate(SLOT, tables=True, trace="run.parquet")


def test_files_are_where_their_names_say(run: tuple[dict[str, Any], dict[str, Path]]) -> None:
    files = run[1]
    written = sorted(file.name for file in files["samples"].parent.iterdir())
    # This job has no [cutting], so it has no passes of teeth.
    assert written == sorted(file.name for key, file in files.items() if "teeth" not in key)
    assert (ROOT / "docs/traces.md").exists()
