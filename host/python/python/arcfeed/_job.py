"""Job files as objects."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from ._commands import PathLike
from ._native import JobText


class Job:
    """A job file whose values can be read and changed; its comments and its order stay (docs/job.md).

    Keys have dots: ``job["tool.outer_radius"]``, ``job["cut.0.n"]`` for the first cut rule.

    >>> job = Job.parse('units = "mm"  # of lengths\\nprogram = "a.nc"\\n')
    >>> job["units"]
    'mm'
    >>> job["units"] = "inch"
    >>> job.text.splitlines()[0]
    'units = "inch"  # of lengths'
    """

    def __init__(self, path: PathLike) -> None:
        """Read a file."""
        self._text = JobText(os.fspath(path), Path(path).read_text(encoding="utf-8"))

    @classmethod
    def parse(cls, text: str, path: PathLike = "job.toml") -> Job:
        """Job of this text. ``path`` is where `write` writes it; names of files in it count from its folder."""
        job = cls.__new__(cls)
        job._text = JobText(os.fspath(path), text)
        return job

    @property
    def path(self) -> Path:
        """Path of the file."""
        return Path(self._text.path)

    @property
    def text(self) -> str:
        """Text of the file."""
        return self._text.text

    def __getitem__(self, key: str) -> Any:
        return self._text.get(key)

    def __setitem__(self, key: str, value: Any) -> None:
        self._text.set(key, value)

    def __delitem__(self, key: str) -> None:
        self._text.remove(key)

    def __contains__(self, key: str) -> bool:
        try:
            self._text.get(key)
        except KeyError:
            return False
        return True

    def __repr__(self) -> str:
        return f"Job({str(self.path)!r})"

    def check(self) -> None:
        """Raise `InputError`, with line and column, if the job is invalid or its program is missing."""
        self._text.check()

    def write(self, path: PathLike | None = None) -> Path:
        """Write the job if it is valid, completely or not at all, and return where.

        Names of files in it count from its folder: into another folder only a job goes whose program is found from there.
        """
        self._text.write(None if path is None else os.fspath(path))
        return self.path
