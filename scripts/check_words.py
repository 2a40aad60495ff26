#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that names, comments, messages and docs use the field's terms and plain words.

Prints file:line for each word of WORDS, with the word to use instead. Exits with status 1 if there
is one outside the areas of NOT_DONE; there, words are only counted, and printed with --all. Names
are split into words first: a pattern for "triangle tree" also finds TriangleTree and triangle_tree.
"""

import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SUFFIXES = {".h", ".cpp", ".inl", ".py", ".pyi", ".md", ".txt", ".cmake", ".sh"}
CHECKED = [
    "src",
    "include",
    "apps",
    "python",
    "tests",
    "bench",
    "cmake",
    "docs",
    "examples",
    "scripts",
    "CMakeLists.txt",
    "README.md",
    "CONTRIBUTING.md",
]
# History, in the words of its time; a page that bench/compare.py writes; and this file.
LEFT_OUT = ["docs/decisions", "docs/benchmarks.md", "scripts/check_words.py"]

# The last column of its table lists words not to use.
GLOSSARY = "docs/glossary.md"

# Areas that still use other words. Remove an area here when it is done.
NOT_DONE = []

# Words to avoid -> words to use. Patterns match lower-case words separated by single blanks.
WORDS = {
    r"meets?|met|meeting": (
        "intersect (geometry); adjacent, share an arc (topology); satisfy (bounds)"
    ),
    r"over (a|the|its|their) bounds?|over bounds": "violate a bound",
    r"both ways": "two-sided",
    r"radius fields?": "sizing field",
    r"boxes within boxes|triangle trees?": "bounding volume hierarchy (BVH)",
    r"buckets?": "CSR adjacency",
    r"rings around": "one-ring, k-ring",
    r"inside out|turned (over|components?|inside)": "inverted",
    r"roam(s|ing)?|stray(s|ed|ing)?|settle vertices": "movable, displacement",
    r"shift(s|ed|ing)?": "displacement, displace",
    r"pinned|held|gave up|giv(e|es|en|ing) up": "fixed",
    r"put back|take back|takes back|taken back|takes? apart|taken apart": "revert; separate",
    r"divid(e|es|ed|ing)(?! (by|out|evenly))": "subdivide (surface), split (face, side)",
    r"part(ed|ing)": "separate; resolve intersections",
    r"the one before|(level|stage|one) before it|level before": "previous",
    r"tells?|told|telling": "report, fill_report",
    r"says?|said|saying": "state, report, determine",
    r"look(s|ed|ing)? (at|into|for|among|between|around)": "test, check, query, search",
    r"ask(s|ed|ing)?": "query, request, test",
    r"brings? out": "to output space",
    r"crowded": "multi-sheet",
    r"watch(es|ed|ing)?": "checked",
    r"ground": "surface data",
    r"re ?mak(e|es|ing)|remade|made anew|makes? anew": "rebuild",
    r"go(es|ing)? on|went on": "continue",
    r"judg(e|es|ed|ing|ement|ements)": "check, evaluate",
    r"mend(s|ed|ing)?": "repair",
    r"badness|goodness": "score, quality",
    r"be it|so as to|is seen to|seen to besides|hangs? together|manieth": "a plain sentence",
    r"work (apart|towards)|stand(s)? alone": "a name for what is done",
}

# Places where such a word is right: prefix of the path, pattern for the unchanged line, reason.
EXCEPTIONS = [
    ("docs/report.md", r"with Shift", "a key"),
    ("src/volume_files/meta_image_header.cpp", r"MET_[A-Z]", "names of sample types in MetaImage"),
    ("tests/differential/independent.py", r"MET_[A-Z]", "names of sample types in MetaImage"),
    ("docs/reference/formats.md", r"MET_[A-Z]", "names of sample types in MetaImage"),
    ("tests/unit/volume_files/", r"MET_[A-Z]", "names of sample types in MetaImage"),
    ("scripts/", r"\bshift( \d| \|\| true)?( ;;|$)", "the shell's command"),
    ("src/core/distance_queue.h", r"bucket", "the buckets of a radix heap"),
    ("apps/isoatlas/completion.cpp", r"shift words", "a builtin of zsh"),
    ("tests/cli/cli_test.py", r"MET_[A-Z]", "names of sample types in MetaImage"),
    ("tests/unit/error/measure_test.cpp", r"/ rings, around", "two variables side by side"),
]


def in_area(path, areas):
    return any(path == area or path.startswith(area + "/") for area in areas)


def words_of(line):
    """The line as lower-case words. Names are split at underscores and capitals."""
    line = re.sub(r"([a-z0-9])([A-Z])", r"\1 \2", line)
    line = re.sub(r"[^A-Za-z0-9' _-]", " | ", line)  # phrases end at punctuation
    return " ".join(re.sub(r"[_-]", " ", line).lower().split())


def is_exception(path, line):
    return any(
        path.startswith(prefix) and re.search(pattern, line) for prefix, pattern, _ in EXCEPTIONS
    )


def findings():
    patterns = [(re.compile(rf"\b({pattern})\b"), word) for pattern, word in WORDS.items()]
    for start in CHECKED:
        top = ROOT / start
        for path in sorted(top.rglob("*")) if top.is_dir() else [top]:
            name = path.relative_to(ROOT).as_posix()
            if path.suffix not in SUFFIXES or in_area(name, LEFT_OUT) or not path.is_file():
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                words = words_of(line.rsplit("|", 2)[0] if name == GLOSSARY else line)
                for pattern, word in patterns:
                    found = pattern.search(words)
                    if found and not is_exception(name, line):
                        yield name, number, found.group(0), word


def main():
    show_all = "--all" in sys.argv[1:]
    counts = collections.Counter()
    failed = False
    for name, number, found, word in findings():
        not_done = next((area for area in NOT_DONE if in_area(name, [area])), None)
        if not_done:
            counts[not_done] += 1
        else:
            failed = True
        if show_all or not not_done:
            print(f"{name}:{number}: '{found}': say {word}")
    for area in NOT_DONE:
        print(f"not done yet: {area}: {counts[area]} words")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
