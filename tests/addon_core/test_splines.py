# SPDX-License-Identifier: GPL-3.0-or-later
import numpy
import pytest
from hybrid_mesh.bridge import splines

POINTS = numpy.random.default_rng(1).normal(size=(6, 3))


@pytest.mark.parametrize("cyclic", [False, True])
@pytest.mark.parametrize("resolution", [1, 2, 7])
def test_splines_pass_through_their_points(cyclic, resolution):
    for line in (splines.catmull_rom(POINTS, cyclic, resolution), splines.bezier(POINTS, POINTS - 0.1, POINTS + 0.1, cyclic, resolution)):
        numpy.testing.assert_allclose(line[::resolution][:6], POINTS, atol=1e-12)
        assert len(line) == (6 if cyclic else 5) * resolution + 1
        assert numpy.array_equal(line[-1], POINTS[0 if cyclic else -1])


def test_a_catmull_rom_spline_reproduces_quadratics():
    x = numpy.arange(8.0)
    line = splines.catmull_rom(numpy.stack([x, x**2, 1 - 3 * x**2], axis=1), False, 5)
    inner = line[(line[:, 0] >= 1) & (line[:, 0] <= 6)]
    numpy.testing.assert_allclose(inner[:, 1], inner[:, 0] ** 2, atol=1e-12)
    numpy.testing.assert_allclose(inner[:, 2], 1 - 3 * inner[:, 0] ** 2, atol=1e-12)


def test_a_bezier_spline_makes_a_quarter_circle():
    k = 4 / 3 * (2**0.5 - 1)
    ends = numpy.array([[1, 0, 0], [0, 1, 0]], float)
    line = splines.bezier(ends, ends + [[0, -k, 0], [k, 0, 0]], ends + [[0, k, 0], [-k, 0, 0]], False, 50)
    assert abs(numpy.linalg.norm(line, axis=1) - 1).max() < 3e-4


def test_where_a_cyclic_spline_begins_does_not_matter():
    once, turned = splines.catmull_rom(POINTS, True, 4), splines.catmull_rom(numpy.roll(POINTS, 2, axis=0), True, 4)
    numpy.testing.assert_allclose(numpy.roll(once[:-1], 8, axis=0), turned[:-1], atol=1e-12)


@pytest.mark.parametrize("count", [0, 1, 2])
@pytest.mark.parametrize("cyclic", [False, True])
def test_splines_of_few_points(count, cyclic):
    few = POINTS[:count]
    for line in (splines.closed(few, cyclic), splines.catmull_rom(few, cyclic, 3), splines.bezier(few, few, few, cyclic, 3)):
        assert line.shape[1:] == (3,) and len(line) >= count and numpy.isfinite(line).all()
        if count:
            assert numpy.array_equal(line[0], few[0])
