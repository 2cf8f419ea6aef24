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


def test_the_mirror_plane_of_an_axis_is_that_of_the_objects_space():
    assert arrays.mirror_plane(numpy.eye(4), 1) == (0, 1, 0, 0)
    matrix = numpy.eye(4)
    turn = numpy.linalg.qr(numpy.random.default_rng(1).random((3, 3)))[0]
    matrix[:3, :3], matrix[:3, 3] = turn * [2, -0.5, 3], (1, 2, 3)
    points = numpy.random.default_rng(2).random((5, 3))
    for axis in range(3):
        *normal, offset = arrays.mirror_plane(matrix, axis)
        heights = arrays.transformed(points, matrix) @ normal - offset
        assert numpy.allclose(arrays.transformed(points, matrix) - 2 * heights[:, None] * normal, arrays.transformed(points * numpy.where(numpy.arange(3) == axis, -1, 1), matrix))
    matrix[0, 1] += 1
    with pytest.raises(arrays.MatrixError, match="sheared"):
        arrays.mirror_plane(matrix, 0)


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


def test_faces_are_found_by_their_places():
    points = numpy.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    faces = numpy.array([[0, 1, 2], [2, 1, 3]])
    assert arrays.matching_faces(points, faces, points, faces).tolist() == [0, 1]
    # Points in another order and one of them twice, a face turned round, one that is not there.
    other = numpy.array([[1.0, 1, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [9, 9, 9]])
    assert arrays.matching_faces(other, numpy.array([[0, 2, 3], [0, 1, 4]]), points, faces).tolist() == [1, -1]


def test_parts_hang_together():
    # A strip of triangles, cut after the third, in any order.
    for count in (6, 3000):
        order = numpy.random.default_rng(3).permutation(count)
        place = numpy.empty(count, dtype=int)
        place[order] = numpy.arange(count)
        before, after = order - 1, order + 1
        before[order == 3], after[order == 2], after[order == count - 1] = -1, -1, -1
        sides = [numpy.where(one >= 0, place[one], -1) for one in (before, after)]
        parts = arrays.connected(numpy.stack([*sides, numpy.full(count, -1)], axis=1))
        assert len(set(parts[order < 3])) == len(set(parts[order >= 3])) == 1 and len(set(parts)) == 2
    assert len(arrays.connected(numpy.zeros((0, 3), dtype=int))) == 0


def test_turned_faces_have_the_same_edges():
    offsets = numpy.array([0, 4, 7, 12])
    indices = numpy.array([0, 1, 2, 3, 2, 1, 4, 5, 6, 7, 8, 9])

    def edges(corners):
        return [{face[i], face[(i + 1) % len(face)]} for face in numpy.split(corners, offsets[1:-1]) for i in range(len(face))]

    order = arrays.reversed_edges(offsets)
    assert edges(indices[arrays.reversed_corners(offsets)]) == [edges(indices)[edge] for edge in order]
    assert sorted(order.tolist()) == list(range(12))


def test_majority():
    assert arrays.majority(numpy.array([[1, 2, 2, 3], [5, 5, 1, 1], [4, 4, 4, 4]])).tolist() == [1, 0, 0]


def test_neighbours_and_walking():
    size = 12
    points = numpy.array([[x, y, 0.0] for y in range(size) for x in range(size)])
    corner = numpy.array([x + size * y for y in range(size - 1) for x in range(size - 1)])
    triangles = numpy.concatenate([numpy.stack([corner, corner + 1, corner + size], 1), numpy.stack([corner + 1, corner + size + 1, corner + size], 1)])
    neighbours = arrays.triangle_neighbours(triangles)
    for triangle, across in enumerate(neighbours):
        for corner, other in enumerate(across):
            if other >= 0:
                assert triangle in neighbours[other]
                assert len(set(triangles[triangle]) & set(triangles[other])) == 2 and triangles[triangle][corner] not in triangles[other]
    assert (neighbours < 0).sum() == 4 * (size - 1)
    random = numpy.random.default_rng(5)
    places = numpy.concatenate([random.random((50, 2)) * (size - 1), random.random((50, 1))], axis=1)
    found = arrays.walk(places, random.integers(len(triangles), size=50), points, triangles, neighbours, 100)
    weights = arrays.closest_weights(places, points[triangles[found]], inside=False)
    assert weights.min() > -1e-6
    # An edge of three triangles is a place to stop.
    assert (arrays.triangle_neighbours(numpy.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]])) == -1).all()
