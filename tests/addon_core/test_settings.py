# SPDX-License-Identifier: GPL-3.0-or-later
import dataclasses
import math

import pytest
from hybrid_mesh.core import settings
from hybrid_mesh.core.limits import limits
from hybrid_mesh.core.settings import RemeshSettings, SettingsError

LARGEST = {
    "vertices": limits().most_vertices, "levels": limits().most_levels, "base": limits().most_base_quads, "seed": limits().most_seed,
    "threads": limits().most_threads,
}  # fmt: skip


def test_defaults_and_presets_are_valid():
    RemeshSettings().validate()
    for name in settings.PRESETS:
        settings.preset(name).validate()
        assert "vertices" in settings.preset_summary(name)
    assert settings.preset_summary("print") == "100,000 vertices, tunnels below 0.5% closed, components below 0.1% dropped"
    assert {"game", "film", "sculpt", "archive", "print"} <= set(settings.PRESETS)


@pytest.mark.parametrize(
    "name, value",
    [
        ("vertices", -1), ("vertices", 1.5), ("vertices", True), ("error", -0.1), ("error", float("nan")), ("error", float("inf")),
        ("error", limits().end_of_error), ("levels", -2), ("refinement", "both"), ("faces", "hexagons"), ("base", "most"), ("base", 0),
        ("base", 1.5), ("stretch_threshold", limits().least_stretch_threshold - 0.25), ("stretch_threshold", 2 * limits().most_stretch_threshold),
        ("stretch_threshold", float("nan")), ("drop_components", limits().end_of_drop_components), ("drop_components", -0.1), ("seed", -1),
        ("features", "some"), ("features", ""), ("features", None), ("features", True), ("features", float("nan")), ("features", -40),
        ("features", limits().least_feature_angle - 0.25), ("features", limits().most_feature_angle + 0.25), ("symmetry", "w"), ("symmetry", None), ("symmetry", 1), ("symmetry", (1, 0, 0)),
        ("symmetry", (0, 0, 0, 1)), ("symmetry", (1, 0, 0, float("inf"))), ("symmetry_side", "left"), ("effort", "high"), ("threads", -1), ("density", None), ("density", 1), *((name, most + 1) for name, most in LARGEST.items()),
    ],
)  # fmt: skip
def test_what_is_out_of_bounds_is_named(name, value):
    with pytest.raises(SettingsError) as raised:
        settings.from_mapping({name: value})
    assert settings.OPTION_NAMES[name] in str(raised.value)
    assert repr(value) in str(raised.value)


@pytest.mark.parametrize(
    "name, value",
    [
        *LARGEST.items(), ("stretch_threshold", limits().least_stretch_threshold), ("stretch_threshold", limits().most_stretch_threshold),
        ("features", limits().least_feature_angle), ("features", limits().most_feature_angle), ("error", math.nextafter(limits().end_of_error, 0)), ("drop_components", math.nextafter(limits().end_of_drop_components, 0)),
    ],
)  # fmt: skip
def test_the_bounds_are_the_native_modules(name, value):
    """Which here is a stand-in that has others than the library."""
    assert getattr(settings.from_mapping({name: value}), name) == value


@pytest.mark.parametrize("value", ["some", 500])
def test_what_features_may_be_is_said(value):
    with pytest.raises(SettingsError, match="auto, none or an angle from 7 to 160 degrees"):
        settings.from_mapping({"features": value})


def test_presets_leave_sharp_edges_to_the_surface():
    assert {settings.preset(name).features for name in settings.PRESETS} == {"auto"}


def test_every_setting_has_an_option_name():
    assert set(settings.OPTION_NAMES) == {field.name for field in dataclasses.fields(RemeshSettings)}


def test_a_density_is_told_where_there_is_one():
    assert "density" not in RemeshSettings().reported() and "density" not in RemeshSettings().identity()
    assert RemeshSettings(density="dense").reported()["density"] == "dense"
    assert RemeshSettings(density="dense").identity() != RemeshSettings(density="other").identity()


def test_unknown_settings_are_refused():
    with pytest.raises(SettingsError, match="colour"):
        settings.from_mapping({"colour": 1})
    with pytest.raises(SettingsError, match="draft"):
        settings.preset("none")


def test_threads_change_neither_report_nor_hash():
    assert RemeshSettings(threads=1).reported() == RemeshSettings(threads=2).reported()
    assert RemeshSettings(seed=1).reported() != RemeshSettings(seed=2).reported()
