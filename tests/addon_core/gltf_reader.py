# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a .glb after the specification, refusing what it does not allow."""

import json
import struct

import numpy

COMPONENTS = {5126: "<f4", 5125: "<u4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


def read(path):
    """The JSON, and a function that gives an accessor's array."""
    data = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    chunks, at = {}, 12
    while at < len(data):
        size, kind = struct.unpack_from("<I4s", data, at)
        assert size % 4 == 0 and at + 8 + size <= len(data)
        chunks[kind] = data[at + 8 : at + 8 + size]
        at += 8 + size
    content, binary = json.loads(chunks[b"JSON"]), chunks[b"BIN\0"]
    assert content["buffers"] == [{"byteLength": len(binary)}]

    def array(number):
        accessor = content["accessors"][number]
        view = content["bufferViews"][accessor["bufferView"]]
        assert view["byteOffset"] % 4 == 0 and view["byteOffset"] + view["byteLength"] <= len(binary)
        width = WIDTHS[accessor["type"]]
        assert accessor["count"] * width * 4 == view["byteLength"]
        values = numpy.frombuffer(binary, COMPONENTS[accessor["componentType"]], accessor["count"] * width, view["byteOffset"])
        values = values.reshape(-1, width) if width > 1 else values
        for bound, found in (("min", values.min(0)), ("max", values.max(0))):
            assert bound not in accessor or (numpy.asarray(accessor[bound], "f4") == found).all()
        return values

    return content, array


def primitive(content, array, node):
    """The arrays of a node's mesh: {attribute: values}, triangles."""
    (part,) = content["meshes"][content["nodes"][node]["mesh"]]["primitives"]
    attributes = {name: array(number) for name, number in part["attributes"].items()}
    assert len({len(values) for values in attributes.values()}) == 1 and "min" in content["accessors"][part["attributes"]["POSITION"]]
    triangles = array(part["indices"]).reshape(-1, 3)
    assert triangles.max() < len(attributes["POSITION"])
    return attributes, triangles
