# SPDX-License-Identifier: GPL-3.0-or-later
import numpy
import pytest
from hybrid_mesh.bridge import arrays, names
from hybrid_mesh.core.colors import stretch_colors


def test_turning_faces_over_twice_is_nothing_and_keeps_each_face_its_corners():
    offsets = numpy.array([0, 3, 7, 12])
    order = arrays.reversed_corners(offsets)
    assert (order[order] == numpy.arange(12)).all()
    assert order[:3].tolist() == [2, 1, 0] and order[3:7].tolist() == [6, 5, 4, 3]


@pytest.mark.parametrize("flat", [numpy.zeros((4, 4)), numpy.diag([1.0, 0, 1, 1]), numpy.diag([1.0, numpy.nan, 1, 1])])
def test_transforms_that_flatten_are_refused(flat):
    with pytest.raises(arrays.MatrixError):
        arrays.world_matrix(flat)


def test_tiny_and_huge_scales_are_not_flat():
    for scale in (1e-6, 1e6):
        matrix = arrays.world_matrix(numpy.diag([scale, -scale, scale, 1]))
        assert arrays.mirrors(matrix)
        points = numpy.random.default_rng(1).random((5, 3))
        back = arrays.transformed(arrays.transformed(points, matrix), numpy.linalg.inv(matrix))
        assert numpy.allclose(points, back, rtol=1e-12)


def test_closest_weights_find_a_point_again():
    random = numpy.random.default_rng(2)
    triangles, weights = random.random((20, 3, 3)), random.dirichlet((1, 1, 1), 20)
    points = numpy.einsum("ij,ijk->ik", weights, triangles)
    assert numpy.allclose(arrays.closest_weights(points, triangles), weights, atol=1e-9)
    degenerate = arrays.closest_weights(points[:1], numpy.zeros((1, 3, 3)))
    assert numpy.isfinite(degenerate).all() and numpy.isclose(degenerate.sum(), 1)


@pytest.mark.parametrize("name", ["a", "x" * 100, "猫" * 40])
def test_suffixes_are_never_cut_off(name):
    made = names.with_suffix(name, ".preview")
    assert made.endswith(".preview") and len(made.encode()) <= names.LIMIT - names.NUMBER
    assert made.startswith(name[:10])


def test_stretch_colours_are_finite_whatever_the_stretch():
    colors = stretch_colors(numpy.array([0, -1, numpy.nan, numpy.inf, 1e-30, 1, 1e30]))
    assert numpy.isfinite(colors).all() and colors.min() >= 0 and colors.max() <= 1
    even = stretch_colors([1.0])[0, :3]
    assert even.max() - even.min() < 0.05
    assert stretch_colors([4.0])[0, 0] > stretch_colors([4.0])[0, 2] and stretch_colors([0.25])[0, 2] > stretch_colors([0.25])[0, 0]
