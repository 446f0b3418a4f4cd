"""`Stock` against closed forms."""

from __future__ import annotations

import math
from pathlib import Path

import arcfeed
import numpy as np
import pytest


def block(step: float = 0.25) -> arcfeed.Stock:
    return arcfeed.Stock.block([0.0, 0.0, 0.0], [40.0, 30.0, 10.0], step=step)


def test_a_slot_has_the_volume_of_a_stadium() -> None:
    stock = block()
    before = stock.volume
    tool = arcfeed.Tool.end_mill(radius=4.0, height=20.0)
    removed = stock.cut(tool, np.array([[10.0, 15.0, 6.0], [30.0, 15.0, 6.0]]))
    expected = (20.0 * 8.0 + math.pi * 16.0) * 4.0
    assert before == pytest.approx(12_000.0, rel=1e-12)
    assert removed == pytest.approx(expected, rel=2e-3) and before - stock.volume == pytest.approx(removed, rel=1e-9)
    assert max(stock.volume_by_axis) - min(stock.volume_by_axis) < 0.01 * expected


def test_a_ring_cuts_a_groove() -> None:
    stock = block(0.2)
    tool = arcfeed.Tool.cup_mill(outer_radius=12.0, inner_radius=9.0, height=20.0)
    point = [20.0, 15.0, 7.0]
    removed = stock.cut(tool, np.array([point, point]))
    assert removed == pytest.approx(math.pi * (144.0 - 81.0) * 3.0, rel=5e-3)
    assert tool.volume == pytest.approx(math.pi * (144.0 - 81.0) * 20.0, rel=1e-9)


def test_a_circular_pocket_is_cut_by_an_arc() -> None:
    stock = block(0.2)
    tool = arcfeed.Tool.end_mill(radius=3.0, height=20.0)
    removed = stock.cut_arc(tool, [25.0, 15.0, 8.0], [20.0, 15.0], -360.0)
    assert removed == pytest.approx(math.pi * (64.0 - 4.0) * 2.0, rel=5e-3)


def test_heights_have_rows_along_y_and_columns_along_x() -> None:
    stock = block()
    stock.cut(arcfeed.Tool.end_mill(radius=2.0, height=20.0), np.array([[-5.0, 5.0, 6.0], [45.0, 5.0, 6.0]]))
    heights, x, y = stock.heights(), stock.centers(0), stock.centers(1)
    assert heights.shape == (len(y), len(x)) == (120, 160) and heights.dtype == np.float64
    in_slot = np.abs(y - 5.0) < 2.0
    assert np.array_equal(np.unique(heights[in_slot]), [6.0]) and np.array_equal(np.unique(heights[~in_slot]), [10.0])
    through = arcfeed.Tool.end_mill(radius=2.0, height=20.0)
    stock.cut(through, np.array([[-5.0, 5.0, -1.0], [45.0, 5.0, -1.0]]))
    assert np.isnan(stock.heights()[in_slot]).all()


def test_a_ball_leaves_scallops_of_the_published_height() -> None:
    stock = arcfeed.Stock.block([0.0, 0.0, 0.0], [1.0, 8.0, 4.0], step=0.05)
    radius, stepover = 3.0, 1.0
    ball = arcfeed.Tool.end_mill(radius=radius, height=20.0, corner=radius)
    for y in np.arange(-3.0, 11.5, stepover):
        stock.cut(ball, np.array([[-5.0, y, 1.0], [6.0, y, 1.0]]))
    height = stock.heights()[:, 10].max() - 1.0
    # The rays stand a fortieth of a millimetre beside the crests.
    assert height == pytest.approx(radius - math.sqrt(radius**2 - (stepover / 2) ** 2), abs=0.006)


def test_surfaces_go_to_stl_and_back(tmp_path: Path) -> None:
    stock = arcfeed.Stock.cylinder([0.0, 0.0, 0.0], radius=10.0, height=5.0, step=0.25)
    assert stock.volume == pytest.approx(math.pi * 500.0, rel=2e-3)
    path = tmp_path / "stock.stl"
    stock.write(path)
    assert arcfeed.Stock.stl(path, step=0.25).volume == pytest.approx(stock.volume, rel=1e-2)
    with pytest.raises(arcfeed.UsageError, match="stl"):
        stock.write(tmp_path / "stock.obj")


def test_a_copy_is_another_stock() -> None:
    stock = block()
    other = stock.copy()
    other.cut(arcfeed.Tool.end_mill(radius=4.0, height=20.0), np.array([[0.0, 0.0, 0.0], [40.0, 0.0, 0.0]]))
    assert other.volume < stock.volume == block().volume


@pytest.mark.parametrize("path", [np.zeros((1, 3)), np.zeros((4, 2)), np.full((2, 3), np.nan)])
def test_paths_that_are_none_are_refused(path: np.ndarray) -> None:
    with pytest.raises(ValueError, match="path"):
        block().cut(arcfeed.Tool.end_mill(radius=4.0, height=20.0), path)


def test_memory_and_measures_are_bounded() -> None:
    with pytest.raises(ValueError, match="bytes"):
        arcfeed.Stock.block([0.0] * 3, [100.0] * 3, step=0.01, memory_max_bytes=1 << 20)
    with pytest.raises(ValueError):
        arcfeed.Tool.end_mill(radius=-1.0, height=2.0)
    with pytest.raises(ValueError, match="axis"):
        block().heights(3)
