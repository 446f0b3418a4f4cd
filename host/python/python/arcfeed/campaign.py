"""Campaigns on a cluster: the shards of a sweep on the workers of a Dask client (docs/campaigns.md).

Dask schedules the shards and repeats those of a lost worker; the journals in the output folder keep the runs that were over.
All workers need this package in the same version, and the same paths of sweep file, job and output folder.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._commands import PathLike, RunsProgress, sweep

if TYPE_CHECKING:
    from distributed import Client

_JOURNAL = re.compile(r"shard-\d+-of-(\d+)\.journal")
#: Shards for each thread of the workers: the last ones to end keep few of them waiting.
_SHARDS_PER_THREAD = 4


def run(
    campaign: PathLike,
    client: Client,
    output: PathLike | None = None,
    *,
    shards: int | None = None,
    retries: int = 3,
    csv: bool = False,
    junit: PathLike | None = None,
    progress: RunsProgress | None = None,
) -> dict[str, Any]:
    """Run a campaign on the workers of a Dask client; returns and raises what `arcfeed.sweep` does on one computer, with the
    same rows to the bit.

    Each shard is a task of one thread. Without ``shards`` there are four for each thread of the workers, or as many as the
    journals in the folder already have, so that a campaign goes on where it stopped. A worker that is lost costs the runs
    that it had under way; a shard that fails for another reason is repeated ``retries`` times, and the other shards go on
    before its exception is raised. ``progress(done, shards)`` is called at the end of each shard.
    """
    from distributed import as_completed

    path = Path(campaign).resolve()
    folder = path.with_suffix(".out") if output is None else Path(output).resolve()
    count = shards or _shards_of(folder) or _SHARDS_PER_THREAD * max(1, sum(client.nthreads().values()))
    # A single shard would be the whole campaign, with its table.
    count = max(2, count)
    tasks = client.map(_shard, range(1, count + 1), count=count, path=path, folder=folder, pure=False, retries=retries)
    failed: list[BaseException] = []
    for done, task in enumerate(as_completed(tasks), 1):
        if task.status != "finished":
            failed.append(task.exception())
        if progress is not None:
            progress(done, count)
    if failed:
        raise failed[0]
    return sweep(path, folder, merge=True, csv=csv, junit=junit)


def _shard(index: int, *, count: int, path: Path, folder: Path) -> None:
    """Runs a shard on a worker."""
    sweep(path, folder, shard=(index, count), threads=1)


def _shards_of(folder: Path) -> int | None:
    """Number of shards of the journals in a folder, if all have the same."""
    names = folder.iterdir() if folder.is_dir() else ()
    counts = {int(found[1]) for found in map(_JOURNAL.fullmatch, (name.name for name in names)) if found}
    return counts.pop() if len(counts) == 1 else None
