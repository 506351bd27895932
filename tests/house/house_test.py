"""The plan of the house: house_test.py CHECKOUT

- No circle of folders: the folders of engine/, calibration/ and experiments/ include each other in one direction only.
  (Which of them a folder may include at all, the build holds: .ci/rooms.cmake.)
- A namespace a room: what lies in engine/ROOM or experiments/ROOM is in lensproof::ROOM, in calibration/ in
  lensproof::calibration, in engine/base in lensproof itself. Folders within a room share its namespace.
- engine/README.md's table of the rooms says what engine/CMakeLists.txt does.
- One door to the terminal: texts for people go through experiments/cli/terminal.h, which shows what would steer it.
- Tests mirror the sources: a folder below tests/engine, tests/calibration and tests/experiments is a folder there.
- What GPUs run (a .cu file and all that it includes) is without what nvcc 13 compiles to nothing, and says nothing of:
  the arithmetic of std::complex (x / y becomes x), std::countr_zero and its kin (32, whatever the bits).
- Names keep to engine/README.md's words: what it calls otherwise (UNNAMED below) is no name's part. Prose may say it.
- A namespace a file of tests, named as the file: they are compiled several to a text, some with another room's.
- No name is defined twice: two files that define the same type, or a function of the same name and parameters, in one
  namespace are linked into one program, which is undefined behaviour that no linker tells.
- An unnamed namespace's name is alone in its room, its headers' and engine/base's included: sources are compiled
  several to a text, and one more decides which.

universal-ctags finds the definitions; without it these two parts are skipped, exit status 77.

Each check is tried first on a small house where it has to find something.
"""
import collections, json, pathlib, re, shutil, subprocess, sys, tempfile

SKIPPED = 77
HOUSES = ("engine", "calibration", "experiments")
UNNAMED = re.compile(r"((^|_)(share|way)|Share|Way)s?(?![a-z])")


def sources(home, houses=HOUSES):
    return sorted(file for house in houses for file in (home / house).rglob("*") if file.suffix in (".h", ".cpp"))


def included_folders(home):
    """{folder: {folder that it includes: one file that does}}"""
    graph = collections.defaultdict(dict)
    for file in sources(home):
        folder = file.parent.relative_to(home).as_posix()
        for included in re.findall(r'^\s*#\s*include\s*"([^"]+)"', file.read_text(), re.MULTILINE):
            other = pathlib.PurePosixPath(included).parent.as_posix()
            if other not in (folder, "."):
                graph[folder].setdefault(other, f"{file.relative_to(home)} includes {included}")
    return graph


def circles(home):
    graph = included_folders(home)
    done, path = set(), []

    def visit(folder):
        if folder in path:
            circle = path[path.index(folder):] + [folder]
            return ["folders in a circle: " + "; ".join(graph[a][b] for a, b in zip(circle, circle[1:]))]
        if folder in done:
            return []
        path.append(folder)
        found = [fault for other in sorted(graph.get(folder, ())) for fault in visit(other)]
        path.pop()
        done.add(folder)
        return found

    return [fault for folder in sorted(graph) for fault in visit(folder)]


def namespace_of(folder):
    room = folder.parts[0] if folder.parts[0] == "calibration" else folder.parts[1]
    return "lensproof" if room == "base" else f"lensproof::{room}"


def misplaced(home):
    faults = []
    for file in sources(home):
        expected = namespace_of(file.parent.relative_to(home))
        opened = re.findall(r"^namespace (lensproof\S*) {", file.read_text(), re.MULTILINE)
        faults += [f"{file.relative_to(home)} opens namespace {name}, expected {expected}"
                   for name in opened if name != expected and not name.startswith(expected + "::")]
        if not opened and file.name != "main.cpp":
            faults.append(f"{file.relative_to(home)} opens no namespace, expected {expected}")
    return faults


def mistold(home):
    told = re.findall(r"^\| `(\S+)` \| .* \| ?((?:`\S+` ?)*)\|$", (home / "engine/README.md").read_text(), re.MULTILINE)
    told = {room: re.findall(r"`(\S+)`", uses) for room, uses in told}
    built = {}
    for room, words in re.findall(r"lensproof_room\(engine/(\S+)([^)]*)\)", (home / "engine/CMakeLists.txt").read_text()):
        uses = re.search(r"USES((?:\s+engine/\S+)*)", words)
        built[room] = re.findall(r"engine/(\S+)", uses[1]) if uses else []
    return [f"engine/README.md says that {room} uses {told.get(room)}, engine/CMakeLists.txt {uses}"
            for room, uses in built.items() if told.get(room) != uses]


def past_the_door(home):
    # The progress bar steers the line that it stands on; main() flushes, and lends the stream to JSON, which has its own
    # escapes.
    doors = {f"experiments/cli/{name}.cpp" for name in ("terminal", "progress", "main")}
    return [f"{file.relative_to(home)} writes to the terminal by itself: {found[0]}" for file in sources(home)
            if file.relative_to(home).as_posix() not in doors
            and (found := re.search(r"fmt::print\(|std::(cout|cerr|fwrite|fputs|puts|printf)\b", file.read_text()))]


def unmirrored(home):
    return [f"tests/{folder} mirrors no folder {folder}"
            for folder in sorted({file.parent.relative_to(home / "tests") for file in sources(home / "tests")})
            if not (home / folder).is_dir()]


def lost_on_gpus(home):
    found, seen, todo = [], set(), sorted(file for house in HOUSES for file in (home / house).rglob("*.cu"))
    while todo:
        file = todo.pop()
        if file in seen or not file.exists():
            continue
        seen.add(file)
        text = re.sub(r"//.*", "", file.read_text())
        todo += [home / included for included in re.findall(r'#\s*include\s*"([^"]+)"', text)]
        found += [f"{file.relative_to(home)}, which GPUs run, has {lost}, which nvcc drops"
                  for lost in re.findall(r"std::(?:complex|count[lr]_(?:zero|one))\b|__builtin_c[lt]z\w*", text)]
    return found


def misnamed(home):
    not_code = re.compile(r'//[^\n]*|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|^TEST\w*\(.*?\)', re.DOTALL | re.MULTILINE)
    names = {(name, file.relative_to(home)) for file in sources(home, HOUSES + ("tests",))
             for name in re.findall(r"[A-Za-z_]\w*", not_code.sub("", file.read_text())) if UNNAMED.search(name)}
    return [f"{file} names {name}, for which engine/README.md has the words" for name, file in sorted(names)]


def crowded(home):
    return [f"{file.relative_to(home)} opens no namespace lensproof::…::{file.stem}"
            for file in sorted((home / "tests").rglob("*_test.cpp"))
            if not re.search(rf"^namespace lensproof\S*::{file.stem} {{", file.read_text(), re.MULTILINE)]


def definitions(home, files):
    """Of ctags, and the file: of functions, types, variables and aliases in namespaces."""
    found = subprocess.run(
        ["ctags", "--languages=C++", "--langmap=C++:.h.cpp", "--kinds-C++=csugtfve", "--fields=+KSZ",
         "--output-format=json", "-o", "-", *map(str, files)], check=True, capture_output=True, text=True)
    for line in found.stdout.splitlines():
        tag = json.loads(line)
        # The members of types are what their types stand for.
        if tag.get("scopeKind", "namespace") == "namespace" and tag["name"] != "main":
            yield tag, pathlib.Path(tag["path"]).relative_to(home)


def parameters_of(tag):
    return re.sub(r"\b\w+(?=[,)])|\s", "", tag.get("signature", "")) if tag["kind"] == "function" else ""


def defined_twice(home):
    places = collections.defaultdict(set)
    for tag, file in definitions(home, sources(home, HOUSES + ("tests",))):
        scope = tag.get("scope", "")
        is_own = "__anon" in scope + tag["name"] or tag["kind"] in ("variable", "enumerator")
        is_anyones = tag["kind"] == "function" and re.search(r"\btemplate\b|\bstatic\b", tag.get("pattern", ""))
        if not is_own and not is_anyones:
            places[f"{scope}::{tag['name']}{parameters_of(tag)}"].add(str(file))
    return [f"{name} is defined in {' and in '.join(sorted(files))}"
            for name, files in sorted(places.items()) if len(files) > 1]


def unnamed_twice(home):
    own, headers = collections.defaultdict(set), collections.defaultdict(set)
    for tag, file in definitions(home, sources(home)):
        scope, name = tag.get("scope", ""), tag["name"] + parameters_of(tag)
        if "__anon" in scope:
            own[namespace_of(file.parent), name].add(str(file))
        elif file.suffix == ".h":
            headers[scope, name].add(str(file))
    places = {(room, name): files | headers[room, name] | headers["lensproof", name]
              for (room, name), files in own.items()}
    return [f"{room}::{name} has no namespace of its own in {' and in '.join(sorted(files))}"
            for (room, name), files in sorted(places.items()) if len(files) > 1]


def planted(check, files, found):
    """That the check finds what is to be found in a house of these files."""
    with tempfile.TemporaryDirectory() as folder:
        home = pathlib.Path(folder)
        for name, text in files.items():
            (home / name).parent.mkdir(parents=True, exist_ok=True)
            (home / name).write_text(text)
        faults = check(home)
    if len(faults) != 1 or found not in faults[0]:
        sys.exit(f"{check.__name__} does not find what was planted, \"{found}\": {faults}")


def main():
    home = pathlib.Path(sys.argv[1]).resolve()
    planted(circles, {"engine/optics/lens.h": '#include "engine/scene/light.h"\n',
                      "engine/scene/light.h": '#include "engine/render/film.h"\n',
                      "engine/render/film.h": '#include "engine/optics/lens.h"\n'}, "film.h includes engine/optics/lens.h")
    planted(misplaced, {"engine/optics/lens.h": "namespace lensproof::scene {\n"}, "expected lensproof::optics")
    planted(mistold, {"engine/CMakeLists.txt": "lensproof_room(engine/optics USES engine/base\n  engine/scene LINKS x)\n",
                      "engine/README.md": "| `optics` | lenses | `base` |\n"}, "optics uses ['base']")
    planted(unmirrored, {"engine/optics/lens.h": "", "tests/engine/io/lens_test.cpp": ""}, "tests/engine/io")
    planted(crowded, {"tests/cli/run_test.cpp": "namespace lensproof {\n"}, "lensproof::…::run_test")
    planted(lost_on_gpus, {"engine/optics/a_job.cu": '#include "engine/optics/film.h"\n',
                           "engine/optics/film.h": "// std::countr_zero\nstd::complex<T> r;\n"}, "film.h, which GPUs run, has std::complex")
    planted(misnamed, {"engine/optics/a.h": "// A way.\nint f(double gap_share, double shared, double always) {\n"
                                            '    return g("share", swayed);\n}\n'}, "a.h names gap_share")
    planted(past_the_door, {"experiments/cli/a_command.cpp": 'fmt::print("{}\\n", name);'}, "fmt::print")
    faults = circles(home) + misplaced(home) + mistold(home) + past_the_door(home) + unmirrored(home) + crowded(home)
    faults += lost_on_gpus(home) + misnamed(home)
    has_ctags = shutil.which("ctags") and "Universal" in subprocess.run(
        ["ctags", "--version"], capture_output=True, text=True).stdout
    if has_ctags:
        for one, other in (("struct Spot {};", "class Spot { int x; };"),
                           ("int sum(int a, double b) { return a; }", "int sum(int x, double y) { return x; }")):
            planted(defined_twice, {"engine/optics/a.cpp": "namespace lensproof {\n" + one + "\n}\n",
                                    "engine/optics/b.cpp": "namespace lensproof {\n" + other + "\n}\n",
                                    "engine/scene/c.cpp": "namespace lensproof {\nnamespace {\n" + one + "\n}\n}\n"},
                    "engine/optics/a.cpp and in engine/optics/b.cpp")
        for text in ("constexpr int kA = 1;", "struct A {};", "using A = int;", "int a(int b) { return b; }"):
            planted(unnamed_twice, {f"engine/{file}.cpp": "namespace lensproof {\nnamespace {\n" + text + "\n}\n}\n"
                                    for file in ("optics/a", "optics/b", "scene/c")},
                    "has no namespace of its own in engine/optics/a.cpp and in engine/optics/b.cpp")
            for header, room in (("engine/optics/b.h", "lensproof::optics"), ("engine/base/b.h", "lensproof")):
                planted(unnamed_twice,
                        {"engine/optics/a.cpp": f"namespace lensproof {{\nnamespace {{\n{text}\n}}\n}}\n",
                         header: f"namespace {room} {{\n{text}\n}}\n",
                         "engine/scene/b.h": f"namespace lensproof::scene {{\n{text}\n}}\n"}, header)
        faults += defined_twice(home) + unnamed_twice(home)
    print("\n".join(faults) or f"{len(sources(home))} sources, {len(included_folders(home))} folders: nothing found")
    if faults:
        sys.exit(1)
    if not has_ctags:
        print("skipped: names that stand twice, because universal-ctags is not installed")
        sys.exit(SKIPPED)


if __name__ == "__main__":
    main()
