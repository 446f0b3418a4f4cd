"""A command leaves the interpreter free, and Ctrl-C stops it."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import arcfeed
import pytest
from conftest import ROOT, SLOT

INTERRUPTED = """
import arcfeed, sys
print("begun", flush=True)
try:
    while True:
        {call}
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.parametrize(
    "call",
    [
        f"arcfeed.simulate({str(SLOT.with_name('job-cutting.toml'))!r}, trace=sys.argv[1] + '/run.parquet')",
        f"arcfeed.plan('cup-mill', {str(ROOT / 'examples/blisk-19/PART.toml')!r}, sys.argv[1])",
    ],
    ids=["simulate", "plan"],
)
def test_ctrl_c_is_a_keyboard_interrupt_and_leaves_no_file(call: str, tmp_path: Path) -> None:
    script = [sys.executable, "-c", INTERRUPTED.format(call=call), str(tmp_path)]
    with subprocess.Popen(script, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None and child.stdout.readline() == "begun\n"
        time.sleep(0.7)
        child.send_signal(signal.SIGINT)
        sent = time.monotonic()
        assert child.stdout.readline() == "interrupted\n"
        took_s = time.monotonic() - sent
        assert child.wait(timeout=60) == 0
    print(f"{took_s:.2f} s")
    assert took_s < 5.0 and list(tmp_path.iterdir()) == []


def test_an_exception_of_the_progress_stops_the_run(tmp_path: Path) -> None:
    def enough(blocks: int, time_s: float) -> None:
        raise LookupError(f"{blocks} blocks")

    with pytest.raises(LookupError, match="blocks"):
        arcfeed.simulate(SLOT, trace=tmp_path / "run.parquet", progress=enough)
    assert list(tmp_path.iterdir()) == []


def test_other_threads_run_beside_a_command() -> None:
    results: list[object] = []
    thread = threading.Thread(target=lambda: results.append(arcfeed.simulate(SLOT)))
    thread.start()
    turns = 0
    while thread.is_alive():
        turns += 1
    assert turns > 1_000 and len(results) == 1
