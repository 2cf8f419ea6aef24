# SPDX-License-Identifier: GPL-3.0-or-later
"""The 26 bones of a right foot as smooth implicit shapes, none of which touches another. Needs numpy alone.

In centimetres: x toward the big toe's side, y from the toes to the heel, z up, the ground at z = 0. Bones are laid out from heel to toe."""

import numpy
from implicit_shapes import axes, block, chain, ellipsoid, limb, union, without

GAP = 0.22  # between two bones


def _along(points, start, end):
    """Points as (along, across, up) from `start` toward `end`, and how far that is."""
    start, end = numpy.asarray(start, dtype=float), numpy.asarray(end, dtype=float)
    return (points - start) @ axes(end - start, (0, 0, 1)).T, numpy.linalg.norm(end - start)


def long_bone(points, start, end, base, shaft, head):
    """A shaft from a flat base to a head with two knobs. base, head: half of (length, width, height); shaft: its radius in the middle."""
    p, length = _along(points, start, end)
    (base_long, base_wide, base_high), (long, wide, high) = base, head
    waist = chain(p, [(0.5 * base_long, 0, 0), (0.5 * length, 0, 0.03 * length), (length - long, 0, 0)], [1.25 * shaft, shaft, 1.1 * shaft])
    bone = union(waist, block(p, (base_long, 0, 0), (base_long, base_wide, base_high), 0.9 * min(base)), 1.5 * shaft)
    end_of_bone = ellipsoid(p, (length - long, 0, 0), (long, 0.95 * wide, high))
    across = numpy.stack([p[:, 0], numpy.abs(p[:, 1]), p[:, 2]], axis=1)
    knob = ellipsoid(across, (length - 0.95 * long, 0.55 * wide, -0.35 * high), (0.8 * long, 0.5 * wide, 0.75 * high))
    return union(bone, union(end_of_bone, knob, 0.2 * wide), 0.9 * shaft)


def toe_tip(points, start, end, base, shaft, tuft):
    """The last bone of a toe: it ends in a flat tuft."""
    p, length = _along(points, start, end)
    bone = limb(p, (0.5 * base[0], 0, 0), (length - tuft[0], 0, 0), 1.2 * shaft, 0.8 * shaft)
    bone = union(bone, block(p, (base[0], 0, 0), base, 0.9 * min(base)), 1.2 * shaft)
    return union(bone, ellipsoid(p, (length - tuft[0], 0, 0), tuft), 0.8 * shaft)


def calcaneus(p):
    bone = limb(p, (0.0, -2.2, 2.5), (-0.9, -6.9, 3.2), 1.45, 1.15)
    bone = union(bone, block(p, (0.1, -1.5, 2.2), (1.35, 1.35, 2.0), 1.2), 1.0)  # the heel
    bone = union(bone, ellipsoid(p, (-0.2, -4.9, 4.0), (1.4, 1.6, 1.2)), 0.8)  # under the talus
    bone = union(bone, limb(p, (-0.2, -5.6, 3.9), (1.25, -6.0, 4.0), 0.8, 0.55), 0.6)  # the shelf on the inner side
    return union(bone, block(p, (-1.25, -7.6, 3.2), (1.15, 0.9, 1.1), 0.8), 0.8)


def talus(p):
    bone = union(block(p, (0.15, -5.4, 5.9), (1.35, 1.6, 1.1), 0.9), ellipsoid(p, (0.1, -5.5, 6.4), (1.5, 1.8, 1.3)), 0.5)
    # A pulley for the shin: a groove from front to back over its top.
    bone = without(bone, limb(p, (0.15, -3.5, 8.3), (0.15, -7.5, 8.3), 1.05, 1.05), 0.6)
    bone = union(bone, ellipsoid(p, (0.0, -3.8, 5.7), (0.8, 0.8, 0.6)), 0.6)
    bone = union(bone, limb(p, (0.4, -6.8, 5.8), (1.1, -8.8, 5.3), 1.0, 1.05), 0.9)
    return union(bone, ellipsoid(p, (1.2, -9.2, 5.2), (1.45, 1.0, 1.2)), 0.7)


def navicular(p):
    bone = ellipsoid(p, (1.35, -10.5, 5.0), (2.0, 0.95, 1.5), axes((1, -0.10, -0.12), (0, 0, 1)))
    return union(bone, ellipsoid(p, (2.9, -10.3, 4.4), (0.75, 0.75, 0.8)), 0.6)


def cuboid(p):
    turn = axes((-0.16, -1, -0.12), (0, 0, 1))
    bone = block(p, (-1.75, -10.6, 3.2), (1.75, 1.35, 1.15), 0.65, turn)
    return union(bone, limb(p, (-2.5, -10.4, 2.2), (-0.9, -11.2, 2.1), 0.45, 0.45), 0.5)


def cuneiform(middle, half, lean):
    """A wedge, broad at the top but for the first, which is broad below. lean: how its width changes with height."""

    def shape(points):
        p = points - middle
        p = numpy.stack([p[:, 0] * (1 + lean * p[:, 2]), p[:, 1], p[:, 2]], axis=1)
        return block(p, (0, 0, 0), half, 0.5 * min(half))

    return shape


# Of a toe: its metatarsal, then the bones of the toe, (start, end) each; half of what is broad in it.
_METATARSALS = [
    ((2.15, -13.2, 3.95), (2.95, -19.3, 1.70), (0.75, 0.90, 1.20), 0.66, (1.00, 1.05, 1.05)),
    ((0.85, -12.9, 4.45), (1.10, -20.0, 1.65), (0.70, 0.65, 0.95), 0.46, (0.80, 0.68, 0.80)),
    ((-0.45, -13.0, 4.05), (-0.50, -19.5, 1.50), (0.70, 0.62, 0.95), 0.43, (0.75, 0.65, 0.76)),
    ((-1.65, -12.3, 3.35), (-2.05, -18.7, 1.35), (0.70, 0.62, 0.85), 0.42, (0.72, 0.62, 0.72)),
    ((-2.85, -11.9, 2.60), (-3.50, -17.6, 1.20), (0.75, 0.85, 0.70), 0.42, (0.72, 0.62, 0.70)),
]  # fmt: skip
_TOES = [
    [(2.95, -19.5, 1.60), (3.05, -22.9, 1.20), (2.90, -25.7, 0.80)],
    [(1.10, -20.2, 1.55), (1.20, -23.2, 1.50), (1.20, -25.2, 1.15), (1.15, -26.9, 0.62)],
    [(-0.50, -19.7, 1.40), (-0.55, -22.5, 1.40), (-0.50, -24.3, 1.10), (-0.45, -25.9, 0.60)],
    [(-2.05, -18.9, 1.28), (-2.20, -21.5, 1.30), (-2.15, -23.1, 1.05), (-2.00, -24.6, 0.60)],
    [(-3.50, -17.8, 1.15), (-3.75, -20.1, 1.15), (-3.70, -21.6, 0.95), (-3.50, -23.0, 0.55)],
]


def _metatarsal(number):
    start, end, base, shaft, head = _METATARSALS[number]

    def shape(p):
        bone = long_bone(p, start, end, base, shaft, head)
        if number < 4:
            return bone
        # The knob at the outer edge of the foot.
        return union(bone, limb(p, (-3.3, -12.4, 2.5), (-4.0, -11.5, 2.3), 0.55, 0.42), 0.5)

    return shape


def _toe_bones(number):
    places, size = _TOES[number], 1.0 if number == 0 else 0.64 - 0.02 * number

    def middle(start, end):
        return lambda p: long_bone(p, start, end, (0.38 * size, 0.92 * size, 0.78 * size), 0.54 * size, (0.50 * size, 0.80 * size, 0.64 * size))

    def last(start, end):
        return lambda p: toe_tip(p, start, end, (0.40 * size, 0.86 * size, 0.62 * size), 0.50 * size, (0.55 * size, 0.72 * size, 0.38 * size))

    parts = list(zip(places[:-1], places[1:]))
    return [middle(*part) for part in parts[:-1]] + [last(*parts[-1])]


_BONES = [
    calcaneus, talus, navicular, cuboid,
    cuneiform((2.05, -12.0, 4.05), (0.95, 1.25, 1.30), 0.12), cuneiform((0.80, -11.9, 4.75), (0.72, 0.95, 1.00), -0.22),
    cuneiform((-0.42, -11.9, 4.30), (0.72, 1.10, 1.05), -0.22),
    *[_metatarsal(k) for k in range(5)], *[bone for k in range(5) for bone in _toe_bones(k)],
]  # fmt: skip
_LOW, _HIGH = numpy.array([-6.0, -28.0, -1.0]), numpy.array([5.0, 1.0, 9.0])


def _box(bone, step=0.3):
    """Where a bone is: (low, high) with some room."""
    lattice = numpy.stack(numpy.meshgrid(*[numpy.arange(a, b, step) for a, b in zip(_LOW, _HIGH)], indexing="ij"), axis=-1).reshape(-1, 3)
    inside = lattice[bone(lattice) < 0.7 * step]
    return inside.min(axis=0) - step, inside.max(axis=0) + step


def _without_those_before(number, boxes):
    """A bone without what is within GAP of the bones before it, which so leave their shape in its joints."""
    low, high = boxes[number]
    before = [_BONES[k] for k in range(number) if (boxes[k][0] - GAP < high).all() and (boxes[k][1] + GAP > low).all()]

    def shape(points):
        away = _BONES[number](points)
        near = away < 1.5
        for other in before:
            away[near] = without(away[near], other(points[near]) - GAP, 0.25)
        return away

    return shape


def foot():
    """The bones: (distance, low, high) each."""
    boxes = [_box(bone) for bone in _BONES]
    return [(_without_those_before(number, boxes), *boxes[number]) for number in range(len(_BONES))]


def two_bones(apart=0.8):
    """The big toe's metatarsal and the bone that follows it, pulled apart by so much along y."""
    first, (distance, low, high) = foot()[7], foot()[12]
    away = numpy.array([0, -apart, 0])
    return [first, (lambda p: distance(p - away), low + away, high + away)]
