#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that names, comments, messages and docs use the field's terms and plain words.

Prints file:line for each word of WORDS, with the word to use instead. Exits with status 1 if there
is one outside the areas of NOT_DONE; there, words are only counted, and printed with --all. Names
are split into words first: a pattern for "triangle tree" also finds TriangleTree and triangle_tree.
Also checks that WORDS or UNCHECKED covers the words that the glossary advises against.
"""

import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SUFFIXES = {
    *(".h", ".cpp", ".inl", ".py", ".pyi", ".md", ".txt", ".cmake", ".sh", ".in", ".tsv"),
    *(".ts", ".js", ".mjs", ".html", ".css"),
}
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
    "samples",
    "scripts",
    "web",
    "CMakeLists.txt",
    "README.md",
    "CONTRIBUTING.md",
    "setup.py",
]
# History, in the words of its time, such as CHANGELOG.md, which is not in CHECKED; a page that
# bench/compare.py writes; and this file.
LEFT_OUT = [
    "docs/decisions",
    "docs/benchmarks.md",
    "scripts/check_words.py",
    "web/node_modules",
    "web/dist",
]

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
    r"both ways|looked at from all sides": "two-sided",
    r"radius fields?": "sizing field",
    r"boxes within boxes|triangle trees?": "bounding volume hierarchy (BVH)",
    r"buckets?": "CSR adjacency",
    r"rings around": "one-ring, k-ring",
    r"borders?|rims?": "boundary, volume boundary",
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
    r"besides": "in addition to",
    r"(there )?(is|are) none": "if it is missing, or another condition",
    r"nobody": "a sentence about what happens",
    r"go(es|ing)? back|went back": "revert",
    r"stays? where|where (it|they) stands?": "keeps its position; anchor",
    r"(?<!on )demand(s|ed|ing)?|wish(es|ed|ing)?|how far over": "constraint, bound, excess",
    r"moved a little": "displaced",
    r"which lies in which": "nesting",
    r"badness|goodness": "score, quality",
    r"be it|so as to|is seen to|seen to besides|hangs? together|manieth": "a plain sentence",
    r"work (apart|towards)|stand(s)? alone": "a name for what is done",
}

# Entries of the last column of the glossary that no pattern finds, because they are ordinary
# English that is right elsewhere: entry, reason.
UNCHECKED = {
    "touch": "triangles touch in shared corners; files are touched",
    "place": "right as a verb: a vertex is placed at its anchor",
    "places": "right as a verb",
    "ring": "one-ring, k-ring",
    "rings": "one-rings, k-rings",
    "around": "right in: triangles around a vertex",
    "triangles around": "the glossary explains fan, link and star with it",
    "evenly on both sides": "explains the balanced placement to users",
    "what is measured": "right as a heading",
    "what is proved": "right as a heading",
    "turned": "right in: turned into an error",
    "stays": "right for files, processes and memory",
    "cell (alone)": "right where one kind only occurs, and in names such as CellId",
    "part": "the term for a component of the capped surface",
    "piece": "the term for a triangle in one grid cell",
    "keep": "right for what is not deleted",
    "over": "right in: sum over all triangles",
    "sizing field": "the term for the radius of the covering",
}

# Places where such a word is right: prefix of the path, pattern for the unchanged line, reason.
EXCEPTIONS = [
    (
        "",
        r"--border|Border::|Border border|enum class Border|parse_border|[.>]border\b|border_text|"
        r"[\"'`]border[\"'`]|border : \{|\bborder[:=]|Border>|\(Border |border` open|"
        r"leave the border|components, border,|[SG]etBorder|BorderType|BORDERS|[(>.]Border\b|"
        r"int Border|Border:|\| Border \||name=\"Border",
        "the option for closed meshes",
    ),
    ("docs/report.md", r"with Shift", "a key"),
    ("docs/tasks/choose-isovalue.md", r"\bShift\b", "a key"),
    ("src/volume_files/meta_image_header.cpp", r"MET_[A-Z]", "names of sample types in MetaImage"),
    ("tests/differential/independent.py", r"MET_[A-Z]", "names of sample types in MetaImage"),
    ("docs/reference/formats.md", r"MET_[A-Z]", "names of sample types in MetaImage"),
    ("tests/unit/volume_files/", r"MET_[A-Z]", "names of sample types in MetaImage"),
    ("scripts/", r"\bshift( \d| \|\| true)?( ;;|$)", "the shell's command"),
    ("src/core/distance_queue.h", r"bucket", "the buckets of a radix heap"),
    ("apps/isoatlas/completion.cpp", r"shift words", "a builtin of zsh"),
    ("tests/cli/cli_test.py", r"MET_[A-Z]", "names of sample types in MetaImage"),
    ("samples/LICENSE-samples.txt", r"conditions are met", "the text of a licence"),
    ("src/page/LICENSE-VTK.txt", r"conditions are met", "the text of a licence"),
    ("web/src/style.css", r"border|--ground", "properties of CSS, and a colour"),
    ("web/src/view/view.css", r"border|--ground", "properties of CSS, and a colour"),
    ("docs/_static/site.css", r"border", "a property of CSS"),
    ("web/src/", r"\b(Shift|shiftKey)\b", "a key"),
    ("tests/page/", r"\bShift\b", "a key"),
    ("web/src/", r"\.(divideScalar|lookAt)\(", "functions of three.js"),
    ("web/src/shaders.ts", r"rim light", "a light from behind, in photography"),
    ("python/src/", r"\.is_none\(\)", "a function of pybind11"),
    ("", r"vtkStreamingDemandDrivenPipeline", "a class of VTK"),
    ("tests/unit/error/measure_test.cpp", r"/ rings, around", "two variables side by side"),
]


def in_area(path, areas):
    return any(path == area or path.startswith(area + "/") for area in areas)


def words_of(line):
    """The line as lower-case words. Names are split at underscores and capitals."""
    line = re.sub(r"([a-z0-9])([A-Z])", r"\1 \2", line)
    line = re.sub(r"\bNone\b", "|", line)  # Python's constant
    line = re.sub(r"[^A-Za-z0-9' _-]", " | ", line)  # phrases end at punctuation
    return " ".join(re.sub(r"[_-]", " ", line).lower().split())


def is_exception(path, line):
    return any(
        path.startswith(prefix) and re.search(pattern, line) for prefix, pattern, _ in EXCEPTIONS
    )


def unchecked_entries():
    """Yields line, entry and advice for what WORDS, UNCHECKED and the glossary do not agree on."""
    patterns = [re.compile(rf"\b({pattern})\b") for pattern in WORDS]
    unused = set(UNCHECKED)
    for number, line in enumerate((ROOT / GLOSSARY).read_text(encoding="utf-8").splitlines(), 1):
        if not line.startswith("| ") or line.startswith("| term |"):
            continue
        for entry in filter(None, map(str.strip, re.split("[,/]", line.split("|")[-2]))):
            unused.discard(entry)
            if entry not in UNCHECKED and not any(p.search(words_of(entry)) for p in patterns):
                yield number, entry, "add a pattern to WORDS, or a reason to UNCHECKED"
    for entry in sorted(unused):
        yield 1, entry, "no entry of the glossary: remove it from UNCHECKED"


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
    for number, entry, advice in unchecked_entries():
        failed = True
        print(f"{GLOSSARY}:{number}: '{entry}': {advice}")
    for area in NOT_DONE:
        print(f"not done yet: {area}: {counts[area]} words")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
