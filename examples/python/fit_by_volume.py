"""Fits one solid to another by gradient descent on the volume of their overlap, with PyTorch.

OverlapVolume makes the volume a function that PyTorch differentiates: the forward pass is an overlap query with
gradient=True, and the backward pass multiplies its derivatives by the incoming gradient. The program moves, rotates and
scales an oval ring until it covers a target, which is the same ring of another size at another pose. The loss is
1 - IoU; the IoU (intersection over union) is the volume of the overlap divided by that of the union. At the start, the
program compares the gradient with finite differences.

    python fit_by_volume.py [PICTURE [STEPS]]    .png: start, midway, end, loss (needs PyVista); .html, .glb: the start
"""

import sys

import numpy as np

import crumple
from two_solids import torus

try:
    import torch
except ImportError:
    sys.exit("fit_by_volume.py needs PyTorch: pip install torch")

ROTATION, TRANSLATION, SCALE = [0.5, -0.4, 0.6], [0.4, 0.3, -0.35], 0.2  # position of the target; SCALE is a logarithm


class OverlapVolume(torch.autograd.Function):
    """Volume of the overlap of two closed meshes with the same faces, differentiable by the vertices of both."""

    @staticmethod
    def forward(ctx, first, second, faces, detector):
        found = detector.overlaps((first.detach(), faces), (second.detach(), faces), gradient=True)
        derivatives = first.new_zeros(2, *first.shape)
        body, vertex = torch.tensor(found.gradient_vertices).long().T
        derivatives[body, vertex] = torch.tensor(found.gradient)
        ctx.save_for_backward(derivatives)
        return first.new_tensor(found.volume.sum())  # volume of one row, or of none if the meshes are disjoint

    @staticmethod
    def backward(ctx, incoming):
        (derivatives,) = ctx.saved_tensors
        return incoming * derivatives[0], incoming * derivatives[1], None, None


class Fit:
    """Ring whose pose and size are parameters, and the target."""

    def __init__(self):
        vertices, faces = torus(48, 24, 0.45)
        self.unposed = torch.from_numpy(vertices * [1, 0.75, 1])
        self.faces = torch.from_numpy(faces)
        self.detector = crumple.Detector()
        self.target = self.posed(torch.tensor([*ROTATION, *TRANSLATION, SCALE], dtype=torch.float64))

    def posed(self, parameters):
        """Returns the vertices for a rotation vector, a translation and the logarithm of a scale."""
        (x, y, z), translation, scale = parameters[:3], parameters[3:6], parameters[6]
        zero = torch.zeros_like(x)
        turn = torch.linalg.matrix_exp(torch.stack([zero, -z, y, z, zero, -x, -y, x, zero]).reshape(3, 3))
        return torch.exp(scale) * self.unposed @ turn.T + translation

    def volume(self, vertices):
        return torch.linalg.det(vertices[self.faces]).sum() / 6

    def overlap(self, vertices):
        return OverlapVolume.apply(vertices, self.target, self.faces, self.detector)

    def loss(self, parameters):
        vertices = self.posed(parameters)
        overlap = self.overlap(vertices)
        return 1 - overlap / (self.volume(vertices) + self.volume(self.target) - overlap)


def check_gradient(fit):
    """Compares the derivative by a random motion of all vertices with central differences. Raises if they differ."""
    vertices = fit.unposed.clone().requires_grad_()
    fit.overlap(vertices).backward()
    motion = torch.from_numpy(np.random.default_rng(1).normal(size=vertices.shape))
    exact = (vertices.grad * motion).sum().item()
    for step in (1e-2, 1e-3, 1e-4):
        ends = [fit.overlap(fit.unposed + sign * step * motion).item() for sign in (1, -1)]
        difference = (ends[0] - ends[1]) / (2 * step)
        print(
            f"derivative {exact:.9f}; by differences over {step:g}: {difference:.9f}, {abs(difference - exact):.0e} off"
        )
    if abs(difference - exact) > 1e-6 * abs(exact):
        raise RuntimeError("the gradient is wrong")


def draw(fit, frames, losses, picture):
    """Draws the ring (blue) and the target (translucent) side by side, and the loss over the steps, by PyVista."""
    import pyvista

    scene = pyvista.Plotter(off_screen=True, shape=(1, len(frames) + 1), window_size=(1200, 300), border=False)
    for i, parameters in enumerate(frames):
        scene.subplot(0, i)
        for vertices, colour, opacity in ((fit.posed(parameters), "#3f7fa6", 1), (fit.target, "#d55e00", 0.45)):
            mesh = pyvista.PolyData.from_regular_faces(vertices.numpy(), fit.faces.numpy())
            scene.add_mesh(mesh, color=colour, opacity=opacity, smooth_shading=True)
        scene.camera_position = [(3.1, -6.0, 4.1), (0.3, 0.15, -0.15), (0, 0, 1)]
    scene.subplot(0, len(frames))
    chart = pyvista.Chart2D(x_label="step", y_label="1 - IoU")
    chart.line(range(len(losses)), losses, color="#d55e00", width=2)
    chart.y_axis.log_scale = True
    scene.add_chart(chart)
    scene.set_background("white")
    scene.screenshot(picture)
    scene.close()


def main(picture="fit_by_volume.html", steps=150):
    torch.set_num_threads(1)  # threads of PyTorch do not pay for arrays as small as these
    steps, fit = int(steps), Fit()
    check_gradient(fit)
    parameters = torch.zeros(7, dtype=torch.float64, requires_grad=True)
    optimizer = torch.optim.Adam([parameters], lr=0.05)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, steps)
    frames, losses = [], []
    for step in range(steps + 1):
        optimizer.zero_grad()
        loss = fit.loss(parameters)
        loss.backward()
        frames.append(parameters.detach().clone())
        losses.append(loss.item())
        if step % (steps // 5) == 0:
            print(f"step {step:3}: IoU {1 - losses[-1]:.5f}")
        optimizer.step()
        schedule.step()
    if losses[-1] > 0.01:
        raise RuntimeError(f"the ring does not cover the target: IoU {1 - losses[-1]:.5f}")
    if picture.endswith(".png"):
        draw(fit, [frames[0], frames[steps // 15], frames[-1]], losses, picture)
    else:
        start = crumple.Mesh(fit.unposed, fit.faces), crumple.Mesh(fit.target, fit.faces)
        fit.detector.overlaps(*start).save(picture, *start)


if __name__ == "__main__":
    main(*sys.argv[1:])
