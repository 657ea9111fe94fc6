"""Open a study's report in a real browser, work its slider and zoom, and look at what is shown.

    python3 tools/check_report.py DIR/report.html [SCREENSHOT.png]

Needs `chromium` and `chromedriver` (Debian: chromium, chromium-driver) and nothing beyond Python's
own library: chromedriver speaks the WebDriver protocol (W3C) over HTTP. Exit code 0 if all is well.
"""

import base64
import json
import pathlib
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
import zlib

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"  # what the protocol calls a reference to an element


class Browser:
    """A headless Chromium behind a chromedriver of our own."""

    def __init__(self, width, height, dark=False):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.driver = subprocess.Popen(
            ["chromedriver", f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        self.base = f"http://127.0.0.1:{port}"
        options = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu",
                   f"--window-size={width},{height}"]
        if dark:
            options.append("--force-dark-mode")
        # Windows have a least width, screens of phones are narrower.
        metrics = {"deviceMetrics": {"width": width, "height": height, "pixelRatio": 2, "touch": False}}
        capabilities = {
            "goog:chromeOptions": {"args": options} | ({"mobileEmulation": metrics} if width < 500 else {}),
            "goog:loggingPrefs": {"browser": "ALL"},
        }
        for attempt in range(50):
            try:
                session = self.call("POST", "/session", {"capabilities": {"alwaysMatch": capabilities}})
                break
            except urllib.error.URLError as error:
                if attempt == 49 or isinstance(error, urllib.error.HTTPError):
                    raise
                time.sleep(0.2)
        self.base += f"/session/{session['sessionId']}"

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, method=method)
        request.add_header("Content-Type", "application/json")
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.load(answer)["value"]

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def drag(self, element, start, end):
        """Drag with the mouse between offsets from the element's middle, in CSS pixels."""
        move = lambda at: {"type": "pointerMove", "duration": 50, "origin": element,
                           "x": round(at[0]), "y": round(at[1])}
        button = lambda kind: {"type": kind, "button": 0}
        steps = [move(start), button("pointerDown"), move(end), button("pointerUp")]
        self.call("POST", "/actions", {"actions": [
            {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": steps}]})

    def wheel(self, element, delta):
        self.call("POST", "/actions", {"actions": [{"type": "wheel", "id": "wheel", "actions": [
            {"type": "scroll", "origin": element, "x": 0, "y": 0, "deltaX": 0, "deltaY": delta}]}]})

    def screenshot(self):
        return base64.b64decode(self.call("GET", "/screenshot"))

    def close(self):
        try:
            self.call("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait()


def colours(png):
    """The number of different rows of an 8-bit PNG before its filters are undone, and of pixels' bytes:
    a blank picture has one or two of the former."""
    data, at = b"", 8
    while at < len(png):
        length = int.from_bytes(png[at:at + 4], "big")
        if png[at + 4:at + 8] == b"IHDR":
            width = int.from_bytes(png[at + 8:at + 12], "big")
            channels = {2: 3, 6: 4}[png[at + 17]]
        if png[at + 4:at + 8] == b"IDAT":
            data += png[at + 8:at + 8 + length]
        at += 12 + length
    rows = zlib.decompress(data)
    stride = 1 + width * channels
    return len({rows[i:i + stride] for i in range(0, len(rows), stride)})


def check(condition, what):
    if not condition:
        raise SystemExit(f"check_report: {what}")


STATE = """
const root = getComputedStyle(document.getElementById("pictures"));
const images = [...document.querySelectorAll("#pictures img")];
return {
  split: root.getPropertyValue("--split"),
  zoom: parseFloat(root.getPropertyValue("--zoom")),
  // Magnification and place as shares of the picture, whose widths may differ by parts of a pixel.
  transforms: [...new Set(images.map((image) => {
    const m = new DOMMatrix(getComputedStyle(image).transform);
    return [m.a, m.e / image.offsetWidth, m.f / image.offsetHeight].map((x) => x.toFixed(2)).join();
  }))].length,
  scale: new DOMMatrix(getComputedStyle(images[0]).transform).a,
  clips: [...new Set([...document.querySelectorAll(".over")].map((e) => getComputedStyle(e).clipPath))],
  loaded: images.every((image) => image.complete && image.naturalWidth > 0),
  views: document.querySelectorAll(".view").length,
  charts: document.querySelectorAll(".chart svg").length,
  wide: document.documentElement.scrollWidth - document.documentElement.clientWidth,
  outside: performance.getEntriesByType("resource").map((entry) => entry.name)
    .filter((name) => !name.startsWith("data:")),
};
"""


def visit(page, width, height, dark, screenshot):
    browser = Browser(width, height, dark)
    try:
        browser.call("POST", "/url", {"url": page})
        before = browser.run(STATE)
        check(before["loaded"], "not all pictures are there")
        check(before["charts"] >= 2, f"{before['charts']} charts")
        check(before["views"] >= 2, f"{before['views']} pictures")
        check(before["wide"] <= 0, f"the page is {before['wide']} pixels wider than a screen of {width}")
        check(before["outside"] == [], f"it asks for {before['outside']}")
        view = browser.call("POST", "/element", {"using": "css selector", "value": ".view"})
        browser.run("arguments[0].scrollIntoView({block: 'center'})", view)
        size = browser.run("const b = arguments[0].getBoundingClientRect(); return [b.width, b.height];", view)

        browser.drag(view, (0, 0), (0.25 * size[0], 0))
        split = browser.run(STATE)
        share = float(split["split"].rstrip("%"))
        check(abs(share - 75) < 2, f"a drag to three quarters moved the slider to {split['split']}")
        check(len(split["clips"]) == 1, f"pictures are cut at different places: {split['clips']}")

        browser.wheel(view, -300)
        zoomed = browser.run(STATE)
        check(zoomed["zoom"] > 1.3, f"the wheel magnified to {zoomed['zoom']}")
        check(abs(zoomed["scale"] - zoomed["zoom"]) < 1e-3, "the pictures do not follow the zoom")
        check(zoomed["transforms"] == 1, "the pictures do not move together")

        browser.run("const s = document.getElementById('split'); s.value = 20; s.dispatchEvent(new Event('input'));"
                    "const z = document.getElementById('zoom'); z.value = 0; z.dispatchEvent(new Event('input'));")
        again = browser.run(STATE)
        check(again["split"] == "20%" and again["zoom"] == 1, f"the controls lead to {again}")

        browser.run("scrollTo(0, 0)")
        top = browser.screenshot()
        check(colours(top) > 50, "the top of the page is blank")
        browser.run("arguments[0].scrollIntoView({block: 'center'})", view)
        picture = base64.b64decode(browser.call("GET", f"/element/{view[ELEMENT]}/screenshot"))
        check(colours(picture) > 10, "the pictures are blank")
        if screenshot:
            pathlib.Path(screenshot).write_bytes(top)
        errors = [entry["message"] for entry in browser.call("POST", "/se/log", {"type": "browser"})
                  if entry["level"] in ("SEVERE", "WARNING")]
        check(not errors, f"the console says {errors}")
    finally:
        browser.close()


def main():
    page = pathlib.Path(sys.argv[1]).resolve().as_uri()
    screenshot = sys.argv[2] if len(sys.argv) > 2 else None
    visit(page, 1280, 900, False, screenshot)
    phone = None if screenshot is None else str(pathlib.Path(screenshot).with_suffix("")) + "-phone.png"
    visit(page, 390, 844, True, phone)
    print(f"{sys.argv[1]}: charts, slider and zoom work in a browser, on a wide and a narrow dark screen")


if __name__ == "__main__":
    main()
