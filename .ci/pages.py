"""Opens the pages of `mechanim report` as a reader does: from a disk, without a network, in a real browser.

    python3 .ci/pages.py PROGRAM FOLDER [--no-browser]

Without a browser the files alone are judged: size, policy, digests, ids, what they would fetch. Screenshots of some pages
go into FOLDER, to be looked at.
"""

import base64
import hashlib
import html.parser
import pathlib
import re
import subprocess
import sys
import tempfile

MOST_BYTES = 600_000
LOOKED_AT = ["gearshift", "seven-r", "four-bar", "twin-steer"]
HOSTILE = """title = "</script><img src=x onerror=document.title='owned'>\u202etxt"
units = { length = "mm", angle = "deg" }
duration = 2
[inputs]
phi = "180*t"
[loops]
A = "Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)"
[guess]
h = 120
alpha = 0
beta = 0
[[bodies]]
name = "<b onclick=alert(1)>crank"
frame = "Rz(phi)"
shapes = [{ box = { size = [40, 8, 8] } }]
"""


class Page(html.parser.HTMLParser):
    """Scripts, styles, ids and addresses of a page."""

    def __init__(self, text):
        super().__init__()
        self.inside, self.scripts, self.styles, self.ids, self.addresses, self.acts, self.policy = None, [], [], [], [], [], ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.inside = (tag, attrs) if tag in ("script", "style") else self.inside
        if "id" in attrs:
            self.ids.append(attrs["id"])
        self.addresses += [attrs[k] for k in ("src", "href", "action", "data", "srcset") if attrs.get(k) and not attrs[k].startswith("#")]
        self.acts += [f"{tag} {k}" for k in attrs if k.startswith("on") or k == "style"]
        if attrs.get("http-equiv") == "Content-Security-Policy":
            self.policy = attrs["content"]

    def handle_endtag(self, tag):
        if self.inside and tag == self.inside[0]:
            self.inside = None

    def handle_data(self, data):
        if self.inside and self.inside[0] == "style":
            self.styles.append(data)
        elif self.inside and self.inside[1].get("type") is None:
            self.scripts.append(data)


def judge_file(path, most=MOST_BYTES):
    text = path.read_text(encoding="utf-8")
    page = Page(text)
    named = set(re.findall(r"'sha256-([^']+)'", page.policy))
    made = {base64.b64encode(hashlib.sha256(t.encode()).digest()).decode() for t in page.scripts + page.styles}
    assert named == made, f"{path}: the policy names other digests"
    assert page.policy.startswith("default-src 'none'") and "unsafe" not in page.policy, page.policy
    assert len(page.ids) == len(set(page.ids)), f"{path}: ids are not unique"
    assert all(a.startswith("data:") for a in page.addresses), f"{path}: fetches {page.addresses}"
    assert not page.acts, f"{path}: {page.acts}"
    assert len(page.scripts) == 2 and len(page.styles) == 1
    assert len(text.encode()) <= most, f"{path}: {len(text.encode())} bytes"
    return len(text.encode())


class Opened:
    """A page in a browser, with everything it said and asked for."""

    def __init__(self, browser, path, size=(1100, 900), **options):
        self.context = browser.new_context(viewport={"width": size[0], "height": size[1]}, offline=True, **options)
        self.page = self.context.new_page()
        self.said, self.asked = [], []
        self.page.on("console", lambda m: self.said.append(m.text) if m.type in ("error", "warning") else None)
        self.page.on("pageerror", lambda e: self.said.append(str(e)))
        self.page.on("request", lambda r: self.asked.append(r.url) if not r.url.startswith("data:") else None)
        self.address = path.resolve().as_uri()

    def __enter__(self):
        self.page.goto(self.address)
        self.page.wait_for_timeout(300)
        return self

    def __exit__(self, kind, *_):
        # What software renderers say about their speed is no fault of the page.
        faults = [t for t in self.said if "GL Driver Message" not in t and "GPU stall" not in t]
        self.context.close()
        if kind is None:
            assert not faults, f"{self.address}: {faults}"
            assert self.asked == [self.address], f"{self.address} asked for {self.asked}"

    def shot(self, path, **options):
        self.page.screenshot(path=str(path), **options)


def judge_live(opened):
    """Slider, keys, buttons and playheads of a page with a 3-D view."""
    page = opened.page
    report = "window.reports[0]"
    # Asked from outside: the page's own policy lets nothing wait inside of it.
    for _ in range(200):
        if page.evaluate(f"{report}.viewer !== null"):
            break
        page.wait_for_timeout(100)
    assert page.locator("canvas").is_visible() and not page.locator(".still").is_visible()
    count = page.evaluate(f"{report}.data.times.length")
    if count > 1:
        slider = page.get_by_role("slider", name="Time")
        before = page.locator("[data-part=clock]").inner_text()
        slider.focus()
        page.keyboard.press("End")
        assert page.evaluate(f"{report}.frame") == count - 1
        assert page.locator("[data-part=clock]").inner_text() != before
        page.get_by_role("button", name="Play").click()
        page.wait_for_timeout(250)
        page.get_by_role("button", name="Pause").click()
    # Something is drawn, and turns.
    canvas = page.locator("canvas")
    first = canvas.screenshot()
    canvas.focus()
    for _ in range(4):
        page.keyboard.press("ArrowLeft")
    page.wait_for_timeout(50)
    assert canvas.screenshot() != first, "arrow keys do not turn the view"
    page.get_by_role("button", name="Reset view").click()
    buttons = page.locator("button[data-frame]:visible")
    if buttons.count() > 0:
        last = buttons.last
        last.click()
        assert page.evaluate(f"{report}.frame") == int(last.get_attribute("data-frame"))


def judge_browser(paths, folder):
    from playwright.sync_api import sync_playwright

    with sync_playwright() as tool:
        arguments = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        browser = tool.chromium.launch(executable_path="/usr/bin/chromium", args=arguments)
        for name, path in paths.items():
            with Opened(browser, path) as opened:
                judge_live(opened)
                if name in LOOKED_AT:
                    opened.page.evaluate("window.reports[0].show(Math.floor(window.reports[0].data.times.length / 3))")
                    opened.shot(folder / f"{name}.png", full_page=True)
            with Opened(browser, path, (360, 740), has_touch=True, is_mobile=True) as opened:
                wide = opened.page.evaluate("document.scrollingElement.scrollWidth")
                assert wide <= 360, f"{name}: {wide} pixels wide on a telephone"
                if name in LOOKED_AT:
                    opened.shot(folder / f"{name}-360.png", full_page=True)
            print(f"page {name}: {path.stat().st_size} bytes, ok")
        path = paths["gearshift"]
        with Opened(browser, path, color_scheme="dark") as opened:
            assert opened.page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(21, 24, 28)"
            opened.shot(folder / "gearshift-dark.png", full_page=True)
        with Opened(browser, path) as opened:
            opened.page.emulate_media(media="print")
            assert opened.page.locator(".still").is_visible() and not opened.page.locator("canvas").is_visible()
            opened.shot(folder / "gearshift-print.png", full_page=True)
        with Opened(browser, path, java_script_enabled=False) as opened:
            assert opened.page.locator(".still").is_visible()
            assert not opened.page.get_by_role("slider").is_visible()
            opened.shot(folder / "gearshift-no-script.png")
        opened = Opened(browser, path)
        opened.page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
        with opened:
            assert opened.page.locator(".still").is_visible() and not opened.page.locator("canvas").is_visible()
            assert "stands still" in opened.page.locator("[data-part=note]").inner_text()
            opened.page.get_by_role("slider", name="Time").focus()
            opened.page.keyboard.press("End")
            opened.shot(folder / "gearshift-no-webgl.png")
        with Opened(browser, paths["hostile"]) as opened:
            assert "owned" not in opened.page.title() or "<img" in opened.page.title()
            assert "</script><img src=x" in opened.page.locator("h1").inner_text()
            assert opened.page.locator("img").count() == 1
        judge_axe(browser, path)
        browser.close()


def judge_axe(browser, path):
    """No serious fault for readers with assistive technology, if the judge can be had."""
    place = pathlib.Path(tempfile.mkdtemp())
    got = subprocess.run(["npm", "install", "--silent", "--prefix", str(place), "axe-core@4"], timeout=120, capture_output=True)
    script = place / "node_modules/axe-core/axe.min.js"
    if got.returncode != 0 or not script.exists():
        print("NOT RUN: axe-core is not to be had")
        return
    for scheme in ("light", "dark"):
        with Opened(browser, path, color_scheme=scheme) as opened:
            opened.page.evaluate(script.read_text())
            found = opened.page.evaluate("axe.run()")["violations"]
            serious = [f"{v['id']}: {v['help']}: {v['nodes'][0]['html'][:200]}" for v in found if v["impact"] in ("serious", "critical")]
            assert not serious, f"axe, {scheme}: {serious}"
            print(f"axe-core, {scheme}: no serious fault, {len(found)} lesser ones")


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    listed = subprocess.run([program, "scenes"], check=True, capture_output=True, text=True, encoding="utf-8").stdout
    names = [line.split()[0] for line in listed.splitlines()]
    scene = folder / "hostile.toml"
    scene.write_text(HOSTILE, encoding="utf-8")
    paths = {name: folder / f"{name}.html" for name in names + ["hostile"]}
    for name, path in paths.items():
        source = str(scene) if name == "hostile" else name
        codes = [subprocess.run([program, *words, "--quiet"]).returncode for words in (["report", source, "--out", str(path)], ["check", source])]
        assert codes[0] == codes[1], f"{name}: report exits with {codes[0]}, check with {codes[1]}"
        print(f"file {name}: {judge_file(path)} bytes")
    together = folder / "all.html"
    subprocess.run([program, "report", *names[3:6], "--out", str(together), "--quiet"], check=True)
    judge_file(together, 4 * MOST_BYTES)
    passed = len(paths) + 1
    if "--no-browser" not in sys.argv:
        judge_browser(paths, folder)
        passed += len(paths)
    print(f"{passed} passed, 0 failed")


main()
