"""What the tests share: the repository, the program, the example."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[3]
SLOT = ROOT / "examples/ibr-slot/job.toml"


@pytest.fixture(scope="session")
def program() -> Callable[..., list[Any]]:
    """Runs the program `arcfeed` (the variable ARCFEED_PROGRAM) with ``--json``; returns the objects that it prints."""
    path = os.environ["ARCFEED_PROGRAM"]

    def run(*words: str) -> list[Any]:
        ended = subprocess.run([path, *words, "--json"], cwd=ROOT, capture_output=True, text=True, check=False)
        return [json.loads(line) for line in ended.stdout.splitlines()]

    return run
