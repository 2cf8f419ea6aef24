# SPDX-License-Identifier: GPL-3.0-or-later
"""The page that scripts/viewer makes, in a headless Chromium, against the library: what its WebAssembly decodes bit for bit, and what its user can do."""

import re
import shutil
import subprocess
import threading
import time
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np
import pytest
from hybrid_mesh import _native
from shapes import bent_sheet, sphere, torus
from viewer_page import ViewerPage, start_browser

ROOT = Path(__file__).resolve().parents[2]
STREAMS = ["uniform.hmesh", "adaptive.hmesh", "operations.hmesh"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The streams, and viewer.html with all of them in it."""
    missing = [name for name in ("chromium", "chromedriver", "emcc") if not shutil.which(name)]
    if missing:
        pytest.skip(f"not installed: {', '.join(missing)}")
    pytest.importorskip("selenium", reason="python3-selenium is not installed")
    folder = tmp_path_factory.mktemp("viewer")
    _native.remesh(*torus(), {"vertices": 2000}).hierarchy.save_stream(folder / "uniform.hmesh", exact=True)
    _native.remesh(*bent_sheet(), {"vertices": 1500, "refinement": "adaptive"}).hierarchy.save_stream(folder / "adaptive.hmesh", exact=True)
    ball = _native.remesh(*sphere(), {"vertices": 2000}).hierarchy
    ball.add_cubes(ball.level("N1")["quad"][:1], height=2)
    ball.save_stream(folder / "operations.hmesh", exact=True)
    ball.save(folder / "container.hmesh")
    subprocess.run([ROOT / "scripts/viewer", folder / "viewer.html", *(folder / name for name in STREAMS)], check=True)
    return folder


@pytest.fixture(scope="module")
def browser(folder):
    started = start_browser()
    yield started
    started.quit()


@pytest.fixture(scope="module")
def page(browser, folder):
    page = ViewerPage(browser, (folder / "viewer.html").as_uri())
    page.wait_for(STREAMS[0])
    return page


def library_levels(path, most_bytes=0):
    loaded = _native.load_hierarchy(path, most_bytes=most_bytes)
    return [loaded.level(name) for name in loaded.level_names if name.startswith("N")]


def faces_of(mesh):
    return [part.tolist() for part in np.split(np.asarray(mesh["indices"]), np.asarray(mesh["offsets"])[1:-1])]


def genus(mesh):
    """Of an oriented manifold of one component, with its number of boundary loops."""
    sides = {(a, b) for face in faces_of(mesh) for a, b in zip(face, face[1:] + face[:1])}
    rim = {a: b for b, a in sides if (a, b) not in sides}
    loops = 0
    while rim:
        loops += 1
        at = next(iter(rim))
        while at in rim:
            at = rim.pop(at)
    edges = len({frozenset(side) for side in sides})
    return 1 - (loops + len(mesh["points"]) - edges + len(mesh["offsets"]) - 1) // 2, loops


def test_nothing_is_loaded_from_elsewhere(folder):
    text = (folder / "viewer.html").read_text()
    assert "{{" not in text
    assert [name for name in re.findall(r"""(?:src|href)=["']?([^"'\s>]+)""", text) if not name.startswith("data:")] == []
    assert re.findall(r"url\(|@import|importScripts|https?://", text) == []


@pytest.mark.parametrize("name", STREAMS)
def test_it_decodes_what_the_library_decodes(page, folder, name):
    page.choose(name)
    size = (folder / name).stat().st_size
    for most_bytes in (page.run("return viewer.stream.firstBytes"), size // 9, size // 2, size):
        levels = library_levels(folder / name, most_bytes)
        for level in {0, len(levels) // 2, len(levels) - 1}:
            page.want(most_bytes, level)
            points, faces = page.mesh()
            assert points.tobytes() == np.asarray(levels[level]["points"]).tobytes(), (most_bytes, level)
            assert faces == faces_of(levels[level])


@pytest.mark.parametrize("name", STREAMS)
def test_it_tells_of_every_level(page, folder, name):
    page.choose(name)
    rows = [[int(cell.replace(",", "")) for cell in row.text.split()] for row in page.browser.find_elements("css selector", "#levels tbody tr")]
    expected = [[level, len(mesh["offsets"]) - 1, 1, *genus(mesh)] for level, mesh in enumerate(library_levels(folder / name))]
    assert rows == expected
    assert page.find("#vertices").text.replace(",", "") == str(page.run("return viewer.shown.points.length / 3"))


def test_the_error_is_how_far_vertices_are_off(page, folder):
    page.choose("uniform.hmesh")
    size = (folder / "uniform.hmesh").stat().st_size
    whole, part = (library_levels(folder / "uniform.hmesh", most_bytes)[-1]["points"] for most_bytes in (size, size // 5))
    page.want(size // 5, len(library_levels(folder / "uniform.hmesh")) - 1)
    off = np.sqrt(((part - whole) ** 2).sum(axis=1).mean()) / np.linalg.norm(np.ptp(whole, axis=0))
    assert off > 0 and page.run("return viewer.shown.off") == pytest.approx(off, rel=1e-9)
    assert float(page.find("#off").text.split()[0]) == pytest.approx(100 * off, rel=0.06)


def test_sliders_show_other_bytes_and_levels(page, folder):
    from selenium.webdriver.common.keys import Keys

    page.choose("uniform.hmesh")
    path = folder / "uniform.hmesh"
    depth = len(library_levels(path)) - 1
    assert page.shown() == {"bytes": path.stat().st_size, "level": depth}
    page.find("#bytes").send_keys(Keys.HOME)
    page.wait("viewer.shown.bytes === viewer.stream.firstBytes")
    # The fewest bytes that are a mesh.
    fewest = page.shown()["bytes"]
    library_levels(path, fewest)
    with pytest.raises(_native.CorruptStream):
        library_levels(path, fewest - 1)
    page.find("#bytes").send_keys(Keys.RIGHT)
    page.wait(f"viewer.shown.bytes > {fewest} || document.getElementById('bytes').value === '1'")
    page.find("#bytes").send_keys(Keys.END)
    page.wait("viewer.shown.bytes === viewer.stream.size")
    page.find("#level").send_keys(Keys.LEFT)
    page.wait(f"viewer.shown.level === {depth - 1}")
    assert f"{depth - 1} of {depth}" in page.find("#timeline").text
    page.find("#levels tbody tr").click()
    page.wait("viewer.shown.level === 0")


def test_play_goes_on_to_all_bytes(page):
    page.choose("uniform.hmesh")
    page.run("window.seen = []; const show = viewer.show; viewer.show = (mesh) => { seen.push(mesh.bytes); show.call(viewer, mesh); }")
    page.run("viewer.want({bytes: viewer.stream.bytesAt(0.93)})")
    page.find("#play").click()
    page.wait("seen.at(-1) === viewer.stream.size && !viewer.playing")
    seen = page.run("delete viewer.show; return seen")
    assert len(seen) > 3 and seen == sorted(seen)


def test_the_picture_shows_what_is_wanted(page):
    page.choose("uniform.hmesh")
    plain = page.drawn()
    assert 0.1 < plain["covered"] < 0.7
    page.find("#lines").click()
    without_lines = page.drawn()
    assert sum(without_lines["color"]) > sum(plain["color"]) + 3  # lines are dark
    page.find("#palette button[value=shape]").click()
    shape = page.drawn()
    assert page.find("#legend").is_displayed() and "Jacobian" in page.find("#legend").text
    assert shape["color"][1] > shape["color"][0] + 10  # squares are green and blue
    page.find("#palette button[value='']").click()
    page.find("#shading button[value=flat]").click()
    assert page.drawn()["color"] != without_lines["color"]
    page.find("#shading button[value=smooth]").click()
    page.find("#lines").click()
    assert page.drawn() == plain


def test_mouse_and_wheel_move_the_view(page):
    from selenium.webdriver.common.action_chains import ActionChains

    page.choose("uniform.hmesh")
    before, camera = page.drawn(), "return [viewer.camera.yaw, viewer.camera.pitch, viewer.camera.zoom]"
    yaw, pitch, zoom = page.run(camera)
    ActionChains(page.browser).move_to_element_with_offset(page.find("#canvas"), -200, -60).click_and_hold().move_by_offset(60, 25).release().perform()
    turned = page.run(camera)
    assert turned[0] < yaw and turned[1] > pitch and turned[2] == zoom
    page.run("document.getElementById('canvas').dispatchEvent(new WheelEvent('wheel', {deltaY: -300, cancelable: true}))")
    assert page.run(camera)[2] > zoom and page.drawn()["covered"] > before["covered"]
    ActionChains(page.browser).double_click(page.find("#canvas")).perform()
    assert page.run(camera) == [yaw, pitch, zoom] and page.drawn() == before
    page.touch("touchStart", (300, 300), (400, 300))
    page.touch("touchMove", (250, 300), (450, 300))
    page.touch("touchEnd")
    page.wait(f"viewer.camera.zoom > {1.5 * zoom}")


def test_what_is_shown_is_saved(page, folder, tmp_path):
    page.choose("adaptive.hmesh")
    page.want((folder / "adaptive.hmesh").stat().st_size // 3, 1)
    page.browser.execute_cdp_cmd("Page.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(tmp_path)})
    page.find("#save").click()
    for _ in range(500):
        if saved := list(tmp_path.glob("*.obj")):
            break
        time.sleep(0.02)
    assert saved[0].name.startswith("adaptive.") and saved[0].read_text() == page.object()


def test_bad_files_are_named_in_a_line_and_the_page_goes_on(page, folder, tmp_path):
    page.choose("adaptive.hmesh")
    whole = (folder / "uniform.hmesh").read_bytes()
    bad = {
        "empty.hmesh": (b"", "empty"),
        "foreign.ply": (b"ply\n" + bytes(3000), "starts with other bytes"),
        "short.hmesh": (whole[:20], "ends before its base does"),
        "later.hmesh": (b"HMw\x02" + whole[4:], "newer"),
        "noise.hmesh": (whole[:4] + bytes(range(255, 55, -1)), "not a stream that can be shown: "),
        "container.hmesh": ((folder / "container.hmesh").read_bytes(), "container"),
    }
    shown = page.shown()
    for name, (content, words) in bad.items():
        (tmp_path / name).write_bytes(content)
        page.pick(tmp_path / name)
        page.wait(f"document.getElementById('message').textContent.includes('{name}')")
        line = page.message().removeprefix(f"{name}: ")
        assert words in line and "\n" not in line
        assert page.run("return viewer.stream.name") == "adaptive.hmesh" and page.shown() == shown
    page.want(shown["bytes"] // 2, 1)
    page.drop("good.hmesh", whole[: len(whole) // 2])
    page.wait_for("good.hmesh")
    assert page.message() == "" and page.shown()["bytes"] == len(whole) // 2


def test_a_decoder_that_breaks_is_replaced(page, folder):
    """As by a trap of the program, or a stream that takes for ever."""
    page.choose("uniform.hmesh")
    before = page.shown()
    page.run("viewer.client.worker.postMessage({ticket: 0, kind: 'unheard of'}); viewer.want({level: 0})")
    page.wait("!document.getElementById('message').hidden && !viewer.decoding")
    page.want(before["bytes"] // 2, 1)
    assert page.mesh()[0].tobytes() == np.asarray(library_levels(folder / "uniform.hmesh", before["bytes"] // 2)[1]["points"]).tobytes()


class Pieces(BaseHTTPRequestHandler):
    """The folder's files; of a stream the second half once it is asked for."""

    def __init__(self, folder, go_on, *arguments):
        self.folder, self.go_on = folder, go_on
        super().__init__(*arguments)

    def do_GET(self):
        path = self.folder / self.path.split("?")[0].lstrip("/")
        if not path.is_file():
            self.send_error(404)
            return
        content = path.read_bytes()
        self.send_response(200)
        self.send_header("Content-Type", "text/html" if path.suffix == ".html" else "application/octet-stream")
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        half = len(content) // 2 if path.suffix == ".hmesh" else len(content)
        self.wfile.write(content[:half])
        self.wfile.flush()
        if half < len(content) and self.go_on.wait(60):
            self.wfile.write(content[half:])

    def log_message(self, *_):
        pass


def test_a_stream_beside_the_page_is_shown_as_it_comes(browser, folder):
    go_on = threading.Event()
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Pieces, folder, go_on))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        address = f"http://127.0.0.1:{server.server_port}/viewer.html"
        size = (folder / "operations.hmesh").stat().st_size
        page = ViewerPage(browser, f"{address}?stream=operations.hmesh")
        page.wait("viewer.shown")
        assert page.shown()["bytes"] == size // 2
        go_on.set()
        page.wait(f"viewer.shown.bytes === {size}")
        page = ViewerPage(browser, f"{address}?stream=nowhere.hmesh")
        page.wait("document.getElementById('message').textContent.includes('404')")
        assert "nowhere.hmesh" in page.message()
        page.choose("adaptive.hmesh")
    finally:
        go_on.set()
        server.shutdown()
        server.server_close()
