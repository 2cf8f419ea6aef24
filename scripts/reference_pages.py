# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages of the documentation that are made of the program itself: reference_pages.py STAGE FOLDER

options.md has every command and option of the command line, of its parser; python_module.md every function and class of the compiled module, of its docstrings.
"""

import argparse
import inspect
import re
import sys
from pathlib import Path


def commands(parser):
    """The commands of a parser by name, in its order."""
    return next(action for action in parser._actions if isinstance(action, argparse._SubParsersAction)).choices


def cell(text):
    return " ".join((text or "").replace("%%", "%").split()).replace("|", "\\|")


def option_name(action):
    metavar = action.metavar or (None if action.nargs == 0 else "|".join(action.choices) if action.choices else action.dest.upper())
    if not action.option_strings:
        return f"`{metavar}`" + ("..." if action.nargs == "+" else "")
    return f"`{action.option_strings[-1]}{' ' + metavar if metavar and action.nargs != 0 else ''}`".replace("|", "\\|")


def options_page(parser):
    lines = ["# All options", "", "What `hybrid-mesh COMMAND --help` says.", ""]
    for name, command in commands(parser).items():
        if len(command._actions) < 2:
            continue  # one that comes with a later version
        lines += [f"## {name}", ""]
        for group in command._action_groups:
            shown = [action for action in group._group_actions if action.dest != "help"]
            if shown:
                heading = group.title if group.title not in ("positional arguments", "options") else ""
                lines += ([f"### {heading.capitalize()}", ""] if heading else []) + ([cell(group.description).capitalize() + ".", ""] if group.description else [])
                lines += ["| | |", "|---|---|", *(f"| {option_name(action)} | {cell(action.help)} |" for action in shown), ""]
    return "\n".join(lines)


def documented(owner):
    """The public functions, methods and properties of a module or class that have a docstring: (name, signature, text)."""
    for name, value in vars(owner).items():
        if name.startswith("_") and name != "__init__" or inspect.isclass(value) or inspect.ismodule(value):
            continue
        text = (getattr(value, "__doc__", None) or "").strip()
        if text and (callable(value) or isinstance(value, property)):
            # What pybind11 puts first is the signature; several overloads have one each.
            first, _, rest = text.partition("\n")
            is_signature = first.startswith(f"{name}(")
            yield name, first if is_signature else name, " ".join((rest if is_signature else text).split())


def tidy(signature):
    signature = re.sub(r"hybrid_mesh\._native\.|collections\.abc\.|typing\.", "", signature)
    return re.sub(r"\(self: \w+(, )?", "(", signature)


def module_page(module):
    lines = ["# The Python module", "", "`hybrid_mesh._native`, from Blender 4.2 on `bl_ext.user_default.hybrid_mesh._native`.", "", "## Functions", ""]

    def entries(owner):
        for name, signature, text in documented(owner):
            yield from (f"`{tidy(signature)}`", "", f":   {text}" if text else "", "")

    lines += entries(module)
    for name, value in vars(module).items():
        if inspect.isclass(value) and not issubclass(value, BaseException):
            lines += [f"## {name}", "", " ".join((value.__doc__ or "").split()), "", *entries(value)]
    errors = [value for value in vars(module).values() if inspect.isclass(value) and issubclass(value, BaseException)]
    lines += ["## Errors", "", "| | |", "|---|---|", *(f"| `{error.__name__}` | {cell(error.__doc__)} |" for error in errors), ""]
    return "\n".join(lines)


def main():
    stage, folder = sys.argv[1], Path(sys.argv[2])
    sys.path.insert(0, stage)
    from hybrid_mesh import _native
    from hybrid_mesh.core import arguments

    folder.mkdir(parents=True, exist_ok=True)
    (folder / "options.md").write_text(options_page(arguments.parser()), encoding="utf-8")
    (folder / "python_module.md").write_text(module_page(_native), encoding="utf-8")


if __name__ == "__main__":
    main()
