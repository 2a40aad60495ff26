#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Installs the build into an empty folder and builds programs against it, as other projects do."""
import array
import functools
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests/docs"))

from markdown_blocks import all_blocks, cpp_program  # noqa: E402

BUILD = pathlib.Path(os.environ.get("ISOATLAS_BUILD", ROOT / "build/release"))
CMAKE = os.environ.get("CMAKE", "cmake")
CXX = os.environ.get("CXX", "g++")
CONSUMER = ROOT / "examples/consumer"
EXPECTED = "296 triangles, genus 0\n1422 triangles, genus 1\n"


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                          **options)
    if done.returncode != 0:
        raise AssertionError(
            f"{' '.join(map(str, command))}: "
            f"{done.returncode}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
        )
    return done.stdout


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.top = pathlib.Path(cls.folder.name)
        cls.prefix = cls.top / "prefix"
        run(CMAKE, "--install", BUILD, "--prefix", cls.prefix)
        cls.libraries = next(path.parent for path in cls.prefix.rglob("libisoatlas.so"))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def environment(self):
        """The environment in which pkg-config and the loader find the libraries."""
        return {
            **os.environ, "PKG_CONFIG_PATH": str(self.libraries / "pkgconfig"),
            "LD_LIBRARY_PATH": str(self.libraries)
        }

    def build_by_pkg_config(self, package, source, program):
        flags = run("pkg-config", "--cflags", "--libs", package, env=self.environment()).split()
        run(CXX, "-std=c++20", source, *flags, "-o", program)
        return program

    def build(self, name, cmake_text, source):
        folder = self.top / name
        folder.mkdir()
        (folder / "CMakeLists.txt").write_text(cmake_text)
        (folder / "main.cpp").write_text(source)
        run(CMAKE, "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}",
            f"-DCMAKE_CXX_COMPILER={CXX}")
        run(CMAKE, "--build", folder / "build")
        return folder / "build" / "main"

    def test_find_package(self):
        build = self.top / "consumer"
        run(CMAKE, "-S", CONSUMER, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}",
            f"-DCMAKE_CXX_COMPILER={CXX}")
        run(CMAKE, "--build", build)
        self.assertEqual(run(build / "consumer"), EXPECTED)

    def test_static_library(self):
        cmake_text = ("cmake_minimum_required(VERSION 3.16)\nproject(main CXX)\n"
                      "find_package(isoatlas CONFIG REQUIRED)\n"
                      "add_executable(main main.cpp)\n"
                      "target_link_libraries(main PRIVATE isoatlas::static)\n")
        main = self.build("static", cmake_text, (CONSUMER / "main.cpp").read_text())
        self.assertEqual(run(main), EXPECTED)
        self.assertNotIn("libisoatlas", run("ldd", main))

    def test_component_io(self):
        if not list(self.prefix.rglob("libisoatlas_io.so")):
            self.skipTest("built without ISOATLAS_BUILD_IO")
        main = self.build(
            "io", "cmake_minimum_required(VERSION 3.16)\nproject(main CXX)\n"
            "find_package(isoatlas CONFIG REQUIRED COMPONENTS core io)\n"
            "add_executable(main main.cpp)\ntarget_link_libraries(main PRIVATE isoatlas::io)\n",
            r"""
#include <isoatlas/io.h>
#include <isoatlas/isoatlas.h>
#include <cstring>
#include <iostream>
int main(int, char** argv) {
  const isoatlas::Volume volume = isoatlas::read_volume(argv[1]);
  isoatlas::write_mesh(isoatlas::extract(volume, 100).mesh(), argv[2]);
  std::cout << isoatlas::mesh_topology(isoatlas::read_mesh(argv[2])).genus() << '\n';
  std::cout << isoatlas::to_json(isoatlas::extract(volume, 100).report).substr(0, 1) << '\n';
  try {
    isoatlas::read_volume("missing.nrrd");  // an error thrown by the library
  } catch (const isoatlas::Error& error) {
    std::cout << (error.code() == isoatlas::ErrorCode::bad_file) << '\n';
  }
}
""")
        self.assertEqual(run(main, ROOT / "samples/protein_iron.nhdr", self.top / "mesh.ply"),
                         "8\n{\n1\n")

    def test_component_vtk(self):
        if not list(self.prefix.rglob("libisoatlas_vtk.so")):
            self.skipTest("built without ISOATLAS_BUILD_VTK_FILTER")
        build = self.top / "vtk_filter"
        run(CMAKE, "-S", ROOT / "examples/vtk_filter", "-B", build,
            f"-DCMAKE_PREFIX_PATH={self.prefix}", f"-DCMAKE_CXX_COMPILER={CXX}")
        run(CMAKE, "--build", build)
        self.assertRegex(run(build / "vtk_filter"),
                         r"^level 0: .*\nlevel 1: .*\nlevel 2: \d+ triangles, 9 components\n$")

    def test_slicer_module(self):
        """The script finds the tool of its own installation."""
        modules = list(self.prefix.rglob("isoatlas/slicer/IsoAtlas"))
        if not modules:
            self.skipTest("built without ISOATLAS_BUILD_TOOL")
        self.assertEqual(len(list(modules[0].parent.iterdir())), 1)  # Slicer runs all programs
        without_path = {**self.environment(), "PATH": "/usr/bin:/bin"}
        self.assertTrue(run(modules[0], "--xml", env=without_path).startswith("<?xml"))

    def test_unknown_component_is_refused(self):
        folder = self.top / "unknown"
        folder.mkdir()
        (folder / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.16)\nproject(main CXX)\n"
            "find_package(isoatlas CONFIG REQUIRED COMPONENTS nothing)\n")
        done = subprocess.run(
            [CMAKE, "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}"],
            capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("nothing", done.stderr)

    def test_pkg_config(self):
        program = self.build_by_pkg_config("isoatlas", CONSUMER / "main.cpp",
                                           self.top / "by_pkg_config")
        self.assertEqual(run(program, env=self.environment()), EXPECTED)

    @functools.lru_cache(maxsize=None)
    def mesher(self):
        """A program VOLUME ISOVALUE MESH that refines to the default bound, by pkg-config."""
        if not list(self.prefix.rglob("libisoatlas_io.so")):
            self.skipTest("built without ISOATLAS_BUILD_IO")
        source = self.top / "mesher.cpp"
        source.write_text(r"""
#include <isoatlas/io.h>
#include <isoatlas/isoatlas.h>
#include <cstdlib>
#include <iostream>
int main(int, char** argv) {
  const isoatlas::Volume volume = isoatlas::read_volume(argv[1]);
  const isoatlas::Extraction result = isoatlas::extract(volume, std::atof(argv[2]));
  isoatlas::write_mesh(result.mesh(), argv[3]);
  const auto& constraints = result.finest().constraints;
  std::cout << result.finest().topology.genus << ' ' << constraints.size() << ' '
            << constraints.at(0).constraint.bound << '\n';
}
""")
        return self.build_by_pkg_config("isoatlas_io", source, self.top / "mesher")

    def test_pkg_config_of_io(self):
        mesh = self.top / "pkg_config.ply"
        printed = run(self.mesher(), ROOT / "samples/protein_iron.nhdr", 100, mesh,
                      env=self.environment())
        self.assertEqual(printed, "8 1 0.5\n")
        self.assertGreater(mesh.stat().st_size, 10000)

    def test_default_bound_is_that_of_the_tool(self):
        """tests/python/test_command_line.py compares Python with the tool."""
        tool = self.prefix / "bin/isoatlas"
        if not tool.exists():
            self.skipTest("built without ISOATLAS_BUILD_TOOL")
        # Layers over four times as thick as the smallest spacing: the bound is 3 / 8.
        layers = self.top / "layers.nrrd"
        samples = array.array("f", (6.3 - math.hypot(0.5 * x - 8, 0.5 * y - 8, 3 * z - 12)
                                    for z in range(9) for y in range(33) for x in range(33)))
        layers.write_bytes(b"NRRD0004\ntype: float\ndimension: 3\nsizes: 33 33 9\n"
                           b"spacings: 0.5 0.5 3\nendian: little\nencoding: raw\n\n" +
                           samples.tobytes())
        for volume, isovalue, bound in ((ROOT / "samples/protein_iron.nhdr", 100, 0.5),
                                        (layers, 0, 0.375)):
            ours, theirs = self.top / "library.ply", self.top / "tool.ply"
            printed = run(self.mesher(), volume, isovalue, ours, env=self.environment())
            summary = run(tool, "extract", volume, "--iso", isovalue, "-o", theirs,
                          env=self.environment())
            self.assertEqual(float(printed.split()[2]), bound)
            self.assertIn(f"(default {bound})", summary)
            without_comments = [re.sub(rb"comment .*\n", b"", path.read_bytes())
                                for path in (ours, theirs)]
            self.assertTrue(without_comments[0] == without_comments[1], volume)

    def test_snippets_of_the_documentation(self):
        """Each CMake snippet of a page builds the C++ snippet of the page, or the consumer."""
        found = all_blocks()
        snippets = [block for block in found if block.language == "cmake"]
        self.assertIn("README.md", [block.page for block in snippets])
        for number, block in enumerate(snippets):
            cpp = [cpp_program(other) for other in found
                   if other.language == "cpp" and other.page == block.page]
            main = self.build(
                f"snippet_{number}", "cmake_minimum_required(VERSION 3.16)\nproject(main CXX)\n"
                f"add_executable(main main.cpp)\n{block.text}",
                cpp[0] if cpp else (CONSUMER / "main.cpp").read_text())
            run(main)

    def test_no_trace_of_the_source_folder(self):
        for path in [
                *self.prefix.rglob("*.cmake"), *self.prefix.rglob("*.pc"), *self.prefix.rglob("*.h")
        ]:
            text = path.read_text()
            self.assertNotIn(str(ROOT), text, path)
            self.assertNotIn(str(BUILD), text, path)
        for header in self.prefix.rglob("*.h"):
            self.assertNotIn("detail/", header.read_text(), header)

    def test_only_public_names_are_exported(self):
        for library in self.libraries.glob("libisoatlas*.so"):
            names = run("nm", "-DC", "--defined-only", library)
            self.assertNotIn("isoatlas::detail::", names, library)
        self.assertIn("SONAME", run("readelf", "-d", self.libraries / "libisoatlas.so"))
        self.assertRegex(run("readelf", "-d", self.libraries / "libisoatlas.so"),
                         r"libisoatlas\.so\.\d+\.\d+")

    def test_manual_pages_and_completions(self):
        if not (self.prefix / "bin/isoatlas").exists():
            self.skipTest("built without ISOATLAS_BUILD_TOOL")
        self.assertIn("isoatlas \\- isosurfaces",
                      (self.prefix / "share/man/man1/isoatlas.1").read_text())
        page = (self.prefix / "share/man/man1/isoatlas-extract.1").read_text()
        for text in (".SH NAME\nisoatlas\\-extract \\- ", ".SH EXIT STATUS\n",
                     "\\-\\-max\\-distance"):
            self.assertIn(text, page)
        script = self.prefix / "share/bash-completion/completions/isoatlas"

        def complete(*words):
            """The completions of the last word, as the shell prints them."""
            line = " ".join(words)
            return run("bash", "-c", f'source {script}; COMP_WORDS=({line}); '
                       f'COMP_CWORD={len(words) - 1}; _isoatlas; echo "${{COMPREPLY[@]}}"')

        self.assertEqual(complete("isoatlas", "extract", "--pla"), "--placement\n")
        self.assertEqual(complete("isoatlas", "extract", "--placement", "b"), "balanced\n")
        self.assertEqual(complete("isoatlas", "ex"), "extract\n")

    def help_options(self):
        """Command of the tool -> options on its help page."""
        tool = self.prefix / "bin/isoatlas"
        if not tool.exists():
            self.skipTest("built without ISOATLAS_BUILD_TOOL")
        pages = {}
        for command in re.findall(r"(?m)^    ([a-z]+)  ", run(tool, "--help",
                                                              env=self.environment())):
            page = run(tool, command, "--help", env=self.environment())
            listed = "\n".join(re.findall(r"(?m)^    (-.*)$", page))
            pages[command] = set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", listed))
        self.assertIn("--max-distance", pages["extract"])
        self.assertGreaterEqual(len(pages), 7)
        return pages

    def scripts(self):
        """Shell -> installed script."""
        share = self.prefix / "share"
        return {
            "bash": share / "bash-completion/completions/isoatlas",
            "zsh": share / "zsh/vendor-completions/_isoatlas",
            "fish": share / "fish/vendor_completions.d/isoatlas.fish",
        }

    def test_completions_have_every_command_and_option(self):
        pages = self.help_options()
        text = {shell: path.read_text() for shell, path in self.scripts().items()}
        for command, options in pages.items():
            self.assertRegex(text["bash"], rf"\b{command}\b")
            self.assertIn(f"'{command}:", text["zsh"])
            self.assertIn(f"-a {command} ", text["fish"])
            zsh = re.search(rf"(?ms)^    {command}\)\n(.*?)^ +;;", text["zsh"])[1]
            of_command = "__fish_seen_subcommand_from " + command
            fish = [line for line in text["fish"].splitlines() if f"{of_command}'" in line]
            bash = re.search(rf"(?ms)^    {command}\)\n?(.*?);;", text["bash"])[1]
            for option in options:
                where = f"{command} {option}"
                name = option.lstrip("-")
                flag = f" -l {name} " if option.startswith("--") else f" -s {name} "
                self.assertIn(f"'*{option}[", zsh, f"zsh: {where}")
                self.assertTrue(any(flag in line for line in fish), f"fish: {where}")
                self.assertRegex(bash, rf"(?<![\w-]){option}(?![\w-])", f"bash: {where}")

    def test_shells_accept_the_completions(self):
        self.help_options()
        missing = []
        for shell, path in self.scripts().items():
            if shutil.which(shell):
                environment = {**os.environ, "HOME": str(self.top)}
                run(shell, "-n", path, env=environment)
            else:
                missing.append(shell)
        if missing:
            self.skipTest(f"{' and '.join(missing)} is not installed")

    def test_fish_completes(self):
        self.help_options()
        if not shutil.which("fish"):
            self.skipTest("fish is not installed")

        def complete(line):
            printed = run("fish", "--no-config", "-c",
                          f"source {self.scripts()['fish']}; complete -C '{line}'",
                          env={**os.environ, "HOME": str(self.top)})
            return [line.split("\t")[0] for line in printed.splitlines()]

        self.assertEqual(complete("isoatlas ex"), ["extract"])
        self.assertEqual(complete("isoatlas extract --pla"), ["--placement"])
        self.assertEqual(complete("isoatlas extract --placement b"), ["balanced"])


@unittest.skipUnless(os.environ.get("ISOATLAS_TEST_SUBFOLDER"),
                     "builds the library again: set ISOATLAS_TEST_SUBFOLDER=1")
class Subfolder(unittest.TestCase):
    """add_subdirectory builds the core without tests and file readers, in the given build type."""

    def test_add_subdirectory(self):
        with tempfile.TemporaryDirectory() as folder:
            top = pathlib.Path(folder)
            (top / "CMakeLists.txt").write_text(
                "cmake_minimum_required(VERSION 3.16)\nproject(main CXX)\n"
                f"add_subdirectory({ROOT} isoatlas)\n"
                f"add_executable(main {CONSUMER}/main.cpp)\n"
                "target_link_libraries(main PRIVATE isoatlas::isoatlas)\n"
                "get_target_property(type isoatlas_static TYPE)\n"
                "message(STATUS \"type=${type} build=[${CMAKE_BUILD_TYPE}]\")\n")
            printed = run(CMAKE, "-S", top, "-B", top / "build", f"-DCMAKE_CXX_COMPILER={CXX}",
                          "-DISOATLAS_UNITY_BUILD=ON", "-G", "Ninja")
            self.assertIn("type=STATIC_LIBRARY build=[]", printed)
            self.assertNotIn("VTK", printed)
            run(CMAKE, "--build", top / "build", "--target", "main")
            self.assertEqual(run(top / "build/main"), EXPECTED)


@unittest.skipUnless(os.environ.get("ISOATLAS_TEST_CLANG"),
                     "builds the library again: set ISOATLAS_TEST_CLANG=1")
class Clang(unittest.TestCase):
    """The core builds without a warning with clang 14 and libc++, and gives the same meshes."""

    def test_core_and_examples(self):
        compiler = shutil.which("clang++-14")
        if not compiler:
            self.skipTest("clang++-14 is not installed")
        with tempfile.TemporaryDirectory() as folder:
            top = pathlib.Path(folder)
            run(CMAKE, "-S", ROOT, "-B", top / "build", "-G", "Ninja",
                "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_CXX_COMPILER={compiler}",
                "-DCMAKE_CXX_FLAGS_RELEASE=-O0", "-DCMAKE_CXX_FLAGS=-stdlib=libc++",
                "-DISOATLAS_WARNINGS_AS_ERRORS=ON", "-DISOATLAS_UNITY_BUILD=ON",
                "-DISOATLAS_BUILD_IO=OFF", "-DISOATLAS_BUILD_TOOL=OFF",
                "-DISOATLAS_BUILD_TESTS=OFF", "-DISOATLAS_BUILD_PAGE=OFF")
            run(CMAKE, "--build", top / "build")
            self.assertIn("libc++", run("ldd", top / "build/src/libisoatlas.so"))
            for example in ("consumer", "implicit_field", "edge_length_field", "custom_metric"):
                run(compiler, "-std=c++20", "-stdlib=libc++", f"-I{ROOT}/include",
                    f"-I{top}/build/include", ROOT / "examples" / example / "main.cpp",
                    f"-L{top}/build/src", "-lisoatlas", f"-Wl,-rpath,{top}/build/src", "-o",
                    top / example)
                self.assertEqual(run(top / example), run(BUILD / "bin" / f"example_{example}"))
            self.assertEqual(run(top / "consumer"), EXPECTED)


if __name__ == "__main__":
    unittest.main()
