"""Campaigns, lobes and laws: the figures of the program, and the same rows on a cluster although a worker is killed."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import threading
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import arcfeed
import kubernetes_validate
import pytest
import yaml
from conftest import ROOT, SLOT
from distributed import Client, LocalCluster

Program = Callable[..., list[Any]]

RUNS = 240
POCKET = ROOT / "examples/pocket/job-contour.toml"
MANIFEST = re.search(r"^```yaml\n(.*?)^```", (ROOT / "docs/campaigns.md").read_text("utf-8"), re.MULTILINE | re.DOTALL)


def write_sweep(folder: Path, runs: int = RUNS) -> Path:
    """Bit errors on the line to the control, and drawn feeds: some runs end in alarms."""
    path = folder / "SWEEP.toml"
    path.write_text(
        f"""
        job = "{POCKET}"
        command = "stream"
        port = "fault://tx.flip={{flip}},seed={{seed}}/sim:"
        accept = ["passed", "stopped"]
        figures = ["cycle_time_s", "alarms", "link.bytes", "chip_load.error_ratio_max"]
        [grid]
        dnc.code = ["iso"]
        flip = [0.0, 0.0005]
        seed = {{ from = 1, to = {runs // 4} }}
        [random]
        runs = 2
        law.feed_per_tooth = {{ from = 0.08, to = 0.1 }}
        """,
        encoding="utf-8",
    )
    return path


def table(folder: Path) -> bytes:
    return (folder / "runs/part-00001.parquet").read_bytes()


def runs_made(folder: Path) -> Counter[str]:
    """How often each run is in the journals."""
    lines = [line for path in folder.glob("*.journal") for line in path.read_text("utf-8").splitlines()[1:]]
    return Counter(line.split(":")[1].split(",")[0] for line in lines)


def test_law_has_the_case_of_the_program(program: Program, tmp_path: Path) -> None:
    case = arcfeed.law(rho=112.7, radius=128.6, edge="outer", feed_per_tooth=0.1, contact=90.0, spindle=200, teeth=10)
    words = "--rho=112.7 --radius=128.6 --edge=outer --feed-per-tooth=0.1 --contact=90 --spindle=200 --teeth=10"
    assert [case] == program("law", *words.split())
    drawing = tmp_path / "law.svg"
    line = next(block["line"] for block in arcfeed.adapt(SLOT) if block["reason"] == "law")
    case = arcfeed.law(SLOT, line=line, at=0.5, svg=drawing)
    assert [case] == program("law", f"--job={SLOT}", f"--line={line}", "--at=0.5") and drawing.exists()
    with pytest.raises(arcfeed.UsageError):
        arcfeed.law(rho=1)


def test_lobes_has_the_diagram_of_the_program(program: Program, tmp_path: Path) -> None:
    job = tmp_path / "job.toml"
    job.write_text(
        """
        units = "mm"
        program = "p.nc"
        tool = { kind = "end-mill", diameter = 10, teeth = 2, height = 100 }
        spindle = { rev_per_min = 5000 }
        law = { kind = "engagement", feed_per_tooth = 0.05 }
        limits = { max_feed = 5000 }
        workpiece = { step = 1, block = { from = [0, 0, -20], to = [20, 20, 0] } }
        [cutting]
        cutting = [600, 200, 0]
        edge = [20, 10, 0]
        axial_depth = 0.5
        modes = [{ frequency = 900, damping = 0.02, stiffness = 15_000, direction = [1, 0, 0] }]
        """,
        encoding="utf-8",
    )
    diagram = arcfeed.lobes(job, speeds=(5000.0, 9000.0), points=10, radial_depth="3mm")
    assert [diagram] == program("lobes", str(job), "--speeds=5000,9000", "--points=10", "--radial-depth=3mm")
    assert len(diagram["points"]) == 10 and diagram["best"]


def test_sweep_has_the_table_of_the_program_in_shards_too(program: Program, tmp_path: Path) -> None:
    campaign, seen = write_sweep(tmp_path, 24), list[tuple[int, int]]()
    whole = arcfeed.sweep(campaign, tmp_path / "whole", progress=lambda done, runs: seen.append((done, runs)))
    (expected,) = program("sweep", str(campaign), "-o", str(tmp_path / "expected"))
    assert whole["ends"] == expected["ends"] and whole["runs"] == 24
    assert seen == sorted(seen) and all(runs == 24 for _, runs in seen)
    for index in (2, 1):
        assert arcfeed.sweep(campaign, tmp_path / "shards", shard=(index, 2), threads=1) == {}
    arcfeed.sweep(campaign, tmp_path / "shards", merge=True)
    assert table(tmp_path / "whole") == table(tmp_path / "shards")
    assert table(tmp_path / "whole") == table(tmp_path / "expected")
    (one,) = program("sweep", str(campaign), "--run=1")
    again = arcfeed.sweep(campaign, run=1)
    assert again.pop("real_time_factor") > 0 and one.pop("real_time_factor") > 0 and again == one


def test_an_exception_in_progress_stops_a_campaign_that_then_goes_on(tmp_path: Path) -> None:
    class Enough(Exception):
        pass

    def stop(done: int, runs: int) -> None:
        raise Enough

    before = signal.getsignal(signal.SIGINT)
    campaign = write_sweep(tmp_path)
    with pytest.raises(Enough):
        arcfeed.sweep(campaign, tmp_path / "out", threads=1, progress=stop)
    # The runs under way end beside the caller, who may have to wait for their journal.
    deadline = time.monotonic() + 60
    while True:
        try:
            assert arcfeed.sweep(campaign, tmp_path / "out")["runs"] == RUNS
            break
        except arcfeed.InputError as error:
            assert "another process" in str(error) and time.monotonic() < deadline
    made = runs_made(tmp_path / "out")
    assert len(made) == RUNS and set(made.values()) == {1}
    assert signal.getsignal(signal.SIGINT) is before


def test_a_run_that_is_not_accepted_raises_with_the_command_that_repeats_it(tmp_path: Path) -> None:
    campaign = tmp_path / "SWEEP.toml"
    campaign.write_text(f'job = "{POCKET}"\nassert = ["time<=14.5s"]\n[grid]\nlaw.feed_per_tooth = [0.1, 0.08]\n')
    with pytest.raises(arcfeed.InputError, match="arcfeed simulate .* --set law.feed_per_tooth=0.08") as raised:
        arcfeed.sweep(campaign)
    assert raised.value.result[0]["unaccepted"] == 1


def test_a_dask_cluster_has_the_rows_of_one_computer_although_a_worker_is_killed(tmp_path: Path) -> None:
    campaign, folder = write_sweep(tmp_path), tmp_path / "out"
    arcfeed.sweep(campaign, tmp_path / "whole")
    found: list[dict[str, Any]] = []
    killed_after = 0
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        worker = min(client.run(os.getpid).values())
        caller = threading.Thread(target=lambda: found.append(arcfeed.campaign.run(campaign, client, folder)))
        caller.start()
        deadline = time.monotonic() + 120
        while killed_after < RUNS // 8 and time.monotonic() < deadline:
            killed_after = sum(runs_made(folder).values()) if folder.exists() else 0
            time.sleep(0.005)
        os.kill(worker, signal.SIGKILL)
        caller.join()
    made = runs_made(folder)
    assert len(list(folder.glob("*.journal"))) == 8
    print(f"a worker killed after {killed_after} runs: {sum(made.values())} runs made for {RUNS} rows")
    assert killed_after < RUNS and len(made) == RUNS and set(made.values()) == {1}
    assert table(folder) == table(tmp_path / "whole")
    assert found[0]["runs"] == RUNS


def test_a_shard_that_fails_does_not_stop_the_others(tmp_path: Path) -> None:
    campaign, folder = write_sweep(tmp_path, 24), tmp_path / "out"
    folder.mkdir()
    (folder / "shard-1-of-3.journal").write_text("not a journal of this campaign, but one with a line\n")
    with (
        LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        with pytest.raises(arcfeed.InputError, match="another campaign"):
            arcfeed.campaign.run(campaign, client, folder, retries=0)
        assert len(runs_made(folder)) >= 16
        (folder / "shard-1-of-3.journal").unlink()
        assert arcfeed.campaign.run(campaign, client, folder)["runs"] == 24
    assert sorted(path.name for path in folder.glob("*.journal")) == [f"shard-{index}-of-3.journal" for index in (1, 2, 3)]


def test_the_manifest_for_kubernetes_has_the_schema_of_its_api_and_runs_every_shard(
    program: Program, tmp_path: Path
) -> None:
    assert MANIFEST is not None
    manifest = yaml.safe_load(MANIFEST[1])
    # The first version in which backoffLimitPerIndex is on by default, and the newest one.
    for version in ("1.29", kubernetes_validate.latest_version()):
        kubernetes_validate.validate(manifest, version, strict=True)
    wrong = yaml.safe_load(MANIFEST[1].replace("completionMode", "completionsMode"))
    with pytest.raises(kubernetes_validate.ValidationError, match="completionsMode"):
        kubernetes_validate.validate(wrong, "1.29", strict=True)
    campaign = write_sweep(tmp_path, 24)
    (container,) = manifest["spec"]["template"]["spec"]["containers"]
    assert manifest["spec"]["completions"] == 4
    script = container["args"][0].replace("/campaign/", f"{tmp_path}/")
    path = f"{Path(os.environ['ARCFEED_PROGRAM']).parent}:{os.environ['PATH']}"
    for index in range(4):
        variables = {**os.environ, "JOB_COMPLETION_INDEX": str(index), "PATH": path}
        subprocess.run([*container["command"], script], env=variables, check=True)
    (merged,) = program("sweep", str(campaign), "-o", str(tmp_path / "out"), "--merge")
    assert merged["runs"] == 24
