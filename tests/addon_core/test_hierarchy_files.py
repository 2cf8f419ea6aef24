# SPDX-License-Identifier: GPL-3.0-or-later
import json

import pytest
from hybrid_mesh import _native
from hybrid_mesh.core import hierarchy_files
from hybrid_mesh.core import report as reports
from hybrid_mesh.core.native import native

MATRIX = [float(value) for value in range(16)]
IDENTITY = [1.0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
VERDICT = {"result": "poor", "reasons": [{"what": "hausdorff", "text": "far off", "where": [1, 2, 3]}, {"text": "few"}]}


def hierarchy():
    return _native.Hierarchy((0, 0, 0), (1, 1, 1), 3)


def test_notes_are_read_as_they_are_written():
    notes = hierarchy_files.parse_notes(json.dumps({"matrix": MATRIX, "placement": IDENTITY, "edited": True, "verdict": VERDICT, "other": 1}))
    assert (notes.matrix, notes.placement, notes.edited, notes.verdict) == (MATRIX, IDENTITY, True, VERDICT)


def test_without_a_placement_objects_stand_where_they_stood():
    assert hierarchy_files.parse_notes(json.dumps({"matrix": MATRIX})).placement == MATRIX
    notes = hierarchy_files.Notes()
    assert notes.matrix == notes.placement == IDENTITY and notes.verdict is None and not notes.edited


@pytest.mark.parametrize("text", ["", "{", "[]", "null", "3", '"text"', "{}", '{"settings": {}}'])
def test_what_is_no_metadata_says_nothing(text):
    assert hierarchy_files.parse_notes(text) == hierarchy_files.Notes()


@pytest.mark.parametrize(
    "matrix", [None, 1, "x", [1.0] * 15, [1.0] * 17, ["1"] * 16, [None] * 16, [float("nan")] * 16, [float("inf")] * 16, [True] * 16, [[1.0] * 4] * 4]
)
def test_a_matrix_that_is_none_is_not_taken(matrix):
    assert hierarchy_files.parse_notes(json.dumps({"matrix": matrix, "placement": MATRIX, "edited": True})).matrix == IDENTITY
    assert hierarchy_files.parse_notes(json.dumps({"matrix": MATRIX, "placement": matrix})).placement == MATRIX


@pytest.mark.parametrize(
    "verdict",
    [
        1, "good", [], {}, {"result": "good"}, {"result": 1, "reasons": []}, {"result": "poor", "reasons": [1]}, {"result": "poor", "reasons": [{}]},
        {"result": "poor", "reasons": [{"text": "x", "where": [1, 2]}]}, {"result": "poor", "reasons": [{"text": "x", "where": ["a", 0, 0]}]},
    ],
)  # fmt: skip
def test_a_verdict_that_is_none_is_not_taken(verdict):
    assert hierarchy_files.parse_notes(json.dumps({"matrix": MATRIX, "verdict": verdict})).verdict is None


def test_bytes_and_back(tmp_path):
    data = hierarchy_files.encode(hierarchy(), {"matrix": MATRIX})
    assert not hierarchy_files.is_stream(data)
    loaded = hierarchy_files.decode(data)
    assert loaded.level_names == ["N0", "N1", "N2"] and hierarchy_files.parse_notes(loaded.metadata).matrix == MATRIX


def test_a_report_has_the_counts_and_no_more():
    class Counted:
        def info(self):
            counts = [{"name": name, "vertices": 8, "faces": 6, "quads": 6} for name in ("N0", "M1", "N1")]
            return json.dumps({"base": {"quads": 6, "vertices": 8}, "operations": 1, "maps": True, "levels": counts, "final": counts[2]})

    made = hierarchy_files.report(Counted(), VERDICT)
    assert [level["level"] for level in made["levels"]] == [0, 1] and reports.reasons(made) == VERDICT["reasons"]
    measured = {key: value for key, value in reports.quality(made).items() if value is not None}
    assert measured == {"vertices": 8, "quads": 6}


def test_errors_name_no_file_that_nobody_knows(tmp_path):
    with pytest.raises(native().CorruptStream) as caught:
        hierarchy_files.decode(b"something else")
    assert str(caught.value) == "not a hierarchy"


def test_what_cannot_be_read_is_said(tmp_path):
    with pytest.raises(OSError):
        hierarchy_files.read(str(tmp_path / "missing.hmesh"))
    (tmp_path / "empty.hmesh").write_bytes(b"")
    with pytest.raises(ValueError, match="the file is empty"):
        hierarchy_files.read(str(tmp_path / "empty.hmesh"))


def test_streams_are_known_by_their_first_bytes():
    assert hierarchy_files.is_stream(b"HMw\x01rest") and hierarchy_files.is_stream(b"HMw\x09")
    assert not hierarchy_files.is_stream(b"HMESH\r\n") and not hierarchy_files.is_stream(b"") and not hierarchy_files.is_stream(b"HM")


@pytest.mark.parametrize("least", [1, 2, 7, 99, 100])
def test_the_least_prefix_is_found(monkeypatch, least):
    def decode(data):
        if len(data) < least:
            raise native().CorruptStream("it ends before its base does")

    monkeypatch.setattr(hierarchy_files, "decode", decode)
    assert hierarchy_files.least_prefix(bytes(100)) == least
    if least > 1:
        with pytest.raises(native().CorruptStream):
            hierarchy_files.least_prefix(bytes(least - 1))
