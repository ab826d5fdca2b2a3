"""Bar plots that compare Crumple with its peers, and with the published averages of [MZ] fig. 6. [MZ] is the paper that
Crumple follows (ARCHITECTURE.md)."""

import matplotlib.pyplot as plt
import numpy as np

from .results import digits, plain
from .style import plot, readable

# Published averages over the sequences, in milliseconds ([MZ] fig. 6).
PUBLISHED = {
    "Cloth on Ball": {
        "[MZ], GTX 480": 20.24,
        "CStreams, GPU": 18.6,
        "Pabst, CPU and GPU": 36.6,
        "HPCCD, CPU and GPU": 23.2,
        "MCCD, 16 cores": 32.5,
    },
    "Funnel": {"[MZ], GTX 480": 6.53, "CStreams, GPU": 4.4, "Pabst, CPU and GPU": 6.7},
}


def bars(ax, entries, theme):
    """Draws horizontal bars on a logarithmic axis. Entries are (label, milliseconds, kind). The kind is `ours` for
    Crumple, `whole` or `boxes` for peers that compute whole results or overlapping boxes only, or `published`."""
    colours = {"ours": theme.accent, "whole": theme.other, "boxes": theme.weak, "published": "none"}
    for row, (label, value, kind) in enumerate(entries):
        ax.barh(row, value, height=0.68, color=colours[kind], edgecolor=theme.muted if kind == "published" else "none",
                hatch="////" if kind == "published" else None, linewidth=0.7)
        ax.annotate(digits(value), (value, row), (3, 0), textcoords="offset points", va="center", fontsize=8)
    ax.set_yticks(range(len(entries)), [label for label, _, _ in entries])
    ax.invert_yaxis()
    ax.set_xscale("log")
    ax.grid(axis="y", visible=False)
    ax.tick_params(axis="y", length=0)
    values = [value for _, value, _ in entries]
    ax.set_xlim(min(values) / 2.5, max(values) * 2.5)
    readable(ax.xaxis)


def kind_of(way):
    return "boxes" if "boxes" in way["computes"] else "whole"


def contest_bars(results, theme, question):
    ours = results.fastest(question, "crumple")
    if not ours:
        return None
    peers = {name: results.fastest(question, name) for name in results.peers(question)}
    lists = []
    for workload, (contest, way) in ours.items():
        rows = [("Crumple", way["milliseconds"]["median"], "ours")]
        for name, found in peers.items():
            if workload in found:
                other = found[workload][1]
                # Peers from PyPI were timed against another process of Crumple's: computes their time from the ratio.
                beside = found[workload][0] is contest
                time = other["milliseconds"]["median"] if beside else rows[0][1] * other["ratio"]["median"]
                rows.append((name.replace(", from Python", ""), time, kind_of(other)))
        lists.append((workload, contest, sorted(rows, key=lambda row: row[1])))
    heights = [len(rows) + 1.6 for _, _, rows in lists]
    figure, axes = plt.subplots(len(lists), 1, figsize=(7.2, 0.21 * sum(heights) + 0.4), squeeze=False,
                                gridspec_kw={"height_ratios": heights})
    for ax, (workload, contest, rows) in zip(axes[:, 0], lists):
        bars(ax, rows, theme)
        ax.set_title(f"{plain(workload)}: {contest['triangles']:,} triangles")
    low = min(ax.get_xlim()[0] for ax in axes[:, 0])
    high = max(ax.get_xlim()[1] for ax in axes[:, 0])
    for ax in axes[:, 0]:
        ax.set_xlim(low, high)
    axes[-1, 0].set_xlabel("ms (log); strong: whole result, pale: boxes only")
    return figure


@plot
def peers_self(results, theme):
    return contest_bars(results, theme, "self")


@plot
def peers_between(results, theme):
    return contest_bars(results, theme, "between")


@plot
def peers_any(results, theme):
    return contest_bars(results, theme, "any")


@plot
def published(results, theme):
    sequences = [results.sequences().get(name) for name in ("cloth_on_ball", "funnel")]
    if None in sequences:
        return None
    figure, axes = plt.subplots(2, 1, figsize=(7.2, 4.2), gridspec_kw={"height_ratios": [8, 6]})
    for ax, (name, theirs), sequence in zip(axes, PUBLISHED.items(), sequences):
        rows = [(label, value, "published") for label, value in theirs.items()]
        rows.append(("Crumple", float(np.mean(sequence["kinds"]["warm, all threads"]["milliseconds"])), "ours"))
        rows += [(peer["name"], float(np.mean(peer["milliseconds"])), kind_of(peer)) for peer in sequence["peers"]]
        bars(ax, rows, theme)
        ax.set_title(f"{name}: averages over a sequence, published and here")
    axes[-1].set_xlabel("ms (log); hatched: published, on other machines")
    return figure
