# SPDX-License-Identifier: GPL-3.0-or-later
import numpy
import pytest
from hybrid_mesh.core import colors, legend, readout


def millimetres(length):
    return f"{1000 * length:.1f} mm"


def test_what_is_said_of_a_level():
    report = {
        "levels": [{"level": 0, "hausdorff": 0.02, "irregular_vertices": 8}, {"level": 1, "hausdorff": None, "irregular_vertices": None, "scaled_jacobian": None}],
        "final": {"hausdorff": 0.0005, "irregular_vertices": {"base": 50, "operations": 7}, "scaled_jacobian": {"p05": 0.8, "inverted": 0}},
    }
    said = [readout.lines(readout.figures_of(report, name, name == "N2"), 1.8, millimetres) for name in ("N0", "N1", "M2", "N2")]
    assert said == [
        ["Largest deviation 36.0 mm (2 %)", "8 poles"], [], [], ["Largest deviation 0.9 mm (0.05 %)", "57 poles", "Quad shape: good"]
    ]  # fmt: skip
    assert readout.lines({"irregular_vertices": 0}, 1, millimetres) == ["No poles"] and readout.lines({"irregular_vertices": 1}, 1, millimetres) == ["1 pole"]
    assert readout.figures_of({}, "N0", True) == readout.figures_of({}, "N0", False) == {}


@pytest.mark.parametrize("jacobian, words", [({}, ""), ({"p05": 0.5}, "fair"), ({"p05": 0.1}, "poor"), ({"p05": 0.9, "inverted": 0.0123}, "good, 12 folded")])
def test_the_shape_of_quads(jacobian, words):
    assert readout.quad_shape(jacobian, 1000) == words


@pytest.mark.parametrize("fraction, words", [(0, "0 %"), (0.5, "50 %"), (0.0123, "1.2 %"), (1.234e-5, "0.0012 %"), (1e-7, "1e-05 %")])
def test_fractions(fraction, words):
    assert legend.percent(fraction) == words


@pytest.mark.parametrize("progress, seconds, words", [(0.01, 100, ""), (0.5, 1, ""), (1, 9, ""), (0.5, 3, "5 s left"), (0.25, 60, "3 min left"), (0.1, 3600, "9.0 h left")])
def test_how_long_it_takes(progress, seconds, words):
    assert readout.time_left(progress, seconds) == words


def test_the_legend_has_the_colours_of_the_mesh():
    entries = legend.error_entries(2.0, millimetres)
    assert [text for _, text in entries] == ["20.0 mm (1 %) and more", "2.0 mm (0.1 %)", "0.2 mm (0.01 %)", "0.0 mm (0.001 %) and less"]
    assert numpy.allclose([color for color, _ in entries], colors.error_colors([0.5, 1e-3, 1e-4, 0])[:, :3])
    stretch = legend.stretch_entries()
    assert numpy.allclose([color for color, _ in stretch], colors.stretch_colors([9, 2, 1, 0.5, 0.1])[:, :3]) and stretch[2][1].startswith("1")


def test_patches_beside_one_another_differ():
    shown = colors.patch_colors(numpy.arange(1000))
    assert shown.shape == (1000, 4) and (shown[1:] == shown[:-1]).all(1).mean() < 0.2 and len(numpy.unique(shown, axis=0)) == 12
