"""Tests of overlaps of closed bodies: boxes for which all numbers are known, and input that is refused."""

import copy
import pickle

import numpy as np
import pytest

import crumple
from crumple import OverlapRelation

FACES = np.array(
    [
        [0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
        [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5],
    ]
)  # fmt: skip
CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)


def box(low, size=1.0):
    return crumple.Mesh(CORNERS * size + low, FACES)


UNIT = box([0, 0, 0])


@pytest.mark.parametrize(
    "other, relation, volume, normal, depth",
    [
        (box([0.5, 0, 0]), OverlapRelation.OVERLAPPING, 0.5, [1, 0, 0], 0.5),
        (box([0, 0, 0.75]), OverlapRelation.OVERLAPPING, 0.25, [0, 0, 1], 0.25),
        (box([0, 1, 0]), OverlapRelation.TOUCHING, 0, [0, 1, 0], 0),
        (box([0.25, 0.25, 0.25], 0.5), OverlapRelation.SECOND_INSIDE, 0.125, None, None),
        (box([-1, -1, -1], 3.0), OverlapRelation.FIRST_INSIDE, 1, None, None),
        (box([0, 0, 0]), OverlapRelation.EQUAL, 1, None, None),
    ],
)
def test_overlaps_of_boxes_have_known_volume_and_depth(detector, other, relation, volume, normal, depth):
    found = detector.overlaps(UNIT, other)
    assert len(found) == 1 and found.any and found.bodies.tolist() == [[0, 1]]
    assert found.relation.tolist() == [relation] and found.volume.tolist() == [volume]
    if normal is None:
        assert np.isnan(found.normal).all() and np.isnan(found.mean_depth).all()
    else:
        assert found.normal.tolist() == [normal] and found.mean_depth.tolist() == [depth]
    exchanged = detector.overlaps(other, UNIT)
    assert exchanged.volume.tolist() == [volume] and (exchanged.area_vector == -found.area_vector).all()


def test_separate_boxes_have_no_overlap(detector):
    found = detector.overlaps(UNIT, box([3, 0, 0]))
    assert not found and len(found) == 0 and found.volume.shape == (0,) and found.normal.shape == (0, 3)


def test_gradient_is_consistent_with_area_vector_and_volume(detector):
    other = box([0.5, 0.25, 0.125])
    found = detector.overlaps(UNIT, other, gradient=True)
    body, vertex = found.gradient_vertices.T
    assert found.gradient_offsets.tolist() == [0, len(found.gradient)]
    assert found.gradient[body == 0].sum(0) == pytest.approx(found.area_vector[0], abs=1e-15)
    positions = np.stack([UNIT.vertices, other.vertices])[body, vertex]
    assert (found.gradient * positions).sum() == pytest.approx(3 * found.volume[0], rel=1e-14)
    step = 2.0**-20
    for i in (0, len(found.gradient) // 2, len(found.gradient) - 1):
        moved = [UNIT.vertices.copy(), other.vertices.copy()]
        moved[body[i]][vertex[i], 0] += step
        more = detector.overlaps(*(crumple.Mesh(points, FACES) for points in moved)).volume[0]
        assert (more - found.volume[0]) / step == pytest.approx(found.gradient[i, 0], abs=1e-5)


def test_winding_numbers_list_the_vertices_inside(detector):
    found = detector.overlaps(UNIT, box([0.5, 0.5, 0.5]), windings=True)
    assert found.winding_vertices.tolist() == [[0, 7], [1, 0]] and found.windings.tolist() == [1, 1]


def test_closed_curve_has_the_area_vector_of_the_overlap(detector):
    found = detector.overlaps(UNIT, box([0.5, 0.5, 0.5]), curves=True)
    ((curve,),) = found.curves
    assert found.curve_offsets.tolist() == [0, 1] and found.curve_closed.tolist() == [True]
    assert curve.tolist() == found.curve_points.tolist() and curve[0].tolist() == curve[-1].tolist()
    assert found.curve_area_vector.tolist() == found.area_vector.tolist() == [[0.25, 0.25, 0.25]]
    assert (found.curve_triangles[:-1] >= 0).all() and found.curve_triangles[-1].tolist() == [-1, -1]
    area = np.cross(curve[:-1], curve[1:]).sum(0) / 2
    assert area.tolist() == found.area_vector[0].tolist()
    assert detector.overlaps(UNIT, box([3, 0, 0]), curves=True).curves == []


def test_open_surfaces_have_open_curves(detector):
    sheet = crumple.Mesh(np.array([[0.5, 0.5, 0.5], [2, 0.5, 0.5], [0.5, 2, 0.5]]), [[0, 1, 2]])
    found = detector.overlaps(UNIT, sheet, open="curves", curves=True)
    assert found.relation.tolist() == [OverlapRelation.UNDEFINED] and np.isnan(found.volume).all()
    ((curve,),) = found.curves
    assert found.curve_closed.tolist() == [False] and np.isnan(found.curve_area_vector).all()
    assert sorted([curve[0].tolist(), curve[-1].tolist()]) == [[0.5, 1, 0.5], [1, 0.5, 0.5]]
    assert pickle.loads(pickle.dumps(found)).curves[0][0].tolist() == curve.tolist()


def test_coplanar_faces_have_a_contact_area(detector):
    found = detector.overlaps(UNIT, box([0.25, 0, 1]))
    assert found.contact_area.tolist() == [0.75] and found.relation.tolist() == [OverlapRelation.TOUCHING]
    assert detector.overlaps(UNIT, box([0.25, 0.25, 0.25])).contact_area.tolist() == [0]


def test_overlap_of_a_mesh_with_itself_has_the_exact_volume(detector):
    alone = detector.overlaps(UNIT)
    assert len(alone) == 0 and alone.body_volume.tolist() == [1] and alone.is_solid.tolist() == [True]
    twice = crumple.Mesh(np.vstack([CORNERS, CORNERS + 0.5]), np.vstack([FACES, FACES + 8]))
    found = detector.overlaps(twice)
    assert found.bodies.tolist() == [[0, 0]] and found.volume.tolist() == [0.125]
    assert found.body_volume.tolist() == [2] and found.is_solid.tolist() == [False]


def test_only_bodies_of_the_same_world_overlap(detector):
    world = crumple.World([UNIT, box([0.5, 0, 0]), UNIT], worlds=[0, 0, 1])
    found = detector.overlaps(world)
    assert found.bodies.tolist() == [[0, 1]] and found.world_hit.tolist() == [True, False]
    assert detector.overlaps(world, output="any").any
    assert detector.any(world, crumple.OverlapQuery(min_volume=0.5))
    assert not detector.any(world, crumple.OverlapQuery(min_volume=0.51))
    assert detector.overlaps(world, output="any_by_world").world_hit.tolist() == [True, False]
    assert detector.overlaps(world, output="body_pairs").relation.tolist() == [OverlapRelation.OVERLAPPING]
    assert len(detector.overlaps(world, min_volume=0.5)) == 1
    assert len(detector.overlaps(world, min_volume=0.51)) == 0 and not detector.overlaps(world, min_volume=0.51).any
    assert detector.overlaps(world, self_overlaps=True).is_solid.tolist() == [True] * 3


def test_open_surfaces_are_refused_by_default_and_may_be_skipped_or_welded(detector):
    opened = crumple.Mesh(CORNERS, FACES[1:])
    with pytest.raises(crumple.InvalidInput, match="body 1: its surface is not closed: 3 edges .* of triangle "):
        detector.overlaps(UNIT, opened)
    skipped = detector.overlaps(crumple.World([UNIT, opened, box([9, 9, 9]), opened, UNIT]), open="skip")
    assert skipped.skipped.tolist() == [1, 3] and skipped.bodies.tolist() == [[0, 4]]
    assert pickle.loads(pickle.dumps(skipped)).skipped.tolist() == [1, 3]
    assert detector.overlaps(UNIT, UNIT, open="skip").skipped.tolist() == []
    soup = crumple.Mesh(CORNERS[FACES].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    with pytest.raises(crumple.InvalidInput, match="crumple.open_edges lists them all, weld=True closes seams"):
        detector.overlaps(UNIT, soup)
    assert detector.overlaps(UNIT, soup, weld=True).relation.tolist() == [OverlapRelation.EQUAL]


def test_a_row_has_regions_with_boxes(detector):
    bridge = box([0, 0, 0], [6, 1, 1])
    legs = crumple.Mesh(
        np.concatenate([box([0.5, 0.25, -2], [1, 0.5, 2.5]).vertices, box([4, 0.25, -2], [1, 0.5, 2.25]).vertices]),
        np.concatenate([FACES, FACES + 8]),
    )
    found = detector.overlaps(bridge, legs, regions=True, curves=True)
    (regions,) = found.regions
    assert found.region_volume[regions].tolist() == [0.25, 0.125] and found.volume.tolist() == [0.375]
    assert found.region_box.tolist() == [[0.5, 0.25, 0, 1.5, 0.75, 0.5], [4, 0.25, 0, 5, 0.75, 0.25]]
    assert found.region_thickness.tolist() == [0.5, 0.25] == found.region_mean_depth.tolist()
    assert found.box.tolist() == [[0.5, 0.25, 0, 5, 0.75, 0.5]] and found.thickness.tolist() == [0.5]
    assert found.curve_regions.tolist() == [0, 1]
    assert not found.region_is_contact.any() and not found.region_is_merged.any()
    assert found.region_pieces.tolist() == [[1, 1], [1, 1]]
    rod = box([1, 0.25, -1], [0.5, 0.5, 3])
    assert detector.overlaps(bridge, rod, regions=True).region_pieces.tolist() == [[2, 1]]


def test_volumes_of_unions_and_differences(detector):
    found = detector.overlaps(UNIT, box([0.5, 0, 0]), unions=True)
    assert found.union_volume.tolist() == [1.5] and found.difference_volume.tolist() == [[0.5, 0.5]]
    assert found.intersection_over_union[0] == pytest.approx(1 / 3, rel=4e-16)
    world = crumple.World([UNIT, box([0.25, 0.25, 0.25], 0.5)])
    assert detector.overlaps(world, unions=True, self_overlaps=True).difference_volume.tolist() == [[0.875, 0]]
    assert detector.overlaps(UNIT, box([0, 1, 0]), unions=True).intersection_over_union.tolist() == [0]


def test_depths_of_vertices_and_of_all_points(detector):
    found = detector.overlaps(UNIT, box([0.25, 0.25, 0.75]), depths=True, depth_tolerance=1e-3)
    deepest = found.deepest[0]
    assert found.depths[deepest] == found.depths.max() == 0.25
    assert sorted(found.depth_vertices.tolist()) == found.depth_vertices.tolist()
    assert found.depth_offsets.tolist() == [0, len(found.depths)] == [0, 2]
    assert found.depth_reached[0] <= 0.25 <= found.depth_bound[0] <= found.depth_reached[0] + 1.1e-3
    bars = detector.overlaps(box([0, -3, 0], [1, 6, 1]), box([-3, 0, 0.5], [6, 1, 1]), depths=True, depth_tolerance=1e-3)
    assert len(bars.depths) == 0 and bars.deepest.tolist() == [-1] and 0.498 < bars.depth_reached[0] <= 0.5


def test_withdrawals_along_directions_and_bounds_on_translations(detector):
    directions = [(0, 0, 2), (0, 0, -1), (1, 0, 0)]
    found = detector.overlaps(UNIT, box([0.25, 0.25, 0.75]), directions=directions, translation=True, solids=True)
    assert found.withdrawals.tolist() == [0.125, 1.75, 0.75]
    assert found.translation_high[0] == pytest.approx(0.25, rel=1e-12) and found.translation_high[0] >= 0.25
    assert found.translation.tolist() == [[0, 0, 0.25]]
    assert 0.05 < found.translation_low[0] <= 0.25
    assert np.isnan(detector.overlaps(UNIT, UNIT, translation=True).translation_low).all()
    world = crumple.World([UNIT, box([0.25, 0.25, 0.75])])
    proved = detector.overlaps(world, translation=True, self_overlaps=True)
    assert proved.translation_low.tolist() == found.translation_low.tolist()
    assert detector.overlaps(UNIT, box([3, 0, 0]), directions=directions).withdrawals.tolist() == []


@pytest.mark.parametrize("backend", ["cpu", "reference"])
@pytest.mark.parametrize("block_rows", [1, 4, 1000])
def test_blocks_follow_each_other_as_in_the_whole_result(backend, block_rows):
    detector = crumple.Detector(backend=backend, threads=1)
    world = crumple.World([crumple.Shape(box([0.375 * b, 0.25 * (b % 2), 0])) for b in range(7)])
    query = crumple.OverlapQuery(curves=True, regions=True, self_overlaps=True)
    whole, blocks = detector.find(world, query), []
    assert detector.stream(world, query, blocks.append, block_rows=block_rows).pairs == len(whole) > 8
    assert [len(block) for block in blocks[:-1]] == [block_rows] * (len(blocks) - 1)
    for name in ("bodies", "volume", "normal", "curve_points", "curve_triangles", "region_volume"):
        joined = np.concatenate([getattr(block, name) for block in blocks])
        assert joined.tobytes() == getattr(whole, name).tobytes(), name
    first = blocks[0]
    assert all(block.curve_offsets[0] == 0 and block.body_volume.tolist() == [1] * 7 for block in blocks)
    assert [len(curves) for curves in first.curves] == [len(curves) for curves in whole.curves[: len(first)]]
    assert repr(first) == f"<crumple.Overlaps: a block of {len(first)} pair{'s' * (len(first) > 1)} of bodies>"
    with pytest.raises(crumple.InvalidInput, match="world_hit is part of a whole result"):
        first.world_hit  # noqa: B018
    with pytest.raises(crumple.InvalidInput, match="output must be body_pairs or pairs: blocks list them"):
        detector.stream(world, crumple.OverlapQuery(output="any"), blocks.append)


def test_first_free_motion_ends_before_later_contacts(detector):
    directions = [(0, 0, 2), (-1, 0, 0)]
    slabs = crumple.Mesh(
        np.concatenate([UNIT.vertices, UNIT.vertices + [0, 0, 4]]),
        np.concatenate([UNIT.faces, UNIT.faces + len(UNIT.vertices)]),
    )
    found = detector.overlaps(slabs, box([0.25, 0.25, 0.75]), directions=directions, first_free=True)
    assert found.first_free.tolist() == [0.125, 1.25]
    assert found.withdrawals.tolist() == [2.125, 1.25]
    with pytest.raises(crumple.InvalidInput, match=r"OverlapQuery\(first_free=True, directions=\[\(0, 0, 1\)\]\)"):
        _ = detector.overlaps(UNIT, UNIT, directions=directions).first_free


def test_error_explains_how_to_request_a_missing_array(detector):
    found = detector.overlaps(UNIT, UNIT, output="body_pairs")
    with pytest.raises(crumple.InvalidInput, match=r'volume was not requested: OverlapQuery\(output="pairs"\)'):
        _ = found.volume
    for name, option in (
        ("gradient", "gradient"),
        ("windings", "windings"),
        ("curve_points", "curves"),
        ("is_solid", "self_overlaps"),
        ("depths", "depths"),
        ("box", "extents"),
        ("region_volume", "regions"),
        ("translation_low", "translation"),
    ):
        with pytest.raises(crumple.InvalidInput, match=rf"{name} was not requested: OverlapQuery\({option}=True\)"):
            getattr(detector.overlaps(UNIT, UNIT), name)


@pytest.mark.parametrize(
    "options, message",
    [
        ({"min_volume": -1.0}, "min_volume must be finite and 0 or more"),
        ({"min_volume": float("nan")}, "min_volume must be finite and 0 or more"),
        ({"output": "count"}, "output must be one of"),
        ({"open": "close"}, 'open must be one of "error", "skip", "curves", not "close"'),
        ({"filter": crumple.PairFilter(bodies="within")}, "bodies must not be within"),
        ({"depth_tolerance": -0.1}, "depth_tolerance must be finite and 0 or more"),
        ({"directions": [(0, 0, 0)]}, "a direction must not be 0"),
        ({"directions": [(0, 0, float("inf"))]}, "directions must be finite"),
        ({"directions": [(0, 0)]}, "directions must have three coordinates each"),
        ({"directions": (0, 0, 1)}, "directions must be a sequence of directions"),
        ({"first_free": True}, "first_free needs directions"),
    ],
)
def test_invalid_options_are_refused(detector, options, message):
    with pytest.raises(crumple.InvalidInput, match=message):
        detector.overlaps(UNIT, UNIT, **options)


def test_results_can_be_copied_and_pickled(detector):
    found = detector.overlaps(
        crumple.World([UNIT, box([0.5, 0.2, 0.3])]),
        **dict.fromkeys(("self_overlaps", "gradient", "windings", "curves", "regions", "depths", "translation"), True),
        unions=True,
        depth_tolerance=0.01,
        directions=[(1, 0, 0)],
        first_free=True,
    )
    for same in (pickle.loads(pickle.dumps(found)), copy.copy(found), copy.deepcopy(found)):
        for name in (
            "bodies",
            "relation",
            "volume",
            "torque",
            "gradient",
            "gradient_vertices",
            "gradient_offsets",
            "windings",
            "winding_vertices",
            "is_solid",
            "body_volume",
            "contact_area",
            "area_vector",
            "normal",
            "mean_depth",
            "curve_points",
            "curve_offsets",
            "curve_triangles",
            "curve_closed",
            "curve_area_vector",
            "curve_regions",
            "region_offsets",
            "region_box",
            "thickness",
            "depths",
            "deepest",
            "depth_bound",
            "withdrawals",
            "first_free",
            "translation_low",
        ):
            np.testing.assert_array_equal(getattr(same, name), getattr(found, name), name)
    assert repr(found) == repr(copy.copy(found)) and "1 pair of bodies" in repr(found)


def area_of(mesh):
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


@pytest.mark.parametrize("name", ["a.html", "a.glb", "a.3mf", "a.obj", "a.ply"])
def test_ply_picture_has_the_overlap_and_other_pictures_both_bodies(detector, tmp_path, name):
    other = box([0.5, 0.25, 0.125])  # the overlap is a box of 1/2 x 3/4 x 7/8
    detector.overlaps(UNIT, other).save(tmp_path / name, UNIT, other)
    world = crumple.World([UNIT], [0, 0], poses=np.array([np.eye(4), np.eye(4)]), names=["a", "b"])
    world.poses[1, :3, 3] = [0.5, 0.25, 0.125]
    found = detector.overlaps(world, output="body_pairs")
    found.save(tmp_path / f"world_{name}", world)
    if name == "a.html":
        assert b"1 overlap of 2 bodies" in (tmp_path / name).read_bytes()
        return
    surface = 2 * (0.5 * 0.75 + 0.5 * 0.875 + 0.75 * 0.875)
    for file in (tmp_path / name, tmp_path / f"world_{name}"):
        assert area_of(crumple.read_mesh(file)) == pytest.approx(surface if name == "a.ply" else 12)
    if name in ("a.glb", "a.3mf"):
        assert list(crumple.read_world(tmp_path / f"world_{name}").names) == ["a", "b"]


def test_picture_of_one_mesh_shows_its_overlap_with_itself(detector, tmp_path):
    other = box([0.5, 0.25, 0.125])
    both = np.concatenate([UNIT.vertices, other.vertices]), np.concatenate([FACES, FACES + 8])
    detector.overlaps(*both).save(tmp_path / "a.ply", both)
    assert area_of(crumple.read_mesh(tmp_path / "a.ply")) == pytest.approx(2.9375)


def test_a_picture_of_open_surfaces_shows_their_curves(detector, tmp_path):
    scene = UNIT, crumple.Mesh(box([0.5, 0.25, 0.125]).vertices, FACES[:-2])
    detector.overlaps(*scene, open="curves").save(tmp_path / "a.html", *scene)
    page = (tmp_path / "a.html").read_text()
    assert "crossing of surfaces" in page and '"opaque": 0,' in page


def test_picture_with_wrong_suffix_scene_or_output_is_refused(detector, tmp_path):
    found = detector.overlaps(UNIT, box([0.5, 0, 0]))
    with pytest.raises(crumple.InvalidInput, match="saved as .html, .glb, .3mf, .obj or .ply"):
        found.save(tmp_path / "a.csv", UNIT, box([0.5, 0, 0]))
    with pytest.raises(crumple.InvalidInput, match="not those of this world"):
        found.save(tmp_path / "a.glb", UNIT)
    with pytest.raises(crumple.InvalidInput, match='output="body_pairs"'):
        detector.overlaps(UNIT, box([0.5, 0, 0]), output="any").save(tmp_path / "a.glb", UNIT, UNIT)
    several = crumple.World([UNIT], [0, 0], worlds=[0, 1])
    with pytest.raises(crumple.InvalidInput, match="shows one configuration"):
        detector.overlaps(several).save(tmp_path / "a.glb", several)
    assert not list(tmp_path.iterdir())


def test_open_edges_are_those_of_missing_or_flipped_triangles():
    edges, triangles = crumple.open_edges(CORNERS, FACES)
    assert edges.shape == (0, 2) and triangles.shape == (0,)
    edges, triangles = crumple.open_edges(CORNERS, FACES[:-1])
    assert edges.dtype == np.int32 and edges.tolist() == [[3, 5], [3, 7], [5, 7]] and triangles.tolist() == [10, 7, 3]
    flipped = np.concatenate([FACES[:-1], FACES[-1:, ::-1]])
    assert crumple.open_edges((CORNERS, flipped))[0].tolist() == edges.tolist()
    soup = CORNERS[FACES].reshape(-1, 3), np.arange(36)
    assert len(crumple.open_edges(*soup)[0]) == 36 and len(crumple.open_edges(*soup, weld=True)[0]) == 0
    with pytest.raises(crumple.InvalidInput):
        crumple.open_edges(CORNERS, [[0, 1, 8]])
    with pytest.raises(crumple.InvalidType, match="weld"):
        crumple.open_edges(CORNERS, FACES, weld="yes")
