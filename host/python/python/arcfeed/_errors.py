"""Exceptions: failures of commands, with the place in the file."""

from __future__ import annotations

import re
from typing import Any

_PLACE = re.compile(r"^(?P<file>.+?)(?::(?P<line>\d+):(?P<column>\d+))?: (?:error: )?(?P<message>.*)$")


class Error(Exception):
    """A command failed.

    ``str(error)`` is what the program prints on stderr: one line for each fault, as ``file:line:column: message``. The
    attributes are those of the first.
    """

    #: File that is at fault; None if the message names none.
    file: str | None
    #: Line, counted from 1; None if the message names none.
    line: int | None
    #: Column, counted from 1.
    column: int | None
    #: What was found.
    message: str
    #: What to do, as far as the message says so after a semicolon; otherwise the empty text.
    remedy: str
    #: Result of the command, if there is one in spite of the failure.
    result: Any
    #: Warnings of the command.
    warnings: list[str]

    def __init__(self, text: str, *, result: Any = None, warnings: list[str] | None = None) -> None:
        super().__init__(text)
        first = text.split("\n", 1)[0]
        place = _PLACE.match(first)
        self.file = place["file"] if place else None
        self.line = int(place["line"]) if place and place["line"] else None
        self.column = int(place["column"]) if place and place["column"] else None
        fault = place["message"] if place else first
        self.message, _, self.remedy = fault.partition("; ")
        self.result = result
        self.warnings = warnings or []


class InputError(Error):
    """The program or the job is at fault."""


class UsageError(Error, ValueError):
    """The arguments make no sense together, or a value is not allowed."""


class MachineError(Error):
    """The simulated machine stopped with an alarm."""


class UndecidedError(Error):
    """A person must decide first."""


class StoppedError(Error):
    """The command was stopped."""


_KINDS: dict[str, type[Error]] = {
    "input": InputError,
    "usage": UsageError,
    "machine": MachineError,
    "undecided": UndecidedError,
    "stopped": StoppedError,
}


def exception(kind: str, text: str, *, result: Any = None, warnings: list[str] | None = None) -> Error:
    """The exception of a failure."""
    return _KINDS[kind](text, result=result, warnings=warnings)
