# SPDX-License-Identifier: GPL-3.0-or-later
"""The vertices of a regularly refined level as square grids, one over each quad of a coarser level; no bpy."""

import numpy


class GridError(RuntimeError):
    """Levels, or meshes, that do not lie over one another as regular refinement has them."""


def level_grids(coarse, fine, steps):
    """(quads, n + 1, n + 1) vertices of a level over each quad of the level that is `steps` coarser, n = 2 ** steps: row y, column x, where x runs from the quad's
    corner 0 to 1, and y from corner 0 to 3.

    coarse, fine: MeshDicts with `root` and `path`, of quads alone and regular in between. Raises GridError.
    """
    n = 2**steps
    quads = numpy.asarray(fine["indices"])
    if len(quads) != 4 * len(fine["path"]) or len(fine["path"]) != len(coarse["path"]) * n * n:
        raise GridError("the finer level is no regular refinement of the coarser one")
    quads = quads.reshape(-1, 4)
    path = numpy.asarray(fine["path"], dtype=numpy.int64)
    key = _key(coarse["root"], coarse["path"])
    order = numpy.argsort(key)
    wanted = _key(fine["root"], path >> (2 * steps))
    place = numpy.minimum(numpy.searchsorted(key, wanted, sorter=order), len(order) - 1)
    below = order[place]
    if not numpy.array_equal(key[below], wanted):
        raise GridError("the finer level has quads that do not come of the coarser one")
    x, y = numpy.zeros(len(path), dtype=numpy.int64), numpy.zeros(len(path), dtype=numpy.int64)
    for step in range(steps):
        # Children are numbered counter-clockwise from the first corner: (0, 0), (1, 0), (1, 1), (0, 1).
        child = (path >> (2 * step)) & 3
        x += ((child == 1) | (child == 2)).astype(numpy.int64) << step
        y += (child >= 2).astype(numpy.int64) << step
    grids = numpy.full((len(coarse["path"]), n + 1, n + 1), -1, dtype=numpy.int64)
    for corner, (dx, dy) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
        grids[below, y + dy, x + dx] = quads[:, corner]
    return grids


def turned_over(grids):
    """The same grids where every face is turned over: its corners 0, 1, 2, 3 are those that were 3, 2, 1, 0."""
    return grids[:, ::-1, :]


def subdivided_grids(corners, side_edges, edges, vertices, steps):
    """The same grids of the mesh that Blender's subdivision makes of quads: it numbers the vertices of the coarse mesh first, then those on its edges, then those inside
    its faces, row by row.

    corners (quads, 4), side_edges (quads, 4): the edge from each corner to the next; edges (n, 2): their ends; vertices: how many there are.
    """
    n = 2**steps
    grids = numpy.empty((len(corners), n + 1, n + 1), dtype=numpy.int64)
    inside = numpy.arange(n - 1)
    inner = vertices + len(edges) * (n - 1) + numpy.arange(len(corners))[:, None, None] * (n - 1) ** 2
    grids[:, 1:n, 1:n] = inner + inside[:, None] * (n - 1) + inside
    along = numpy.arange(1, n)
    rows = ((0, slice(1, n)), (slice(1, n), n), (n, slice(n - 1, 0, -1)), (slice(n - 1, 0, -1), 0))
    for side, (row, column) in enumerate(rows):
        edge = side_edges[:, side]
        forward = edges[edge, 0] == corners[:, side]
        grids[:, row, column] = vertices + edge[:, None] * (n - 1) + numpy.where(forward[:, None], along, n - along) - 1
    for corner, (x, y) in enumerate(((0, 0), (n, 0), (n, n), (0, n))):
        grids[:, y, x] = corners[:, corner]
    return grids


def grid_faces(grids):
    """The quads of grids, (m, 4), counter-clockwise."""
    return numpy.stack([grids[:, :-1, :-1], grids[:, :-1, 1:], grids[:, 1:, 1:], grids[:, 1:, :-1]], axis=-1).reshape(-1, 4)


def correspondence(grids, other, count):
    """For each of `count` vertices of grids the vertex of the other grids that lies in the same place. Raises GridError where they are not glued alike."""
    found = numpy.full(count, -1, dtype=numpy.int64)
    found[grids] = other
    if found.min(initial=0) < 0 or not numpy.array_equal(found[grids], other):
        raise GridError("the levels are not glued as the mesh is")
    return found


def same_faces(faces, others):
    """Whether two lists of quads have the same vertices face by face, in whatever order."""
    if faces.shape != others.shape:
        return False
    one, other = (numpy.sort(quads, axis=1) for quads in (faces, others))
    return numpy.array_equal(one[numpy.lexsort(one.T)], other[numpy.lexsort(other.T)])


def _key(root, path):
    return (numpy.asarray(root, dtype=numpy.int64) << 32) + numpy.asarray(path, dtype=numpy.int64)
