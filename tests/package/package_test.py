#!/usr/bin/env python3
"""package_test.py BUILD SOURCE — an installation serves by itself, wherever it is moved to.

Installs what BUILD has made of SOURCE into a folder, moves that, and asks of it, without the source tree's help: the
program and the data that ship with it; that no file names the machine's folders; the manual page; bash's and, where
there is one, zsh's completions; a program of another project that finds the engine and traces the ray that the command
line traces.
"""
import csv
import io
import os
import pathlib
import pty
import re
import select
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD, SOURCE = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
ENVIRONMENT = {key: value for key, value in os.environ.items() if not key.startswith("LENSPROOF_")}
EVERYDAY = ["demo", "check", "convert", "analyze", "trace", "ghosts", "render", "merge", "chart", "measure", "fit",
            "compare", "twins", "export", "run", "tradeoff", "plan", "lenses", "glasses", "coatings", "completion",
            "manual"]


def output(*command, **settings):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=600,
                          env=ENVIRONMENT | settings.pop("env", {}), **settings)
    if done.returncode:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="lensproof-package-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        output("cmake", "--install", BUILD, "--prefix", cls.folder / "made here")
        cls.place = cls.folder / "moved there"
        (cls.folder / "made here").rename(cls.place)
        cls.program = cls.place / "bin/lensproof"

    def test_the_program_finds_its_data(self):
        self.assertIn("focal length", output(self.program, "analyze", "tessar", cwd=self.folder))
        self.assertIn("SCHOTT", output(self.program, "glasses", "N-BK7", cwd=self.folder))
        output(self.program, "chart", "charuco", "-o", "markers.svg", cwd=self.folder)  # engine/scene/data
        scene = self.place / "share/lensproof/experiments/scenes/tessar_checkerboard.toml"
        output(self.program, "render", scene, "--spp", 1, "-o", "view.exr", cwd=self.folder)  # engine/spectral/data
        output(self.program, "run", "--help", cwd=self.folder)

    def test_starting_it_loads_no_library_for_pictures(self):
        needed = output("readelf", "-d", self.program)
        self.assertIn("libOpenEXR", needed)
        self.assertNotIn("libOpenImageIO", needed)  # loaded late, with the 250 that it brings

    def test_it_knows_what_it_was_made_from(self):
        version = output(self.program, "--version")
        commit = subprocess.run(["git", "-c", "safe.directory=*", "-C", SOURCE, "rev-parse", "HEAD"],
                                capture_output=True, text=True)
        self.assertIn(commit.stdout.strip() or "unknown", version)
        self.assertRegex(version, r"built by \w+ [0-9.]+ against OpenCV [0-9.]+")

    def test_no_file_names_the_machine(self):
        for file in self.place.rglob("*"):
            if file.is_file():
                content = file.read_bytes()
                for folder in (SOURCE, BUILD, self.folder):
                    self.assertFalse(str(folder).encode() in content, f"{file} names {folder}")

    def test_links_between_the_pages_lead_somewhere(self):
        data = self.place / "share/lensproof"
        for page in data.rglob("*.md"):
            for link in re.findall(r"\]\(([^)#]+)", page.read_text()):
                if not link.startswith("http") and (SOURCE / page.relative_to(data).parent / link).suffix in (".md", ".png"):
                    self.assertTrue((page.parent / link).exists(), f"{page.relative_to(data)} links to {link}")

    def test_the_manual_page_has_every_command(self):
        page = (self.place / "share/man/man1/lensproof.1").read_text()
        for command in EVERYDAY:
            self.assertRegex(page, rf"(?m)^\.SS {command}$")
        self.assertRegex(page, r"(?m)^\.SH EXIT STATUS$")
        if shutil.which("groff"):
            warned = subprocess.run(["groff", "-man", "-ww", "-Kutf8", "-Tutf8", "-z"], input=page, text=True,
                                    capture_output=True, check=True)
            self.assertEqual(warned.stderr, "")

    def completions(self, *words):
        script = self.place / "share/bash-completion/completions/lensproof"
        lines = f'source "{script}"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _lensproof; printf "%s\\n" "${{COMPREPLY[@]}}"'
        return output("bash", "-c", lines, "bash", "lensproof", *words, cwd=self.folder).split("\n")[:-1]

    def test_bash_completes_commands_options_choices_lenses_and_files(self):
        self.assertEqual(self.completions("ana"), ["analyze"])
        self.assertEqual(sorted(self.completions("")), sorted(EVERYDAY + ["--help", "--version"]))
        self.assertIn("--f-number", self.completions("analyze", "--f"))
        self.assertEqual(self.completions("trace", "--precision", "e"), ["extended"])
        self.assertEqual(self.completions("analyze", "tessar-j"), ["tessar-jena-50"])
        (self.folder / "my lens.toml").touch()
        self.assertEqual(self.completions("check", "my"), ["my lens.toml"])
        self.assertEqual(self.completions("measure", "my"), ["my lens.toml"])
        self.assertEqual(self.completions("analyze", "--plots", "mov"), ["moved there"])

    def pressed(self, *lines):
        """What a person's zsh makes of each line, typed into its terminal and followed by a tab."""
        functions = self.place / "share/zsh/vendor-completions"
        process, terminal = pty.fork()
        if process == 0:
            os.chdir(self.folder)
            os.execvpe("zsh", ["zsh", "-f", "-i"], ENVIRONMENT | {"TERM": "dumb", "LC_ALL": "C.UTF-8"})
        os.write(terminal, f'fpath=("{functions}" $fpath); autoload -Uz compinit; compinit -u -D; setopt no_beep; '
                 'tell() { print -r -- "<$BUFFER>"; BUFFER=; }; zle -N tell; bindkey "^G" tell; PS1="now""> "\n'.encode())
        told = ""

        def read_until(enough):
            nonlocal told
            while not enough():
                self.assertTrue(select.select([terminal], [], [], 60)[0], told)
                told += os.read(terminal, 4096).decode(errors="replace")

        read_until(lambda: "now> " in told)
        told = ""
        for count, line in enumerate(lines, 1):
            os.write(terminal, f"{line}\t\a".encode())
            read_until(lambda: len(re.findall(r"<(.*?)>\r", told)) == count)
        os.close(terminal)
        os.waitpid(process, 0)
        return [line.rstrip() for line in re.findall(r"<(.*?)>\r", told)]

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not here")
    def test_zsh_completes_commands_options_choices_lenses_and_files(self):
        (self.folder / "my other lens.toml").touch()
        self.assertEqual(
            self.pressed("lensproof ana", "lensproof analyze --f-n", "lensproof trace --precision e",
                         "lensproof analyze tessar-j", "lensproof check my\\ o", "lensproof measure my\\ o"),
            ["lensproof analyze", "lensproof analyze --f-number", "lensproof trace --precision extended",
             "lensproof analyze tessar-jena-50", "lensproof check my\\ other\\ lens.toml",
             "lensproof measure my\\ other\\ lens.toml"])

    def test_another_program_traces_the_same_ray(self):
        build = self.folder / "uses_engine"
        output("cmake", "-G", "Ninja", "-S", SOURCE / "tests/package/uses_engine", "-B", build,
               f"-DCMAKE_PREFIX_PATH={self.place}")
        output("cmake", "--build", build)
        theirs = output(build / "uses_engine", env={"LENSPROOF_HOME": str(self.place / "share/lensproof")}).split()
        rays = self.folder / "rays.csv"
        rays.write_text("id,x_mm,y_mm,z_mm,dx,dy,dz,wavelength_nm\na,0,3,-10,0,0,1,587.5618\n")
        rows = list(csv.DictReader(io.StringIO(output(self.program, "trace", "tessar", "--rays", rays))))
        # The program stops at the last surface; the image plane is the command line's own last row.
        last = rows[-2]
        for have, key in zip(theirs, ("x_mm", "y_mm", "z_mm")):
            self.assertAlmostEqual(float(have), float(last[key]), delta=1e-12)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
