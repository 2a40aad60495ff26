#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Adds the licences of the libraries in a wheel, and packs it so that equal files give equal bytes.

  scripts/finish_wheel.py WHEEL FOLDER   reads a wheel that `auditwheel repair` made, writes FOLDER

The libraries are Debian's, and so are the texts: .dist-info/licenses/libraries. LICENCES names the
licence of each package; a package that is not in it stops the build, so that no library under the
GNU GPL gets into a wheel unnoticed.
"""

import base64
import hashlib
import pathlib
import re
import subprocess
import sys
import zipfile

# Debian package -> licence of the library in it.
LICENCES = {
    "libblosc1": "BSD-3-Clause",
    "libdraco7": "Apache-2.0",
    "libbrotli1": "MIT",
    "libbz2-1.0": "bzip2-1.0.6",
    "libcharls2": "BSD-3-Clause",
    "libcpp-httplib0.11": "MIT",
    "libdcmtk17": "BSD-3-Clause",
    "libdeflate0": "MIT",
    "libdouble-conversion3": "BSD-3-Clause",
    "libglew2.2": "BSD-3-Clause, MIT",
    "libgmp10": "LGPL-3.0-or-later",
    "libicu72": "Unicode-DFS-2016",
    "libjpeg62-turbo": "IJG, BSD-3-Clause, Zlib",
    "liblerc4": "Apache-2.0",
    "liblz4-1": "BSD-2-Clause",
    "liblzma5": "public domain",
    "libmeshoptimizer2d": "MIT",
    "libopenjp2-7": "BSD-2-Clause",
    "libpng16-16": "libpng-2.0",
    "libpugixml1v5": "MIT",
    "libsnappy1v5": "BSD-3-Clause",
    "libssl3": "Apache-2.0",
    "libstb0": "MIT or public domain",
    "libtbb12": "Apache-2.0",
    "libtiff6": "libtiff",
    "libtinygltf2d": "MIT",
    "libvtk9.1": "BSD-3-Clause",
    "libwebp7": "BSD-3-Clause",
    "libxml2": "MIT",
    "libzip4": "BSD-3-Clause",
    "libzstd1": "BSD-3-Clause",
}
# What is compiled in: a file that the package contains -> licence.
COMPILED_IN = {
    "/usr/include/CLI/CLI.hpp": "BSD-3-Clause",
    "/usr/include/boost/version.hpp": "BSL-1.0",
    "/usr/include/CGAL/version.h": "LGPL-3.0-or-later (headers of the Kernel)",
    "/usr/include/expat.h": "MIT",
    "/usr/include/nifti/nifti2.h": "public domain",
    "/usr/include/nlohmann/json.hpp": "MIT",
}
NOT_JBIG = b"JBIG is not supported in this build of isoatlas"  # scripts/no_jbig.c
HEADER = """\
Libraries in this wheel, in addition to isoatlas (Apache-2.0). They are those of Debian 12; only the
names by which they find each other are changed. Their sources are Debian's source packages of the
same versions. The folder `libraries` has the full texts. You may replace a shared library, such as
GMP, by another build of it.
The HTML page contains three.js and meshoptimizer (both MIT); it starts with their licences.
"""


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def package_of(file):
    """(package, version) of Debian that contains the file; a name alone is searched."""
    found = output_of("dpkg-query", "-S", file if file.startswith("/") else f"*/{file}")
    package = found.split(":")[0]
    return package, output_of("dpkg-query", "-W", "-f=${Version}", package)


def shared_libraries(files):
    """{name as in Debian: contents} of the libraries that auditwheel has put into the wheel."""
    return {
        re.sub(r"-[0-9a-f]{8}(?=\.)", "", pathlib.PurePath(name).name, count=1): contents
        for name, contents in files.items()
        if re.match(r"isoatlas\.libs/.*\.so", name)
    }


def licences(files, pybind11):
    """{name below .dist-info/licenses: contents} for all libraries in the wheel."""
    rows, texts = [], {}

    def add(library, package, version, licence):
        rows.append((library, f"{package} {version}", licence))
        texts[f"libraries/{package}.txt"] = pathlib.Path(
            f"/usr/share/doc/{package}/copyright").read_bytes()

    for library, contents in sorted(shared_libraries(files).items()):
        if library.startswith("libjbig"):
            if NOT_JBIG not in contents:
                sys.exit(f"{library}: is the library under the GNU GPL, expected scripts/no_jbig.c")
            continue
        package, version = package_of(library)
        if package not in LICENCES:
            sys.exit(f"{library}: the licence of its package {package} is not known: read "
                     f"/usr/share/doc/{package}/copyright, and add it to {sys.argv[0]}")
        add(library, package, version, LICENCES[package])
    for file, licence in COMPILED_IN.items():
        add("(compiled in)", *package_of(file), licence)
    rows.append(("(compiled in)", "pybind11", "BSD-3-Clause"))
    texts["libraries/pybind11.txt"] = pybind11.read_bytes()
    widths = [max(len(row[column]) for row in rows) for column in (0, 1)]
    table = "".join(f"{library:{widths[0]}}  {package:{widths[1]}}  {licence}\n"
                    for library, package, licence in rows)
    texts["LIBRARIES.txt"] = (HEADER + "\n" + table).encode()
    return texts


def record_line(name, contents):
    digest = base64.urlsafe_b64encode(hashlib.sha256(contents).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(contents)}\n"


def main(wheel, folder):
    with zipfile.ZipFile(wheel) as archive:
        modes = {it.filename: it.external_attr for it in archive.infolist() if not it.is_dir()}
        files = {name: archive.read(name) for name in modes}
    (record,) = [name for name in files if name.endswith(".dist-info/RECORD")]
    info = record.rsplit("/", 1)[0]
    import pybind11

    (text,) = pathlib.Path(pybind11.__file__).parent.parent.glob("pybind11-*/**/LICENSE")
    for name, contents in licences(files, text).items():
        files[f"{info}/licenses/{name}"] = contents
    del files[record]
    lines = [record_line(name, files[name]) for name in sorted(files)]
    files[record] = ("".join(lines) + f"{record},,\n").encode()
    result = folder / wheel.name
    with zipfile.ZipFile(result, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name in [*sorted(name for name in files if name != record), record]:
            entry = zipfile.ZipInfo(name)  # of 1980, so that equal files give equal wheels
            entry.external_attr = modes.get(name, 0o100644 << 16)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, files[name], compresslevel=9)
    print(f"{result}: {result.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
