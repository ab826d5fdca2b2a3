"""Simulates a cloth that falls on a ball and folds on the floor; in no frame does anything pass through anything.

Each step of the simulation makes three queries:

    proximities  pairs that are near each other, and their closest points: such pairs push each other apart
    impacts      pairs of features that would touch in the step nevertheless: their vertices move less far
    free_step    the part of the remaining step that is free of impacts, with rounded positions: this is the guarantee

Cloth, ball and floor are one mesh. The solver is position based dynamics (Müller et al. 2007), with springs along the
grid and ROUNDS iterations per step. The program shows how to use the queries; it does not model a real fabric.

    python cloth_that_never_passes_through_itself.py [PICTURE [SECONDS]]      .gif: an animation; else the last frame
"""

import sys
from dataclasses import replace

import numpy as np

import crumple

SIDE = 31  # vertices along each side of the cloth
SPACING = 1 / (SIDE - 1)
THICKNESS = 0.3 * SPACING
BALL, HEIGHT = 0.2, 0.45  # radius of the ball, and initial height of the cloth
FRAMES_A_SECOND, STEPS_A_FRAME, ROUNDS = 30, 4, 20
FRICTION, DRAG, BENDING = 0.2, 0.5, 0.02


def grid():
    """Returns a square of SIDE x SIDE vertices, slightly rotated so that it does not fall in perfect symmetry."""
    i, j = np.meshgrid(np.arange(SIDE), np.arange(SIDE), indexing="ij")
    x, y = SPACING * i.ravel() - 0.46, SPACING * j.ravel() - 0.52
    vertices = np.stack([x * 0.96 - y * 0.28, x * 0.28 + y * 0.96, HEIGHT + 0 * x], axis=1)
    number = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    return vertices, np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])


def ball(rings=12, sectors=24):
    """Returns a sphere just above the floor."""
    across, around = np.meshgrid(
        np.linspace(0, np.pi, rings + 1)[1:-1], np.arange(sectors) * 2 * np.pi / sectors, indexing="ij"
    )
    points = np.stack([np.sin(across) * np.cos(around), np.sin(across) * np.sin(around), np.cos(across)], -1)
    number = np.arange((rings - 1) * sectors).reshape(rings - 1, sectors)
    right = np.roll(number, -1, axis=1)
    top, bottom = number.size, number.size + 1
    faces = [
        np.stack([number[:-1], number[1:], right[1:]], -1).reshape(-1, 3),
        np.stack([number[:-1], right[1:], right[:-1]], -1).reshape(-1, 3),
        np.stack([np.full(sectors, top), number[0], right[0]], -1),
        np.stack([np.full(sectors, bottom), right[-1], number[-1]], -1),
    ]
    vertices = np.concatenate([points.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    return BALL * vertices + [0, 0, BALL + THICKNESS], np.concatenate(faces)


def floor():
    return np.array([[-1.5, -1.5, 0], [1.5, -1.5, 0], [1.5, 1.5, 0], [-1.5, 1.5, 0]]), np.array([[0, 1, 2], [0, 2, 3]])


def springs():
    """Yields springs in batches (i, j, rest length, stiffness): along the grid, diagonal, bending.

    No vertex is twice in a batch.
    """
    number = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    for di, dj, stiffness in ((1, 0, 1), (0, 1, 1), (1, 1, 0.5), (1, -1, 0.5), (2, 0, BENDING), (0, 2, BENDING)):
        first = number[: SIDE - di, max(0, -dj) : SIDE - max(0, dj)]
        second = number[di:, max(0, dj) : SIDE + min(0, dj)]
        along = np.arange(first.shape[0])[:, None] if di else np.arange(first.shape[1])[None, :]
        odd = np.broadcast_to(along // max(di, dj) % 2 == 1, first.shape)
        for half in (odd, ~odd):
            yield first[half], second[half], SPACING * np.hypot(di, dj), stiffness


class Contacts:
    """Pairs of features that are near each other, as stencils at the start of the step."""

    def __init__(self, stencils, positions, movable):
        self.stencils, self.start, self.movable = stencils, positions, movable

    def push(self, positions):
        """Makes one Jacobi round: pushes apart pairs that are nearer than the thickness, with friction."""
        gap = np.einsum("kx,kx->k", self.stencils.vectors(positions), self.stencils.normals)
        pressed = self.stencils.select(gap < THICKNESS)
        depth, normals = THICKNESS - gap[gap < THICKNESS], pressed.normals
        slid = pressed.vectors(positions - self.start)
        slid -= np.einsum("kx,kx->k", slid, normals)[:, None] * normals
        grip = np.minimum(1, FRICTION * depth / np.maximum(np.linalg.norm(slid, axis=1), 1e-30))
        moved = pressed.weights * self.movable[pressed.vertices]
        correction = (depth[:, None] * normals - grip[:, None] * slid) / (pressed.weights * moved).sum(axis=1)[:, None]
        count = np.bincount(pressed.vertices.ravel(), moved.ravel() != 0, len(positions))
        change = replace(pressed, weights=moved).scatter(correction, len(positions))
        positions += change / np.maximum(count, 1)[:, None]


def pull(positions, batches):
    """Makes one iteration: moves the ends of each spring towards its rest length."""
    for i, j, rest, stiffness in batches:
        apart = positions[j] - positions[i]
        length = np.linalg.norm(apart, axis=1)[:, None]
        half = 0.5 * stiffness * (1 - rest / np.maximum(length, 1e-9)) * apart
        positions[i] += half
        positions[j] -= half


class Simulation:
    def __init__(self):
        parts = [grid(), ball(), floor()]
        first = np.cumsum([0] + [len(vertices) for vertices, _ in parts])
        self.positions = np.concatenate([vertices for vertices, _ in parts])
        self.faces = np.concatenate([faces + start for (_, faces), start in zip(parts, first)]).astype(np.int32)
        self.groups = np.repeat([0, 1, 1], [len(faces) for _, faces in parts]).astype(np.int32)
        self.movable = (np.arange(len(self.positions)) < SIDE * SIDE).astype(float)
        self.velocity = np.zeros_like(self.positions)
        self.batches = list(springs())
        self.detector = crumple.Detector()
        # Ball and floor are static: pairs of triangles within group 1 are not tested.
        self.options = {"groups": self.groups, "filter": crumple.PairFilter(excluded_groups=[(1, 1)])}
        self.held = 0  # impacts that the thickness alone did not prevent

    def step(self, seconds):
        start = self.positions
        self.velocity += self.movable[:, None] * [0, 0, -9.81 * seconds]
        self.velocity *= 1 - DRAG * seconds
        target = start + seconds * self.velocity

        # Finds features that may come nearer than the thickness in this step. Some are too fast for this radius; the
        # query for impacts finds these.
        fastest = np.linalg.norm(self.velocity, axis=1).max() * seconds
        radius = THICKNESS + min(2 * fastest, THICKNESS)
        near = self.detector.proximities(start, self.faces, radius=radius, closest=True, **self.options)
        contacts = Contacts(crumple.stencils((start, self.faces), near), start, self.movable)
        for _ in range(ROUNDS):
            pull(target, self.batches)
            contacts.push(target)

        self.positions = self.without_impacts(start, target)
        self.velocity = (self.positions - start) / seconds

    def without_impacts(self, start, target):
        """Returns positions that can be reached without impact: vertices that would hit something move half-way."""
        for _ in range(10):
            impacts = self.detector.impacts(start, target, self.faces, min_distance_share=0.1, **self.options)
            if not impacts:
                break
            self.held += len(impacts)
            share = np.ones(len(start))
            stencils = crumple.stencils(crumple.Mesh(start, self.faces).moving_to(target), impacts)
            toi = np.concatenate([impacts.vertex_face_toi, impacts.edge_edge_toi])
            np.minimum.at(share, stencils.vertices, toi[:, None])
            target = start + np.where(share < 1, 0.5 * share, 1)[:, None] * (target - start)
        return self.detector.free_step(start, target, self.faces, **self.options).positions


def animate(frames, faces, picture):
    """Writes an animated GIF, by PyVista and Pillow."""
    import pyvista
    from PIL import Image

    pictures = []
    cloth = 2 * (SIDE - 1) ** 2
    for vertices in frames:
        scene = pyvista.Plotter(off_screen=True, window_size=(320, 220))
        scene.set_background("white")
        for part, colour in ((faces[:cloth], "#3f7fa6"), (faces[cloth:-2], "#8a9199"), (faces[-2:], "#c7ccd1")):
            scene.add_mesh(pyvista.PolyData.from_regular_faces(vertices, part), color=colour, smooth_shading=True)
        scene.camera_position = [(1.0, -1.4, 0.83), (0, 0, 0.17), (0, 0, 1)]
        pictures.append(Image.fromarray(scene.screenshot(return_img=True)))
        scene.close()
    colours = Image.fromarray(np.concatenate([pictures[0], pictures[-1]])).quantize(24)
    pictures = [each.quantize(palette=colours, dither=Image.Dither.NONE) for each in pictures]
    duration = 2000 // FRAMES_A_SECOND
    pictures[0].save(picture, save_all=True, append_images=pictures[1:], duration=duration, loop=0)


def main(picture="cloth.html", seconds=1.6):
    simulation = Simulation()
    frames = [simulation.positions]
    intersecting, least = 0, np.inf
    for _ in range(round(float(seconds) * FRAMES_A_SECOND)):
        for _ in range(STEPS_A_FRAME):
            simulation.step(1 / (FRAMES_A_SECOND * STEPS_A_FRAME))
        frames.append(simulation.positions)
        result = simulation.detector.intersections(simulation.positions, simulation.faces)
        intersecting += len(result)
        near = simulation.detector.proximities(
            simulation.positions, simulation.faces, radius=THICKNESS, least=True, **simulation.options
        )
        least = min(least, near.vertex_distance.min(), near.edge_distance.min())
    print(f"{len(simulation.faces)} triangles, {len(frames) - 1} frames: {intersecting} pairs of triangles intersect")
    print(f"impacts held back: {simulation.held}; least distance in any frame: {least / THICKNESS:.2g} thicknesses")
    if picture.endswith(".gif"):
        animate(frames[::2], simulation.faces, picture)
    else:
        result.save(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
