"""Area, line and dot plots: time by stage, growth with the number of triangles, parts, and alternatives that studies compare."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter, NullLocator

from .results import STAGES, plain
from .style import log_ticks, plot, readable, short

def stage_plot(results, theme, name):
    sequence = results.sequences().get(name)
    if not sequence:
        return None
    warm = sequence["kinds"]["warm"]
    frames = sequence["frames"]
    figure, (ax, below) = plt.subplots(2, 1, figsize=(7.2, 4.2), sharex=True, gridspec_kw={"height_ratios": [3, 1]})
    ax.stackplot(frames, [warm["stages"][stage] for stage in STAGES], labels=STAGES, colors=theme.series, linewidth=0)
    ax.plot(frames, warm["milliseconds"], color=theme.text, linewidth=0.9, label="whole call")
    ax.set_ylabel("ms, one thread")
    ax.set_ylim(bottom=0)
    ax.margins(x=0)
    handles, labels = ax.get_legend_handles_labels()
    ax.legend(handles[::-1], labels[::-1], loc="center left", bbox_to_anchor=(1, 0.5))
    below.plot(frames, sequence["pairs"], color=theme.accent)
    below.set_ylabel("pairs")
    below.set_ylim(bottom=0)
    below.yaxis.set_major_formatter(FuncFormatter(short))
    below.set_xlabel("frame")
    ax.set_title(f"{plain(name)}: {max(sequence['triangles']):,} triangles, {len(frames)} frames")
    return figure


@plot
def stages_cloth_on_ball(results, theme):
    return stage_plot(results, theme, "cloth_on_ball")


@plot
def stages_funnel(results, theme):
    return stage_plot(results, theme, "funnel")


@plot
def growth(results, theme):
    sizes = results.sizes()
    if not sizes:
        return None
    n = np.array([size["triangles"] for size in sizes])
    one = np.array([size["one_thread"]["median"] for size in sizes])
    every = np.array([size["all_threads"]["median"] for size in sizes])
    figure, (ax, memory) = plt.subplots(1, 2, figsize=(7.2, 3), gridspec_kw={"width_ratios": [3, 2]})
    ax.loglog(n, one, "o-", label="one thread")
    ax.loglog(n, every, "s-", label="all threads")
    ax.loglog(n, every[-1] * n / n[-1], ":", color=theme.muted, label="in proportion")
    ax.set_xlabel("triangles")
    ax.set_ylabel("ms")
    ax.legend()
    memory.semilogx(n, [size["bytes_a_triangle"] for size in sizes], "o-", color=theme.series[2])
    memory.set_ylim(bottom=0)
    memory.set_xlabel("triangles")
    memory.set_ylabel("bytes a triangle, without output")
    for axis in (ax.xaxis, ax.yaxis, memory.xaxis):
        log_ticks(axis)
    return figure


def dot_panel(ax, rows_by_scene, value, theme):
    """Draws a line of dots for each category, one dot per scene. `value` is the position of a category's row on the x axis."""
    for i, (name, rows) in enumerate(rows_by_scene.items()):
        shift = (i - (len(rows_by_scene) - 1) / 2) * 0.16
        ax.plot([value(row) for row in rows], np.arange(len(rows)) + shift, "o", markersize=4.5,
                color=theme.series[i % len(theme.series)], label=plain(name), clip_on=False, zorder=3)


def from_zero(ax, most):
    """Sets a logarithmic scale that includes 0."""
    ax.set_xscale("symlog", linthresh=1)
    ax.set_xlim(-0.3, 2 * max(1, most))
    ticks = [0, *(10**p for p in range(int(np.log10(max(1, most))) + 1))]
    ax.xaxis.set_ticks(ticks, [short(t) for t in ticks])
    ax.xaxis.set_minor_locator(NullLocator())


@plot
def membership(results, theme):
    groups = {}
    for figure in results.study("membership"):
        rows = [dict(rule, share=100 * rule["members_added"] / figure["triangles"]) for rule in figure["rules"]]
        groups.setdefault(figure["clusters"], {})[figure["workload"]] = rows
    if not groups:
        return None
    rules = [rule["rule"] for rule in rows]
    columns = {"members added, %": lambda row: row["share"], "time / bisector rule's": lambda row: row["relative"]["median"],
               "pairs lost": lambda row: row["pairs_lost"]}
    height = 0.6 + len(groups) * (0.25 + 0.24 * len(rules))
    figure, panels = plt.subplots(len(groups), len(columns), figsize=(7.2, height), squeeze=False, sharex="col", sharey=True)
    for axes_row, (clusters, rows_by_scene) in zip(panels, groups.items()):
        axes_row[0].set_ylabel(f"{clusters} clusters")
        for ax, value in zip(axes_row, columns.values()):
            dot_panel(ax, rows_by_scene, value, theme)
    panels[0, 0].set_yticks(range(len(rules)), rules)
    panels[0, 0].set_ylim(len(rules) - 0.5, -0.5)
    for ax, (title, value) in zip(panels[0], columns.items()):
        ax.set_title(title, fontsize=9)
        values = [value(row) for scenes in groups.values() for rows in scenes.values() for row in rows]
        if min(values) == 0:
            from_zero(ax, max(values))
        else:
            ax.set_xscale("log")
            log_ticks(ax.xaxis, 4)
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8)
    return figure


@plot
def parts(results, theme):
    figures = results.study("parts")
    if not figures:
        return None
    figure, (gain, work) = plt.subplots(1, 2, figsize=(7.2, 3.4))
    for i, row in enumerate(figures):
        count = [size["parts"] for size in row["counts"]]
        colour = theme.series[i % len(theme.series)]
        for kind, line in (("alone", "o-"), ("owning", "s--")):
            label = plain(row["workload"]) if kind == "alone" else None
            gain.plot(count, [size[kind]["most_speed_up"] for size in row["counts"]], line, color=colour, label=label)
            work.plot(count, [size[kind]["inflation"] for size in row["counts"]], line, color=colour)
    gain.plot(count, count, ":", color=theme.muted, label="in proportion")
    gain.set_ylabel("whole / largest part")
    work.set_ylabel("sum of parts / whole")
    for ax in (gain, work):
        ax.set_xscale("log", base=2)
        ax.set_yscale("log")
        ax.set_xlabel("parts")
        ax.set_xticks(count)
        readable(ax.xaxis)
        log_ticks(ax.yaxis)
    figure.legend(*gain.get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8)
    return figure
