# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes and chains of levels as .glb, after the specification of glTF 2.0 and the vendor extension MSFT_lod.

glTF has triangles and vertices with one value each: quads are split along their shorter diagonal, and a vertex is written once for each of its texture coordinates, patches and sides of
sharp edges. Positions are 32-bit: they are written from the middle of the mesh, which its node moves back.
"""

import json
import struct

import numpy

FLOAT, UNSIGNED_INT = 5126, 5125
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
# Blender's z is up, glTF's y: the quaternion of that turn.
Z_UP = (-(0.5**0.5), 0.0, 0.0, 0.5**0.5)
# Face attributes, as vertex attributes of the names that the specification leaves to applications; those that vary within a patch are averaged at vertices.
ATTRIBUTES = ("patch", "stretch", "anisotropy", "irregular", "opened", "opened_level")
COVERAGE = 0.5  # of the screen, from which on a mesh is shown as fine as it is; half of that for each coarser level


def write(path, meshes, z_up=False):
    """Writes meshes, as level() and final_mesh() give them, to a .glb.

    meshes: [(name, mesh)], the finest last; of several, that one is the scene's, and the others are its coarser levels of detail. z_up: the coordinates' z is up, as in Blender, and not y.
    """
    file = _File()
    nodes = [file.node(name, mesh, z_up) for name, mesh in meshes]
    finest = len(nodes) - 1
    if finest > 0:
        coarser = list(range(finest - 1, -1, -1))
        nodes[finest]["extensions"] = {"MSFT_lod": {"ids": coarser}}
        nodes[finest]["extras"] = {"MSFT_screencoverage": [COVERAGE / 2**level for level in range(finest)] + [0.0]}
    content = {
        "asset": {"version": "2.0", "generator": "Hybrid Mesh"},
        **({"extensionsUsed": ["MSFT_lod"]} if finest > 0 else {}),
        "scene": 0, "scenes": [{"nodes": [finest]}], "nodes": nodes, "meshes": file.meshes, "materials": [{"name": "surface", "pbrMetallicRoughness": {"metallicFactor": 0.0}}],
        "accessors": file.accessors, "bufferViews": file.views, "buffers": [{"byteLength": file.length}],
    }  # fmt: skip
    text = json.dumps(content, ensure_ascii=False, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + file.length))
        out.write(struct.pack("<I4s", len(text), b"JSON") + text)
        out.write(struct.pack("<I4s", file.length, b"BIN\0"))
        for piece in file.pieces:
            out.write(piece)


class _File:
    def __init__(self):
        self.pieces, self.length = [], 0
        self.views, self.accessors, self.meshes = [], [], []

    def node(self, name, mesh, z_up):
        points = numpy.asarray(mesh["points"], dtype=numpy.float64)
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        corners = _Corners(mesh)
        attributes = {"POSITION": (points - middle)[corners.points], "NORMAL": corners.normals}
        if mesh.get("uv") is not None:
            uv = numpy.asarray(mesh["uv"])[corners.first]
            attributes["TEXCOORD_0"] = numpy.column_stack([uv[:, 0], 1 - uv[:, 1]])  # glTF counts from the top
        for key in ATTRIBUTES:
            if mesh.get(key) is not None:
                attributes[f"_{key.upper()}"] = corners.mean(mesh[key])
        primitive = {
            "attributes": {key: self._accessor(values.astype("<f4"), ARRAY_BUFFER) for key, values in attributes.items()},
            "indices": self._accessor(corners.triangles.astype("<u4").ravel(), ELEMENT_ARRAY_BUFFER),
            "material": 0,
        }
        self.meshes.append({"name": name, "primitives": [primitive]})
        made = {"name": name, "mesh": len(self.meshes) - 1}
        if z_up:
            made["rotation"] = list(Z_UP)
            middle = numpy.array([middle[0], middle[2], -middle[1]])
        return {**made, "translation": middle.tolist()}

    def _accessor(self, values, target):
        data = values.tobytes()
        self.views.append({"buffer": 0, "byteOffset": self.length, "byteLength": len(data), "target": target})
        data += b"\0" * (-len(data) % 4)
        self.pieces.append(data)
        self.length += len(data)
        kind = "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}"
        made = {"bufferView": len(self.views) - 1, "componentType": UNSIGNED_INT if target == ELEMENT_ARRAY_BUFFER else FLOAT, "count": len(values), "type": kind}
        if target == ARRAY_BUFFER and kind == "VEC3":
            made.update(min=values.min(axis=0).tolist(), max=values.max(axis=0).tolist())
        self.accessors.append(made)
        return len(self.accessors) - 1


class _Corners:
    """The corners of a mesh's faces, put together to the vertices that are written.

    points: the mesh's point of each vertex; first: one of its corners; triangles: as vertices; normals.
    """

    def __init__(self, mesh):
        offsets, indices = numpy.asarray(mesh["offsets"], dtype=numpy.int64), numpy.asarray(mesh["indices"], dtype=numpy.int64)
        counts = numpy.diff(offsets)
        self._face = numpy.repeat(numpy.arange(len(counts)), counts)
        following = numpy.arange(len(indices)) + 1
        following[offsets[1:] - 1] = offsets[:-1]
        before = numpy.empty_like(following)
        before[following] = numpy.arange(len(indices))
        points = numpy.asarray(mesh["points"], dtype=numpy.float64)

        # What tells two vertices at a point apart.
        parts = [indices, _fans(indices, following, before, mesh.get("sharp"))]
        if mesh.get("uv") is not None:
            parts += list(numpy.asarray(mesh["uv"], dtype=numpy.float32).view(numpy.int32).T)
        if mesh.get("patch") is not None:
            parts.append(numpy.asarray(mesh["patch"])[self._face])
        _, self.first, self._vertex = numpy.unique(numpy.column_stack(parts), axis=0, return_index=True, return_inverse=True)
        self._vertex = self._vertex.ravel()
        self.points = indices[self.first]
        self.triangles = self._vertex[_triangles(points[indices], offsets)]

        # Of a fan, not of a written vertex, so that no seam of the texture is seen.
        _, fan = numpy.unique(numpy.column_stack(parts[:2]), axis=0, return_inverse=True)
        fan = fan.ravel()
        position = points[indices]
        turn = numpy.cross(position[following] - position, position[before] - position)
        normals = numpy.column_stack([numpy.bincount(fan, turn[:, axis]) for axis in range(3)])
        length = numpy.linalg.norm(normals, axis=1, keepdims=True)
        normals = numpy.where(length > 0, normals / numpy.where(length > 0, length, 1), [0.0, 0.0, 1.0])
        self.normals = normals[fan[self.first]]

    def mean(self, values):
        """An attribute of faces at the vertices."""
        corner_values = numpy.asarray(values, dtype=numpy.float64)[self._face]
        return numpy.bincount(self._vertex, corner_values) / numpy.bincount(self._vertex)


def _fans(indices, following, before, sharp):
    """For each corner the number of its fan: corners of a point are of one where their faces meet at an edge that is not sharp."""
    fan = numpy.arange(len(indices))
    if sharp is None or not numpy.any(sharp):
        return numpy.zeros_like(fan)
    # The corner whose edge to the next one runs the other way along the same edge.
    key = numpy.column_stack([indices, indices[following]])
    order = numpy.lexsort((key[:, 1], key[:, 0]))
    ordered = key[order, 0] * (indices.max() + 1) + key[order, 1]
    wanted = key[:, 1] * (indices.max() + 1) + key[:, 0]
    place = numpy.minimum(numpy.searchsorted(ordered, wanted), len(ordered) - 1)
    other = numpy.where(ordered[place] == wanted, order[place], -1)
    soft = numpy.nonzero((other >= 0) & ~numpy.asarray(sharp, dtype=bool))[0]
    # Along a soft edge the corner at its start meets the next one of the other face, and the corner at its end the other corner itself.
    pairs = numpy.concatenate([numpy.column_stack([soft, following[other[soft]]]), numpy.column_stack([following[soft], other[soft]])])
    while True:
        least = numpy.minimum(fan[pairs[:, 0]], fan[pairs[:, 1]])
        made = fan.copy()
        numpy.minimum.at(made, pairs[:, 0], least)
        numpy.minimum.at(made, pairs[:, 1], least)
        if (made == fan).all():
            return fan
        fan = made


def _triangles(position, offsets):
    """Corners of triangles: quads along the shorter diagonal, faces of more sides from their first corner."""
    counts = numpy.diff(offsets)
    made = []
    for count in numpy.unique(counts):
        first = offsets[:-1][counts == count][:, None]
        corners = first + numpy.arange(count)
        if count == 4:
            p = position[corners]
            turned = numpy.linalg.norm(p[:, 1] - p[:, 3], axis=1) < numpy.linalg.norm(p[:, 0] - p[:, 2], axis=1)
            corners[turned] = numpy.roll(corners[turned], -1, axis=1)
        for k in range(1, count - 1):
            made.append(corners[:, [0, k, k + 1]])
    return numpy.concatenate(made)
