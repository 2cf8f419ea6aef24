# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark of streams: what it reads off curves of bytes against distance."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests/benchmarks"))
import rate_distortion  # noqa: E402

POINTS = [(100, 1e-2), (400, 1e-3), (300, 2e-2), (1600, 1e-4), (1700, 1e-4)]


def test_the_front_is_what_nothing_beats():
    assert rate_distortion.pareto_front(POINTS).tolist() == [[100, 1e-2], [400, 1e-3], [1600, 1e-4]]


def test_bytes_are_those_of_the_front():
    assert rate_distortion.bytes_at(POINTS, 1e-3) == pytest.approx(400)
    assert rate_distortion.bytes_at(POINTS, 10**-3.5) == pytest.approx(800)
    assert rate_distortion.bytes_at(POINTS, 9e-5) is None and rate_distortion.bytes_at(POINTS, 2e-2) is None


class Corrupt(Exception):
    pass


class Streams:
    """Stands for the native module: a stream whose distance falls as its bytes grow, and whose base takes 50."""

    CorruptStream = Corrupt

    def load_hierarchy(self, path, most_bytes):
        if most_bytes < 50:
            raise Corrupt
        return Final(most_bytes)

    def compare(self, points, offsets, indices, samples):
        return {"l2": 1 / len(points)}



class Final:
    def __init__(self, size):
        self.size = size

    def final_mesh(self):
        return {"points": np.zeros((self.size, 3)), "offsets": [0], "indices": []}


def test_the_shortest_prefix_is_found(tmp_path):
    path = tmp_path / "a.hmesh"
    path.write_bytes(bytes(5000))
    prefixes = rate_distortion.Prefixes(Streams(), path, ())
    for size in (60, 700, 4900):
        found = prefixes.shortest(1 / size)
        assert size <= found <= size * (1 + rate_distortion.CLOSE) + 1
    assert prefixes.shortest(1 / 5001) is None
