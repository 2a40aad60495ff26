# SPDX-License-Identifier: Apache-2.0
"""SVG plots for docs/benchmarks.md. With the same matplotlib, equal figures give equal bytes."""

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

matplotlib.rcParams.update(
    {
        "svg.hashsalt": "isoatlas",
        "svg.fonttype": "none",
        "font.size": 9,
        "font.family": "sans-serif",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "#dddddd",
        "axes.axisbelow": True,
    }
)
COLOURS = {"A": "#c8553d", "B": "#3a6ea5"}
OTHER = ("#3b8f5a", "#8a5aa8")


def save(figure, path):
    figure.savefig(
        path,
        format="svg",
        metadata={"Date": None, "Creator": None},
        facecolor="white",
        bbox_inches="tight",
    )
    plt.close(figure)
    # Matplotlib ends lines with spaces.
    path.write_text("\n".join(line.rstrip() for line in path.read_text().splitlines()) + "\n")


def plain(value, _=None):
    return f"{value:,.10g}"


def short(value, _=None):
    """The value with a suffix, such as 100 k or 2 M."""
    for factor, unit in ((1e6, " M"), (1e3, " k")):
        if value >= factor:
            return f"{value / factor:,.10g}{unit}"
    return plain(value)


def log_ticks(axes, which, widen=2.0, show=plain):
    """Put ticks at 1, 2 and 5 (in wide ranges at 1) on a logarithmic axis.

    The axis covers at least a factor of widen^2.
    """
    get, put, axis = (
        (axes.get_xlim, axes.set_xlim, axes.xaxis)
        if which == "x"
        else (axes.get_ylim, axes.set_ylim, axes.yaxis)
    )
    low, high = get()
    if low <= 0:  # the plot is empty
        return
    middle = (low * high) ** 0.5
    low, high = min(low, middle / widen), max(high, middle * widen)
    put(low, high)
    axis.set_major_locator(
        matplotlib.ticker.LogLocator(subs=(1, 2, 5) if high < 200 * low else (1,))
    )
    axis.set_major_formatter(show)
    axis.set_minor_locator(matplotlib.ticker.NullLocator())


def no_figures(path):
    figure, axes = plt.subplots(figsize=(8, 0.6))
    axes.set_axis_off()
    axes.text(0.5, 0.5, "no run has finished", ha="center", va="center")
    save(figure, path)


def marker(figure, default="o"):
    """The marker of a figure: an arrow for a bound."""
    return {"": default, ">": ">", "<": "<"}[figure.bound]


def dots(path, names, series, label, reference=1.0, limits=None):
    """Plot one row per name.

    series: list of (label, colour, figures), with a figure or None per name.
    limits: per name an upper limit, or None.
    """
    if not any(f for _, _, figures in series for f in figures):
        return no_figures(path)
    height = 1 + 0.2 * len(names)
    figure, axes = plt.subplots(figsize=(8, height))
    rows = range(len(names))
    for text, colour, figures in series:
        shown = [(f.value, row, marker(f)) for row, f in zip(rows, figures) if f is not None]
        for kind in sorted({m for _, _, m in shown}):
            axes.scatter(
                [v for v, _, m in shown if m == kind],
                [r for _, r, m in shown if m == kind],
                s=26,
                marker=kind,
                color=colour,
                label=text if kind == "o" else f"{text}, only a bound",
                zorder=3,
            )
    if limits and any(limits):
        axes.scatter(
            [x for x in limits if x],
            [r for r, x in zip(rows, limits) if x],
            marker="|",
            s=60,
            color="#222222",
            label="at most",
            zorder=2,
        )
    axes.axvline(reference, color="#888888", linewidth=1, zorder=1)
    axes.set_xscale("log")
    log_ticks(axes, "x")
    axes.set_yticks(list(rows), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.set_xlabel(label)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.65 / height), ncol=3, frameon=False)
    return save(figure, path)


def growth(path, lines):
    """Plot time and memory over the number of c-vertices.

    lines: (label, colour, style, [(c_vertices, microseconds Figure, bytes Figure), ...]).
    """
    if not any(p[0] and p[1] for _, _, _, points in lines for p in points):
        return no_figures(path)
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.4))
    for text, colour, style, points in lines:
        for axes, index in ((left, 1), (right, 2)):
            shown = [
                (p[0], p[index].value, p[index].bound)
                for p in points
                if p[0] and p[index] is not None
            ]
            axes.plot(
                [x for x, _, bound in shown if not bound],
                [y for _, y, bound in shown if not bound],
                style,
                color=colour,
                label=text,
                markersize=4,
            )
            axes.plot(
                [x for x, _, bound in shown if bound],
                [y for _, y, bound in shown if bound],
                "^",
                color=colour,
                fillstyle="none",
                markersize=6,
            )
    for axes, title in (
        (left, "CPU microseconds per c-vertex"),
        (right, "peak bytes per c-vertex"),
    ):
        axes.set_xscale("log")
        axes.set_yscale("log")
        log_ticks(axes, "x", 1.5, short)
        log_ticks(axes, "y")
        axes.set_xlabel("c-vertices")
        axes.set_title(title, fontsize=9)
    handles, labels = left.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="lower center", ncol=4, frameon=False, bbox_to_anchor=(0.5, -0.14)
    )
    return save(figure, path)
