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
    ``asserts`` are limits such as ``"chip<=1.05"``, of which a broken one raises `InputError`. ``progress(blocks,
    time_s)`` is called some twenty times a second with the blocks executed and the machine time; an exception in it, or
    Ctrl-C, stops the run, and no file is written.
    """
    box = None if stock is None else ",".join(str(value) for value in stock)
    others = {**locals(), "job": None, "progress": None, "asserts": None, "box": None, "stock": box}
    words = ["simulate", os.fspath(job), *_words(**others)]
    words += [f"--assert={limit}" for limit in asserts]
    (result,) = _run(words, progress)
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


def _run(words: list[str], progress: Progress | None = None) -> list[Any]:
    """Runs a command with ``--json``; returns the objects that it prints, and passes its warnings on."""
    printed, notes, failure = _native.run([*words, "--json"], progress)
    result = [json.loads(line) for line in printed.splitlines()]
    if failure is not None:
        kind, text = failure
        raise exception(kind, text, result=result, warnings=notes)
    for note in notes:
        if "warning: " in note:
            warnings.warn(note, ArcfeedWarning, stacklevel=3)
    return result
