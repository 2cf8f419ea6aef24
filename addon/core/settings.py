# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a remesh, checked in one place for the command line, the operator and scripts."""

import hashlib
import math
from dataclasses import asdict, dataclass, fields, replace

from .limits import limits

REFINEMENTS = ("uniform", "adaptive")
FACES = ("quads", "transition", "triangles")
BASES = ("auto", "min")
FEATURES = ("auto", "none")
TOPOLOGIES = ("auto", "late", "base")
COMPONENTS = ("apart", "joined")
SYMMETRIES = ("none", "auto", "x", "y", "z")
EFFORTS = ("quick", "normal", "thorough")
SYMMETRY_SIDES = ("positive", "negative", "average")

# How an option is called where the user typed it; the command line's name is the one people look up.
OPTION_NAMES = {
    "vertices": "--vertices",
    "error": "--error",
    "levels": "--levels",
    "refinement": "--adaptive",
    "faces": "--faces",
    "base": "--base-quads",
    "topology": "--topology",
    "components": "--components",
    "remove_noise": "--remove-noise",
    "stretch_threshold": "--stretch",
    "semi_regular": "--semi-regular",
    "features": "--features",
    "symmetry": "--symmetry",
    "symmetry_side": "--symmetry-side",
    "effort": "--effort",
    "drop_components": "--drop-components",
    "density": "--density",
    "strict": "--strict",
    "plan": "--plan",
    "seed": "--seed",
    "threads": "--threads",
}


class SettingsError(ValueError):
    """A setting out of its bounds; the message names the option and the bounds."""


@dataclass(frozen=True)
class RemeshSettings:
    vertices: int = 0  # hard upper bound on the final mesh's vertices; 0 = none
    error: float = 0.0  # stop at this l2, relative to the bounding-box diagonal; 0 = none
    levels: int = -1  # uniform: exactly, adaptive: at most so many regular levels; -1 = as many as are needed
    refinement: str = "uniform"
    faces: str = "quads"  # what becomes of leaves with hanging nodes (adaptive)
    base: object = "auto"  # "auto", "min" or a number of base quads
    topology: str = "auto"  # "late": handles, boundaries and tubes open on finer levels; "base": in the base; "auto": late with a minimal base
    components: str = "apart"  # "joined": one base for all components, which part on finer levels (with late topology)
    remove_noise: float = 0.0  # handles and tunnels with shorter loops, as a fraction of the bounding-box diagonal, are closed for good
    stretch_threshold: float = 4.0  # above it irregular operations grow skin
    semi_regular: bool = False  # no irregular operations
    features: object = "auto"  # sharp edges: "auto" where flat or smooth faces meet at them, "none", or the angle in degrees from which they are kept
    symmetry: object = "none"  # the mesh is its own mirror image: "auto" in a plane that is found, "x", "y", "z" across that axis, or a plane's normal and offset
    symmetry_side: str = "positive"  # what is mirrored: the surface on the side that the normal points to, on the other ("negative"), or their "average"
    effort: str = "normal"  # what is tried where the first mesh is poor: nothing ("quick"), other bases and smaller quads, or more of both ("thorough")
    drop_components: float = 0.0  # components below this fraction of the area are removed
    density: str = ""  # name of the attribute by whose values, in 0..1, quads are smaller or larger; empty: none
    strict: bool = False  # refuse input that needs repair; a poor result is an error
    plan: str = ""  # JSON text of a plan (see core/plans.py) that decides base and irregular operations; empty: they are searched for
    seed: int = 1
    threads: int = 0  # 0 = all cores; never changes the result

    def validate(self):
        """Returns self; raises SettingsError naming the first option that is out of bounds."""
        bounds = limits()
        _whole("vertices", self.vertices, 0, bounds.most_vertices, "0 for no bound, or")
        _fraction("error", self.error, bounds.end_of_error, "the bounding-box diagonal")
        _whole("levels", self.levels, -1, bounds.most_levels, "-1 for as many as are needed, or")
        _choice("refinement", self.refinement, REFINEMENTS)
        _choice("faces", self.faces, FACES)
        if isinstance(self.base, str):
            if self.base not in BASES:
                raise SettingsError(f"--base-quads must be auto, min or a whole number from 1 to {bounds.most_base_quads}, not {self.base!r}")
        else:
            _whole("base", self.base, 1, bounds.most_base_quads, "auto, min or")
        _choice("topology", self.topology, TOPOLOGIES)
        _choice("components", self.components, COMPONENTS)
        _fraction("remove_noise", self.remove_noise, bounds.end_of_remove_noise, "the bounding-box diagonal")
        least, most = bounds.least_stretch_threshold, bounds.most_stretch_threshold
        _number("stretch_threshold", self.stretch_threshold, lambda value: least <= value <= most, f"from {least:.7g} to {most:.7g}")
        if self.features not in FEATURES:
            least, most = bounds.least_feature_angle, bounds.most_feature_angle
            _number("features", self.features, lambda value: least <= value <= most, f"auto, none or an angle from {least:g} to {most:g} degrees")
        if isinstance(self.symmetry, str):
            _choice("symmetry", self.symmetry, SYMMETRIES)
        else:
            _plane("symmetry", self.symmetry)
        _choice("symmetry_side", self.symmetry_side, SYMMETRY_SIDES)
        _choice("effort", self.effort, EFFORTS)
        _fraction("drop_components", self.drop_components, bounds.end_of_drop_components, "the whole area")
        if not isinstance(self.density, str):
            raise SettingsError(f"--density must be the name of an attribute, not {self.density!r}")
        if not isinstance(self.plan, str):
            raise SettingsError("--plan must be a plan's text")
        _whole("seed", self.seed, 0, bounds.most_seed)
        _whole("threads", self.threads, 0, bounds.most_threads, "0 for all cores, or")
        return self

    def native(self):
        """The dictionary that the native module takes."""
        return asdict(self)

    def reported(self):
        """What the report states: everything that can change the result but the plan, which has a file of its own."""
        values = asdict(self)
        del values["threads"], values["plan"]
        if not self.density:
            del values["density"]
        if self.symmetry == "none":
            del values["symmetry"], values["symmetry_side"]
        return values

    def identity(self):
        """reported(), and which plan it is if there is one: what a resumed run compares."""
        return {**self.reported(), **({"plan": hashlib.sha256(self.plan.encode()).hexdigest()} if self.plan else {})}


PRESETS = {
    "draft": ("Draft", "A light mesh for blocking and tests", RemeshSettings(vertices=5000, effort="quick")),
    "standard": ("Standard", "A uniform mesh for sculpting and retouching", RemeshSettings(vertices=20000)),
    "game": ("Game", "Few vertices, where the shape needs them", RemeshSettings(vertices=8000, refinement="adaptive")),
    "film": ("Film", "A dense, even mesh to be subdivided and displaced", RemeshSettings(vertices=80000, effort="thorough")),
    "sculpt": ("Sculpt", "A coarse base with four levels above it, as Multires has them", RemeshSettings(vertices=50000, levels=4, semi_regular=True)),
    "archive": ("Scan Archive", "As few vertices as keep to the scan within a bound that is not seen", RemeshSettings(vertices=0, error=5e-5, refinement="adaptive")),
    "print": ("3D Print", "Fine, and without the specks and tunnels that scanners see", RemeshSettings(vertices=100000, drop_components=0.001, remove_noise=0.005)),
}

_WORDS = {
    "vertices": lambda value: f"{value:,} vertices" if value else "as many vertices as the source at most",
    "error": lambda value: f"error {value:g}",
    "levels": lambda value: f"{value} levels",
    "refinement": str,
    "effort": lambda value: f"{value} effort",
    "semi_regular": lambda value: "semi-regular",
    "drop_components": lambda value: f"components below {value:.1%} dropped",
    "remove_noise": lambda value: f"tunnels below {value:.1%} closed",
}


def preset_summary(name):
    """What a preset sets, in words."""
    settings, first = preset(name), RemeshSettings()
    changed = [field.name for field in fields(RemeshSettings) if getattr(settings, field.name) != getattr(first, field.name)]
    return ", ".join(_WORDS[field](getattr(settings, field)) for field in dict.fromkeys(["vertices", *changed]))


def preset(name):
    """The settings of a preset; raises SettingsError naming the presets there are."""
    if name not in PRESETS:
        raise SettingsError(f"there is no preset {name!r}; there are {', '.join(PRESETS)}")
    return PRESETS[name][2]


def from_mapping(values, base=RemeshSettings()):
    """Settings from a dictionary; unknown names are refused."""
    known = {field.name for field in fields(RemeshSettings)}
    for name in values:
        if name not in known:
            raise SettingsError(f"there is no setting {name!r}")
    return replace(base, **values).validate()


def _whole(name, value, least, most, prefix=""):
    bounds = f"{prefix + ' ' if prefix else ''}a whole number from {max(least, 0)} to {most}"
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise SettingsError(f"{OPTION_NAMES[name]} must be {bounds}, not {value!r}")


def _fraction(name, value, end, whole):
    _number(name, value, lambda number: 0 <= number < end, f"at least 0 and below {end:.7g} (a fraction of {whole})")


def _number(name, value, fits, bounds):
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value) or not fits(value):
        raise SettingsError(f"{OPTION_NAMES[name]} must be {bounds}, not {value!r}")


def _plane(name, value):
    numbers = isinstance(value, (tuple, list)) and len(value) == 4 and all(isinstance(n, (int, float)) and math.isfinite(n) for n in value)
    if not numbers or not any(value[:3]):
        raise SettingsError(f"{OPTION_NAMES[name]} must be one of {', '.join(SYMMETRIES)}, or a plane NX,NY,NZ,OFFSET, not {value!r}")


def _choice(name, value, choices):
    if value not in choices:
        raise SettingsError(f"{OPTION_NAMES[name]} must be one of {', '.join(choices)}, not {value!r}")
