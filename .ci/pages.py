"""Opens the pages of `mechanim report` as a reader does: from a disk, without a network, in a real browser.

    python3 .ci/pages.py PROGRAM FOLDER [--no-browser] [--wasm ENGINE [--briefly]]

With an engine, live pages too: what they compute is compared with the program; briefly, those of some scenes with few moves.
Without a browser the files alone are judged: size, policy, digests, ids, what they would fetch. Screenshots of some pages go
into FOLDER, to be looked at.
"""

import base64
import hashlib
import html.parser
import json
import lzma
import pathlib
import re
import subprocess
import sys
import tempfile

MOST_BYTES = 600_000
MOST_LIVE = 1_200_000
MOVES = 60 if "--briefly" in sys.argv else 3000
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


def unpacked(text):
    """The bytes that a live page holds as text: see `src/page/packing.rs`."""
    digits = []
    for code in map(ord, text):
        digits += divmod(code - 0xA0, 111) if code >= 0xA0 else [code - (33 if code > 60 else 32)]
        if code >= 0xA0:
            digits[-2] += 94
    packed = bytearray()
    for start in range(0, len(digits) // 13 * 13, 13):
        number = 0
        for digit in digits[start : start + 13]:
            number = 111 * number + digit
        packed += number.to_bytes(11, "big")
    return lzma.LZMADecompressor(lzma.FORMAT_ALONE).decompress(packed)


class Page(html.parser.HTMLParser):
    """Scripts, styles, ids and addresses of a page."""

    def __init__(self, text):
        super().__init__()
        self.inside, self.scripts, self.styles, self.ids, self.addresses, self.acts, self.policy = None, [], [], [], [], [], ""
        self.held = []
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
        elif self.inside and self.inside[1]["type"] == "text/javascript":
            self.scripts.append(data)
        elif self.inside and self.inside[1].get("id") == "packed":
            self.held = json.loads(unpacked(data))
            self.scripts += [element["text"] for element in self.held if element["type"] == "text/javascript"]


def judge_file(path, most=MOST_BYTES, live=False):
    text = path.read_text(encoding="utf-8")
    page = Page(text)
    named = set(re.findall(r"'sha256-([^']+)'", page.policy))
    made = {base64.b64encode(hashlib.sha256(t.encode()).digest()).decode() for t in page.scripts + page.styles}
    assert named == made, f"{path}: the policy names other digests"
    words = page.policy.replace("'wasm-unsafe-eval'; worker-src blob:", "") if live else page.policy
    assert words.startswith("default-src 'none'") and "unsafe" not in words and "blob" not in words, page.policy
    assert len(page.ids) == len(set(page.ids)), f"{path}: ids are not unique"
    assert all(a.startswith("data:") for a in page.addresses), f"{path}: fetches {page.addresses}"
    assert not page.acts, f"{path}: {page.acts}"
    assert len(page.scripts) == (4 if live else 2) and len(page.styles) == 1
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
        self.page.on("request", lambda r: self.asked.append(r.url) if not r.url.startswith(("data:", "blob:")) else None)
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


class Program:
    """The program itself, whose words and bytes a live page must repeat."""

    def __init__(self, path, engine, folder):
        self.path, self.engine, self.folder = path, engine, folder

    def run(self, *words):
        return subprocess.run([self.path, *map(str, words), "--quiet"], capture_output=True)

    def live_page(self, source, name):
        path = self.folder / f"{name}-live.html"
        run = self.run("report", source, "--live", "--wasm", self.engine, "--out", path)
        assert path.exists(), run.stderr.decode()
        return path

    def table(self, source):
        return self.run("solve", source, "--out", "-").stdout.decode()

    def picture(self, source, frame):
        path = self.folder / "frame.png"
        self.run("render", source, "--renderer", "cpu", "--frame", frame, "--out", path)
        return path.read_bytes()


LIVE = "window.reports[0].live"


def awaken(page):
    """Waits for the engine and its first answer."""
    for _ in range(300):
        if page.evaluate(f"{LIVE} !== null && {LIVE}.opened.then(() => true)"):
            return
        page.wait_for_timeout(100)
    raise AssertionError(page.locator("[data-part=bench]").inner_text())


def settle(page):
    """Waits until nothing is computed and the curves are those of the picture."""
    for _ in range(300):
        page.wait_for_timeout(100)
        if page.evaluate(f"!{LIVE}.isBusy && !{LIVE}.sections.inert"):
            return
    raise AssertionError("the article is not made anew")


def bytes_of(page, question):
    """What the engine answers with, as bytes."""
    text = page.evaluate(
        "q => window.reports[0].live.ask(q).then(b => { let s = ''; for (const c of b) s += String.fromCharCode(c); return btoa(s); })",
        question)
    return base64.b64decode(text)


def judge_numbers(page, program, source, name):
    """The engine in the browser says what the program says, digit by digit and pixel by pixel."""
    assert bytes_of(page, {"ask": "csv"}).decode() == program.table(source), f"{name}: another table"
    times = page.evaluate("window.reports[0].data.times")
    assert bytes_of(page, {"ask": "png", "time": 0}) == program.picture(source, 0), f"{name}: another picture"
    return times


def judge_sliders(page, program, folder, name):
    """A slider by keys and as a number; what it leads to is what the program makes of the page's own text."""
    sliders = page.locator("[data-part=bench] input[type=range]")
    if page.evaluate(f"{LIVE}.sliders.length") == 0:
        return
    first = sliders.first
    first.focus()
    before = first.input_value()
    page.keyboard.press("ArrowRight")
    settle(page)
    # Where the way ends at once the slider stays, and the page says why.
    assert first.input_value() != before or page.locator("[data-part=bench] [role=alert]:visible").first.inner_text() != ""
    assert page.locator("[data-part=bench] > .verdict[role=status]").inner_text() != ""
    text = page.evaluate(f"{LIVE}.toml()")
    scene = folder / f"{name}-moved.toml"
    scene.write_text(text, encoding="utf-8")
    assert bytes_of(page, {"ask": "csv"}).decode() == program.table(scene), f"{name}: another table after a move"


def judge_pull(page, name):
    """A link follows the pointer that drags it, and the drive takes it back."""
    place = page.evaluate("""() => {
      const report = window.reports[0];
      if (!report.viewer) return null;
      const { left, top, width, height } = report.canvas.getBoundingClientRect();
      for (let y = 6; y < height; y += 6) for (let x = 6; x < width; x += 6) {
        if (report.linkBelow({ clientX: left + x, clientY: top + y })) return [left + x, top + y];
      }
      return null;
    }""")
    assert place, f"{name}: no moving link is seen"
    # The point that is taken hold of is drawn below the pointer.
    off = page.evaluate("""([x, y]) => {
      const { viewer, frame, canvas } = window.reports[0];
      const { left, top, width, height } = canvas.getBoundingClientRect();
      const { body, point } = window.reports[0].linkBelow({ clientX: x, clientY: y });
      const at = [...viewer.placeOf(body, frame, point), 1];
      const matrix = viewer.orbit.matrix(width / height);
      const [u, v, , w] = [0, 1, 2, 3].map((row) => at.reduce((sum, c, k) => sum + matrix[4 * k + row] * c, 0));
      return Math.hypot((0.5 + 0.5 * u / w) * width - (x - left), (0.5 - 0.5 * v / w) * height - (y - top));
    }""", place)
    assert off < 0.1, f"{name}: the point is {off} pixels off the pointer"
    page.mouse.move(*place)
    page.mouse.down()
    for k in range(1, 9):
        page.mouse.move(place[0] + 3 * k, place[1] + 2 * k)
        page.wait_for_timeout(60)
    page.wait_for_timeout(300)
    assert page.evaluate("window.reports[0].isHeld"), f"{name}: the link does not move"
    page.mouse.up()
    page.get_by_role("button", name="Back to the drive").click()
    settle(page)
    assert not page.evaluate("window.reports[0].isHeld")


def judge_assemblies(page, program, folder, name):
    """Another assembly is the motion that the program makes of the page's text."""
    page.get_by_role("button", name="Find the assemblies").click()
    chooser = page.get_by_label("Assembly", exact=True)
    chooser.wait_for(timeout=30000)
    count = chooser.locator("option").count()
    now = int(chooser.input_value())
    if count < 2:
        return
    chooser.select_option(str((now + 1) % count))
    settle(page)
    scene = folder / f"{name}-chosen.toml"
    scene.write_text(page.evaluate(f"{LIVE}.toml()"), encoding="utf-8")
    assert bytes_of(page, {"ask": "csv"}).decode() == program.table(scene), f"{name}: another table in assembly {now + 1}"


def judge_many_moves(page):
    """Thousands of moves take no more memory than hundreds, and how long one takes."""
    run = """async count => {
      const { live } = window.reports[0];
      const slider = live.sliders[0];
      const at = slider.value;
      const [taken, computed] = [[], []];
      for (let k = 0; k < count; k += 1) {
        const begun = performance.now();
        await live.enqueue({ ask: "move", name: slider.name, value: String(at * (1 + 0.004 * Math.sin(k / 7))) }, slider, at);
        const gl = window.reports[0].viewer?.gl;
        gl?.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
        taken.push(performance.now() - begun);
        computed.push(live.engine.milliseconds);
      }
      const middle = (list) => list.sort((a, b) => a - b)[count >> 1];
      return [middle(taken), middle(computed), live.engine.memory];
    }"""
    page.evaluate(run, 100)
    [_, _, memory] = page.evaluate(run, 200)
    [middle, engine, after] = page.evaluate(run, MOVES)
    assert after <= 1.1 * memory, f"memory grows from {memory} to {after}"
    taken = "async ask => { const b = performance.now(); await window.reports[0].live.ask({ ask }); return performance.now() - b; }"
    [clearance, article] = [page.evaluate(taken, ask) for ask in ("clearance", "settle")]
    print(f"live: slider to proved motion {engine:.1f} ms, to its picture {middle:.1f} ms, clearances {clearance:.0f} ms, article {article:.0f} ms, "
          f"engine memory {after / 1e6:.0f} MB after {MOVES} moves")


def judge_text(page):
    """Mistakes have their places; a text without them is taken over."""
    page.locator("summary", has_text="Text of the scene").click()
    editor = page.locator("textarea")
    text = editor.input_value()
    editor.fill(text.replace("[loops]", "[loops]\nwrong = \"Tx(nobody\"", 1))
    page.get_by_role("button", name="Read the text").click()
    page.wait_for_timeout(500)
    assert page.locator(".mistakes li").count() > 0
    page.locator(".mistakes button").first.click()
    assert page.evaluate("document.activeElement.tagName") == "TEXTAREA"
    title = "</script><img src=x onerror=document.title='owned'>"
    lines = [line for line in text.splitlines() if not line.startswith("title")]
    editor.fill("\n".join([f'title = "{title}"', *lines]))
    page.get_by_role("button", name="Read the text").click()
    # Nothing is computed, either, before the engine has begun to read.
    page.locator("h1").filter(has_text=title).wait_for(timeout=30000)
    settle(page)
    assert page.locator("h1").inner_text() == title
    assert page.locator("img").count() == 1 and "owned" not in page.title()


def judge_fault(page):
    """An engine that fails is replaced, and goes on where the other one was."""
    before = bytes_of(page, {"ask": "csv"})
    page.evaluate(f"{LIVE}.engine.worker.postMessage({{ id: 1e9, engine: new ArrayBuffer(8) }})")
    for _ in range(100):
        page.wait_for_timeout(100)
        if page.evaluate(f"{LIVE}.engine.restarts") == 1:
            break
    assert page.evaluate(f"{LIVE}.engine.restarts") == 1
    assert bytes_of(page, {"ask": "csv"}) == before


def judge_comparison(browser, program, folder):
    """Two versions on one page: one slider and one hand lead both."""
    names = ["gearshift", "gearshift-optimised"]
    path = folder / "comparison.html"
    run = program.run("compare", *names, "--out", path)
    assert run.returncode == program.run("check", names[1]).returncode, run.stderr.decode()
    judge_file(path, 3 * MOST_BYTES)
    for size in [(1400, 1000), (360, 740)]:
        with Opened(browser, path, size) as opened:
            page = opened.page
            assert page.evaluate("document.scrollingElement.scrollWidth") <= size[0]
            for _ in range(100):
                if page.evaluate("window.reports.every(r => r.viewer !== null)") or size[0] < 1000:
                    break
                page.wait_for_timeout(100)
            page.get_by_role("slider", name="Time").first.focus()
            page.keyboard.press("End")
            frames = page.evaluate("window.reports.map(r => [r.frame, r.data.times.length - 1])")
            assert all(frame == last for frame, last in frames), frames
            if size[0] > 1000:
                page.locator("canvas").first.focus()
                page.keyboard.press("ArrowLeft")
                turns = page.evaluate("window.reports.map(r => r.viewer.orbit.azimuth)")
                assert turns[0] == turns[1], turns
            assert page.locator("h2", has_text="Clearance").count() == 1
            opened.shot(folder / f"comparison-{size[0]}.png", full_page=True)
    print("comparison: ok")


def judge_site(browser, program, folder):
    """A folder of pages: the front page leads to each of them."""
    out = folder / "site"
    words = ["--wasm", program.engine] if program.engine else []
    run = program.run("site", "four-bar", "slider-crank", "--out", out, *words)
    assert run.returncode in (0, 1), run.stderr.decode()
    with Opened(browser, out / "index.html") as opened:
        assert opened.page.locator("li img").count() == 2
        opened.shot(folder / "site.png")
        links = opened.page.evaluate("[...document.querySelectorAll('a')].map(a => a.getAttribute('href'))")
    assert links == ["four-bar.html", "slider-crank.html"], links
    for link in links:
        with Opened(browser, out / link) as opened:
            if program.engine:
                awaken(opened.page)
    print("site: ok")


def judge_live_pages(browser, names, program, folder):
    for name in names:
        path = program.live_page(name, name)
        size = judge_file(path, MOST_LIVE, live=True)
        with Opened(browser, path, (1400, 1000)) as opened:
            awaken(opened.page)
            judge_numbers(opened.page, program, name, name)
            judge_sliders(opened.page, program, folder, name)
            if name in LOOKED_AT:
                settle(opened.page)
                opened.shot(folder / f"{name}-live.png")
                judge_many_moves(opened.page)
                settle(opened.page)
                judge_pull(opened.page, name)
                judge_assemblies(opened.page, program, folder, name)
        print(f"live page {name}: {size} bytes, ok")
    path = folder / "gearshift-live.html"
    with Opened(browser, path, (360, 740), has_touch=True, is_mobile=True) as opened:
        awaken(opened.page)
        wide = opened.page.evaluate("document.scrollingElement.scrollWidth")
        assert wide <= 360, f"live: {wide} pixels wide on a telephone"
        opened.shot(folder / "gearshift-live-360.png")
    with Opened(browser, path, (1400, 1000), color_scheme="dark") as opened:
        awaken(opened.page)
        settle(opened.page)
        opened.shot(folder / "gearshift-live-dark.png")
        judge_fault(opened.page)
        judge_text(opened.page)
    opened = Opened(browser, path)
    opened.page.add_init_script("const own = HTMLCanvasElement.prototype.getContext;"
                                "HTMLCanvasElement.prototype.getContext = function (kind, ...more) { return kind === '2d' ? own.call(this, kind, ...more) : null; }")
    with opened:
        awaken(opened.page)
        opened.page.locator(".drawn").wait_for()
        drawn = opened.page.evaluate("""() => {
          const c = document.querySelector('.drawn'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
          let s = ''; for (const b of d) s += String.fromCharCode(b); return btoa(s); }""")
        assert base64.b64decode(drawn) == bytes_of(opened.page, {"ask": "picture", "time": 0}), "the canvas shows another picture"
        opened.shot(folder / "gearshift-live-no-webgl.png")
    scene = folder / "hostile.toml"
    with Opened(browser, program.live_page(scene, "hostile")) as opened:
        awaken(opened.page)
        assert "</script><img src=x" in opened.page.locator("h1").inner_text()
        assert opened.page.locator("img").count() == 1 and opened.page.title() != "owned"
    judge_axe(browser, path, "live ")
    return len(names) + 4


def judge_browser(paths, folder, program):
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
            assert "does not move" in opened.page.locator("[data-part=note]").inner_text()
            opened.page.get_by_role("slider", name="Time").focus()
            opened.page.keyboard.press("End")
            opened.shot(folder / "gearshift-no-webgl.png")
        with Opened(browser, paths["hostile"]) as opened:
            assert "owned" not in opened.page.title() or "<img" in opened.page.title()
            assert "</script><img src=x" in opened.page.locator("h1").inner_text()
            assert opened.page.locator("img").count() == 1
        judge_axe(browser, path)
        judge_comparison(browser, program, folder)
        judge_site(browser, program, folder)
        names = LOOKED_AT if "--briefly" in sys.argv else [name for name in paths if name != "hostile"]
        more = judge_live_pages(browser, names, program, folder) if program.engine else 0
        browser.close()
        return len(paths) + 2 + more


def judge_axe(browser, path, kind=""):
    """No serious fault for readers with assistive technology, if the judge can be had."""
    place = pathlib.Path(tempfile.mkdtemp())
    got = subprocess.run(["npm", "install", "--silent", "--prefix", str(place), "axe-core@4"], timeout=120, capture_output=True)
    script = place / "node_modules/axe-core/axe.min.js"
    if got.returncode != 0 or not script.exists():
        print("NOT RUN: axe-core is not to be had")
        return
    for scheme in ("light", "dark"):
        with Opened(browser, path, color_scheme=scheme) as opened:
            if kind:
                awaken(opened.page)
                settle(opened.page)
            opened.page.evaluate(script.read_text())
            found = opened.page.evaluate("axe.run()")["violations"]
            serious = [f"{v['id']}: {v['help']}: {v['nodes'][0]['html'][:200]}" for v in found if v["impact"] in ("serious", "critical")]
            assert not serious, f"axe, {scheme}: {serious}"
            print(f"axe-core, {kind}{scheme}: no serious fault, {len(found)} lesser ones")


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
    engine = sys.argv[sys.argv.index("--wasm") + 1] if "--wasm" in sys.argv else None
    if "--no-browser" not in sys.argv:
        passed += judge_browser(paths, folder, Program(program, engine, folder))
    print(f"{passed} passed, 0 failed")


main()
