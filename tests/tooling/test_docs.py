# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation: links lead somewhere, options exist, pages are in the site, and what is generated has everything."""

import os
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "scripts"), str(ROOT / "build/stage")]
import reference_pages  # noqa: E402
from hybrid_mesh.core import arguments  # noqa: E402

PAGES = sorted([*ROOT.glob("docs/**/*.md"), ROOT / "README.md", ROOT / "blend_samples/README.md", ROOT / "native/README.md", ROOT / "native/decoder/web/README.md"])
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
FLAG = re.compile(r"(?<![\w-])--[a-z][a-z-]+")
# Of programs that are not ours, on lines that name them, and of Blender, which starts the command line.
FOREIGN = {"blender": {"--background", "--python-exit-code", "--addons", "--python-expr", "--command"}, "openjd": {"--step", "--run-dependencies"}}


def anchors(text):
    """What a heading's link is called: its words in small letters, with hyphens between."""
    headings = re.findall(r"^#+ (.+)$", re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def broken_links(page, text):
    wrong = []
    for link in LINK.findall(text):
        if re.match(r"https?:", link):
            continue
        path, _, anchor = link.partition("#")
        target = Path(os.path.normpath(page.parent / path)) if path else page
        if not target.exists() or anchor and anchor not in anchors(target.read_text("utf-8")):
            wrong.append(link)
    return wrong


def known_flags():
    """The options of the command line and of the scripts."""
    flags = {flag for command in reference_pages.commands(arguments.parser()).values() for action in command._actions for flag in action.option_strings}
    flags |= {flag for action in arguments.parser()._actions for flag in action.option_strings}
    for path in [*ROOT.glob("scripts/*"), *ROOT.glob("tests/benchmarks/*.py")]:
        if path.is_file():
            flags |= set(FLAG.findall(path.read_text("utf-8")))
    return flags


def unknown_flags(text):
    wrong = []
    for line in text.splitlines():
        allowed = {flag for program, flags in FOREIGN.items() if program in line for flag in flags}
        wrong += [flag for flag in FLAG.findall(line) if flag not in KNOWN | allowed]
    return wrong


KNOWN = known_flags()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere_and_options_exist(page):
    text = page.read_text("utf-8")
    assert (broken_links(page, text), unknown_flags(text)) == ([], [])


def test_the_first_screen_loads_at_once():
    pictures = [link for link in LINK.findall((ROOT / "README.md").read_text("utf-8")) if link.endswith(".png")]
    assert pictures and all((ROOT / link).stat().st_size < 200_000 for link in pictures)


def test_what_is_broken_is_seen():
    page = ROOT / "docs/index.md"
    assert broken_links(page, "[a](gallery.md) [b](none.md) [c](gallery.md#levels) ![d](gallery.md#no-such) [e](#where-to-read-on)") == ["none.md", "gallery.md#no-such"]
    assert unknown_flags("`--vertices 3 --vertexes 4` and blender --background --foreground") == ["--vertexes", "--foreground"]
    assert unknown_flags("--step 3") == ["--step"]


def test_every_page_is_in_the_site():
    listed = set(re.findall(r": (\S+\.md)$", (ROOT / "mkdocs.yml").read_text("utf-8"), re.MULTILINE))
    generated = {"docs/reference/options.md", "docs/reference/python_module.md"}
    assert generated < listed
    assert {str(page.relative_to(ROOT)) for page in PAGES} - {"README.md"} | generated | {"native/decoder/FORMAT.md"} == listed


def test_every_option_is_in_the_list():
    page = reference_pages.options_page(arguments.parser())
    for name, command in reference_pages.commands(arguments.parser()).items():
        if name in arguments.LATER_COMMANDS:
            continue
        section = page.partition(f"\n## {name}\n")[2].partition("\n## ")[0]
        for action in command._actions:
            if action.dest != "help":
                shown = action.option_strings[-1] if action.option_strings else action.metavar
                assert f"| `{shown}" in section and action.help, f"{name} {shown}"


def test_every_public_function_of_the_module_is_in_the_list():
    from hybrid_mesh import _native

    page = reference_pages.module_page(_native)
    for owner in (_native, _native.Hierarchy, _native.Job):
        for name in vars(owner):
            if not name.startswith("_") and not isinstance(vars(owner)[name], type):
                assert re.search(rf"^(`{name}\b|## {name}$|\| `{name}`)", page, re.MULTILINE), f"{owner.__name__}.{name} has no docstring"


def test_the_tested_platforms_are_named_alike():
    """What the manifest offers, and what scripts/test runs, is what the page of limits has."""
    limits = (ROOT / "docs/limits.md").read_text("utf-8")
    assert re.search(r'^platforms = \["linux-x64"\]$', (ROOT / "addon/blender_manifest.toml").read_text("utf-8"), re.MULTILINE) and "Linux on x86-64 processors alone" in limits
    runners = re.findall(r"^ *run (blender|bpy-[\d.]+) ", (ROOT / "scripts/test").read_text("utf-8"), re.MULTILINE)
    assert [name for name in runners if name.replace("-", "` ") not in limits and name != "blender"] == [] and runners
