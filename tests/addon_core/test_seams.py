# SPDX-License-Identifier: GPL-3.0-or-later
import numpy
import pytest
from hybrid_mesh.bridge import arrays, seams

AROUND, ALONG = 24, 6


def cylinder(around, along, turn=0.0):
    """Points (around * (along + 1), 3) and quads of a cylinder of height 1, without caps."""
    angle = 2 * numpy.pi * (numpy.arange(around) + turn) / around
    ring = numpy.stack([numpy.cos(angle), numpy.sin(angle), 0 * angle], 1)
    points = numpy.concatenate([ring + (0, 0, height) for height in numpy.linspace(0, 1, along + 1)])
    first = numpy.array([[i + around * j, (i + 1) % around + around * j, (i + 1) % around + around * (j + 1), i + around * (j + 1)] for j in range(along) for i in range(around)])
    return points, first


def unrolled(points, middles):
    """(angle / 2 pi, height) of corners, each on the same turn as the middle of its face."""
    turns = numpy.arctan2(points[..., 1], points[..., 0]) / (2 * numpy.pi)
    middle = numpy.arctan2(middles[..., 1], middles[..., 0])[:, None] / (2 * numpy.pi)
    return numpy.stack([middle + (turns - middle + 0.5) % 1 - 0.5, points[..., 2]], axis=-1)


def source(change):
    points, quads = cylinder(AROUND, ALONG)
    triangles = numpy.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    values = change(unrolled(points[triangles], points[triangles].mean(1)))
    return seams.SeamedMap(points, triangles, values, arrays.triangle_neighbours(triangles))


def mapped(uv_map, around, along, turn):
    """A coarser cylinder with the map: (points of corners, values, whether pulled back), a row a face."""
    points, quads = cylinder(around, along, turn)
    middles = uv_map.points[uv_map.triangles].mean(1)

    def nearest(places):
        return numpy.linalg.norm(middles - numpy.asarray(places)[:, None], axis=2).argmin(1)

    triangle = nearest(points)
    triangle = arrays.walk(points, triangle, uv_map.points, uv_map.triangles, uv_map.neighbours)
    weights = arrays.closest_weights(points, uv_map.points[uv_map.triangles[triangle]])
    offsets = numpy.arange(0, 4 * len(quads) + 1, 4)
    made, pulled = uv_map.from_places(points, triangle, weights, offsets, quads.ravel(), nearest)
    return points[quads], made.reshape(-1, 4, 2), pulled


@pytest.mark.parametrize("turn", [0.0, 0.1, 0.37, 0.5])
def test_a_map_that_repeats_goes_on_beyond_its_seam(turn):
    points, made, pulled = mapped(source(lambda uv: uv), 12, 4, turn)
    assert not pulled.any()
    expected = unrolled(points, points.mean(1))
    off = (made - expected)[..., 0]
    assert numpy.abs(off - numpy.round(off[:, :1])).max() < 0.01  # whole turns, the same ones at all corners of a face
    assert numpy.abs(made - expected)[..., 1].max() < 0.01


@pytest.mark.parametrize("turn", [0.1, 0.37])
def test_elsewhere_faces_end_at_the_seam(turn):
    # On half of the map, so that another turn is no whole number off.
    points, made, pulled = mapped(source(lambda uv: uv * (0.5, 1)), 12, 4, turn)
    expected = unrolled(points, points.mean(1)) * (0.5, 1)
    across = (numpy.abs(expected[..., 0]) > 0.25).any(1)
    assert across.sum() == 4 and (pulled == across).all()
    assert numpy.abs(made[..., 0]).max() <= 0.25 + 1e-9
    assert numpy.abs(made - numpy.clip(expected, -0.25, [0.25, 1])).max() < 0.01


def test_two_islands():
    # The upper half of the cylinder is elsewhere in the map; the middle ring of three lies across.
    def apart(uv):
        return uv + numpy.where(uv.mean(1, keepdims=True)[..., 1:] > 0.5, [3.3, 0.4], [0.0, 0])

    points, made, pulled = mapped(source(apart), 12, 3, 0.0)
    upper = made[..., 0] > 2
    assert (upper == upper[:, :1]).all()
    assert (pulled == (numpy.abs(points.mean(1)[:, 2] - 0.5) < 0.1)).all()
    height = made[..., 1] - 0.4 * upper
    assert (height[upper] >= 0.5 - 1e-9).all() and (height[~upper] <= 0.5 + 1e-9).all()


def test_a_map_without_area():
    assert source(lambda uv: uv).has_area
    assert not source(lambda uv: uv * (0, 1)).has_area
