# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user would select and draw on a head, found by numpy alone: four points of the neck's boundary; a block of quads of a level around what sticks out;
curves over it that give it more skin, a ring of quads along its rim and inside as many quads as before."""

import numpy


class Block:
    """Columns x rows of quads in a level of a hierarchy.

    points: (n, 3); quads: (m, 4), counter-clockwise. `rows` has for each row, from below, (face, side that leads to the right) of its quads.
    """

    def __init__(self, points, quads, rows):
        self.points, self.quads, self.rows = points, quads, rows

    @property
    def shape(self):
        return len(self.rows[0]), len(self.rows)

    @property
    def faces(self):
        return [face for row in self.rows for face, _ in row]

    def corners(self, column, row):
        """Which corners of a quad's four are its lower left, lower right, upper right and upper left."""
        _, right = self.rows[row][column]
        return [(right + turn) % 4 for turn in (3, 0, 1, 2)]

    def around(self, rings):
        """Faces that share a corner with the block, and so on outward."""
        within = numpy.zeros(len(self.quads), dtype=bool)
        within[self.faces] = True
        for _ in range(rings):
            within |= numpy.isin(self.quads, self.quads[within]).any(axis=1)
        within[self.faces] = False
        return numpy.nonzero(within)[0].tolist()


def four_corners(points):
    """Which of some points lie farthest left and right to the front and to the back, as seen from above."""
    middle, half = (points.max(axis=0) + points.min(axis=0)) / 2, numpy.ptp(points, axis=0) / 2
    flat = (points - middle)[:, :2] / half[:2]
    return [int((flat @ numpy.array(toward)).argmax()) for toward in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def block_at(points, quads, tip, weight, columns, rows, up=(0, 0, 1), right=(1, 0, 0)):
    """The upright block with the most weight (a number a face) of those that hold the face nearest to `tip`."""
    quads = numpy.asarray(quads)
    beyond = {(int(quad[k]), int(quad[(k + 1) % 4])): (face, k) for face, quad in enumerate(quads) for k in range(4)}

    def strip(face, side, length):
        """`length` quads across opposite sides, each with the side that leads on; None where the surface ends or a row comes back on itself."""
        found = [(face, side)]
        while len(found) < length:
            face, side = found[-1]
            over = beyond.get((int(quads[face][(side + 1) % 4]), int(quads[face][side])))
            if over is None:
                return None
            found.append((over[0], (over[1] + 2) % 4))
        return found

    def block(face, side):
        column = strip(face, (side + 1) % 4, rows)
        lines = [strip(one, (upward + 3) % 4, columns) for one, upward in column] if column else [None]
        return None if None in lines else Block(points, quads, lines)

    middles = points[quads].mean(axis=1)
    away = numpy.linalg.norm(middles - tip, axis=1)
    nearest, best = int(away.argmin()), None
    for face in numpy.argsort(away, kind="stable")[: 4 * columns * rows]:
        sides = (points[quads[face]] + points[numpy.roll(quads[face], -1)]) / 2 - middles[face]
        sides /= numpy.linalg.norm(sides, axis=1)[:, None]
        # The side to the right, and the next one upward.
        fit = sides @ numpy.asarray(right) + numpy.roll(sides, -1, axis=0) @ numpy.asarray(up)
        found = block(int(face), int(fit.argmax()))
        if found is None or nearest not in found.faces or len(set(found.faces)) < columns * rows:
            continue
        total = float(numpy.asarray(weight)[found.faces].sum())
        if best is None or total > best[0]:
            best = total, found
    if best is None:
        raise ValueError(f"no {columns} x {rows} quads lie around {numpy.round(tip, 3).tolist()}")
    return best[1]


def skin_lines(block, place, inset=0.5, steps=8):
    """Curves ((n, 3) points each) that lay a block out anew: a ring at `inset` quads from its rim, a curve to it from each corner of the rim, and inside the rows and
    columns as they were.

    place(face, corners, s, t): the point of the surface at s, t in [0, 1] along and up a face with these corners (see Block.corners); steps: points a quad, at
    most as many as the level that `place` knows has.
    """
    columns, rows = block.shape

    def at(column, row):
        i, j = min(int(column), columns - 1), min(int(row), rows - 1)
        return place(block.rows[j][i][0], block.corners(i, j), column - i, row - j)

    def line(*stops):
        found = [at(*stops[0])]
        for (a, b), (c, d) in zip(stops[:-1], stops[1:]):
            count = max(1, round(steps * max(abs(c - a), abs(d - b))))
            found += [at(a + (c - a) * k / count, b + (d - b) * k / count) for k in range(1, count + 1)]
        return numpy.array(found)

    def inside(column, row):
        return min(max(column, inset), columns - inset), min(max(row, inset), rows - inset)

    rim = [(i, 0) for i in range(columns)] + [(columns, j) for j in range(rows)] + [(i, rows) for i in range(columns, 0, -1)] + [(0, j) for j in range(rows, 0, -1)]
    lines = [line(*[inside(*corner) for corner in [*rim, rim[0]]])]
    lines += [line(corner, inside(*corner)) for corner in rim]
    lines += [line((i, inset), (i, rows - inset)) for i in range(1, columns)]
    lines += [line((inset, j), (columns - inset, j)) for j in range(1, rows)]
    return lines


def places_on(uv, fine_points, fine_uv):
    """`place` for skin_lines: where a finer level has the point. A row a corner: uv and fine_uv in the map of the patches' islands, which is one for all levels,
    fine_points in space. Four corners a face."""

    def place(face, corners, s, t):
        a, b, c, d = (uv[4 * face + corner] for corner in corners)
        wanted = (1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d
        return fine_points[numpy.abs(fine_uv - wanted).sum(axis=1).argmin()].astype(float)

    return place
