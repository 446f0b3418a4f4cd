"""Commands of the program as functions.

Each function runs the command of the same name in this process and returns its JSON (docs/json.md) as Python objects, so
its figures are those of the program. Options that are not given have the program's defaults.
"""

from __future__ import annotations

import json
import os
import tempfile
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from . import _native
from ._errors import Error, exception

PathLike = str | os.PathLike[str]
Progress = Callable[[int, float], object]
RunsProgress = Callable[[int, int], object]
Length = float | str
PerTool = Length | Mapping[int, Length]
"""A value, or one for each tool number: ``{1: "10 mm", 2: 6}``."""


class ArcfeedWarning(UserWarning):
    """Warning of a command, as the program prints it on stderr."""


def check(
    program: PathLike | None = None,
    *,
    text: str | bytes | None = None,
    strict: bool = False,
    control: str | None = None,
    settings: PathLike | None = None,
    decimals: str | None = None,
    units: Literal["inch", "mm"] | None = None,
    library: PathLike | None = None,
) -> dict[str, Any]:
    """Check an NC program, or a job and its program: every alarm with line and column.

    Give the path of a program or job, or the ``text`` of a program. Errors of the program are in ``errors`` of the result,
    which is the object ``check`` of docs/json.md; they raise nothing.
    """
    if (program is None) == (text is None):
        raise TypeError("check takes either the path of a program or its text")
    words = _words(strict=strict, control=control, settings=settings, decimals=decimals, units=units, library=library)
    if text is None:
        assert program is not None
        return _checked(["check", os.fspath(program), *words])
    with tempfile.TemporaryDirectory(prefix="arcfeed-") as folder:
        file = Path(folder, "text")
        file.write_bytes(text.encode("latin-1", "replace") if isinstance(text, str) else text)
        return _checked(["check", str(file), *words]) | {"program": "text"}


def _checked(words: list[str]) -> dict[str, Any]:
    try:
        (report,) = _run(words)
    except Error as error:
        if not error.result or not error.result[0]["errors"]:
            raise
        report = error.result[0]
    return dict(report)


def init(
    program: PathLike,
    output: PathLike | None = None,
    *,
    force: bool = False,
    tool: PerTool | None = None,
    teeth: int | Mapping[int, int] | None = None,
    feed_per_tooth: PerTool | None = None,
    spindle: int | None = None,
    max: int | None = None,
    mode: Literal["rewrite-only", "safe-base", "override-only"] | None = None,
    milling: Literal["climb", "conventional"] | None = None,
    library: PathLike | None = None,
    control: str | None = None,
    settings: PathLike | None = None,
    decimals: str | None = None,
    units: Literal["inch", "mm"] | None = None,
) -> dict[str, Any]:
    """Write a first job file from a program, and return what was found: the object ``init`` of docs/json.md.

    Without ``output`` the job lies beside the program, under its name with ``.toml``. ``questions`` of the result are the
    values that a person must add.
    """
    (report,) = _run(["init", os.fspath(program), *_words(**{**locals(), "program": None})])
    return dict(report)


def adapt(
    job: PathLike,
    output: PathLike | None = None,
    *,
    expand: bool = False,
    tool: PerTool | None = None,
    teeth: int | Mapping[int, int] | None = None,
    feed_per_tooth: PerTool | None = None,
    spindle: int | None = None,
    max: int | None = None,
    mode: Literal["rewrite-only", "safe-base", "override-only"] | None = None,
    milling: Literal["climb", "conventional"] | None = None,
    library: PathLike | None = None,
    control: str | None = None,
    settings: PathLike | None = None,
    decimals: str | None = None,
    units: Literal["inch", "mm"] | None = None,
) -> list[dict[str, Any]]:
    """Rewrite a program's feeds according to its job; with ``output`` write the adapted program.

    Returns an object ``adapt`` of docs/json.md for each block with a move: ``pandas.DataFrame(arcfeed.adapt(...))`` is a
    table of them. The first argument is a job file, or an NC program for end mills with the values in the options.
    """
    return _run(["adapt", os.fspath(job), *_words(**{**locals(), "job": None})])


def simulate(
    job: PathLike,
    *,
    trace: PathLike | None = None,
    report: PathLike | None = None,
    surface: PathLike | None = None,
    asserts: Sequence[str] = (),
    tables: bool = False,
    progress: Progress | None = None,
    stock: Sequence[float] | None = None,
    material: str | None = None,
    tool: PerTool | None = None,
    teeth: int | Mapping[int, int] | None = None,
    feed_per_tooth: PerTool | None = None,
    spindle: int | None = None,
    max: int | None = None,
    mode: Literal["rewrite-only", "safe-base", "override-only"] | None = None,
    milling: Literal["climb", "conventional"] | None = None,
    library: PathLike | None = None,
    control: str | None = None,
    settings: PathLike | None = None,
    decimals: str | None = None,
    units: Literal["inch", "mm"] | None = None,
) -> dict[str, Any]:
    """Run a job on the simulated machine, before and after: the object ``simulate`` of docs/json.md.

    ``trace`` names the tables of both runs, ``.parquet`` or ``.csv`` (docs/traces.md; `trace_files` has their names);
    with ``tables`` the result has them in memory, in ``result["tables"]`` under the same keys: each is a `Table` that pandas,
    polars, pyarrow and DuckDB read without a copy. ``asserts`` are limits such as ``"chip<=1.05"``, of which a broken one
    raises `InputError`. ``progress(blocks,
    time_s)`` is called some twenty times a second with the blocks executed and the machine time; an exception in it, or
    Ctrl-C, stops the run, and no file is written.
    """
    box = None if stock is None else ",".join(str(value) for value in stock)
    others = {**locals(), "job": None, "progress": None, "asserts": None, "tables": None, "box": None, "stock": box}
    words = ["simulate", os.fspath(job), *_words(**others)]
    words += [f"--assert={limit}" for limit in asserts]
    if tables and trace is not None:
        raise TypeError("the tables of a run are either files (trace) or in memory (tables)")
    found: dict[str, Any] = {}
    (result,) = _run(words, progress, found if tables else None)
    if tables:
        names = {path.name: key for key, path in trace_files("run").items()}
        result["tables"] = {names[name]: table for name, table in found.items()}
    return dict(result)


def trace_files(trace: PathLike) -> dict[str, Path]:
    """Names of the tables that ``simulate(..., trace=trace)`` writes, by ``samples``, ``teeth``, ``blocks`` and the same
    with ``original_`` in front for the program without arcfeed. ``teeth`` are written for jobs with ``[cutting]`` alone."""
    path = Path(trace)
    tables = {"samples": "", "teeth": "-teeth", "blocks": "-blocks"}
    runs = {"": "", "original_": "-original"}
    names = {run + table: path.stem + before + after for run, before in runs.items() for table, after in tables.items()}
    return {key: path.with_name(name + path.suffix) for key, name in names.items()}


def plan(
    method: Literal["cup-mill", "plunge", "finish", "repair"],
    part: PathLike,
    output: PathLike | None = None,
) -> dict[str, Any]:
    """Plan tool paths from geometry: the object of the method in docs/json.md.

    With ``output``, a folder, the NC program, its job and the report are written there. A plan that is refused raises
    `InputError`, whose ``result`` has the reason. After Ctrl-C the plan goes on until its end, without writing files, while
    the caller has `KeyboardInterrupt` at once.
    """
    (result,) = _run(["plan", method, os.fspath(part), *_words(output=output)])
    return dict(result)


def lobes(
    job: PathLike,
    *,
    speeds: tuple[float, float] | None = None,
    points: int | None = None,
    radial_depth: Length | None = None,
    milling: Literal["climb", "conventional"] | None = None,
    feed_direction: float | None = None,
    svg: PathLike | None = None,
) -> dict[str, Any]:
    """Limit depth of stable milling against spindle speed, and the best speeds: the object ``lobes`` of docs/json.md.

    ``speeds`` is the range in rev/min; without it the machine's. ``pandas.DataFrame(arcfeed.lobes(job)["points"])`` is the
    diagram as a table.
    """
    ends = None if speeds is None else ",".join(repr(speed) for speed in speeds)
    (result,) = _run(["lobes", os.fspath(job), *_words(**{**locals(), "job": None, "speeds": ends, "ends": None})])
    return dict(result)


def law(
    job: PathLike | None = None,
    *,
    line: int | None = None,
    at: float | None = None,
    rho: Length | None = None,
    radius: Length | None = None,
    edge: Literal["outer", "inner", "inside", "outside"] | None = None,
    feed_per_tooth: Length | None = None,
    contact: float | None = None,
    stock_normal: float | None = None,
    stock_offset: Length | None = None,
    position: float | None = None,
    clockwise: bool = False,
    spindle: float | None = None,
    teeth: int | None = None,
    units: Literal["inch", "mm"] | None = None,
    svg: PathLike | None = None,
) -> dict[str, Any]:
    """One case of a feed law with every quantity and its equation: the object ``law`` of docs/json.md.

    The case is that of a ``line`` of a job's program, ``at`` a fraction of its arc, or of the values in the options. `Law`
    has the same law at many positions.
    """
    (result,) = _run(["law", *_words(**locals())])
    return dict(result)


def sweep(
    sweep: PathLike,
    output: PathLike | None = None,
    *,
    shard: tuple[int, int] | None = None,
    merge: bool = False,
    run: int | None = None,
    threads: int | None = None,
    csv: bool = False,
    junit: PathLike | None = None,
    progress: RunsProgress | None = None,
) -> dict[str, Any]:
    """Run a campaign, or one ``shard`` (index, count) of it: the object ``sweep`` of docs/json.md, empty for a shard.

    ``output`` is the folder of the journals and the table (docs/campaigns.md). Called again, it goes on where it stopped.
    With ``run`` it repeats a single run and returns its object. Runs that are not accepted raise `InputError`, whose
    ``result`` has the object. ``progress(done, runs)`` is called some twenty times a second; an exception in it, or Ctrl-C,
    stops the campaign, which loses the runs under way. `arcfeed.campaign` runs it on a cluster.
    """
    part = None if shard is None else "/".join(str(number) for number in shard)
    others = {**locals(), "sweep": None, "progress": None, "shard": part, "part": None}
    result = _run(["sweep", os.fspath(sweep), *_words(**others)], progress)
    return dict(result[0]) if result else {}


def _words(**options: Any) -> list[str]:
    """Options of the command line."""
    words: list[str] = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            words.append(option)
        elif isinstance(value, Mapping):
            words += [f"{option}=T{number}={_text(one)}" for number, one in value.items()]
        else:
            words.append(f"{option}={_text(value)}")
    return words


def _text(value: Any) -> str:
    return os.fspath(value) if isinstance(value, (str, os.PathLike)) else repr(value)


def _run(
    words: list[str],
    progress: Progress | RunsProgress | None = None,
    tables: dict[str, Any] | None = None,
) -> list[Any]:
    """Runs a command with ``--json``; returns the objects that it prints, and passes its warnings on. ``tables`` receives
    those of a simulated run."""
    printed, notes, failure, found = _native.run([*words, "--json"], progress, tables is not None)
    if tables is not None:
        tables.update(found)
    result = [json.loads(line) for line in printed.splitlines()]
    if failure is not None:
        kind, text = failure
        raise exception(kind, text, result=result, warnings=notes)
    for note in notes:
        if "warning: " in note:
            warnings.warn(note, ArcfeedWarning, stacklevel=3)
    return result
