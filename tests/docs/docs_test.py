"""The pages say what is so: docs_test.py PROGRAM CHECKOUT [PAGE…]

The pages are all Markdown files of the checkout; commands are run of README.md and of experiments/docs, and of those that
are named. In each of them

- links and their anchors lead somewhere, and what looks like a file of the project is one;
- blocks of TOML and JSON can be read; a block whose first line is `# NAME` or `// NAME` is that file of the reader's;
- blocks of commands are run one after the other, in a folder that has what a reader is said to have (your_things.py) and
  the page's own files. A block ```text behind them is what they print: those lines, `…` standing for anything;
- an experiment's tables are read by `run --list`, put into a file of experiments/;
- pictures in SVG beside the page that a command of it makes are those that it makes now.

Not run are commands whose comment says what they take (minutes, hours) or need (root, a network): of these, and of
commands within sentences, it is asked whether the program has such a command with such options, and the files are there. Where
a test of the build is named, such a test has to be there.

The site that mkdocs makes of them is built and opened in a browser by site_test.py.
"""
import collections, fnmatch, json, os, pathlib, re, shlex, shutil, subprocess, sys, tempfile, tomllib, unicodedata

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import your_things

BLOCK = re.compile(r"^( *)```(\w*)\n(.*?)^\1```\s*?$", re.MULTILINE | re.DOTALL)
SPAN = re.compile(r"`([^`\n]+)`")
LINK = re.compile(r"\]\(([^()\s]+)\)")
UNRUN = re.compile(r"#.*\b(takes?|needs?)\b")
PLACEHOLDER = re.compile(r"\b[A-Z][A-Z_]+\b|…|\[")
FILE = re.compile(r"^[\w.-]+(/[\w.-]+)+\.(h|cpp|py|toml|md|csv|yml|sh|sbatch|ipynb|png|exr|cmake)$")
TABLES = re.compile(r"^\[\[?(simulations|photos|comparisons|twins|sweeps|pupil_passage|stray_light|edge_diffraction|tradeoff"
                    r"|planned|analysis_rings|focus_breathing|stability|measurement_floor|photographed_lenses|profiles)\b",
                    re.MULTILINE)


class Page:
    def __init__(self, checkout, path):
        self.path, self.folder = path, path.parent
        self.text = (checkout / path).read_text()
        self.prose = BLOCK.sub("", self.text)
        self.is_run = str(path) == "README.md" or str(path.parent) == "experiments/docs"

    def blocks(self):
        """(line, language, text without the indent)"""
        for found in BLOCK.finditer(self.text):
            lines = [line.removeprefix(found[1]) for line in found[3].splitlines()]
            yield self.text.count("\n", 0, found.start()) + 2, found[2], "\n".join(lines) + "\n"

    def headings(self):
        return [re.sub(r"`|\*", "", line) for line in re.findall(r"^#{1,6} (.*)$", self.prose, re.MULTILINE)]


def anchor(heading):
    return re.sub(r"[^\w\- ]", "", unicodedata.normalize("NFC", heading).strip().lower()).replace(" ", "-")


class Checkout:
    def __init__(self, program, root):
        self.program, self.root = program, root
        self.files = set(subprocess.run(["git", "-c", f"safe.directory={root}", "ls-files", "-co", "--exclude-standard"],
                                        cwd=root, check=True, capture_output=True, text=True).stdout.splitlines())
        self.pages = {path: Page(root, path) for path in map(pathlib.PurePosixPath, sorted(self.files)) if path.suffix == ".md"}
        told = subprocess.run([program, "--help"], check=True, capture_output=True, text=True).stdout
        self.commands = set(re.findall(r"^  ([a-z]+) ", told, re.MULTILINE))
        self.help = {}
        self.suites = {name for file in self.files if file.startswith("tests/") and file.endswith(".cpp")
                       for name in re.findall(r"^(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)", (root / file).read_text(), re.MULTILINE)}

    def options(self, command):
        """Of a command of the program, by its own help."""
        if command not in self.help:
            told = subprocess.run([self.program, command, "--help"], check=True, capture_output=True, text=True).stdout
            self.help[command] = set(re.findall(r"(?<![\w-])--?[a-z][\w-]*", told))
        return self.help[command]

    def complaint(self, words):
        """What is wrong with a command that is not run."""
        if not words or not re.fullmatch(r"[a-z]+", words[0]) or words[0] in ("test", "package", "docs"):  # the script's
            return None
        if words[0] not in self.commands:
            return f"the program has no command {words[0]}"
        known = self.options(words[0])
        for word in words[1:]:
            option = word.split("=")[0]
            if option.startswith("-") and option != "-" and not re.fullmatch(r"-[\d.].*", option) and option not in known:
                return f"{words[0]} has no option {option}"
            if word.startswith(("experiments/", "lenses/", "reference_photos/", "tests/")) and word.rstrip("/") not in self.files \
                    and not any(file.startswith(word.rstrip("/") + "/") for file in self.files):
                return f"there is no {word}"
        return None

    def has_file(self, page, name):
        return any(f"{place}{name}" in self.files for place in
                   ("", f"{page.folder}/", "engine/", "experiments/", "calibration/", "tests/")) or \
            any(file.endswith("/" + name) for file in self.files)


def words_of(line):
    return shlex.split(line, comments=True)


def check_words(checkout, page):
    """Links, files and commands within the sentences of a page."""
    for link in LINK.findall(SPAN.sub("", page.prose)):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, part = link.partition("#")
        target = pathlib.PurePosixPath(os.path.normpath(page.folder / path)) if path else page.path
        if str(target) not in checkout.files:
            yield f"links to {link}, which is no file"
        elif part and target.suffix == ".md" and part not in map(anchor, checkout.pages[target].headings()):
            yield f"links to {link}, where no heading is called so"
    for span in SPAN.findall(page.prose):
        span = span.replace("\\|", "|")
        filtered = re.search(r"--gtest_filter='([^']*)'", span)
        for pattern in filtered[1].split(":") if filtered else []:
            if not any(fnmatch.fnmatch(f"{suite}.{name}", pattern) or fnmatch.fnmatch(f"x/{suite}.{name}/0", pattern)
                       for suite, name in checkout.suites):
                yield f"names tests {pattern}, of which there is none"
        if FILE.match(span) and not span.startswith(("build/", "output/", "my_", "OpenImageDenoise/")) and not checkout.has_file(page, span):
            yield f"names {span}, which is no file of the project"
        if re.match(r"(\./)?lensproof [a-z]", span):
            try:
                words = words_of(span)[1:]
            except ValueError:
                continue
            if wrong := checkout.complaint([word for word in words if not PLACEHOLDER.search(word)] if words else words):
                yield f"`{span}`: {wrong}"


def agrees(expected, printed):
    """The expected lines stand in what was printed, in their order; `…` is anything within a line, or any lines."""
    lines = printed.splitlines()
    at = 0
    for want in expected.splitlines():
        if want.strip() in ("", "…"):
            continue
        pattern = re.escape(want.rstrip()).replace("…", ".*")
        while at < len(lines) and not re.fullmatch(pattern, lines[at].rstrip()):
            at += 1
        if at == len(lines):
            return want
        at += 1
    return None


def experiment_file(text):
    head = "" if re.search(r"^title\s*=", text.split("[")[0], re.MULTILINE) else 'title = "A page\'s"\n'
    return head + text


def check_block(checkout, page, language, text, place, state):
    named = re.match(r"(?:#|//) ([\w./-]+\.\w+)\n", text)
    if language == "json":
        json.loads(text)
    elif named and language in ("toml", "csv", "python", "json", ""):
        file = place / named[1]
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text.split("\n", 1)[1])
        state["own"].add(named[1])
        if language == "toml":
            tomllib.loads(text)
    elif language == "toml" and TABLES.search(text) and page.is_run:
        file = place / "experiments" / "of_a_page.toml"
        file.write_text(experiment_file(text))
        done = subprocess.run([checkout.program, "run", file, "--list"], capture_output=True, text=True)
        if done.returncode != 0:
            return f"run --list: {done.stderr.strip()}"
    elif language == "toml" and "…" not in text and page.is_run:
        tomllib.loads(text)
    elif language == "text" and page.is_run:
        want = agrees(text, state["printed"])
        if want is not None:
            return f"“{want}” is not what is printed:\n{state['printed']}"
    elif language in ("", "sh"):
        return run_commands(checkout, page, text, place, state)
    return None


def run_commands(checkout, page, text, place, state):
    state["printed"] = ""
    for line in text.replace("\\\n", " ").splitlines():
        ours = re.match(r"\s*(?:\./)?lensproof ", line)
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        if UNRUN.search(line) or (ours and not page.is_run):
            wrong = checkout.complaint([w for w in words_of(line)[1:] if not PLACEHOLDER.search(w)]) if ours else None
            if wrong:
                return f"{line.strip()}: {wrong}"
            continue
        if not ours and not page.is_run:
            continue
        if not ours:
            return f"{line.strip()}: is no command of the program's, and no comment says what it takes or needs"
        command = re.sub(r"^\s*(?:\./)?lensproof ", f"{shlex.quote(checkout.program)} ", line)
        done = subprocess.run(["bash", "-c", command], cwd=place, capture_output=True, text=True)
        state["printed"] += done.stdout + done.stderr
        wanted = re.search(r"exit status (\d)", line)
        if done.returncode != (int(wanted[1]) if wanted else 0):
            return f"{line.strip()}: exit status {done.returncode}: {(done.stdout + done.stderr)[-600:]}"
    return None


def check_pictures(checkout, page, place):
    for link in LINK.findall(page.prose):
        made = list(place.rglob(pathlib.PurePosixPath(link).name)) if link.endswith(".svg") else []
        shown = checkout.root / page.folder / link
        if made and made[0].read_bytes() != shown.read_bytes():
            shutil.copy(made[0], shown.with_suffix(".new.svg"))
            yield f"shows {link}, and its commands make another, which lies beside it as .new.svg"


def check_page(checkout, page, things):
    yield from check_words(checkout, page)
    blocks = [(line, language, text) for line, language, text in page.blocks()]
    if not any(language in ("toml", "csv", "json", "text", "sh", "") for _, language, _ in blocks):
        return
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder)
        shutil.copytree(things, place, dirs_exist_ok=True)
        for name in ("lenses", "reference_photos", "tests"):
            (place / name).symlink_to(checkout.root / name)
        (place / "experiments").mkdir()
        for inside in (checkout.root / "experiments").iterdir():
            (place / "experiments" / inside.name).symlink_to(inside)
        state = {"printed": "", "own": set()}
        for line, language, text in blocks:
            try:
                wrong = check_block(checkout, page, language, text, place, state)
            except (ValueError, json.JSONDecodeError, tomllib.TOMLDecodeError) as error:
                wrong = str(error)
            if wrong:
                yield f"line {line}: {wrong}"
        yield from check_pictures(checkout, page, place)


def check_itself(program):
    """That each check finds what is wrong with a page in which it is."""
    page = "# A page\n\nA [link](nowhere.md), a [place](README.md#b), `tests/no_such_test.cpp`, `lensproof rnder x`.\n"
    wrong = page + "\n```\n./lensproof lenses --no-such-option\n```\n```text\nnothing of the kind\n```\n" \
        "\n```toml\n[[sweeps]]\nname = 1\n```\n\n```\nls   # takes a network\nls\n```\n"
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name in ("experiments", "lenses", "reference_photos", "tests"):
            (root / name).mkdir()
        (root / "README.md").write_text(wrong)
        subprocess.run(["git", "init", "-q"], cwd=root, check=True)
        checkout = Checkout(program, root)
        (root / "things").mkdir()
        found = list(check_page(checkout, checkout.pages[pathlib.PurePosixPath("README.md")], root / "things"))
    for part in ("nowhere.md, which is no file", "#b, where no heading", "no_such_test.cpp, which", "no command rnder",
                 "--no-such-option", "nothing of the kind", "run --list", "ls: is no command"):
        if not any(part in fault for fault in found):
            sys.exit(f"a page with \"{part}\" in it is not found wrong: {found}")


def main():
    program, root = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
    os.environ["LENSPROOF_CACHE"] = "off"
    os.environ["LENSPROOF_HOME"] = str(root)
    check_itself(program)
    checkout = Checkout(program, root)
    faults = []
    with tempfile.TemporaryDirectory() as things:
        your_things.make(program, things)
        for path, page in checkout.pages.items():
            page.is_run |= str(path) in sys.argv[3:]
            if not sys.argv[3:] or str(path) in sys.argv[3:]:
                faults += [f"{path}: {fault}" for fault in check_page(checkout, page, things)]
    print("\n".join(faults) or f"{len(checkout.pages)} pages are as they say")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
