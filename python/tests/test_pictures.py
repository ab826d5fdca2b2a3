"""Tests of the contents of pictures. Their appearance was checked by eye (docs/python_gallery.md)."""

import base64
import errno
import json
import re

import numpy as np
import pytest

import crumple
from conftest import peer
from crumple._drawing import CALM, COLLIDING, drawing_of


def test_colliding_triangles_are_coloured(crossing, detector):
    far = crumple.Mesh(crossing.vertices.astype(np.float32)[::-1][::-1], crossing.faces[:1])
    drawing = drawing_of(detector.intersections(crossing, far, output="contacts")._painted())
    assert drawing.vertices.shape == (18, 3) and drawing.faces.tolist()[-1] == [9, 10, 11]
    assert drawing.colours.tolist() == [list(c) for c in (COLLIDING[0], COLLIDING[0], CALM[0], COLLIDING[1])]


def test_area_contact_is_drawn_as_lines_and_touching_as_a_point(detector):
    """This coplanar overlap, a triangle, is drawn with three lines, and a touching point with none."""
    vertices = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 0], [2, 1, 0], [1, 2, 0]]
    area = detector.intersections(vertices, [[0, 1, 2], [3, 4, 5]], output="contacts")
    assert drawing_of(area._painted()).lines.shape == (3, 2, 3) and not len(drawing_of(area._painted()).points)
    edges = {tuple(sorted(map(tuple, line))) for line in drawing_of(area._painted()).lines.tolist()}
    corners = [tuple(map(float, v)) for v in vertices[3:]]
    assert edges == {tuple(sorted(e)) for e in zip(corners, corners[1:] + corners[:1])}
    touch = detector.intersections(
        [*vertices[:3], [1, 1, 0], [1, 1, 5], [2, 1, 5]], [[0, 1, 2], [3, 4, 5]], output="contacts"
    )
    assert drawing_of(touch._painted()).points.tolist() == [[1, 1, 0]] and not len(drawing_of(touch._painted()).lines)


def test_all_contacts_of_a_scene_are_drawn(detector):
    mesh = crumple.make_scene("lattice", triangles=2000)
    contacts = detector.intersections(mesh, output="contacts").contacts
    drawing = drawing_of(detector.intersections(mesh, output="contacts")._painted())
    counts = np.diff(contacts.offsets)
    assert set(counts.tolist()) >= {1, 2, 3, 4}
    assert len(drawing.lines) == (counts == 2).sum() + counts[counts > 2].sum()
    assert len(drawing.points) == (counts == 1).sum()
    assert sorted(drawing.points.tolist()) == sorted(contacts.points[contacts.offsets[:-1][counts == 1]].tolist())
    lines = {tuple(line.ravel().tolist()) for line in drawing.lines}
    for pair in np.nonzero(counts > 1)[0]:
        points = contacts[pair]
        ring = [(*a, *b) for a, b in zip(points.tolist(), np.roll(points, -1, axis=0).tolist())]
        assert lines.issuperset(ring if len(ring) > 2 else ring[:1])


@pytest.mark.parametrize("scale", [1.0, 1e-300, 8e307])
def test_html_picture_has_finite_corners_at_extreme_scales(scale, crossing, detector):
    result = detector.intersections(crumple.Mesh(crossing.vertices * (scale / 9), crossing.faces), output="contacts")
    text = result.to_html(height=333)
    assert "@" not in re.sub(r"const data = .*", "", text) and "height:333px" in text
    assert "1 colliding pairs of 3 triangles" in text and "http" not in text
    data = json.loads(re.search(r"const data = (.*);", text).group(1))
    corners = np.frombuffer(base64.b64decode(data["corners"]), "<f4").reshape(-1, 3)
    colours = np.frombuffer(base64.b64decode(data["colours"]), "u1").reshape(-1, 3)
    assert corners.shape == colours.shape == (9, 3)
    assert np.isfinite(corners).all() and 0.5 < np.linalg.norm(corners, axis=1).max() < 1.001
    assert result.to_html() != result.to_html(), "two viewers in one notebook do not share an id"


def test_html_of_an_empty_mesh_shows_no_pairs(detector):
    assert "0 colliding pairs of 0 triangles" in detector.intersections([], []).to_html()


def test_import_error_without_pyvista_explains_how_to_install_it(tmp_path, crossing, detector, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(ModuleNotFoundError, match="pip install pyvista"):
        detector.intersections(crossing).save(tmp_path / "picture.png")


def test_picture_is_red_only_if_triangles_collide(tmp_path, detector):
    peer("pyvista")
    image = peer("PIL.Image")
    mesh = crumple.make_scene("cloth", triangles=5000, frame=60)
    detector.intersections(mesh, output="contacts").save(tmp_path / "hit.png", window_size=(400, 300))
    detector.intersections(mesh, filter=crumple.PairFilter(groups="between", excluded_groups=[(0, 1)])).save(
        tmp_path / "calm.png", window_size=(400, 300)
    )

    detector.intersections(mesh).save(tmp_path / "LOUD.PNG", window_size=(400, 300), return_img=False)
    assert image.open(tmp_path / "LOUD.PNG").format == "PNG"
    for extension in ("png", "jpg"):
        with pytest.raises(crumple.FileError, match=f"cannot write .*none/a.{extension}: there is no folder") as caught:
            detector.intersections(mesh).save(tmp_path / "none" / f"a.{extension}")
        assert caught.value.errno == errno.ENOENT

    def red(name):
        pixels = np.asarray(image.open(tmp_path / name).convert("RGB")).astype(int)
        assert pixels.shape == (300, 400, 3)
        return ((pixels[..., 0] > 100) & (pixels[..., 0] > 1.8 * pixels[..., 1])).sum()

    assert red("hit.png") > 100 and red("calm.png") == 0
