# SPDX-License-Identifier: GPL-3.0-or-later
"""The viewer's page in a headless browser, as its user has it."""

import base64
import json
import time

import numpy as np

OPTIONS = [
    "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars", "--window-size=1200,800", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]  # fmt: skip


def start_browser():
    """Debian's Chromium, which draws without a graphics card."""
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service

    options = Options()
    options.binary_location = "/usr/bin/chromium"
    for option in OPTIONS:
        options.add_argument(option)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
    browser.set_script_timeout(60)
    return browser


class ViewerPage:
    def __init__(self, browser, address):
        self.browser = browser
        browser.get(address)

    def run(self, script, *arguments):
        return self.browser.execute_script(script, *arguments)

    def wait(self, condition, seconds=60):
        """Until a JavaScript expression is true."""
        end = time.monotonic() + seconds
        while not self.run(f"return Boolean({condition})"):
            assert time.monotonic() < end, f"{condition} does not come true; the page says {self.message()!r}, {self.browser.get_log('browser')}"
            time.sleep(0.03)

    def find(self, selector):
        return self.browser.find_element("css selector", selector)

    def message(self):
        return self.find("#message span").text

    def wait_for(self, name):
        """Until a stream is shown, whole, and all is known of its levels."""
        self.wait(f"viewer.stream?.name === {json.dumps(name)} && viewer.stream.levels.filter(Boolean).length === viewer.shown.depth + 1 && !viewer.decoding")

    def choose(self, name):
        """One of the streams in the page, anew if it is shown already."""
        before = self.run("return viewer.stream?.number ?? 0")
        self.run("const list = document.getElementById('streams'); list.value = arguments[0]; list.dispatchEvent(new Event('change'))", name)
        self.wait(f"viewer.stream?.number > {before}")
        self.wait_for(name)

    def pick(self, path):
        """A file, by the button."""
        self.find("#file").send_keys(str(path))

    def shown(self):
        return self.run("return {bytes: viewer.shown.bytes, level: viewer.shown.level}")

    def want(self, most_bytes, level):
        self.browser.execute_async_script("viewer.want({bytes: arguments[0], level: arguments[1]}).then(arguments[2])", most_bytes, level)
        assert self.shown() == {"bytes": most_bytes, "level": level}

    def drop(self, name, content):
        """A file, on the page."""
        script = """
            const dropped = new DataTransfer();
            dropped.items.add(new File([Uint8Array.from(atob(arguments[1]), (letter) => letter.charCodeAt(0))], arguments[0]));
            document.body.dispatchEvent(new DragEvent("drop", {dataTransfer: dropped, bubbles: true, cancelable: true}));
            """
        self.run(script, name, base64.b64encode(content).decode())

    def touch(self, kind, *places):
        points = [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(places)]
        self.browser.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    def object(self):
        return self.browser.execute_async_script("viewer.object().then(arguments[0])")

    def mesh(self):
        """What is shown, as it would be saved: every number is written so that it is read as the same bits."""
        rows = [line.split() for line in self.object().splitlines()]
        points = np.array([[float(x) for x in row[1:]] for row in rows if row[0] == "v"])
        faces = [[int(i) - 1 for i in row[1:]] for row in rows if row[0] == "f"]
        return points, faces

    def drawn(self):
        """How much of the picture the surface takes, and its mean colour."""
        return self.run(
            """
            const {gl, canvas, look} = viewer.renderer;
            viewer.renderer.draw(Infinity);
            const pixels = new Uint8Array(4 * canvas.width * canvas.height);
            gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
            let covered = 0;
            const color = [0, 0, 0];
            for (let i = 0; i < pixels.length; i += 4)
              if (pixels[i + 3] === 255 && ++covered) for (let k = 0; k < 3; ++k) color[k] += pixels[i + k];
            return {covered: covered / (pixels.length / 4), color: color.map((sum) => sum / covered)};
            """
        )
