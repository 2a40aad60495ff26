#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that each row of docs/reference/formats.md names an existing test.

    scripts/check_formats.py [PROJECT]

Prints one line for each row without a test or with an unknown test, and then exits with status 1.
"""

import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)


def all_tests():
    """The names of all tests, and the suites with parametrized tests."""
    names, suites = set(), set()
    for file in (root / "tests").rglob("*.cpp"):
        for kind, suite, name in re.findall(
            r"\b(TEST|TEST_F|TEST_P|TYPED_TEST)\((\w+),\s*(\w+)\)", file.read_text()
        ):
            names.add(f"{suite}.{name}")
            if kind == "TEST_P":
                suites.add(suite)
    return names, suites


def problems(text, names, suites):
    for number, line in enumerate(text.splitlines(), 1):
        last = line.rstrip().rstrip("|").split("|")[-1].strip()
        if not line.startswith("|") or line.startswith("|---") or last == "test":
            continue
        tests = re.findall(r"`([^`]+)`", last)
        if not tests:
            yield f"line {number}: names no test: {line[:80]}"
        for test in tests:
            if test not in names and test.split(".")[0] not in suites:
                yield f"line {number}: there is no test {test}"


found = list(problems((root / "docs/reference/formats.md").read_text(), *all_tests()))
print("\n".join(found) if found else "each row names an existing test")
sys.exit(1 if found else 0)
