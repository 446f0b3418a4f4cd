"""Constant chip load on circular moves: check, adapt and simulate NC programs; feed laws, stocks, job files, campaigns.

>>> import arcfeed
>>> found = arcfeed.check(text="%\\nG21 G90 G0 X0 Y0\\nG1 X10. F100.\\nM30\\n%\\n")
>>> found["counts"]["linear"], found["errors"]
(1, [])

All lengths and forces of results are in the units that docs/json.md and docs/traces.md name.
"""

from . import campaign
from ._commands import (
    ArcfeedWarning,
    adapt,
    check,
    init,
    law,
    lobes,
    plan,
    simulate,
    sweep,
    trace_files,
)
from ._errors import Error, InputError, MachineError, StoppedError, UndecidedError, UsageError
from ._job import Job
from ._native import Law, Stock, Table, Tool

__all__ = [
    "ArcfeedWarning",
    "Error",
    "InputError",
    "Job",
    "Law",
    "MachineError",
    "Stock",
    "StoppedError",
    "Table",
    "Tool",
    "UndecidedError",
    "UsageError",
    "adapt",
    "campaign",
    "check",
    "init",
    "law",
    "lobes",
    "plan",
    "simulate",
    "sweep",
    "trace_files",
]
