"""The site of the pages in a real browser: site_test.py CHECKOUT [FOLDER]

Made by mkdocs and opened from the disk: no page asks for anything beyond its folder, complains or is wider than the
window, every link within the site leads to a file, and the search finds. With FOLDER, screenshots stay there. Without
Chromium or mkdocs it says so and exits with 77 (skipped).
"""
import os, pathlib, re, shutil, subprocess, sys, tempfile, time
from urllib.parse import unquote

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "browser"))
from browser import Browser

failures = []


def expect(holds, what):
    if not holds:
        failures.append(what)
    print(("ok      " if holds else "FAILED  ") + what)


def make(checkout, site):
    return subprocess.run(["mkdocs", "build", "--strict", "--quiet", "--config-file", checkout / "experiments/docs/mkdocs.yml",
                           "--site-dir", site], capture_output=True, text=True)


def dead_links(site):
    for page in site.rglob("*.html"):
        for link in re.findall(r'(?:href|src)="([^"]*)"', page.read_text()):
            path = unquote(link.split("#")[0])
            if path and not re.match(r"[a-z]+:", path) and not (page.parent / path).exists():
                yield f"{page.relative_to(site)}: {link}"


def own(complaints, site):
    """Those that are not the page's own style and script."""
    return [said for said in complaints if not said.startswith(f"request file://{site}/")]


def test_search(browser, site):
    browser.open(site / "experiments/docs/report.html")
    browser.js("{ const box = document.querySelector('input[type=search]'); box.value = 'vignetting';"
               " box.dispatchEvent(new Event('input')); }")
    deadline = time.monotonic() + 10
    while browser.js("document.querySelectorAll('#found a').length") == 0 and time.monotonic() < deadline:
        time.sleep(0.05)
    links = browser.js("[...document.querySelectorAll('#found a')].map((link) => link.href)")
    expect(links and all(pathlib.Path(unquote(link.removeprefix("file://").split("#")[0])).is_file() for link in links),
           f"the search finds {len(links)} sections, each in a page that is there")


def main():
    chromium = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if chromium is None or shutil.which("mkdocs") is None:
        print("SKIPPED: no Chromium or no mkdocs on this machine, so the site was not looked at")
        return 77
    checkout = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as temporary:
        folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else temporary)
        folder.mkdir(parents=True, exist_ok=True)
        site = pathlib.Path(temporary).resolve() / "site"
        made = make(checkout, site)
        expect(made.returncode == 0, f"mkdocs makes the site {made.stdout}{made.stderr}")
        dead = list(dead_links(site))
        expect(dead == [], f"every link leads to a file {dead}")
        pages = [page for page in site.rglob("*.html") if 'class="source"' not in page.read_text()]
        expect(len(pages) > 20, f"{len(pages)} pages")
        browser = Browser(chromium, os.path.join(temporary, "profile"))
        try:
            for page in sorted(pages):
                name = page.relative_to(site)
                for width, dark in ((400, True), (1400, False)):
                    browser.open(page, width=width, dark=dark)
                    across = browser.js("document.scrollingElement.scrollWidth")
                    expect(across <= width, f"{name}: {width} px wide, nothing sticks out ({across} px)")
                    complaints = own(browser.complaints(), site)
                    expect(complaints == [], f"{name}: no error, no request beyond the site {complaints}")
                    if len(sys.argv) > 2:
                        browser.screenshot(folder / f"{str(name).replace('/', '_')}-{width}.png")
            test_search(browser, site)
        finally:
            browser.close()
    print(f"{len(failures)} failures" if failures else "all good")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
