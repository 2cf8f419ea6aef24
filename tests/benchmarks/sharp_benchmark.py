# SPDX-License-Identifier: GPL-3.0-or-later
"""Remeshes machine parts with sharp edges and prints a row a tool: ours, Blender's QuadriFlow that preserves sharp edges, and Instant Meshes with a
crease angle. All are measured in the same way, against the file as it was read, its sharp edges by the angle between its faces. Besides what is in the
folder there is a cube of twelve triangles. A tool that makes no mesh has a row that says why. The rows are also written as build/bench/sharp.csv."""

import sys
from pathlib import Path

import bench
import numpy as np
import sharp_edges
import tools
from bench import native
from quality import measure

PARTS = ["fandisk", "gear", "cylinder", "plate_holes", "angle_block", "octagonal_pocket", "featuretype", "cube"]  # where no folder is given
OURS = "hybrid-mesh"
NAMES = {OURS: "Hybrid Mesh", "quadriflow": "QuadriFlow", "instant-meshes": "Instant Meshes"}
CUBE = tools.ROOT / "build/bench/cube.ply"
# heading, key, format
FIGURES = [
    ("vertices", "vertices", "{:d}"),
    ("L2", "l2", "{:.2e}"),
    ("Hausdorff", "hausdorff", "{:.2e}"),
    ("missing", "missing", "{:.2e}"),
    ("mean", "missing_mean", "{:.2e}"),
    ("false", "false", "{:.2e}"),
    ("mean", "false_mean", "{:.2e}"),
    ("corners", "corners_kept", "{:d}"),
    ("angle", "angle_error", "{:.2f}"),
    ("SJ p05", "sj_p05", "{:.3f}"),
    ("SJ med.", "sj_median", "{:.3f}"),
    ("inv. %", "inverted_percent", "{:.3f}"),
    ("pieces", "pieces", "{:d}"),
    ("valid", "valid", "{}"),
    ("CPU s", "cpu_seconds", "{:.1f}"),
]
NAME_WIDTH, TOOL_WIDTH, WIDTH = 18, 15, 10


def write_cube():
    """The file of a cube of twelve triangles."""
    points = np.array([[k & 1, k >> 1 & 1, k >> 2] for k in range(8)], float)
    squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    faces = [corners for a, b, c, d in squares for corners in ([a, b, c], [a, c, d])]
    CUBE.parent.mkdir(parents=True, exist_ok=True)
    native.write_mesh(CUBE, points, np.arange(0, 37, 3), np.array(faces, np.int32).ravel())
    return CUBE


def models_of(folder):
    """The meshes of a folder, or those of PARTS that are in the default one or its folder `mechanical`, and the cube."""
    wanted = None
    if folder is None:
        folder, wanted = bench.default_folder(), set(PARTS)
    folders = [folder] if wanted is None else [folder / "mechanical", folder]
    paths = {}
    for path in [path for one in folders if one.is_dir() for path in bench.meshes_in(one)] + [write_cube()]:
        if wanted is None or path.stem in wanted:
            paths.setdefault(path.stem, path)
    order = PARTS if wanted else sorted(paths)
    return [paths[name] for name in order if name in paths]


def why_invalid(model, mesh):
    """What is wrong with a mesh as one of a model's surface, in a word; `yes` if nothing is."""
    made, wanted = native.topology(*mesh), native.topology(*model.triangles)
    if made["nonmanifold_edges"] or made["nonmanifold_vertices"]:
        return "manifold"
    if made["misoriented_edges"]:
        return "oriented"
    if any(made[key] != wanted[key] for key in ("components", "boundary_loops", "euler")):
        return "topology"
    return "yes" if (np.diff(mesh[1]) == 4).all() else "quads"


def figures_of(model, outcome):
    mesh = outcome.mesh
    if not np.isfinite(mesh[0]).all():
        raise tools.Failure("made points that are no numbers")
    row = measure(native, model.mesh, mesh)
    row.update(sharp_edges.measure(model.triangles, mesh))
    row.update(pieces=native.topology(*mesh)["components"], valid=why_invalid(model, mesh), cpu_seconds=outcome.cpu_seconds, seconds=outcome.seconds)
    return row


def run_tool(tool, model, arguments, options):
    """(outcome, its figures), or raises Failure."""
    if tool == OURS:
        outcome = tools.hybrid_mesh(native, model, arguments.vertices, options, arguments.timeout)
    else:
        outcome = tools.VERSUS[tool](model, arguments.vertices, sharp_angle=sharp_edges.ANGLE, timeout_s=arguments.timeout)
    try:
        return outcome, figures_of(model, outcome)
    except native.Error as error:
        raise tools.Failure(f"made what cannot be measured: {error}") from error


def load(path):
    try:
        return bench.load_model(path)
    except native.Error as error:
        raise tools.Failure(f"cannot be read: {error}") from error


def remarks(outcome):
    """What our own report says against the result."""
    features = outcome.report.get("features")
    said = [f"sharp edges are not kept: {features.get('reason', 'no reason')}"] if features and not features["kept"] else []
    if outcome.report and not features:
        said.append("no sharp edges were found")
    return said + [f"poor: {reason['text']}" for reason in outcome.report.get("verdict", {}).get("reasons", [])]


def text_of(key, pattern, row):
    value = row.get(key)
    if value is None:
        return "-"
    return pattern.format(value) + (f"/{row['corners']}" if key == "corners_kept" else "")


def print_row(name, tool, cells):
    print(name.ljust(NAME_WIDTH) + tool.ljust(TOOL_WIDTH) + "".join(cell.rjust(WIDTH) for cell in cells), flush=True)


def original_row(model):
    """Cells of what a model is itself."""
    topology = native.topology(*model.triangles)
    curves = sharp_edges.sharp_edges(model.triangles)
    known = {"vertices": topology["vertices"], "corners_kept": str(len(sharp_edges.corners(curves))), "pieces": topology["components"]}
    return [str(known.get(key, "")) for _, key, _ in FIGURES]


def parse(argv):
    parser = bench.parser("bench sharp", __doc__, "sharp.csv")
    parser.set_defaults(vertices=8000)
    known = ",".join(tools.VERSUS)
    parser.add_argument("--versus", metavar="TOOL,TOOL", default=known, help=f"of {known}, which both are by default; '' for none")
    parser.add_argument("--timeout", metavar="S", type=float, default=600, help="seconds until a tool is ended")
    drawn = "draw the results side by side, their sharp edges red, those of the model that are lost blue"
    parser.add_argument("--picture", metavar="FILE.png", type=Path, help=drawn)
    arguments, options = bench.parse(parser, argv, models_of)
    arguments.versus = [tool for tool in arguments.versus.split(",") if tool]
    unknown = set(arguments.versus) - set(tools.VERSUS)
    if unknown:
        parser.error(f"--versus knows {known}, not {', '.join(sorted(unknown))}")
    return arguments, options


def run_model(model, arguments, options):
    """Prints a model's rows and returns (records, remarks, tiles of a picture, whether ours is done)."""
    print_row(model.name, "(the model)", original_row(model))
    records, said, tiles, done = [], [], [], False
    for tool in [OURS, *arguments.versus]:
        made, failure = bench.attempt(run_tool, tool, model, arguments, options)
        record = {"model": model.name, "tool": tool}
        if made:
            outcome, row = made
            print_row("", NAMES[tool], [text_of(key, pattern, row) for _, key, pattern in FIGURES])
            record.update(row)
            said += [f"{model.name}, {NAMES[tool]}: {remark}" for remark in remarks(outcome)]
            text = f"{model.name}, {NAMES[tool]}\nmissing {row['missing']:.1e}, false {row['false']:.1e}"
            done = done or tool == OURS
        else:
            print_row("", NAMES[tool], [f"  FAILED: {failure}"])
            record["failure"] = failure
            text = f"{model.name}, {NAMES[tool]}\nfailed"
        tiles.append((text, model, outcome.mesh if made else None))
        records.append(record)
    return records, said, tiles, done


def draw(tiles, columns, picture):
    """Has Blender draw tiles of (text, model, mesh or None)."""
    arrays = {"texts": np.array([text for text, _, _ in tiles]), "columns": columns}
    for number, (_, model, mesh) in enumerate(tiles):
        parts = {"around": model.triangles[0]}
        if mesh is not None:
            curves, before = sharp_edges.sharp_edges(mesh), sharp_edges.sharp_edges(model.triangles)
            parts.update(zip(("points", "offsets", "indices"), mesh))
            parts.update(sharp=curves.points[curves.edges], lost=sharp_edges.lost_pieces(before, curves, sharp_edges.diagonal(model.triangles)))
        arrays.update({f"{number}.{name}": array for name, array in parts.items()})
    data = tools.ROOT / "build/bench/sharp_picture.npz"
    data.parent.mkdir(parents=True, exist_ok=True)
    np.savez(data, **arrays)
    picture.parent.mkdir(parents=True, exist_ok=True)
    script = tools.ROOT / "scripts/sharp_picture.py"
    ended = tools.run([*tools.BLENDER, script, "--", data, picture.resolve()])
    if ended.code != 0:
        raise tools.Failure(tools.last_complaint(ended.output))


def main(argv):
    arguments, options = parse(argv)
    print_row("model", "tool", [heading for heading, _, _ in FIGURES])
    records, said, tiles, all_done = [], [], [], True
    for path in arguments.paths:
        model, failure = bench.attempt(load, path)
        if model:
            more, remarked, drawn, done = run_model(model, arguments, options)
        else:
            print_row(path.stem, "(the model)", [f"  FAILED: {failure}"])
            more, remarked, drawn, done = [{"model": path.stem, "failure": failure}], [], [], False
        records += more
        said += remarked
        tiles += drawn
        all_done = all_done and done
        bench.write_csv(records, arguments.output)
    for line in said:
        print(line)
    print(f"rows in {arguments.output}")
    if arguments.picture:
        _, failure = bench.attempt(draw, tiles, 1 + len(arguments.versus), arguments.picture)
        print(f"picture: FAILED: {failure}" if failure else f"picture in {arguments.picture}")
        all_done = all_done and not failure
    return 0 if all_done else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
