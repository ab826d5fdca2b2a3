"""Plots of the figures: each function takes results and a theme, and returns a figure, or None where nothing is known."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter, NullLocator

from .results import PUBLISHED, digits, plain

STAGES = ["bounds", "subdivide", "align", "sort", "sweep", "narrow", "output"]
PLOTS = {}


def plot(function):
    PLOTS[function.__name__] = function
    return function


def short(value, _=None):
    for unit, size in (("M", 1e6), ("k", 1e3)):
        if abs(value) >= size:
            return f"{value / size:g}{unit}"
    return f"{value:g}"


def readable(axis):
    axis.set_major_formatter(FuncFormatter(short))
    axis.set_minor_locator(NullLocator())


def log_ticks(axis, most=6):
    """Ticks at 1, 2 and 5 times powers of ten if there is room for them, else at powers alone."""
    axis.set_minor_locator(NullLocator())
    low, high = sorted(axis.get_view_interval())
    powers = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    for steps in ((1, 1.2, 1.5, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,)):
        ticks = [step * 10.0**p for p in powers for step in steps if low <= step * 10.0**p <= high]
        if len(ticks) <= most:
            break
    if len(ticks) > most:
        ticks = ticks[::2]
    axis.set_ticks(ticks, [short(float(f"{t:.3g}")) for t in ticks])


def bars(ax, entries, theme):
    """Horizontal bars on a log axis: (label, milliseconds, kind), kinds are ours, whole, boxes, published."""
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
                # Peers from PyPI race against another process of Crumple's: their ratio is carried over.
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
    axes[-1, 0].set_xlabel("ms (log); strong: whole answer, pale: boxes only")
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
    """[MZ] fig. 6."""
    figure, axes = plt.subplots(2, 1, figsize=(7.2, 4.2), gridspec_kw={"height_ratios": [8, 6]})
    for ax, (name, theirs), frame, simulated in zip(
            axes, PUBLISHED.items(), ("cloth_ball92", "227"), ("cloth_on_ball", "funnel")):
        rows = [(label, value, "published") for label, value in theirs.items()]
        title = f"{name}: averages over a sequence, published and here"
        sequence = results.sequences().get(simulated)
        if sequence:
            kinds = sequence["kinds"]
            rows.append(("Crumple", float(np.mean(kinds["warm, all threads"]["milliseconds"])), "ours"))
            rows += [(peer["name"], float(np.mean(peer["milliseconds"])), kind_of(peer)) for peer in sequence["peers"]]
        else:
            for peer in ("crumple", "CGAL", "Embree"):
                found = results.fastest("self", peer).get(frame)
                if found:
                    rows.append(("Crumple" if peer == "crumple" else peer, found[1]["milliseconds"]["median"],
                                 "ours" if peer == "crumple" else kind_of(found[1])))
            title += f" (frame {'92' if frame == 'cloth_ball92' else frame} alone)"
        bars(ax, rows, theme)
        ax.set_title(title)
    axes[-1].set_xlabel("ms (log); hatched: published, on other machines")
    return figure


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
def growth(results, theme):
    sizes = (results.study("growth") or {}).get("sizes")
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


def option_panel(ax, results, theme, study, label):
    figures = results.study(study)
    for figure in figures:
        values = [str(value["value"]).removesuffix(" (default)") for value in figure["values"]]
        relative = [value["relative"]["median"] for value in figure["values"]]
        low = [value["relative"]["lower_quartile"] for value in figure["values"]]
        high = [value["relative"]["upper_quartile"] for value in figure["values"]]
        line, = ax.plot(range(len(values)), relative, "o-", label=plain(figure["workload"].removesuffix(", new detector")))
        ax.fill_between(range(len(values)), low, high, color=line.get_color(), alpha=0.15, linewidth=0)
        ax.set_xticks(range(len(values)), values)
    ax.axhline(1, color=theme.muted, linewidth=0.8)
    ax.set_yscale("log")
    ax.yaxis.set_minor_locator(NullLocator())
    log_ticks(ax.yaxis)
    ax.set_xlabel(label)
    ax.set_ylabel("time / default's")


@plot
def cuts(results, theme):
    if not (results.study("clusters") and results.study("leaf_size")):
        return None
    figure, axes = plt.subplots(1, 2, figsize=(7.2, 3.2))
    option_panel(axes[0], results, theme, "clusters", "clusters (0: chosen)")
    option_panel(axes[1], results, theme, "leaf_size", "triangles a leaf")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8)
    return figure


@plot
def fuzziness(results, theme):
    if not results.study("fuzziness"):
        return None
    figure, ax = plt.subplots(figsize=(5.2, 3))
    option_panel(ax, results, theme, "fuzziness", "fuzziness t")
    ax.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    return figure


@plot
def threads(results, theme):
    figures = results.study("threads")
    if not figures:
        return None
    figure, ax = plt.subplots(figsize=(5.2, 3))
    most = 1
    for row in figures:
        count = [int(str(value["value"]).removesuffix(" (default)")) for value in row["values"]]
        times = [value["milliseconds"]["median"] for value in row["values"]]
        ax.plot(count, [times[0] / t for t in times], "o-", label=plain(row["workload"]))
        most = max(most, *count)
    ax.plot([1, most], [1, most], ":", color=theme.muted, label="in proportion")
    ax.set_xticks(sorted(set(count)))
    ax.set_xlabel("threads")
    ax.set_ylabel("speed-up")
    ax.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    return figure


def dot_grid(groups, theme, categories, columns, row_title):
    """A row of panels for each group, a panel for each column (title, value function, scale), in it a row for each category
    and a dot for each scene."""
    height = 0.6 + len(groups) * (0.25 + 0.24 * len(categories))
    figure, panels = plt.subplots(len(groups), len(columns), figsize=(7.2, height), squeeze=False, sharex="col", sharey=True)
    for axes_row, (key, rows_by_scene) in zip(panels, groups.items()):
        axes_row[0].set_ylabel(row_title(key))
        for ax, (_, value, _) in zip(axes_row, columns):
            for i, (name, rows) in enumerate(rows_by_scene.items()):
                shift = (i - (len(rows_by_scene) - 1) / 2) * 0.16
                ax.plot([value(row) for row in rows], np.arange(len(categories)) + shift, "o", markersize=4.5,
                        color=theme.series[i % len(theme.series)], label=plain(name), clip_on=False, zorder=3)
    panels[0, 0].set_yticks(range(len(categories)), categories)
    panels[0, 0].set_ylim(len(categories) - 0.5, -0.5)
    for column, (title, value, scale) in enumerate(columns):
        ax = panels[0, column]
        ax.set_title(title, fontsize=9)
        values = [value(row) for rows in groups.values() for scene in rows.values() for row in scene]
        if scale == "symlog":
            ax.set_xscale("symlog", linthresh=1)
            ax.set_xlim(-0.3, 2 * max(1, *values))
            powers = range(int(np.log10(max(1, *values))) + 1)
            ticks = [0, *(10**p for p in powers)]
            ax.xaxis.set_ticks(ticks, [short(t) for t in ticks])
            ax.xaxis.set_minor_locator(NullLocator())
        else:
            ax.set_xscale("log")
            log_ticks(ax.xaxis, 4)
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8)
    return figure


@plot
def membership(results, theme):
    figures = results.study("membership")
    if not figures:
        return None
    groups = {}
    for figure in figures:
        rows = [dict(rule, share=100 * rule["members_added"] / figure["triangles"]) for rule in figure["rules"]]
        groups.setdefault(figure["clusters"], {})[figure["workload"]] = rows
    columns = [("members added, %", lambda row: row["share"], "symlog"),
               ("time / bisector rule's", lambda row: row["relative"]["median"], "log"),
               ("pairs lost", lambda row: row["pairs_lost"], "symlog")]
    return dot_grid(groups, theme, [rule["rule"] for rule in figures[0]["rules"]], columns, lambda key: f"{key} clusters")


@plot
def axes(results, theme):
    figures = results.study("axes")
    if not figures:
        return None
    groups = {}
    for figure in figures:
        groups.setdefault(figure["parts"], {})[figure["workload"]] = figure["ways"]
    columns = [("overlapping intervals", lambda row: row["interval_overlaps"], "log"),
               ("false positives", lambda row: row["false_positives"], "log"),
               ("ms, plain sweep", lambda row: row["milliseconds"]["median"], "log")]
    names = [way["direction"] for way in figures[0]["ways"]]
    return dot_grid(groups, theme, names, columns, lambda key: "whole scene" if key == 1 else f"{key} parts")


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


@plot
def two_clusters(results, theme):
    figures = results.study("two_clusters")
    if not figures:
        return None
    figure, axes_ = plt.subplots(1, 2, figsize=(7.2, 3), sharey=True)
    names = [cut["cut"] for cut in figures[0]["cuts"]]
    for ax, kind in zip(axes_, ("one_thread", "all_threads")):
        for i, row in enumerate(figures):
            times = [cut[kind]["median"] for cut in row["cuts"]]
            ax.plot([t / times[0] for t in times], np.arange(len(names)) + 0.14 * (i - (len(figures) - 1) / 2), "o",
                    label=plain(row["workload"]))
        ax.set_yticks(range(len(names)), names)
        ax.axvline(1, color=theme.muted, linewidth=0.8)
        ax.set_xscale("log")
        log_ticks(ax.xaxis)
        ax.set_xlabel(f"time / leaves', {kind.replace('_', ' ')}")
    axes_[0].set_ylim(len(names) - 0.5, -0.5)
    figure.legend(*axes_[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8)
    return figure


@plot
def memory(results, theme):
    """[MZ] fig. 2's prediction beside what survives and what is owned."""
    figures = results.study("two_clusters")
    if not figures:
        return None
    figure, ax = plt.subplots(figsize=(7.2, 0.9 + 0.62 * len(figures)))
    for row, entry in enumerate(figures):
        cuts_ = {cut["cut"]: cut for cut in entry["cuts"]}
        paper, ours = cuts_["2 whole"], cuts_["leaves (default)"]
        marks = [("list of overlapping intervals, 2 clusters", paper["predicted_bytes"], "o", theme.series[0]),
                 ("the same, leaves", ours["predicted_bytes"], "o", theme.series[5]),
                 ("of these, boxes overlap", 8 * ours["candidates"], "s", theme.series[4]),
                 ("colliding pairs", 8 * ours["pairs"], "s", theme.series[2]),
                 ("most that the detector owns", ours["peak_bytes"], "D", theme.accent)]
        ax.plot([min(m[1] for m in marks) / 2**20, max(m[1] for m in marks) / 2**20], [row, row], color=theme.grid, zorder=1)
        for label, value, marker, colour in marks:
            ax.plot(value / 2**20, row, marker, color=colour, markersize=6, label=label if row == 0 else None)
    ax.set_yticks(range(len(figures)), [plain(entry["workload"]) for entry in figures])
    ax.set_ylim(len(figures) - 0.5, -0.5)
    ax.set_xscale("log")
    readable(ax.xaxis)
    ax.set_xlabel("MiB (log)")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=8)
    return figure


@plot
def warm_start(results, theme):
    found = {name: s for name, s in results.sequences().items() if "cold" in s["kinds"]}
    if not found:
        return None
    figure, axes_ = plt.subplots(len(found), 2, figsize=(7.2, 0.8 + 1.7 * len(found)), squeeze=False)
    for (left, right), (name, sequence) in zip(axes_, found.items()):
        for i, kind in enumerate(("warm", "cold", "fixed")):
            run = sequence["kinds"][kind]
            left.plot(sequence["frames"], run["stages"]["subdivide"], color=theme.series[i], linewidth=1.2, label=kind)
            right.plot(sequence["frames"], run["milliseconds"], color=theme.series[i], linewidth=1.2)
        left.set_title(f"{plain(name)}: subdivide, ms")
        right.set_title("whole call, ms, one thread")
        for ax in (left, right):
            ax.set_ylim(bottom=0)
            ax.margins(x=0)
    for ax in axes_[-1]:
        ax.set_xlabel("frame")
    figure.legend(*axes_[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def all_plots(results):
    """Every plot by name; sequences bring one each."""
    found = dict(PLOTS)
    for name in results.sequences():
        found[f"stages_{name.replace(':', '_')}"] = lambda r, theme, name=name: stage_plot(r, theme, name)
    return found
