#!/usr/bin/env python3
"""Draws docs/images/start/*.png: the output of the programs of docs/start_*.md, and overlap.png, a picture of overlaps
(docs/overlap.md).

    scripts/start_pictures.py

Needs the Python package with PyVista, pip install ".[pictures]". Where the programs write .html, this script lets them write
.glb, which PyVista can render. The bytes of a rendering depend on the machine, so no test compares the committed pictures.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
import pyvista

import crumple

TOP = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TOP / "python" / "tests"))
import pages  # noqa: E402

IMAGES = TOP / "docs" / "images" / "start"
# Maps each page to the direction from the scene to the camera, and the zoom.
VIEWS = {
    "start_cloth": ((1, 0.6, 0.9), 1.3),
    "start_printing": ((0.2, -1, 0.4), 1.45),
    "start_robots": ((0.5, -1.6, 0.6), 1.3),
    "start_research": ((1, 0.6, 0.7), 1.15),
}


def draw(scene, picture, eye, zoom):
    plotter = pyvista.Plotter(off_screen=True, window_size=(800, 480), lighting="none")
    plotter.import_gltf(scene)
    plotter.set_background("white")
    for place, intensity in (((0, 0, 1), 2.0), ((-0.6, 0.9, 1), 2.5)):
        plotter.add_light(pyvista.Light(position=place, light_type="camera light", intensity=intensity))
    plotter.view_vector(eye, (0, 0, 1))
    plotter.camera.zoom(zoom)
    plotter.screenshot(picture)
    plotter.close()


def ring(turn, centre):
    """Returns vertices and triangles of a torus around `centre`, rotated by `turn` radians about the x axis."""
    around, across, radius, thickness = 96, 40, 1.0, 0.35
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = 2 * np.pi * u.ravel() / around, 2 * np.pi * v.ravel() / across
    x, y, z = np.cos(a) * (radius + thickness * np.cos(b)), np.sin(a) * (radius + thickness * np.cos(b)), thickness * np.sin(b)
    points = np.stack([x, y * np.cos(turn) - z * np.sin(turn), y * np.sin(turn) + z * np.cos(turn)], axis=1) + centre

    def corner(du, dv):
        return ((u + du) % around * across + (v + dv) % across).ravel()

    return points, np.concatenate([
        np.stack([corner(0, 0), corner(1, 0), corner(1, 1)], axis=1),
        np.stack([corner(0, 0), corner(1, 1), corner(0, 1)], axis=1),
    ])


def draw_overlap(picture):
    rings = ring(0, [0, 0, 0]), ring(1.3, [0.6, 0.1, 0.05])
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "overlap.glb"
        crumple.overlaps(*rings).save(scene, *rings)
        draw(scene, picture, (1, -1.3, 0.8), 1.5)


def main():
    draw_overlap(IMAGES / "overlap.png")
    print("docs/images/start/overlap.png")
    for page in pages.PAGES:
        if page.stem not in VIEWS:
            continue
        (program,) = pages.programs(page)
        with tempfile.TemporaryDirectory() as folder:
            done = pages.run(program._replace(text=program.text.replace(".html", ".glb")), Path(folder))
            if done.returncode:
                sys.exit(f"{page.name}: {done.stdout}")
            (scene,) = Path(folder).glob("*.glb")
            picture = IMAGES / f"{page.stem.removeprefix('start_')}.png"
            draw(scene, picture, *VIEWS[page.stem])
            print(picture.relative_to(TOP))


if __name__ == "__main__":
    main()
