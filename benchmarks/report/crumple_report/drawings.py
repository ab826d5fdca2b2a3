"""Explanatory drawings: [MZ] fig. 1, the sweep along a principal component; fig. 4, membership at a border between
clusters; and the numbers that describe an overlap. [MZ] is the paper that Crumple follows (ARCHITECTURE.md)."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Circle, Polygon, Rectangle

from .style import plot


def triangle(centre, angle, size, stretch=1.0):
    corners = np.array([[0, 1], [-0.866, -0.5], [0.866, -0.5]]) * [size * stretch, size]
    c, s = np.cos(angle), np.sin(angle)
    return corners @ np.array([[c, s], [-s, c]]) + centre


def boxes_overlap(a, b):
    return bool(np.all(a.min(0) <= b.max(0)) and np.all(b.min(0) <= a.max(0)))


def intervals_overlap(a, b):
    return bool(a.min(0)[0] <= b.max(0)[0] and b.min(0)[0] <= a.max(0)[0])


@plot
def sweep_direction(_, theme):
    """Draws [MZ] fig. 1: intervals and boxes of the same triangles, along x and along the first principal component of
    the triangles' centroids."""
    along = np.deg2rad(42)
    step = np.array([np.cos(along), np.sin(along)])
    across = np.array([-step[1], step[0]])
    places = [(-2.75, 0.1), (-1.7, -0.12), (-0.6, 0.1), (0.55, -0.08), (1.6, 0.12), (2.75, -0.1)]
    triangles = [triangle(u * step + v * across, along + np.pi / 2 + turn, 0.3, 3.2)
                 for (u, v), turn in zip(places, (0.1, -0.08, 3.2, 0.05, 3.05, 0.06))]
    centroids = np.array([t.mean(0) for t in triangles])
    covariance = np.cov((centroids - centroids.mean(0)).T)
    axis = np.linalg.eigh(covariance)[1][:, -1]
    axis *= np.sign(axis[0])
    turn = np.array([axis, [-axis[1], axis[0]]])
    turned = [(t - centroids.mean(0)) @ turn.T for t in triangles]

    figure, panels = plt.subplots(1, 2, figsize=(7.2, 3.3))
    for ax, shapes, title in zip(panels, (triangles, turned), ("along x", "along the first principal component")):
        pairs = [(i, j) for i in range(len(shapes)) for j in range(i)]
        overlapping = [p for p in pairs if boxes_overlap(shapes[p[0]], shapes[p[1]])]
        intervals = sum(intervals_overlap(shapes[i], shapes[j]) for i, j in pairs)
        touched = {i for pair in overlapping for i in pair}
        low = min(s[:, 1].min() for s in shapes) - 0.4
        for i, shape in enumerate(shapes):
            colour = theme.series[1] if i in touched else theme.series[0]
            ax.add_patch(Polygon(shape, facecolor=colour, alpha=0.45, edgecolor=colour))
            size = shape.max(0) - shape.min(0)
            ax.add_patch(Rectangle(shape.min(0), *size, fill=False, edgecolor=theme.muted, linewidth=0.8))
            ax.plot([shape[:, 0].min(), shape[:, 0].max()], [low - 0.22 * i] * 2, color=colour, linewidth=3,
                    solid_capstyle="butt")
        boxes = "pair of boxes overlaps" if len(overlapping) == 1 else "pairs of boxes overlap"
        ax.set_title(f"{title}:\n{intervals} pairs of intervals, {len(overlapping)} {boxes}", fontsize=9)
        ax.set_aspect("equal")
        ax.autoscale_view()
        ax.axis("off")
    return figure


@plot
def overlap(_, theme):
    """Draws [MZ] fig. 4: two triangles that collide across the border between clusters. On the left, a triangle belongs
    to the cluster of its nearest centre; on the right, to each cluster that its ball reaches."""
    a, b = triangle((-0.3, 0.25), 1.45, 0.85), triangle((0.42, -0.1), 0.3, 0.8)
    others = [triangle(c, t, 0.4) for c, t in (((-2.0, 1.0), 0.3), ((-2.2, -0.7), 1.1), ((-1.2, -1.25), 0.6),
                                               ((2.1, 0.9), 0.9), ((1.9, -1.0), 0.1), ((1.1, 1.3), 1.7))]
    figure, panels = plt.subplots(1, 2, figsize=(7.2, 3.0))
    centres = np.array([[-1.7, 0.0], [1.7, 0.0]])
    for ax, local in zip(panels, (False, True)):
        for shape in [*others, a, b]:
            centre = shape.mean(0)
            radius = np.linalg.norm(shape - centre, axis=1).max() if local else 0
            member = [-centre[0] + radius >= 0, centre[0] + radius >= 0]  # the border is x = 0
            colour = theme.series[2] if all(member) else theme.series[0] if member[0] else theme.series[1]
            ax.add_patch(Polygon(shape, facecolor=colour, alpha=0.5, edgecolor=colour))
            ax.plot(*centre, ".", color=theme.text, markersize=3)
            if local and all(member):
                ax.add_patch(plt.Circle(centre, radius, fill=False, edgecolor=colour, linewidth=0.8, linestyle=":"))
        ax.plot(*centres.T, "x", color=theme.text, markersize=7)
        ax.axvline(0, color=theme.muted, linewidth=1, linestyle="--")
        ax.set_xlim(-2.9, 2.9)
        ax.set_ylim(-1.9, 2.0)
        ax.set_aspect("equal")
        ax.axis("off")
        ax.set_title("balls that reach over the border: both share a cluster" if local
                     else "nearest centre only: the two that collide\nbelong to different clusters", fontsize=9)
    return figure


def arrow(ax, begin, end, colour, width=1.8, size=13):
    ax.annotate("", end, begin, zorder=5, annotation_clip=False,
                arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": width, "mutation_scale": size,
                            "shrinkA": 0, "shrinkB": 0})


@plot
def overlap_numbers(_, theme):
    """Draws a disc and a rectangle that overlap, as sections of two bodies, with the numbers that describe the overlap:
    volume, centroid, area vector, normal and mean depth."""
    ball, radius, corner, size = np.array([0.0, 0.0]), 1.0, np.array([0.3, 0.05]), np.array([1.75, -1.55])
    # The arc of the disc's circle inside the rectangle, from the rectangle's top side to its left side.
    angles = np.linspace(np.arcsin(corner[1]), -np.arccos(corner[0]), 400)
    arc = ball + radius * np.column_stack([np.cos(angles), np.sin(angles)])
    region = np.vstack([corner, arc])
    x, y = region.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    volume = cross.sum() / 2  # negative, because the region's points are in clockwise order
    centroid = ((region + np.roll(region, -1, axis=0)) * cross[:, None]).sum(0) / (6 * volume)
    area = np.array([arc[0, 1] - arc[-1, 1], arc[-1, 0] - arc[0, 0]])  # the chord of the arc, rotated by a right angle
    normal, depth = area / np.linalg.norm(area), abs(volume) / np.linalg.norm(area)
    along = np.array([-normal[1], normal[0]]) * np.linalg.norm(area) / 2

    first, second, strong = theme.series[0], theme.series[2], theme.accent
    figure, panels = plt.subplots(1, 3, figsize=(7.2, 2.6))
    titles = ("the space that both bodies cover:\nvolume and centroid",
              "the first surface in the second body:\narea vector and normal", "volume divided by area:\nmean depth")
    for ax, title in zip(panels, titles):
        ax.add_patch(Rectangle(corner, *size, facecolor=second, alpha=0.16, edgecolor="none"))
        ax.add_patch(Rectangle(corner, *size, fill=False, edgecolor=second, linewidth=1.4))
        ax.add_patch(Circle(ball, radius, facecolor=first, alpha=0.16, edgecolor="none"))
        ax.add_patch(Circle(ball, radius, fill=False, edgecolor=first, linewidth=1.4))
        ax.set_title(title, fontsize=9)
        ax.set_xlim(-1.1, 2.15)
        ax.set_ylim(-1.6, 1.1)
        ax.set_aspect("equal")
        ax.axis("off")
    for ax, alpha in zip(panels, (0.75, 0.3, 0.3)):
        ax.add_patch(Polygon(region, facecolor=strong, alpha=alpha, edgecolor="none"))

    panels[0].plot(*centroid, "o", color=theme.text, markersize=5)
    panels[0].annotate("centroid", centroid, (1.2, 0.55), fontsize=9,
                       arrowprops={"arrowstyle": "-", "color": theme.muted, "linewidth": 0.8})
    panels[0].text(-0.42, 0.2, "first\nbody", color=first, ha="center", va="center")
    panels[0].text(1.45, -1.05, "second\nbody", color=second, ha="center", va="center")

    panels[1].plot(*arc.T, color=strong, linewidth=3, solid_capstyle="butt")
    for i in np.linspace(0, len(arc) - 1, 8).astype(int)[1:-1]:
        arrow(panels[1], arc[i], arc[i] + 0.3 * (arc[i] - ball), strong, 1, 7)
    arrow(panels[1], centroid, centroid + area, theme.text)
    panels[1].text(1.38, -1.24, "area vector", ha="center", va="center")

    middle = centroid
    base = np.array([middle - along - depth / 2 * normal, middle + along - depth / 2 * normal,
                     middle + along + depth / 2 * normal, middle - along + depth / 2 * normal])
    panels[2].add_patch(Polygon(base, facecolor=strong, alpha=0.75, edgecolor="none"))
    side = middle + 1.25 * along
    for sign in (-1, 1):
        arrow(panels[2], side, side + sign * depth / 2 * normal, theme.text, 1.2, 8)
    panels[2].annotate("mean depth", side, side + [0.35, 0.42], ha="center", fontsize=9,
                       arrowprops={"arrowstyle": "-", "color": theme.muted, "linewidth": 0.8})
    away = ball - 0.35 * normal
    arrow(panels[2], away, away - 0.5 * normal, first)
    panels[2].text(*(away + [-0.28, -0.14]), "way out", color=first, ha="center", va="center")
    panels[2].text(1.3, -1.1, "the same\nvolume", color=strong, ha="center", va="center")
    panels[2].plot([1.2, middle[0] + 0.15], [-0.86, middle[1] - 0.12], color=theme.muted, linewidth=0.8)
    return figure
