"""Time of `Law` for a million positions, beside the thesis's equations in NumPy: prints the figures of docs/python.md."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import arcfeed
import numpy as np
from thesis import step_per_tooth

POSITIONS = 1_000_000
REPEATS = 7


def least_ns(work: Callable[[], object]) -> float:
    """Least processor time of a position over some repeats, ns."""
    times = []
    for _ in range(REPEATS):
        begun = time.process_time_ns()
        work()
        times.append((time.process_time_ns() - begun) / POSITIONS)
    return min(times)


def main() -> None:
    """The published tool on the first movement of the published table."""
    rho, r0, chip, normal_deg, offset = 4.43706 * 25.4, 5.06205 * 25.4, 0.004 * 25.4, 54.187, 90.0
    law = arcfeed.Law.circumference(
        path_radius=rho, edge_radius=r0, feed_per_tooth=chip, normal_deg=normal_deg, offset=offset,
        start_deg=-40.0, sweep_deg=120.0,
    )  # fmt: skip
    part = np.linspace(0.0, 1.0, POSITIONS)
    angle = np.radians(-40.0 + 120.0 * part)
    line = (math.radians(normal_deg), offset)
    found, (expected, _) = law.feed_per_tooth(part), step_per_tooth(angle, 1, (rho, r0), 1, chip, line)
    both = np.isfinite(found) & np.isfinite(expected)
    error = np.abs(found[both] / expected[both] - 1.0)
    print(f"{both.mean():.1%} of the positions have a demand; median {np.median(error):.1e}, largest {error.max():.1e} apart")
    print(f"Law {least_ns(lambda: law.feed_per_tooth(part)):.0f} ns a position")
    print(f"NumPy {least_ns(lambda: step_per_tooth(angle, 1, (rho, r0), 1, chip, line)):.0f} ns a position")


if __name__ == "__main__":
    main()
