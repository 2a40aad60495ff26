# SPDX-License-Identifier: Apache-2.0
"""Medians of runs and their ratios. Some are only bounds: a run over its time limit gives one."""

import dataclasses
import statistics


@dataclasses.dataclass(frozen=True)
class Figure:
    value: float
    bound: str = ""  # ">": the true value is larger, "<": smaller

    def scaled(self, factor):
        return Figure(self.value * factor, self.bound)


def ratio(numerator, denominator):
    """The quotient; None if a figure is missing, or if two bounds leave the ratio undetermined."""
    if numerator is None or denominator is None or denominator.value == 0:
        return None
    opposite = {"": "", ">": "<", "<": ">"}[denominator.bound]
    if numerator.bound and opposite and numerator.bound != opposite:
        return None
    return Figure(numerator.value / denominator.value, numerator.bound or opposite)


def number(value):
    """At least three significant digits, without an exponent."""
    size = abs(value)
    digits = 0 if size >= 100 else 1 if size >= 10 else 2 if size >= 1 or size == 0 else 3
    return f"{value:,.{digits}f}"


def text(figure, show=number):
    """The figure for a table cell, with its sign if it is a bound; "–" without a figure."""
    if figure is None:
        return "–"
    return (f"{figure.bound} " if figure.bound else "") + show(figure.value)


class Series:
    """All runs of one program on one case."""

    def __init__(self, records):
        self.records = records
        self.results = [r["result"] for r in records if r["outcome"] == "finished"]
        self.over = next((r for r in records if r["outcome"] == "over_limit"), None)
        self.failed = next((r for r in records if r["outcome"] == "failed"), None)

    def median(self, value):
        """Median over all repeats of all runs; None if a run did not finish.

        value(result) is the list of the repeats in one process.
        """
        if not self.results or self.over or self.failed:
            return None
        values = [x for result in self.results for x in value(result) if x is not None]
        return Figure(statistics.median(values)) if values else None

    def seconds(self, clock):
        """The time of isoatlas. `clock` is "cpu_s" or "wall_s"."""
        if self.over and not self.failed:
            return Figure(self.over["result"]["cancelled_after"][clock], ">")
        return self.median(lambda r: r["isoatlas"][clock])

    def peak_bytes(self):
        # The first repeat, because its heap is unused before.
        return self.median(lambda r: r["isoatlas"]["peak_bytes"][:1])

    def stages(self):
        names = dict.fromkeys(
            name for result in self.results for name in result["isoatlas"]["stages_s"]
        )
        return {
            name: self.median(lambda r, name=name: r["isoatlas"]["stages_s"].get(name, []))
            for name in names
        }

    def c_vertices(self):
        return self.results[0]["c_vertices"] if self.results else None

    def bytes_per_c_vertex(self):
        return ratio(self.peak_bytes(), Figure(self.c_vertices())) if self.results else None

    def level(self, key, index=-1):
        return self.results[0]["levels"][index][key] if self.results else None

    def intersections(self):
        """Number of intersecting pairs of all levels."""
        return (
            sum(level["self_intersections"] for level in self.results[0]["levels"])
            if self.results
            else None
        )

    def problem(self):
        """Why there are no figures, or None."""
        if self.failed:
            limit = f"limit of the address space: {self.failed['memory_limit_gib']:g} GiB"
            return f"failed: {self.failed['message']} ({limit})"
        if self.over:
            return f"more than {number(self.over['limit_s'])} s"
        return None


def filter_seconds(all_series, name, clock="cpu_s"):
    """Median time of a VTK filter over the runs of all series."""
    values = [
        x
        for series in all_series
        for record in series.records
        for x in record.get("result", {}).get(name, {}).get(clock, [])
    ]
    return Figure(statistics.median(values)) if values else None
