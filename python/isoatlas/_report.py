# SPDX-License-Identifier: Apache-2.0
"""Reports as dicts: the JSON of the command line with the names that arguments have in Python."""

from __future__ import annotations

import json
import re
from typing import Any

# Names of constraints inside sentences: "max-distance comes first".
_NAME = re.compile(
    r"\b(?:(?:max|mean)-distance|area-curvature(?:-smooth)?|geodesic-ratio|normal-angle"
    r"|(?:max|min)-(?:vertices|edge)|min-aspect)\b"
)


def report_of(text: str) -> dict[str, Any]:
    """The report of an extraction."""
    report: dict[str, Any] = json.loads(text)
    parameters = report["parameters"]
    for constraint in parameters["coarse"]:
        _name(constraint)
    for level in parameters["refine"]:
        for constraint in level:
            _name(constraint)
    rule = parameters.pop("non_finite")
    # The arguments that select the surface come first, as in the signature of extract().
    report["parameters"] = {
        "iso": report["surface"]["isovalue"],
        "inside": report["surface"]["inside"],
        "nan": None if rule == "refuse" else rule,
        "topology": report["surface"]["topology"],
        **parameters,
    }
    report["levels"] = [_level(level) for level in report["levels"]]
    return report


def level_of(text: str) -> dict[str, Any]:
    """The report of a level, as stored in a file; empty if the file has none."""
    return _level(json.loads(text) or {})


def _level(level: dict[str, Any]) -> dict[str, Any]:
    for constraint in level.get("constraints") or ():
        _name(constraint)
    if level.get("metrics"):
        level["metrics"] = {_argument(name): it for name, it in level["metrics"].items()}
    return level


def _name(constraint: dict[str, Any]) -> None:
    constraint["quantity"] = _argument(constraint["quantity"])
    if constraint.get("reason"):
        constraint["reason"] = _NAME.sub(lambda name: _argument(name[0]), constraint["reason"])


def _argument(name: str) -> str:
    return name.replace("-", "_")
