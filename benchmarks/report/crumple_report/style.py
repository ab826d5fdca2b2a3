"""Style of plots. Each has two variants, for light and for dark pages. They are transparent, with text stored as text.

The same figures and the same version of matplotlib give the same bytes, because files have no date and fixed ids, and
fonts are those that matplotlib includes.
"""

import io
from dataclasses import dataclass

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.ticker import FuncFormatter, NullLocator  # noqa: E402

# Maps the name of each plot to a function that makes a figure from results and a theme; None without measurements.
PLOTS = {}


def plot(function):
    PLOTS[function.__name__] = function
    return function


@dataclass(frozen=True)
class Theme:
    name: str
    text: str
    muted: str
    grid: str
    surface: str
    accent: str  # for crumple
    other: str  # for peers that compute the whole result
    weak: str  # for peers that compute overlapping boxes only
    series: tuple


LIGHT = Theme("light", "#1f2328", "#59636e", "#d8dee4", "#ffffff", "#c2410c", "#4b6b94", "#a9bdd6",
              ("#2563c9", "#d2691e", "#15803d", "#a21caf", "#8a6d00", "#0e7490", "#6b7280"))
DARK = Theme("dark", "#e6edf3", "#9198a1", "#363c44", "#0d1117", "#ff8a4c", "#7fa6d9", "#46597a",
             ("#6ea8fe", "#f0a35e", "#4ade80", "#e879f9", "#e5c04b", "#4dd0e1", "#a1a8b3"))
THEMES = (LIGHT, DARK)


def apply(theme):
    plt.rcdefaults()
    plt.rcParams.update({
        "svg.hashsalt": "crumple",
        "svg.fonttype": "none",
        "font.family": ["DejaVu Sans"],
        "font.size": 9,
        "text.color": theme.text,
        "axes.edgecolor": theme.muted,
        "axes.labelcolor": theme.text,
        "axes.titlecolor": theme.text,
        "axes.titlesize": 10,
        "axes.titlelocation": "left",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "axes.axisbelow": True,
        "axes.prop_cycle": plt.cycler(color=theme.series),
        "grid.color": theme.grid,
        "grid.linewidth": 0.6,
        "xtick.color": theme.muted,
        "ytick.color": theme.muted,
        "xtick.labelcolor": theme.text,
        "ytick.labelcolor": theme.text,
        "xtick.minor.visible": False,
        "ytick.minor.visible": False,
        "lines.linewidth": 1.6,
        "lines.markersize": 4,
        "legend.frameon": False,
        "legend.fontsize": 8.5,
        "figure.facecolor": "none",
        "axes.facecolor": "none",
        "savefig.facecolor": "none",
        "figure.constrained_layout.use": True,
        "hatch.linewidth": 0.7,
    })


def save(figure, path, **how):
    """Saves a figure, with positions of axes rounded to nine digits. Otherwise their last digits would differ from run
    to run, and with them the ids in an SVG file, which are hashes of positions."""
    how["format"] = path.suffix[1:]
    if path.suffix == ".svg":
        how["metadata"] = {"Date": None, "Creator": None}
    figure.savefig(io.BytesIO(), **how)  # computes the layout, which depends on the format's text
    figure.set_layout_engine("none")
    for axes in figure.axes:
        axes.set_position([round(number, 9) for number in axes.get_position().bounds])
    figure.savefig(path, **how)
    plt.close(figure)
    if path.suffix == ".svg":  # matplotlib leaves trailing spaces
        path.write_text("".join(line.rstrip() + "\n" for line in path.read_text().splitlines()))


def short(value, _=None):
    for unit, size in (("M", 1e6), ("k", 1e3)):
        if abs(value) >= size:
            return f"{value / size:g}{unit}"
    return f"{value:g}"


def readable(axis):
    axis.set_major_formatter(FuncFormatter(short))
    axis.set_minor_locator(NullLocator())


def log_ticks(axis, most=6):
    """Sets ticks at multiples of powers of ten. Of several sets of multiples, uses the densest one with at most `most`
    ticks in view; if there is none, every other power of ten."""
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
