"""Drawings that explain: [MZ] fig. 1, the sweep along a principal component, and fig. 4, membership at a border."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Polygon, Rectangle

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
    """[MZ] fig. 1: the same triangles, along x and along the first principal component of their centroids."""
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
    """[MZ] fig. 4: two triangles that collide across the border between clusters, under two rules."""
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
