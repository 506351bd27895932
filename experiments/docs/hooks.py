"""What mkdocs is told by a program: the pages are all that README.md leads to, link by link, at the places where they lie.

Links to other files lead to pages that show their text, pictures and those files are copied, and anchors are those of code hosts, so that
the same text serves there and here. A link that leads nowhere ends the build.
"""
import html, json, os, pathlib, re, unicodedata

from mkdocs.exceptions import BuildError
from mkdocs.structure.files import File, Files

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURES = (".png", ".jpg", ".svg")
LINK = re.compile(r"\]\(([^()\s]+)\)")
CODE = re.compile(r"^(```).*?^```|`[^`\n]*`", re.MULTILINE | re.DOTALL)
sources = set()  # files that pages link to and that are neither pages nor pictures
sections = []    # what is searched


def links(page):
    """The files that a page links to, as (link, file)."""
    for link in LINK.findall(CODE.sub("", (ROOT / page).read_text())):
        path = link.split("#")[0]
        if path and not re.match(r"[a-z]+:", path):
            yield link, pathlib.PurePosixPath(os.path.normpath(page.parent / path))


def anchor(heading, separator="-"):
    """As code hosts make it of a heading."""
    words = unicodedata.normalize("NFC", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", words).replace(" ", separator)


def reached(first):
    pages, pictures = {}, set()
    waiting = list(first)
    while waiting:
        page = waiting.pop(0)
        if page in pages:
            continue
        pages[page] = None
        for link, file in links(page):
            if not (ROOT / file).is_file():
                raise BuildError(f"{page} links to {link}, which is no file")
            if file.suffix == ".md":
                waiting.append(file)
            else:
                (pictures if file.suffix in PICTURES else sources).add(file)
    return list(pages), sorted(pictures)


def on_config(config):
    config["mdx_configs"]["toc"] = {"slugify": anchor}
    return config


def on_files(files, config):
    named = [pathlib.PurePosixPath(path) for entry in config["nav"] for path in entry.values()]
    pages, pictures = reached(named)
    theme = [file for file in files if not file.src_uri.endswith((".html", ".md"))]
    return Files(theme + [File(str(path), str(ROOT), config["site_dir"], False) for path in pages + pictures + sorted(sources)])


def add_sections(content, page):
    heads = [*re.finditer(r'<h[1-3] id="([^"]*)">(.*?)</h[1-3]>', content, re.DOTALL), None]
    for head, following in zip(heads, heads[1:]):
        text = content[head.end():following.start() if following else None]
        plain = [html.unescape(" ".join(re.sub(r"<[^>]+>", " ", part).split())) for part in (head[2], text)]
        sections.append({"page": page.title, "title": plain[0], "url": f"{page.file.url}#{head[1]}", "text": plain[1]})


def on_page_content(content, page, config, files):
    add_sections(content, page)
    folder = pathlib.PurePosixPath(page.file.src_uri).parent
    def to_page(found):
        file = pathlib.PurePosixPath(os.path.normpath(folder / found[1]))
        return f'href="{found[1]}.html"' if file in sources else found[0]
    return re.sub(r'href="([^"#]+)"', to_page, content)


def on_post_build(config):
    site = pathlib.Path(config["site_dir"])
    (site / "search.js").write_text(f"takeSections({json.dumps(sections, ensure_ascii=False)});\n")
    template = config["theme"].get_env().get_template("source.html")
    for file in sources:
        out = site / f"{file}.html"
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(template.render(name=file, text=(ROOT / file).read_text(), home="../" * len(file.parents[:-1])))
