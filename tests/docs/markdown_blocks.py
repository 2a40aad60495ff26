# SPDX-License-Identifier: Apache-2.0
"""The pages of the documentation and their code blocks, fenced and indented."""

import dataclasses
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
FENCE = re.compile(r"(?P<indent> *)(?P<marks>```+|~~~+) *(?P<language>\S*)")
ITEM = re.compile(r" *([-*+]|\d+[.)]) +")


def pages():
    """README, the pages of the site and those that they include, without history."""
    folders = [
        path
        for path in (ROOT / "docs").rglob("*.md")
        if "decisions" not in path.parts and path.name not in ("decisions.md", "changelog.md")
    ]
    others = ["README.md", "CONTRIBUTING.md", "samples/README.md", "bench/peers/README.md"]
    return sorted([*folders, *(ROOT / name for name in others)])


@dataclasses.dataclass(frozen=True)
class Block:
    """A code block. `language` is empty if the block states none."""

    page: str  # relative to the root of the repository
    line: int  # of the first line of the text
    language: str
    text: str  # without its indentation

    def __str__(self):
        return f"{self.page}:{self.line}"


def dedented(lines, columns):
    """The lines without their first blanks, as one text."""
    return "".join(
        (line[columns:] if not line[:columns].strip() else line.lstrip()) + "\n" for line in lines
    )


def blocks(path):
    """All code blocks of a page, from top to bottom."""
    page = str(pathlib.Path(path).relative_to(ROOT))
    return blocks_of_text(page, pathlib.Path(path).read_text(encoding="utf-8"))


def blocks_of_text(page, text):
    lines = text.splitlines()
    found, at, text_column = [], 0, 0
    while at < len(lines):
        line = lines[at]
        indent = len(line) - len(line.lstrip())
        fence = FENCE.match(line)
        is_after_blank = at == 0 or not lines[at - 1].strip()
        if fence and indent < text_column + 4:
            if indent < text_column:
                text_column = 0
            end = at + 1
            while end < len(lines) and not lines[end].strip().startswith(fence["marks"]):
                end += 1
            found.append(Block(page, at + 2, fence["language"],
                               dedented(lines[at + 1:end], len(fence["indent"]))))
            at = end + 1
            continue
        if line.strip() and is_after_blank:
            if indent < text_column:
                text_column = 0
            if indent >= text_column + 4:
                end = at
                while end < len(lines) and (not lines[end].strip() or
                                            lines[end].startswith(" " * (text_column + 4))):
                    end += 1
                code = lines[at:end]
                while not code[-1].strip():
                    code.pop()
                found.append(Block(page, at + 1, "", dedented(code, text_column + 4)))
                at = end
                continue
        item = ITEM.match(line)
        if item:
            text_column = item.end()
        elif line.strip() and indent < text_column and is_after_blank:
            text_column = 0
        at += 1
    return found


def all_blocks():
    """All code blocks of all pages."""
    return [block for path in pages() for block in blocks(path)]


# Declarations of the names that a C++ block of a page uses: a ball, by its distances.
CPP_NAMES = {
    "README.md": r"""
  const int nx = 36, ny = 30, nz = 20;
  std::vector<float> samples;
  for (int i = 0; i < nx * ny * nz; ++i)
    samples.push_back(static_cast<float>(310 - std::hypot(0.8 * (i % nx) - 14,
        0.8 * (i / nx % ny) - 12, 1.5 * (i / (nx * ny)) - 14)));
""",
    "docs/hosts/vtk.md": r"""
  vtkNew<vtkImageData> ct;
  ct->SetDimensions(20, 20, 20);
  ct->AllocateScalars(VTK_FLOAT, 1);
  for (int i = 0; i < 8000; ++i)
    static_cast<float*>(ct->GetScalarPointer())[i] = static_cast<float>(
        306 - std::hypot(i % 20 - 9.4, i / 20 % 20 - 9.6, i / 400 - 9.1));
""",
}


def cpp_program(block):
    """A whole program that contains a C++ block, with the names that it needs in front of it."""
    if re.search(r"(?m)^int main\(", block.text):
        return block.text
    at_top = re.compile(r"(?m)^(#include .*|using namespace .*)\n")
    top = "".join(match[0] for match in at_top.finditer(block.text))
    return (f"#include <cmath>\n#include <vector>\n{top}int main() {{\n"
            f"{CPP_NAMES.get(block.page, '')}{at_top.sub('', block.text)}}}\n")
