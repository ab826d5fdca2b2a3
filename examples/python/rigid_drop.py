"""Drops a ring onto a cone. The contact force comes from an energy of the overlap volume, so that energy is conserved.

The contact has the energy E(V) = STIFFNESS / 2 * V**2, where V is the volume that both bodies cover. `area_vector` and
`torque` of an overlap are the derivatives of V by a translation and a rotation of the first body, here the ring. So the
force on the ring is -E'(V) * area_vector, and the torque is -E'(V) * torque. Each step is symplectic: half a kick by
force and torque, a free motion, half a kick. The program simulates two bounces with two step sizes, and checks that the
error of the total energy is small, and at least 8 times less with a quarter of the step.

    python rigid_drop.py [PICTURE [SECONDS]]      .png: poses and energies (needs PyVista); .html, .glb: deepest overlap
"""

import sys
from typing import NamedTuple

import numpy as np

import crumple
from two_solids import torus

STIFFNESS, GRAVITY = 2e4, 9.81  # stiffness of the contact, in energy per squared volume; the ring has density 1
STEPS = 1 / 250, 1 / 1000  # seconds


class State(NamedTuple):
    """State after a step: time, pose of the ring, and the three energies, whose sum is constant in an exact motion."""

    time: float
    pose: np.ndarray
    energies: tuple[float, float, float]  # energies: kinetic, potential, contact


def cone(sides=48, radius=2.5, height=2.2):
    """Returns a cone with its tip at the origin."""
    angle = 2 * np.pi * np.arange(sides) / sides
    base = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(sides, -height)], axis=1)
    i, j = np.arange(sides), np.roll(np.arange(sides), -1)
    tip, middle = np.full(sides, sides), np.full(sides, sides + 1)
    faces = np.concatenate([np.stack([i, j, tip], axis=1), np.stack([j, i, middle], axis=1)])
    return np.concatenate([base, [[0, 0, 0], [0, 0, -height]]]), faces


def principal_frame(vertices, faces):
    """Returns vertices relative to the centre of mass and the principal axes, the mass, and the principal inertias."""
    corners = vertices[faces]
    mass_of = np.linalg.det(corners) / 6  # volume of the tetrahedron over each face
    centre = (mass_of[:, None] * corners.mean(axis=1)).sum(axis=0) / (4 / 3 * mass_of.sum())
    corners = corners - centre
    mass_of, total = np.linalg.det(corners) / 6, corners.sum(axis=1)
    second = np.einsum("f,fi,fj->ij", mass_of, total, total) + np.einsum("f,fci,fcj->ij", mass_of, corners, corners)
    inertias, axes = np.linalg.eigh(second / 20)
    axes[:, 0] *= np.linalg.det(axes)  # a rotation, no reflection
    return (vertices - centre) @ axes, mass_of.sum(), inertias.sum() - inertias


def turn(axis, angle):
    """Returns the matrix of a rotation about a coordinate axis."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[j, i], matrix[i, j] = np.sin(angle), -np.sin(angle)
    return matrix


class Drop:
    """A ring that falls onto a fixed cone: position and momentum, and rotation and angular momentum in its own axes."""

    def __init__(self):
        vertices, faces = torus(64, 32, 0.4)
        vertices, self.mass, self.inertias = principal_frame(vertices, faces)
        shapes = [crumple.Shape(vertices, faces, name="ring"), crumple.Shape(*cone(), name="cone")]
        self.world = crumple.World(shapes, poses=np.tile(np.eye(3, 4), (2, 1, 1)))
        self.detector = crumple.Detector(threads=1)
        self.position, self.momentum = np.array([0.25, 0.1, 1.4]), np.zeros(3)
        self.rotation = turn(1, np.pi / 2) @ turn(1, 0.35) @ turn(0, 0.2)
        self.spin = np.zeros(3)
        self.feel()

    def feel(self):
        """Computes force and torque at the current pose, and the energy of the contact."""
        self.world.poses[0, :, :3], self.world.poses[0, :, 3] = self.rotation, self.position
        found = self.detector.overlaps(self.world)
        self.force, self.torque, self.contact = np.array([0, 0, -GRAVITY * self.mass]), np.zeros(3), 0.0
        if found:
            volume, area_vector = found.volume[0], found.area_vector[0]
            self.contact = STIFFNESS / 2 * volume**2
            self.force = self.force - STIFFNESS * volume * area_vector
            arm = found.torque_point[0] - self.position
            about_centre = found.torque[0] + np.cross(arm, area_vector)
            self.torque = -STIFFNESS * volume * self.rotation.T @ about_centre

    def rotate(self, axis, seconds):
        """Applies the part of a free rotation that is about one principal axis."""
        matrix = turn(axis, seconds * self.spin[axis] / self.inertias[axis])
        self.rotation = self.rotation @ matrix
        self.spin = matrix.T @ self.spin

    def step(self, seconds):
        self.momentum = self.momentum + seconds / 2 * self.force
        self.spin = self.spin + seconds / 2 * self.torque
        self.position = self.position + seconds / self.mass * self.momentum
        for axis, share in ((0, 0.5), (1, 0.5), (2, 1), (1, 0.5), (0, 0.5)):
            self.rotate(axis, share * seconds)
        self.feel()
        self.momentum = self.momentum + seconds / 2 * self.force
        self.spin = self.spin + seconds / 2 * self.torque

    def run(self, seconds, duration):
        """Returns the states at the start and after each step."""
        states = [self.state(0)]
        for i in range(round(duration / seconds)):
            self.step(seconds)
            states.append(self.state((i + 1) * seconds))
        return states

    def state(self, time):
        motion = (self.momentum**2).sum() / (2 * self.mass) + (self.spin**2 / self.inertias).sum() / 2
        height = GRAVITY * self.mass * self.position[2]
        return State(time, self.world.poses[0].copy(), (motion, height, self.contact))


def draw(states, world, picture):
    """Draws poses of the ring (first pale, deepest orange, then highest blue) and energies over time, by PyVista."""
    import pyvista

    scene = pyvista.Plotter(off_screen=True, shape=(1, 2), window_size=(960, 400), border=False)
    meshes = [shape.mesh for shape in world.shapes]
    ring, fixed = (pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.faces) for mesh in meshes)
    scene.add_mesh(fixed, color="#c7ccd1", show_edges=True, edge_color="#8a9199")
    contact = np.array([state.energies[2] for state in states])
    deepest = contact.argmax()
    highest = deepest + np.argmax([state.pose[2, 3] for state in states[deepest:]])
    for i, colour, opacity in ((0, "#8a9199", 0.3), (deepest, "#d55e00", 1), (highest, "#3f7fa6", 1)):
        posed = ring.transform(np.vstack([states[i].pose, [0, 0, 0, 1]]), inplace=False)
        scene.add_mesh(posed, color=colour, opacity=opacity, smooth_shading=True)
    scene.camera_position = [(4.5, -8.5, 2.2), (0, 0, 0.25), (0, 0, 1)]
    scene.subplot(0, 1)
    chart = pyvista.Chart2D(x_label="seconds", y_label="energy")
    times = [state.time for state in states]
    curves = np.array([state.energies for state in states]).T
    for name, colour, energy in (
        ("motion", "#3f7fa6", curves[0]),
        ("height", "#8a9199", curves[1]),
        ("contact", "#d55e00", curves[2]),
        ("sum", "black", curves.sum(axis=0)),
    ):
        chart.line(times, energy, color=colour, width=2, label=name)
    chart.y_range = -20, 80
    scene.add_chart(chart)
    scene.set_background("white")
    scene.screenshot(picture)
    scene.close()


def main(picture="rigid_drop.html", seconds=2.0):
    errors = []
    for step in STEPS:
        drop = Drop()
        states = drop.run(step, float(seconds))
        sums = np.array([sum(state.energies) for state in states])
        contact = np.array([state.energies[2] for state in states])
        errors.append(np.abs(sums / sums[0] - 1).max())
        stored, at_end = contact.max() / sums[0], abs(sums[-1] / sums[0] - 1)
        print(f"step 1/{1 / step:.0f} s: the contact stores up to {stored:.0%} of the energy; ", end="")
        print(f"the sum of energies is off by at most {errors[-1]:.2%}, at the end by {at_end:.2%}")
    if not (contact.any() and errors[0] < 0.02 and errors[1] < errors[0] / 8):
        raise RuntimeError(f"energy is not conserved: errors {errors}")
    print(f"a quarter of the step: {errors[0] / errors[1]:.0f} times less error")
    if picture.endswith(".png"):
        draw(states, drop.world, picture)
    else:
        drop.world.poses[0] = states[contact.argmax()].pose
        drop.detector.overlaps(drop.world).save(picture, drop.world)


if __name__ == "__main__":
    main(*sys.argv[1:])
