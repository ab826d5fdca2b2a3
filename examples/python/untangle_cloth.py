"""Untangles two layers of cloth that pass through each other, by moving vertices so that curves get shorter.

The layers are open surfaces: they have no inside, and their overlap has no volume. With open="curves", an overlap query
still finds the curves in which they cross. At each point of a curve, an edge of one layer crosses a triangle of the
other. So the length of the curves is a function of the vertices, and its derivative shows how to move them: when the
length is 0, the layers are separate. The method (P. Volino, N. Magnenat-Thalmann, "Resolving surface collisions through
intersection contour minimization", 2006) does not depend on which layer was above.

    python untangle_cloth.py [PICTURE [SIDE]]      .png: start, midway, end (needs PyVista); .html, .glb: the start
"""

import sys

import numpy as np

import crumple

MOST_STEPS = 200
SPEED = 0.2  # how far the fastest vertex moves in a step, in sides of a grid cell
SMOOTHING = 20  # rounds in which each vertex gets the mean of its own motion and those of its neighbours
PULLS = 4  # rounds in which each edge pulls its ends towards its length at the start


def cloth(side):
    """Returns the vertices (2 n, 3) of two wavy layers, their faces (2, m, 3), and all edges (k, 2)."""
    x, y = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side), indexing="ij")
    lower = np.stack([x, y, 0.06 * np.sin(6 * x + 1) * np.cos(3 * y)], axis=-1)
    upper = np.stack([x, y, 0.03 + 0.12 * np.sin(3 * x - 2 * y) * np.cos(5 * y + x)], axis=-1)
    upper += [0.37 / side, 0.26 / side, 0]
    number = np.arange(2 * side * side).reshape(2, side, side)
    a, b, c, d = number[:, :-1, :-1], number[:, 1:, :-1], number[:, 1:, 1:], number[:, :-1, 1:]
    faces = np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)], axis=1).reshape(2, -1, 3)
    edges = np.unique(np.sort(faces[:, :, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    return np.concatenate([lower.reshape(-1, 3), upper.reshape(-1, 3)]), faces, edges


def barycentric(points, corners):
    """Returns the barycentric coordinates (k, 2, 3) of points (k, 3) that lie in two triangles each."""
    u, v = corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0]
    w, normal = points[:, None] - corners[:, :, 0], np.cross(u, v)
    s, t = (np.cross(w, v) * normal).sum(axis=-1), (np.cross(u, w) * normal).sum(axis=-1)
    square = (normal**2).sum(axis=-1)
    return np.stack([square - s - t, s, t], axis=-1) / square[:, :, None]


def length_and_derivative(found, vertices, faces):
    """Returns the length of all curves, and its derivative by each vertex, with the shape of `vertices`."""
    points, triangles = found.curve_points, found.curve_triangles
    starts = np.flatnonzero(triangles[:, 0] >= 0)  # starts of segments: all points but the last one of each curve
    along = points[starts + 1] - points[starts]
    length = np.linalg.norm(along, axis=1)
    starts, along = starts[length > 0], along[length > 0] / length[length > 0, None]
    names = faces[[0, 1], triangles[starts]]  # (k, 2, 3): the vertices of the two triangles of each segment
    corners, derivative, row = vertices[names], np.zeros_like(vertices), np.arange(len(starts))
    for ends, sign in ((starts, -1), (starts + 1, 1)):
        # The point lies on an edge of one of the two triangles, where one of its barycentric coordinates is 0.
        weights = barycentric(points[ends], corners)
        one = np.abs(weights).min(axis=2).argmin(axis=1)
        opposite = np.abs(weights[row, one]).argmin(axis=1)
        edge = corners[row, one, (opposite + 2) % 3] - corners[row, one, (opposite + 1) % 3]
        a, b, c = corners[row, 1 - one].swapaxes(0, 1)
        normal = np.cross(b - a, c - a)
        # Moving the edge by d and the triangle by e moves the point by d - edge * (normal @ (d - e)) / (normal @ edge).
        of_other = normal * ((edge * along).sum(axis=1) / (edge * normal).sum(axis=1))[:, None]
        for layer, change in ((one, along - of_other), (1 - one, of_other)):
            np.add.at(derivative, names[row, layer], sign * weights[row, layer, :, None] * change[:, None])
    return length.sum(), derivative


class Cloth:
    """Two layers of cloth whose edges keep their lengths approximately."""

    def __init__(self, side):
        self.vertices, self.faces, self.edges = cloth(side)
        self.largest_motion = SPEED * 2 / (side - 1)
        self.lengths, self.degree = self.along_edges()[1], np.bincount(self.edges.ravel())[:, None]
        self.detector = crumple.Detector()

    def layers(self, vertices):
        half = len(vertices) // 2
        return crumple.Mesh(vertices[:half], self.faces[0]), crumple.Mesh(vertices[half:], self.faces[0])

    def curves(self, vertices):
        """Returns the overlaps, the length of their curves, and its derivative by the vertices."""
        found = self.detector.overlaps(*self.layers(vertices), open="curves", curves=True)
        return found, *length_and_derivative(found, vertices, self.faces)

    def along_edges(self):
        """Returns the vector from the first to the second vertex of each edge, and its length."""
        vectors = self.vertices[self.edges[:, 1]] - self.vertices[self.edges[:, 0]]
        return vectors, np.linalg.norm(vectors, axis=1)

    def step(self, motion):
        """Moves the vertices by a smoothed motion, scaled to the speed. Then edges pull."""
        for _ in range(SMOOTHING):
            of_neighbours = np.zeros_like(motion)
            np.add.at(of_neighbours, self.edges, motion[self.edges[:, ::-1]])
            motion = (motion + of_neighbours / self.degree) / 2
        self.vertices = self.vertices + self.largest_motion / np.linalg.norm(motion, axis=1).max() * motion
        for _ in range(PULLS):
            (vectors, lengths), change = self.along_edges(), np.zeros_like(self.vertices)
            pull = (1 - self.lengths / lengths)[:, None] * vectors / 2
            np.add.at(change, self.edges, np.stack([pull, -pull], axis=1))
            self.vertices = self.vertices + change / self.degree


def draw(frames, picture):
    """Draws layers and their curves side by side, with crossing triangles in orange, by PyVista."""
    import pyvista

    scene = pyvista.Plotter(off_screen=True, shape=(1, len(frames)), window_size=(1080, 270), border=False)
    for i, (layers, found) in enumerate(frames):
        scene.subplot(0, i)
        for layer, colour in ((0, (199, 204, 209)), (1, (63, 127, 166))):
            mesh = pyvista.PolyData.from_regular_faces(layers[layer].vertices, layers[layer].faces)
            colours, crossing = np.full((mesh.n_cells, 3), colour, np.uint8), found.curve_triangles[:, layer]
            colours[crossing[crossing >= 0]] = (213, 94, 0)
            scene.add_mesh(mesh, scalars=colours, rgb=True, smooth_shading=True)
        scene.camera_position = [(0.7, -2.9, 2.8), (0, 0, -0.05), (0, 0, 1)]
    scene.set_background("white")
    scene.screenshot(picture)


def main(picture="untangle_cloth.html", side=41):
    layers = Cloth(int(side))
    found, _, derivative = layers.curves(layers.vertices)
    if not picture.endswith(".png"):
        found.save(picture, *layers.layers(layers.vertices))
    lift = 1e-7 * np.repeat([[0, 0, 0], [0, 0, 1]], len(derivative) // 2, axis=0)  # heights of the upper layer
    change = layers.curves(layers.vertices + lift)[1] - layers.curves(layers.vertices - lift)[1]
    slope, difference = (derivative * lift).sum() / 1e-7, change / 2e-7
    print(f"derivative of the length by a lift of the upper layer: {slope:.5f}, by differences {difference:.5f}")
    if abs(slope - difference) > 1e-5 * abs(slope):
        raise RuntimeError("the derivative is wrong")

    frames = []
    for step in range(MOST_STEPS + 1):
        found, length, derivative = layers.curves(layers.vertices)
        frames.append((layers.layers(layers.vertices), found))
        count = layers.detector.intersections(*frames[-1][0], output="count").count
        if step % 10 == 0 or not count:
            print(f"step {step:3}: {count:4} pairs of triangles intersect, in curves of length {length:.3f}")
        if not count:
            break
        layers.step(-derivative)
    else:
        raise RuntimeError(f"{count} pairs of triangles still intersect after {MOST_STEPS} steps")
    stretch = layers.along_edges()[1] / layers.lengths
    print(f"no pair intersects; edges have {stretch.min():.2f} to {stretch.max():.2f} of their lengths at the start")
    if picture.endswith(".png"):
        draw([frames[0], frames[len(frames) // 3], frames[-1]], picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
