"""Runs a second of a campaign on 1 and 2 workers of a Dask cluster of processes, and on this computer without Dask.

    python host/python/tests/bench_campaign.py [RUNS]
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import arcfeed
from distributed import Client, LocalCluster
from test_campaign import write_sweep

#: Measurements of each; the shortest counts.
REPEATS = 3


def seconds(workers: int, campaign: Path, folder: Path) -> float:
    """Time of a campaign with a worker of one thread on each of some processes; 0 is without Dask, on one thread."""
    if workers == 0:
        started = time.perf_counter()
        arcfeed.sweep(campaign, folder, threads=1)
        return time.perf_counter() - started
    with (
        LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        client.run(lambda: arcfeed.__name__)
        started = time.perf_counter()
        arcfeed.campaign.run(campaign, client, folder, shards=8)
        return time.perf_counter() - started


def main() -> None:
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    shortest = dict.fromkeys((0, 1, 2), float("inf"))
    with tempfile.TemporaryDirectory(prefix="arcfeed-") as scratch:
        campaign = write_sweep(Path(scratch), runs)
        for repeat in range(REPEATS):
            for workers in shortest:
                took = seconds(workers, campaign, Path(scratch, f"{workers}-{repeat}"))
                shortest[workers] = min(shortest[workers], took)
    for workers, took in shortest.items():
        print(f"{workers or 'no'} workers: {runs / took:.1f} runs a second, {took:.2f} s for {runs} runs")
    print(f"1 -> 2 workers: {shortest[1] / shortest[2]:.2f} times as fast")


if __name__ == "__main__":
    main()
