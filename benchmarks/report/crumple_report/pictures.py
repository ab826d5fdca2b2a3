"""Off-screen renderings by PyVista: models coloured by cluster, like [MZ] fig. 3, and frames of scenes, like fig. 5.
[MZ] is the paper that Crumple follows (ARCHITECTURE.md).

Meshes, parts and pairs come from crumple_benchmark --serve. Pictures are transparent and in medium tones, so that they
are readable on light and dark pages. Their bytes depend on the machine, so no test compares the committed pictures.
"""

import io
import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pyvista
from PIL import Image, ImageDraw, ImageFont

LARGE, SMALL = (400, 300), (280, 220)
VIEW, UP = (1.0, -1.6, 0.95), (0, 0, 1)
COLOURS = ["#4f8fe6", "#f08a3c", "#3fae6b", "#c25bd0", "#c9a227", "#2aa7b8", "#e0566f", "#8d80e8",
           "#7fae3a", "#b5754a", "#5b9aa0", "#d67fb0", "#6f86b0", "#a8963f", "#4aa58c", "#d2694f"]
OVERLAP, CLOTH, HIT, BALL, LABEL = "#555b64", "#8fa9c9", "#e5484d", "#b9a37c", "#7d8590"


class Scene:
    """Mesh and colliding triangles of a workload; for each number in `parts`, bit masks of the parts of triangles."""

    def __init__(self, benchmark, workload, parts=()):
        with tempfile.TemporaryDirectory() as folder:
            server = subprocess.Popen([benchmark, "--scene", workload, "--serve"], stdin=subprocess.PIPE,
                                      stdout=subprocess.PIPE, text=True)

            def ask(request):
                print(request, file=server.stdin, flush=True)
                return json.loads(server.stdout.readline())

            scalar = ask(f"dump {folder}")["scalar"]
            self.vertices = np.fromfile(Path(folder) / "vertices", scalar).reshape(-1, 3)
            self.triangles = np.fromfile(Path(folder) / "triangles", np.int32).reshape(-1, 3)
            pairs = np.fromfile(Path(folder) / "pairs", np.int32)
            self.hit = np.zeros(len(self.triangles), bool)
            self.hit[pairs] = True
            self.masks = {}
            for count in parts:
                ask(f"parts {count} {folder}")
                self.masks[count] = np.fromfile(Path(folder) / "parts", np.uint64)
            server.stdin.close()
            server.wait()


def rgb(colour):
    return [int(colour[i:i + 2], 16) for i in (1, 3, 5)]


def by_part(masks):
    """Returns a colour for each triangle by its part (bit k of its mask: part k). Triangles of several are dark."""
    bits = (masks[:, None] >> np.arange(64, dtype=np.uint64) & np.uint64(1)).astype(bool)
    colours = np.array([rgb(c) for c in COLOURS], np.uint8)[bits.argmax(1) % len(COLOURS)]
    colours[bits.sum(1) > 1] = rgb(OVERLAP)
    return colours


def polydata(scene):
    faces = np.column_stack([np.full(len(scene.triangles), 3), scene.triangles]).ravel()
    return pyvista.PolyData(scene.vertices.astype(float), faces)


def bodies(scene):
    """Returns the number of the connected component of each triangle."""
    return polydata(scene).connectivity("all").cell_data["RegionId"]


def by_hit(scene):
    """Returns a colour for each triangle: red if it collides, else one colour for the body with the most triangles (the
    cloth) and another one for all other bodies."""
    body = bodies(scene)
    colours = np.array([rgb(BALL), rgb(CLOTH)], np.uint8)[(body == np.bincount(body).argmax()).astype(int)]
    colours[scene.hit] = rgb(HIT)
    return colours


def shown(scene):
    """Returns a mask of the triangles to show. Hides a ground, which is a body that lies entirely at the lowest z."""
    height = scene.vertices[scene.triangles][:, :, 2]
    low, high = height.min(), height.max()
    body = bodies(scene)
    raised = np.bincount(body, (height > low + 1e-6 * (high - low)).any(1))
    return raised[body] > 0


def bounds(scene):
    points = scene.vertices[scene.triangles[shown(scene)]].reshape(-1, 3)
    return np.column_stack([points.min(0), points.max(0)])


def render(scene, colours, size, zoom, box=None):
    mesh = polydata(scene)
    mesh.cell_data["colour"] = colours
    mesh = mesh.extract_cells(shown(scene)).extract_surface(algorithm="dataset_surface")
    plotter = pyvista.Plotter(off_screen=True, window_size=(2 * size[0], 2 * size[1]), lighting="light_kit")
    plotter.add_mesh(mesh, scalars="colour", rgb=True, smooth_shading=False, ambient=0.15, diffuse=0.85, specular=0.1)
    plotter.camera_position = [VIEW, (0, 0, 0), UP]
    plotter.reset_camera(bounds=(bounds(scene) if box is None else box).ravel())
    plotter.camera.zoom(zoom)
    image = plotter.screenshot(transparent_background=True, return_img=True)
    plotter.close()
    return Image.fromarray(image).resize(size, Image.LANCZOS)


def labelled(image, text):
    """Adds a line of text in the lower left corner of an image."""
    ImageDraw.Draw(image).text((10, image.height - 24), text, fill=LABEL, font=ImageFont.load_default(15))
    return image


def sheet(rows, path):
    """Writes rows of pictures of one size as a PNG with a small palette."""
    width, height = rows[0][0].size
    picture = Image.new("RGBA", (width * max(map(len, rows)), height * len(rows)))
    for y, row in enumerate(rows):
        for x, image in enumerate(row):
            picture.paste(image, (x * width, y * height))
    buffer = io.BytesIO()
    picture.quantize(256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(buffer, "PNG", optimize=True)
    path.write_bytes(buffer.getvalue())
    print(f"{path.name}: {picture.width} x {picture.height}, {len(buffer.getvalue()) // 1024} KiB")


def listed(benchmark):
    """Returns the words of the benchmark's --list, which include its scenes."""
    return subprocess.run([benchmark, "--list"], capture_output=True, text=True, check=True).stdout.split()


def frames_of(benchmark, name, frames):
    return [Scene(benchmark, f"{name}@{frame}") for frame in frames]


def film(scenes, frames, zoom, box=None):
    """Renders a row of frames with their numbers."""
    return [labelled(render(scene, by_hit(scene), SMALL, zoom, box), f"frame {frame}")
            for scene, frame in zip(scenes, frames)]


def draw_pictures(folder, benchmark):
    folder.mkdir(parents=True, exist_ok=True)
    known = listed(benchmark)
    cloth = "cloth_on_ball" if "cloth_on_ball" in known else "cloth"
    models = [(cloth, 60 if cloth == "cloth_on_ball" else 80), ("bodies", 40), ("model:2000000", 0)]
    if "funnel" in known:
        models.insert(1, ("funnel", 375))
    scenes = [Scene(benchmark, f"{name}@{frame}", (2, 16)) for name, frame in models]
    sheet([[render(scene, by_part(scene.masks[count]), LARGE, 1.15) for scene in scenes] for count in (2, 16)],
          folder / "clusters.png")

    frames = (0, 10, 40, 60, 93)
    rows = [film(frames_of(benchmark, cloth, frames), frames, 1.2)]
    if "funnel" in known:  # the same camera for all frames, because the funnel itself does not move
        frames = (0, 125, 200, 375, 500)
        scenes = frames_of(benchmark, "funnel", frames)
        boxes = np.array([bounds(scene) for scene in scenes[1:]])
        box = np.column_stack([boxes[:, :, 0].min(0), boxes[:, :, 1].max(0)])
        rows.append(film(scenes, frames, 1.28, box))
    sheet(rows, folder / "frames.png")
