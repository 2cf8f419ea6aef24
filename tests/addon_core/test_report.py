# SPDX-License-Identifier: GPL-3.0-or-later
import csv
import io
import json

from hybrid_mesh.core import report


def test_the_hash_covers_input_settings_and_version():
    base = report.resume_hash([b"ab"], {"seed": 1}, "1")
    assert base == report.resume_hash([b"a", b"b"], {"seed": 1}, "1")
    assert len({base, report.resume_hash([b"ac"], {"seed": 1}, "1"), report.resume_hash([b"ab"], {"seed": 2}, "1"), report.resume_hash([b"ab"], {"seed": 1}, "2")}) == 4


def test_summary_has_a_line_an_input_and_survives_any_name():
    rows = [
        report.summary_row('a,"b"\n', "x.ply", "failed", error="no faces"),
        report.summary_row("猫", "猫.ply", "done", {"final": {"vertices": 5, "irregular_vertices": {"base": 2, "operations": 3}}, "levels": [1, 2]}),
    ]
    read = list(csv.DictReader(io.StringIO(report.summary_csv(rows), newline="")))
    assert [row["name"] for row in read] == ['a,"b"\n', "猫"]
    assert read[0]["status"] == "failed" and read[0]["vertices"] == ""
    assert read[1]["irregular_vertices"] == "5" and read[1]["levels"] == "2"


def test_the_summary_repeats_warnings():
    row = report.summary_row("a", "a.ply", "done", {"final": {}, "warnings": ["too far", "too late"]})
    assert row["warnings"] == "too far; too late"
    assert report.summary_row("a", "a.ply", "done", {"final": {}})["warnings"] == ""


POOR = {"result": "poor", "reasons": [{"what": "hausdorff", "text": "far off", "where": [1.0, -2.5, 1234567.0]}, {"what": "vertices", "text": "few"}]}


def test_the_summary_has_the_verdict_and_its_reasons_with_their_places():
    row = report.summary_row("a", "a.ply", "done", {"final": {}, "verdict": POOR})
    assert row["verdict"] == "poor" and row["reasons"] == "far off (at 1, -2.5, 1.23457e+06); few"
    row = report.summary_row("a", "a.ply", "done", {"final": {}, "verdict": {"result": "good", "reasons": []}})
    assert (row["verdict"], row["reasons"]) == ("good", "")
    assert report.summary_row("a", "a.ply", "failed", {"error": "no"})["verdict"] == ""


def test_a_report_without_a_verdict_is_neither_good_nor_poor():
    for made in ({}, {"verdict": None}):
        assert report.verdict(made) == "" and report.reasons(made) == []


def test_quality_of_a_report_without_figures():
    figures = report.quality({})
    assert figures["vertices"] is None and figures["irregular_vertices"] == 0


def test_json_is_readable_and_ends_with_a_line_break():
    text = report.to_json({"name": "Größe"})
    assert "Größe" in text and text.endswith("}\n") and json.loads(text) == {"name": "Größe"}


def test_peak_memory_is_this_process():
    peak = report.peak_memory_bytes()
    assert peak is None or 1 << 20 < peak < 1 << 40


def test_the_level_table_names_every_level():
    lines = report.level_table({"levels": [{"level": 0, "vertices": 8, "quads": 6}, {"level": "M1", "vertices": 26, "quads": 24, "l2": 1e-3}]})
    assert len(lines) == 3 and lines[1].startswith("N0") and lines[2].startswith("M1") and "1.00e-03" in lines[2]
