# SPDX-License-Identifier: GPL-3.0-or-later
"""The quads of a level that a region is made of, and the layouts that other operations of its hierarchy have."""

import numpy

from ...bridge import meshes
from ...core import plans, regions
from ..levels import properties as hierarchy_properties
from . import properties


def selected_quads(level, hierarchy):
    """Addresses of the faces that are selected in a level object; raises ValueError where they cannot be had."""
    root, path = _addresses(level)
    if root is None:
        raise ValueError(f"{level.name} does not know its quads; remesh the source again")
    chosen = meshes.selected_faces(level)
    made_by_hand = int((path[chosen] < 1).sum())
    if made_by_hand:
        raise ValueError(f"{made_by_hand} of the selected faces of {level.name} were not made by a remesh; deselect them")
    _refuse_replaced(level, hierarchy, list(zip(root[chosen].tolist(), path[chosen].tolist())))
    known = []
    for obj in levels_of(hierarchy):
        roots, paths = _addresses(obj)
        if roots is not None:
            known.append((level_number(obj), roots[paths == 1].tolist(), paths[paths == 1].tolist()))
    return plans.quad_addresses(level_number(level), root[chosen].tolist(), path[chosen].tolist(), plans.root_levels(known))


def copied_layout(level, hierarchy, source, turn):
    """The layout of an operation, to be put onto the selected faces; raises ValueError where it does not fit them."""
    found = hierarchy_properties.operations_of(hierarchy)
    if not source.isdigit() or int(source) >= len(found) or not found[int(source)]["corners"]:
        raise ValueError(f"{hierarchy.name} has no operation whose layout can be copied; lay out a region in another way first")
    operation = found[int(source)]
    chosen = meshes.selected_faces(level)
    quads = meshes.quad_corners(level, chosen)
    if quads is None:
        raise ValueError(f"the selected faces of {level.name} are not all quads, or its UV map {meshes.PATCH_UV} is gone")
    quad, side = regions.copy_start(quads, removed_counts(hierarchy, operation), turn)
    root, path = (values[chosen] for values in _addresses(level))
    return plans.template_layout(plans.address(root[quad], path[quad]), side, operation["new_quads"])


def removed_counts(hierarchy, operation):
    """regions.corner_counts() of the quads that an operation replaced, from its layout's corner 0 on; all 0 where the level that had them is gone."""
    unknown = [0] * operation["corners"]
    name = f"M{operation['level']}"
    before = next((obj for obj in levels_of(hierarchy) if obj.hybrid_mesh.level == name and obj.mode == "OBJECT"), None)
    root, path = _addresses(before) if before is not None else (None, None)
    if root is None:
        return unknown
    wanted = set(operation["quads"])
    removed = [number > 0 and plans.address(of, number) in wanted for of, number in zip(root.tolist(), path.tolist())]
    quads = meshes.quad_corners(before, removed)
    if quads is None or len(quads) != len(operation["quads"]):
        return unknown
    addresses = [plans.address(root[face], path[face]) for face in numpy.nonzero(removed)[0]]
    sides = regions.boundary(quads)
    start = next((k for k, (quad, side) in enumerate(sides) if [addresses[quad], side] == operation["start"]), None)
    return unknown if start is None else regions.corner_counts(quads, sides[start:] + sides[:start])


def finest_level(hierarchy):
    return max(map(level_number, levels_of(hierarchy)), default=0)


def levels_of(hierarchy):
    """The level objects of a hierarchy that are in its collection."""
    return [obj for obj in hierarchy.objects if properties.is_level(obj) and obj.hybrid_mesh.hierarchy == hierarchy]


def level_number(level):
    return hierarchy_properties.level_number(level.hybrid_mesh.level)


def _refuse_replaced(level, hierarchy, quads):
    """Raises ValueError where quads (root, path) of a level before its operations are not there after them."""
    name = f"N{level_number(level)}"
    after = next((obj for obj in levels_of(hierarchy) if obj.hybrid_mesh.level == name), None)
    root, path = _addresses(after) if after is not None and after != level else (None, None)
    if root is None:
        return
    there = set(zip(root.tolist(), path.tolist()))
    replaced = sum(quad not in there for quad in quads)
    if replaced:
        raise ValueError(f"{replaced} of the selected faces of {level.name} {'has' if replaced == 1 else 'have'} been laid out anew already; select faces of {after.name}")


def _addresses(level):
    """(root, path) of every face of a level object as arrays, or (None, None)."""
    root, path = (meshes.face_numbers(level, name) for name in (meshes.ROOT, meshes.PATH))
    return (None, None) if root is None or path is None else (root, path)
