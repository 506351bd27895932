"""Drives the report page in headless Chromium: report_page_test.py REPORT_PAGE_SAMPLE [FOLDER]

REPORT_PAGE_SAMPLE is the program built beside this file. With FOLDER, the pages and a screenshot of each stay there.
Needs Python's standard library and Chromium; without Chromium it says so and exits with 77 (skipped).
"""
import json, math, os, shutil, struct, subprocess, sys, tempfile, time, zlib

from browser import Browser

ATTACK = '</script><img src=x onerror="window.pwned=1"><b>'


# ---- Reports to show -------------------------------------------------------------------------------------------------

def png(width, height):
    rows = b"".join(b"\0" + bytes(60 + (x * 5 ^ y * 3) % 140 for x in range(width)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def check(i, **more):
    return {"id": f"c{i}", "group": f"group {i % 5} {ATTACK}", "label": f"check {i}", "value": 0.1 * (i % 9),
            "sigma": 0.03, "unit": "px", "limit": 0.5, "expect": "at most", "verdict": "PASS",
            "explanation": "because", **more}


def reports():
    """By name: a usual one with hostile texts, a large one, and one in which everything is missing."""
    x = [0.5 * i for i in range(61)]
    curve = {"x": x, "y": [0.002 * v * v for v in x], "lower": [0.002 * v * v - 0.02 for v in x],
             "upper": [0.002 * v * v + 0.02 for v in x]}
    plot = {"id": "distortion", "title": "Distortion", "x_label": "field angle", "y_label": "distortion", "x_unit": "°",
            "y_unit": "%", "limit": 0.5, "series": [
                {"label": "measured", "subject": "a", "style": "measured", "covered_to": 24, "floor": 0.03, **curve},
                {"label": "traced " + ATTACK, "subject": "a", "style": "reference", "x": x, "y": curve["y"]},
                {"label": "second", "subject": "a", "style": "measured", "x": [0, 10, 20, 30], "y": [0, None, 1, 2]}]}
    points = [[20 + 10 * i % 600, 20 + 10 * (i // 58), 0.1 * math.sin(i), 0.1 * math.cos(i)] for i in range(2000)]
    subject = {"id": "a", "kind": "simulation", "label": "Lens " + ATTACK, "facts": [{"label": "f", "value": "100 mm"}],
               "points": {"centre_px": [319.5, 199.5], "half_diagonal_px": 377.0, "rms_px": 0.07},
               "worst": [{"name": "a/2.png", "caption": "far " + ATTACK}, {"name": "gone.svg"}],
               "pictures": [{"name": "a/1.png", "caption": "one", "width": 640, "height": 400, "points": points},
                            {"name": "gone.png", "caption": "absent", "width": 640, "height": 400,
                             "points": [[9, 9, None, 1]]},
                            {"name": "a/1.png", "caption": "no size"}]}
    layers = [{"name": "a/2.png", "label": "twin " + ATTACK, "kind": "picture"},
              {"name": "a/1.png", "label": "difference", "kind": "difference"}, {"name": "gone.png", "kind": ATTACK}]
    pair = {"id": "b", "kind": "twins", "label": "Pairs", "pictures": [
        {"name": "a/1.png", "caption": "first pair", "label": "photo", "layers": layers, "width": 640, "height": 400,
         "points": points[:50]},
        {"name": "a/2.png", "caption": "second pair", "label": "photo", "layers": layers[:2]}]}
    behind = {"id": "behind", "title": "Behind", "over": "image_height", "x_label": "image height", "y_label": "y",
              "series": [{"label": "radial", "subject": "a", "style": "measured", "x": [0, 1], "y": [0, 1]}]}
    usual = {"schema": "lensproof-report/1", "title": "Title " + ATTACK, "summary": ATTACK, "verdict": "FAIL",
             "checks": [check(0, floor=0.02), check(1, expect="at least", verdict="FAIL"), check(2, expect="within", target=0.2),
                        check(3, expect="differs", value=9), check(4, value=None, verdict="INCONCLUSIVE"),
                        check(5, limit=0), check(6, limit=None), check(7, expect=ATTACK, value=-1, sigma=1e9)],
             "subjects": [subject, pair], "plots": [plot, {**plot, "id": "again"}, behind],
             "maps": [{"name": "a/1.png", "subject": "a", "caption": "map " + ATTACK}, None],
             "provenance": {"program": ATTACK, "inputs": [{"file": ATTACK, "sha256": "0" * 64}],
                            "settings": {"a": {"b": 1}}},
             "reproduce": "./lensproof run x.toml"}
    long = "a very long name without a place to break_" * 8
    large = {"title": long, "summary": long, "verdict": "PASS",
             "checks": [check(i, label=long if i % 7 == 0 else f"check {i}") for i in range(60)],
             "subjects": [{"id": str(i), "kind": "photos", "label": long} for i in range(9)],
             "plots": [{"id": long, "title": long, "x_label": long, "y_label": long, "series": [
                 {"label": long, "subject": str(i), "style": "difference", "x": x, "y": [i * v for v in x]}
                 for i in range(9)]}]}
    empty = {"title": None, "checks": [None, {}], "subjects": [None, {}, {"pictures": [None]}],
             "plots": [None, {}, {"series": [None, {}, {"x": [None], "y": [1]}, {"x": [1, 1], "y": [2, 3]}]}]}
    return {"usual": usual, "large": large, "empty": empty, "nothing": {}}


# ---- What must hold --------------------------------------------------------------------------------------------------

failures = []


def expect(holds, what):
    if not holds:
        failures.append(what)
    print(("ok      " if holds else "FAILED  ") + what)


def box(browser, selector):
    return browser.js(f"(() => {{ const e = document.querySelector({json.dumps(selector)});"
                      "e.scrollIntoView({block: 'center'});"
                      "const b = e.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()")


def readouts(browser):
    outputs = "document.querySelectorAll('[data-plot=distortion] .legend output')"
    return browser.js(f"[...{outputs}].map((o) => o.textContent)")


def ticks(browser):
    return browser.js("[...document.querySelectorAll('[data-plot=distortion] .wide-canvas .number')]"
                      ".filter((t) => t.checkVisibility()).map((t) => t.textContent).join()")


def test_curves(browser):
    curves = "[data-plot=distortion] .wide-canvas"
    expect(browser.js(f"document.querySelectorAll('{curves} path.curve').length") >= 4, "curves are drawn")
    expect(browser.js("document.querySelector('#curves .maps img').naturalWidth") == 320, "a map stands beside them")
    expect(browser.js(f"document.querySelector('{curves} .series-0 path.curve').getTotalLength()") > 200,
           "a curve has length")
    expect(browser.js(f"document.querySelectorAll('{curves} .series-0 path.area').length") == 1,
           "the 95 % band is drawn")
    expect(browser.js(f"document.querySelectorAll('{curves} .series-0 path[stroke-dasharray]').length") == 2,
           "the method's own error is drawn on either side of its curve")
    expect("own error ±0.03" in browser.js("document.querySelector('[data-plot=distortion] .legend').textContent"),
           "and said")
    expect(browser.js(f"document.querySelectorAll('{curves} .series-0 path.hatch').length") == 1,
           "the extrapolated part stands apart")
    left, top, width, height = box(browser, curves)
    browser.mouse("mouseMoved", left + width * 0.3, top + height / 2)
    values = readouts(browser)
    expect(values[0].endswith("± 0.020\u00a0%"), f"hovering gives a value ± half the band: {values}")
    expect(browser.js(f"document.querySelectorAll('{curves} .point').length") == 2,
           "a dot on each curve that is defined there")
    browser.mouse("mouseMoved", 2, 2)
    expect(readouts(browser) == ["", "", ""], "leaving clears the readout")

    before = ticks(browser)
    browser.mouse("mousePressed", left + width * 0.3, top + height * 0.3, button="left", clickCount=1)
    browser.mouse("mouseMoved", left + width * 0.5, top + height * 0.6, button="left", buttons=1)
    browser.mouse("mouseReleased", left + width * 0.5, top + height * 0.6, button="left", clickCount=1)
    dragged = ticks(browser)
    expect(dragged != before, "dragging zooms")
    browser.mouse("mouseWheel", left + width * 0.4, top + height * 0.5, deltaX=0, deltaY=-200)
    deadline = time.monotonic() + 5
    while ticks(browser) == dragged and time.monotonic() < deadline:
        time.sleep(0.05)
    expect(ticks(browser) != dragged, "the wheel zooms the plot that was clicked")
    for clicks in (1, 2):
        browser.mouse("mousePressed", left + width * 0.4, top + height * 0.5, button="left", clickCount=clicks)
        browser.mouse("mouseReleased", left + width * 0.4, top + height * 0.5, button="left", clickCount=clicks)
    expect(ticks(browser) == before, "a double click resets")

    browser.js(f"document.querySelector('{curves}').focus()")
    browser.key("ArrowRight")
    expect(readouts(browser)[0] != "", "an arrow key reads values")
    expect("measured" in browser.js("document.querySelector('[data-plot=distortion] [aria-live]').textContent"),
           "and they are announced")
    browser.key("+")
    expect(not browser.js("document.querySelector('[aria-label=\"Reset zoom: Distortion\"]').disabled"),
           "the + key zooms")
    browser.js("document.querySelector('[aria-label=\"Reset zoom: Distortion\"]').click()")
    expect(ticks(browser) == before, "the reset button resets")
    browser.js("document.querySelector('[data-plot=distortion] .legend input').click()")
    expect(browser.js(f"[...document.querySelectorAll('{curves} .series-0')].every((g) => getComputedStyle(g).display == 'none')"),
           "the legend hides a curve")
    browser.js("document.querySelector('[data-plot=distortion] .legend input').click()")
    expect(browser.js("document.querySelectorAll('[data-plot=distortion] details td').length") >= 9,
           "the values are listed")


def test_checks(browser):
    expect(browser.js("document.querySelectorAll('td.scale > svg').length") == 7, "each limit has its scale")
    expect(browser.js("document.querySelectorAll('td.scale rect.own').length") == 1, "with the method's own error")
    left, top, width, height = box(browser, ".check.pass")
    browser.js("document.querySelector('.check.pass').focus()")
    browser.js("new Promise((done) => setTimeout(done, 300))")
    why = "getComputedStyle(document.querySelector('.check.pass .why')).visibility"
    expect(browser.js(why) == "visible", "focus shows an explanation")
    browser.key("Escape")
    browser.js("new Promise((done) => setTimeout(done, 300))")
    expect(browser.js(why) == "hidden", "Escape sends it away")
    expect(browser.js("getComputedStyle(document.querySelector('.check.fail .why')).position") == "static",
           "a check that fails shows its own")


def test_pictures(browser):
    arrows = "document.querySelector('#picture-0-0 path.arrows:last-of-type').getAttribute('d')"
    expect(browser.js(arrows).count("M") >= 2000, "2000 points are drawn")
    before = browser.js(arrows)
    browser.js("(() => { const s = document.querySelector('.tools [type=range]'); s.value = s.max;"
               "s.dispatchEvent(new Event('input')); })()")
    expect(browser.js(arrows) != before, "the slider magnifies the residuals")
    expect("×500" in browser.js("document.querySelector('.tools output').textContent"), "and the scale is said")
    browser.js("document.querySelector('.tools [type=checkbox]').click()")
    expect(browser.js("document.querySelectorAll('#subject-0 .stage > svg').length") == 0, "the overlay can be switched off")
    browser.js("document.querySelector('.tools [type=checkbox]').click()")
    browser.js("document.querySelector('#picture-0-0 .enlarge').click()")
    expect(browser.js("document.querySelector('dialog').open && document.querySelectorAll('dialog .stage svg').length")
           == 1,
           "a click enlarges the picture with its overlay")
    browser.js("document.querySelector('dialog .bar > button:last-of-type').click()")
    expect(not browser.js("document.querySelector('dialog').open"), "and it closes")


def test_layers(browser):
    page, dialog = "#subject-1", "dialog"

    def look(where, way):
        browser.js(f"[...document.querySelectorAll('{where} .views button')]"
                   f".find((b) => b.textContent === {json.dumps(way)}).click()")

    def seen(where):
        """Of each layer of the first picture: whether it is to be seen, and how it is cut."""
        return browser.js(f"[...document.querySelector('{where} .stage').querySelectorAll(':scope > .layer')].map((l) =>"
                          "[l.checkVisibility(), getComputedStyle(l).clipPath, getComputedStyle(l).maskImage !== 'none'])")

    def stages():
        return browser.js("[...document.querySelectorAll('dialog .stage')].map((s) => { const b = s.getBoundingClientRect(),"
                          "p = s.parentNode.getBoundingClientRect();"
                          "return [b.left - p.left, b.top - p.top, b.width].map(Math.round).join(); })")

    hidden = [False, "none", False]
    whole = [True, "none", False]
    expect(seen(page) == [whole, [True, "inset(0px 0px 0px 50%)", False], hidden, hidden],
           f"a pair begins with the divider in the middle: {seen(page)}")
    left, top, width, height = box(browser, page + " .stage")
    browser.mouse("mousePressed", left + width / 2, top + height / 2, button="left", clickCount=1)
    browser.mouse("mouseMoved", left + width / 4, top + height / 2, button="left", buttons=1)
    browser.mouse("mouseReleased", left + width / 4, top + height / 2, button="left", clickCount=1)
    expect(seen(page)[1][1] == "inset(0px 0px 0px 25%)", f"the divider follows the pointer: {seen(page)[1]}")
    expect(seen("#picture-1-1")[1][1] == seen(page)[1][1], "in all pairs of a subject")
    browser.js(f"(() => {{ const s = document.querySelector('{page} .tools [type=range]'); s.value = 0.75;"
               "s.dispatchEvent(new Event('input')); })()")
    expect(seen(page)[1][1] == "inset(0px 0px 0px 75%)", "and the slider, so that keys move it")
    look(page, "checker")
    expect(seen(page) == [whole, [True, "none", True], hidden, hidden], f"the checker masks one: {seen(page)}")
    look(page, "blink")
    expect(browser.js(f"document.querySelector('{page} .over').getAnimations().length") == 1, "blink blinks")
    look(page, "difference")
    expect(seen(page) == [hidden, hidden, whole, hidden], f"the difference alone: {seen(page)}")
    expect(browser.js(f"document.querySelector('{page} .views [aria-pressed=true]').textContent") == "difference",
           "and the button says so")

    browser.js("document.querySelector('#picture-1-0 .enlarge').click()")
    expect(seen(dialog) == [hidden, hidden, whole, hidden], "enlarged, the same is shown")
    look(dialog, "side by side")
    before = stages()
    expect(len(before) == 4 and len(set(before)) == 1, f"all layers beside each other: {before}")
    left, top, width, height = box(browser, "dialog .pane:nth-child(2)")
    browser.mouse("mouseWheel", left + width / 3, top + height / 2, deltaX=0, deltaY=-600)
    deadline = time.monotonic() + 5
    while stages() == before and time.monotonic() < deadline:
        time.sleep(0.05)
    zoomed = stages()
    expect(zoomed != before and len(set(zoomed)) == 1, f"the wheel zooms all of them alike: {zoomed}")
    browser.mouse("mousePressed", left + width / 2, top + height / 2, button="left", clickCount=1)
    browser.mouse("mouseMoved", left + width / 2 - 30, top + height / 2 - 10, button="left", buttons=1)
    browser.mouse("mouseReleased", left + width / 2 - 30, top + height / 2 - 10, button="left", clickCount=1)
    expect(stages() != zoomed and len(set(stages())) == 1, f"dragging moves all of them alike: {stages()}")
    moved = stages()
    browser.js("document.querySelector('dialog .view').focus()")
    browser.key("PageDown")
    expect("second pair" in browser.js("document.querySelector('dialog strong').textContent"), "Page Down goes on")
    browser.key("PageUp")
    expect(stages() == moved, "and back: place and zoom stay")
    browser.key("ArrowLeft")
    expect(stages() != moved, "an arrow key moves the picture")
    browser.key("0")
    expect(stages() == before, "0 fits it again")
    look(dialog, "slider")
    expect(len(stages()) == 1 and seen(dialog)[1][1] == "inset(0px 0px 0px 75%)", "the divider is where it was")
    browser.js("document.querySelector('dialog .bar > button:last-of-type').click()")
    expect(seen(page)[1][1] == "inset(0px 0px 0px 75%)", "the page shows what was chosen")


def test_calm_and_print(browser, page):
    browser.open(page, calm=True)
    ways = browser.js("[...document.querySelectorAll('#subject-1 .views button')].map((b) => b.textContent)")
    expect("checker" in ways and "blink" not in ways, f"who wants no motion is offered no blinking: {ways}")
    browser.open(page)
    browser.call("Emulation.setEmulatedMedia", media="print")
    boxes = browser.js("[...document.querySelectorAll('#picture-1-0 .layer')].map((l) => [l.checkVisibility(),"
                       "getComputedStyle(l).clipPath, l.getBoundingClientRect().left])")
    expect(all(shown and clip == "none" for shown, clip, left in boxes) and
           len({left for shown, clip, left in boxes}) == 4, f"in print layers stand side by side: {boxes}")
    browser.call("Emulation.setEmulatedMedia", media="")


def test_points_behind_curves(browser):
    curves = "[data-plot=behind] .wide-canvas"
    rings = ("((p) => p ? p.getAttribute('d').split('M').length - 2 : 0)"  # and the circle that they lie on
             "(document.querySelector('#picture-0-0 path.behind'))")
    expect(browser.js(rings) == 0, "no point is ringed at first")
    left, top, width, height = box(browser, curves)
    x, y, frame_width, _ = map(float, browser.js(f"document.querySelector('{curves}').dataset.frame").split())
    scale = width / browser.js(f"document.querySelector('{curves}').viewBox.baseVal.width")
    at = left + (x + 0.5 * frame_width) * scale
    browser.mouse("mousePressed", at, top + height / 2, button="left", clickCount=1)
    browser.mouse("mouseReleased", at, top + height / 2, button="left", clickCount=1)
    points = reports()["usual"]["subjects"][0]["pictures"][0]["points"]
    near = sum(abs(math.hypot(p[0] - 319.5, p[1] - 199.5) / 377.0 - 0.5) < 0.025 for p in points)
    found = browser.js(rings)
    # The pointer's place is known to a px of the screen: so many points come and go at the ring's two borders.
    border = sum(abs(abs(math.hypot(p[0] - 319.5, p[1] - 199.5) / 377.0 - 0.5) - 0.025) < 2 / frame_width for p in points)
    expect(near > 50 and abs(found - near) <= border, f"a click rings the points behind it: {found}, {near} ± {border}")
    browser.mouse("mouseMoved", 2, 2)
    expect(browser.js("document.querySelector('[data-plot=behind] .legend output').textContent") != "", "the place stays")
    button = "document.querySelector('[data-plot=behind] .pixels')"
    expect(str(found) in browser.js(button + ".textContent"), "and says how many they are")
    browser.js(button + ".click()")
    expect(browser.js("document.querySelector('dialog').open && document.querySelectorAll('dialog path.behind').length") == 1,
           "they are shown where they are most")
    browser.js("document.querySelector('dialog .bar > button:last-of-type').click()")
    browser.js(f"document.querySelector('{curves}').focus()")
    browser.key("Escape")
    expect(browser.js(rings) == 0 and browser.js(button + ".hidden"), "Escape lets go of it")
    browser.key("ArrowRight")
    browser.key("Enter")
    expect(browser.js(rings) > 0, "and Enter holds what the arrow keys found")
    browser.key("Escape")
    expect(browser.js("document.querySelectorAll('#subject-0 .worst .picture').length") == 2,
           "the points that are furthest off stand below")


def test_without_script(browser):
    expect(browser.js("document.querySelector('[data-plot=distortion] .series-0 path.curve').getTotalLength()") > 200,
           "without script: the curves are there")
    expect(browser.js("document.querySelector('[data-plot=distortion] details').textContent").count("±") >= 6,
           "without script: and their values")
    expect(browser.js("document.querySelectorAll('td.scale > svg').length") == 7, "without script: and the scales")
    sides = browser.js("[...document.querySelectorAll('#picture-1-0 .layer')].map((l) => l.getBoundingClientRect().left)")
    expect(len(sides) == 4 and sides == sorted(set(sides)), f"without script: layers stand side by side {sides}")
    expect(browser.js("[...document.querySelectorAll('.plot button, .plot input')].every((b) => !b.checkVisibility())"),
           "without script: nothing that would not work")


def main():
    chromium = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if chromium is None:
        print("SKIPPED: no Chromium on this machine (chromium, chromium-browser, google-chrome), so the report page "
              "was not looked at")
        return 77
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as temporary:
        folder = sys.argv[2] if len(sys.argv) > 2 else temporary
        os.makedirs(os.path.join(folder, "pictures/a"), exist_ok=True)
        for i in (1, 2):
            with open(os.path.join(folder, f"pictures/a/{i}.png"), "wb") as out:
                out.write(png(320, 200))
        for name, report in reports().items():
            with open(os.path.join(folder, name + ".json"), "w", encoding="utf-8") as out:
                json.dump(report, out)
            subprocess.run([sys.argv[1], os.path.join(folder, name + ".json"), os.path.join(folder, "pictures"),
                            os.path.join(folder, name + ".html")], check=True)
        browser = Browser(chromium, os.path.join(temporary, "profile"))
        try:
            for name in reports():
                page = os.path.join(folder, name + ".html")
                for width, dark in ((400, True), (1600, False)):
                    browser.open(page, width=width, dark=dark)
                    across = browser.js("document.scrollingElement.scrollWidth")
                    expect(across <= width, f"{name}: {width} px wide, nothing sticks out ({across} px)")
                    expect(browser.complaints() == [], f"{name}: no error and no request {browser.complaints()}")
                    browser.screenshot(os.path.join(folder, f"{name}-{width}.png"))
            browser.open(os.path.join(folder, "usual.html"))
            test_checks(browser)
            test_curves(browser)
            test_pictures(browser)
            test_layers(browser)
            test_points_behind_curves(browser)
            expect(browser.js("window.pwned === undefined && !document.querySelector('[onerror], img[src=x], h1 b')"),
                   "hostile texts stay texts")
            blocked = browser.js("new Promise((done) => { const i = new Image(); i.onerror = () => done(true); "
                                 "i.onload = () => done(false); i.src = 'pictures/a/1.png'; })")
            expect(blocked, "the page's own policy blocks a request, even one that would succeed")
            test_calm_and_print(browser, os.path.join(folder, "usual.html"))
            browser.open(os.path.join(folder, "usual.html"), script=False)
            browser.screenshot(os.path.join(folder, "no-script.png"))
            expect(browser.complaints() == [], "without script: no complaint")
            test_without_script(browser)
        finally:
            browser.close()
    print(f"{len(failures)} failures" if failures else "all good")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
