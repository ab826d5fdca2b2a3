"""Tests of input of worlds: errors that name argument and body, names, excluded pairs, and shapes cached by name."""

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup

MESH = soup(20, size=0.5)
THREE = {"names": ["arm", "hand", "table"], "self_collisions": False}


def three(**others):
    return crumple.World([MESH], [0, 0, 0], **{**THREE, **others})


def poses(count=3):
    return np.tile(np.eye(3, 4), (count, 1, 1))


def with_entry(array, place, value):
    array = np.array(array)
    array[place] = value
    return array


NAN_IN_1, FAR_AWAY = with_entry(poses(), (1, 2, 0), np.nan), with_entry(poses(), (0, 0, 3), 1e39)
SQUARE = np.tile(np.eye(4), (3, 1, 1))
MASKED = np.ma.masked_array(poses(), mask=with_entry(np.zeros((3, 3, 4), bool), (1, 0, 2), True))


@pytest.mark.parametrize(
    "arguments, message",
    [
        ({"shapes": MESH}, "shapes must be a sequence of crumple.Shape or of meshes, not Mesh"),
        ({"shapes": 5}, "shapes must be a sequence of crumple.Shape or of meshes, not int"),
        ({"shapes": [MESH, 5]}, "shape 1: a mesh must be crumple.Mesh, a tuple"),
        ({"shapes": [(MESH.vertices, MESH.faces[:, :2])]}, r"shape 0: faces must have shape \(n, 3\)"),
        ({"shapes": [MESH, MESH._replace(groups=[1, 2])]}, "shape 1: groups must be one for each of the 20 faces"),
        ({"shapes": [(OnDevice(MESH.vertices), OnDevice(MESH.faces))]}, "shape 0: vertices lie in CUDA memory"),
        ({"bodies": [0.5]}, "bodies must be integers, not float64"),
        ({"bodies": [0, 2**40]}, "bodies: 1099511627776 of body 1 does not fit int32"),
        ({"bodies": [[0]]}, r"bodies must have shape \(bodies,\), not \(1, 1\)"),
        ({"bodies": [0, None]}, "bodies must be an array of numbers"),
        ({"groups": [0, 1]}, "groups must be one for each of the 3 bodies, not 2"),
        ({"groups": [0, 1, 1.5]}, "groups must be integers, not float64"),
        ({"worlds": np.ma.masked_array([0, 0, 0], mask=[0, 1, 0])}, r"worlds are masked at \(1,\)"),
        ({"worlds": "abc"}, "worlds must be integers"),
        ({"self_collisions": [1, 0, 1]}, r"self_collisions must be True or False, or \(bodies,\) of bool, not int64"),
        ({"self_collisions": [True]}, "self_collisions must be one for each of the 3 bodies, not 1"),
        ({"names": "abc"}, "names must be a sequence of str, not str"),
        ({"names": ["a", "b"]}, "names must be one for each of the 3 bodies, not 2"),
        ({"names": ["a", 5, "c"]}, "names must be str, but that of body 1 is int"),
        ({"names": ["a", "b", "a"]}, "names: bodies 0 and 2 are both called 'a'"),
        ({"poses": poses(2)}, r"poses must have shape \(3, 3, 4\) or \(3, 4, 4\), one for each body, not \(2, 3, 4\)"),
        ({"poses": np.eye(4)}, r"poses must have shape \(bodies, 3, 4\) or \(bodies, 4, 4\), not \(4, 4\)"),
        ({"poses": poses()[:, :, :3]}, r"poses must have shape .*not \(3, 3, 3\)"),
        ({"poses": poses().astype(complex)}, "poses must be float64 or float32, not complex128"),
        ({"poses": MASKED}, r"poses are masked at \(1, 0, 2\)"),
        ({"poses": "none"}, "poses must"),
        ({"poses": OnDevice(poses()[:, ::-1])}, r"poses in CUDA memory must be \(n, 3, 4\)"),
        ({"end_poses": OnDevice(poses()[:, ::-1])}, r"end_poses in CUDA memory must be \(n, 3, 4\)"),
        ({"groups": [1], "bodies": [crumple.Body(0)]}, "poses, groups, .* must be given in each crumple.Body"),
    ],
)
def test_invalid_arguments_of_a_world_are_refused(arguments, message):
    given = {"shapes": [MESH], "bodies": [0, 0, 0], **arguments}
    if isinstance(given["bodies"], list) and len(given["bodies"]) != 3:
        given.setdefault("names", None)
    with pytest.raises(crumple.InvalidInput, match=message):
        crumple.World(given.pop("shapes"), given.pop("bodies"), **given)


@pytest.mark.parametrize(
    "body, message",
    [
        (crumple.Body(MESH), "body 0: its shape must be an index, or one of the world's crumple.Shape, not Mesh"),
        (crumple.Body(crumple.Shape(MESH)), "body 0: its shape must be an index, .*, not another Shape"),
        (crumple.Body(0, np.eye(3)), r"body 0: its pose must have shape \(3, 4\) or \(4, 4\), .*not \(3, 3\)"),
        (
            crumple.Body(0, np.ones((4, 4))),
            r"body 0: the last row of its pose must be 0 0 0 1, not 1\.0 1\.0 1\.0 1\.0",
        ),
        (crumple.Body(0, "here"), "body 0: its pose"),
        (
            crumple.Body(0, np.eye(4, dtype=np.float16)),
            "body 0: its pose must have .*, of float64, float32 or integers, not float16",
        ),
        (crumple.Body(0, group="a"), "groups must be integers"),
        (crumple.Body(0, name=b"a"), "names must be str, but that of body 0 is bytes"),
    ],
)
def test_invalid_body_is_refused(body, message):
    with pytest.raises(crumple.InvalidInput, match=message):
        crumple.World([MESH], [body])


@pytest.mark.parametrize(
    "world, message, element, index",
    [
        (
            lambda: three(poses=with_entry(poses(), (1, 2, 0), np.nan)),
            r"body 1 \('hand'\): its pose is not finite",
            "body",
            1,
        ),
        (
            lambda: three(poses=with_entry(SQUARE, (2, 3, 1), 1e-9)),
            r"body 2 \('table'\): the last row of its pose must be 0 0 0 1, not 0\.0 1e-09 0\.0 1\.0",
            "body",
            2,
        ),
        (
            lambda: three(poses=with_entry(poses(), (0, 0, 3), 1e39)),
            r"body 0 \('arm'\): vertex 0 is posed to infinity",
            "vertex",
            0,
        ),
        (lambda: three(worlds=[1, 0, 0]), r"body 1 \('hand'\): its world 0 comes after world 1", "body", 1),
        (
            lambda: three(worlds=[0, -1, 0]),
            r"body 2 \('table'\): bodies that are in all worlds \(-1\) must come last",
            "body",
            2,
        ),
        (lambda: three(worlds=[-2, 0, 0]), r"body 0 \('arm'\): its world is -2", "body", 0),
        (lambda: crumple.World([MESH], [0, 1]), r"body 1: there is no shape 1 \(number of shapes: 1\)", "body", 1),
        (lambda: crumple.World([MESH], [-1]), "body 0: there is no shape -1", "body", 0),
        (
            lambda: crumple.World([MESH, MESH._replace(vertices=with_entry(MESH.vertices, (7, 1), np.inf))]),
            "body 1: vertex 7 is not finite",
            "vertex",
            7,
        ),
        (
            lambda: crumple.World([crumple.Shape(MESH.vertices, MESH.faces + 9, name="wrong faces")]),
            "shape 0: triangle 17 names vertex",
            "triangle",
            17,
        ),
    ],
)
def test_error_of_a_search_names_the_body_or_shape(world, message, element, index, detector):
    with pytest.raises(crumple.InvalidInput, match=message) as caught:
        detector.intersections(world())
    assert (caught.value.element, caught.value.index) == (element, index)
    assert detector.intersections(three()), "the detector stays usable"


def test_error_names_the_wrong_configuration(detector):
    base = three(worlds=[0, 0, -1])
    many = base.configurations(with_entry(poses(10).reshape(5, 2, 3, 4), (3, 1, 0, 0), np.nan))
    with pytest.raises(crumple.InvalidInput, match=r"body 7 \('hand' of configuration 3\): its pose is not finite"):
        detector.intersections(many)


def test_invalid_configurations_are_refused():
    base = three(worlds=[0, 0, -1])
    many = base.configurations(poses(10).reshape(5, 2, 3, 4))
    for wrong, message in [
        (
            poses(10).reshape(2, 5, 3, 4),
            r"poses must have shape \(2, 2, 3, 4\) or \(2, 2, 4, 4\), .* not \(2, 5, 3, 4\)",
        ),
        (poses(10), r"poses of configurations must have shape \(configurations, 2, 3, 4\)"),
        (None, "poses of configurations must have shape|poses must be"),
    ]:
        with pytest.raises(crumple.InvalidInput, match=message):
            base.configurations(wrong)
    with pytest.raises(crumple.InvalidInput, match=r"poses must have shape \(5, 2, 3, 4\)"):
        many.poses = poses(8).reshape(4, 2, 3, 4)
    with pytest.raises(crumple.InvalidInput, match="does not consist of configurations itself"):
        many.configurations(poses(10).reshape(5, 2, 3, 4))
    with pytest.raises(crumple.InvalidInput, match="body 2: its world is 1; configurations need bodies"):
        three(worlds=[0, 0, 1]).configurations(poses(10).reshape(5, 2, 3, 4))
    with pytest.raises(crumple.InvalidInput, match="come last"):
        three(worlds=[0, -1, 0]).configurations(poses(10).reshape(5, 2, 3, 4))


@pytest.mark.parametrize(
    "excluded, message",
    [
        ([{"arm", "hnad"}], "excluded: there is no body 'hnad'; did you mean 'hand'"),
        ([{"arm", ""}], "excluded: there is no body ''"),
        ("arm", "excluded must be pairs of bodies, not str"),
        (["arm"], "excluded must be pairs of bodies, such as {'arm', 'hand'}, but 'arm' is not a pair"),
        ([{"arm", "hand", "table"}], "excluded must be pairs of bodies, such as"),
        ([("arm",)], "excluded must be pairs of bodies, such as"),
        ([(0, 3)], "excluded names body 3 of 3"),
        ([(0, -1)], "excluded names body -1 of 3"),
        ([(0, 2**40)], "excluded names body 1099511627776 of 3"),
        ([(0, 1.0)], "excluded must name bodies by str or int, not float"),
        ([(0, True)], "excluded must name bodies by str or int, not bool"),
        (np.array([[0, 3]]), "excluded names body 3 of 3"),
        (np.array([[0, 3]], np.int32), "excluded names body 3 of 3"),
        (np.array([[0, 1, 2]]), r"excluded must have shape \(k, 2\), not \(1, 3\)"),
        (np.array([[0, 0.5]]), "excluded must be integers, not float64"),
        (np.ma.masked_array([[0, 1]], mask=[[1, 0]]), r"excluded are masked at \(0, 0\)"),
        (7, "excluded must be pairs of bodies, not int"),
    ],
)
def test_invalid_excluded_bodies_are_refused(excluded, message, detector):
    with pytest.raises(crumple.InvalidInput, match=message):
        detector.intersections(three(), filter=crumple.PairFilter(excluded_bodies=excluded))


def test_excluded_bodies_can_be_names_numbers_or_arrays(detector):
    world = three(self_collisions=True)
    every = {(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)}

    def colliding(excluded):
        return set(
            map(
                tuple,
                detector.intersections(
                    world, output="body_pairs", filter=crumple.PairFilter(excluded_bodies=excluded)
                ).bodies.tolist(),
            )
        )

    assert colliding(None) == colliding([]) == colliding(np.empty((0, 2), int)) == every
    less = every - {(0, 1), (2, 2)}
    pairs = np.array([[1, 0], [2, 2]])
    for excluded in (
        [{"arm", "hand"}, {"table"}],
        {frozenset({"hand", "arm"}), ("table", "table")},
        [["arm", 1], [2, "table"]],
        ({"arm", "hand"} if i else (2, 2) for i in range(2)),
        pairs,
        pairs.astype(np.int32),
        pairs.astype(np.uint8),
        np.asfortranarray(pairs.astype(np.int32)),
        list(pairs),
    ):
        assert colliding(excluded) == less
    assert detector.intersections(world, output="body_pairs", filter=crumple.PairFilter(bodies="between")).names == [
        ("arm", "hand"),
        ("arm", "table"),
        ("hand", "table"),
    ]


def test_names_of_excluded_bodies_are_looked_up_in_each_world(detector):
    row = np.array([0, 1])
    by_name, by_row = (crumple.PairFilter(excluded_bodies=[pair]) for pair in (["arm", "hand"], row))
    row[:] = 1
    one, other = three(), three(names=["table", "hand", "arm"])

    def colliding(world, pairs):
        found = detector.intersections(world, output="body_pairs", filter=pairs)
        return set(map(tuple, found.bodies.tolist()))

    for _ in range(2):
        assert colliding(one, by_name) == {(0, 2), (1, 2)} == colliding(one.at(one.poses), by_name)
        assert colliding(other, by_name) == {(0, 1), (0, 2)}
        assert colliding(one, by_row) == colliding(other, by_row) == {(0, 2), (1, 2)}


@pytest.mark.parametrize(
    "arguments, message",
    [
        ({"output": "all"}, 'output must be one of "any", "any_by_world", "body_pairs", "count", "pairs", "contacts"'),
        ({"output": None}, "output must be one of .*, not None"),
        (
            {"filter": crumple.PairFilter(bodies="none")},
            'bodies must be one of "both", "between", "within", not "none"',
        ),
        ({"filter": crumple.PairFilter(groups=1)}, "groups must be one of .*, not int"),
        ({"index": 1}, "index must be True or False, not int"),
        ({"weld": "no"}, "weld must be True or False, not str"),
        ({"copy": 1}, "copy must be True or False, not int"),
        ({"filter": crumple.PairFilter(excluded_groups=[1])}, "excluded_groups"),
    ],
)
def test_invalid_query_is_refused(arguments, message, detector):
    with pytest.raises(crumple.InvalidInput, match=message):
        detector.intersections(three(), **arguments)


def test_replaced_poses_must_be_one_for_each_body():
    with pytest.raises(crumple.InvalidInput, match=r"^poses must have shape \(3, 3, 4\)"):
        three().at(poses(2))
    with pytest.raises(crumple.InvalidInput, match=r"^end_poses must have shape \(3, 3, 4\)"):
        three().at(None, poses(2))


def test_error_suggests_the_correct_name_of_an_option(detector):
    with pytest.raises(TypeError, match=r"Detector.intersections\(\) got an .* 'neighbors'. Did you mean 'neighbours'"):
        detector.intersections(three(), neighbors="skip")
    part = detector.partition(MESH, count=1)[0]
    with pytest.raises(crumple.InvalidInput, match="output must be pairs or contacts for a part"):
        detector.intersections(part, output="any")
    with pytest.raises(crumple.InvalidType, match="a mesh must be .*, not numpy.ndarray"):
        detector.intersections(MESH.vertices)


@pytest.mark.parametrize(
    "name, message",
    [
        ("", "name must not be empty"),
        (0, "name must be a str or from 1 to"),
        (2**63, "name must be a str or from 1 to"),
        (True, "name must be a str, an int or None, not bool"),
        (1.5, "name must be a str, an int or None, not float"),
    ],
)
def test_invalid_name_of_a_shape_is_refused(name, message):
    with pytest.raises(crumple.InvalidInput, match=message):
        crumple.Shape(MESH, name=name)


@pytest.mark.parametrize("name", ["remembered", 17, np.int32(18)])
def test_detector_reads_a_named_shape_only_once(name, detector):
    vertices = MESH.vertices.copy()
    shape = crumple.Shape(vertices, MESH.faces, name=name)
    assert shape.name == name and shape.triangles == 20 and shape.mesh.vertices is vertices
    apart = poses(2)
    apart[1, 0, 3] = 0.1
    how = {"poses": apart, "self_collisions": False}
    expected = detector.intersections(crumple.World([(MESH.vertices.copy(), MESH.faces)], [0, 0], **how)).pairs.tolist()
    world = crumple.World([shape], [0, 0], **how)
    assert detector.intersections(world).pairs.tolist() == expected
    vertices[:] = np.nan  # breaks the contract, to check that the cached copy is used
    assert detector.intersections(world).pairs.tolist() == expected
    again = crumple.World([crumple.Shape(vertices, MESH.faces, name=name)], [0, 0], **how)
    assert detector.intersections(again).pairs.tolist() == expected
    with pytest.raises(crumple.InvalidInput, match="is not finite"):
        crumple.Detector().intersections(world)


@pytest.mark.parametrize("other", [soup(21), soup(20, dtype=np.float64)], ids=["size", "precision"])
def test_different_shape_under_a_cached_name_is_refused(other, detector):
    detector.intersections(crumple.World([crumple.Shape(MESH, name="known")]))
    message = "shape 0: an earlier shape with the name 'known' had 60 float32 vertices and 20 triangles"
    with pytest.raises(crumple.InvalidInput, match=message) as caught:
        detector.intersections(crumple.World([crumple.Shape(other, name="known")]))
    assert (caught.value.element, caught.value.index) == ("shape", 0)


def test_error_of_a_reused_shape_name_quotes_the_name(detector):
    detector.intersections(crumple.World([crumple.Shape(MESH, name="wheel")]))
    with pytest.raises(crumple.InvalidInput, match="an earlier shape with the name 'wheel' had 60 float32 vertices"):
        detector.intersections(crumple.World([crumple.Shape(soup(21), name="wheel")]))


def test_intersections_and_distances_refuse_bodies_without_triangles(detector):
    dust = crumple.Shape(MESH.vertices, points=[0, 1])
    world = crumple.World([MESH, dust], names=["stone", "dust"])
    for ask in (detector.intersections, detector.distances):
        with pytest.raises(crumple.InvalidInput, match=r"body 1 \('dust'\): it has edges or points but no "):
            ask(world)
        assert ask(world, filter=crumple.PairFilter(excluded_bodies=[{"stone", "dust"}])) is not None
    assert len(detector.proximities(world, radius=1))


def test_numbers_and_strings_are_different_names_of_shapes(detector):
    """The name "5" and the name 5 are different names."""
    detector.intersections(crumple.World([crumple.Shape(MESH, name="5")]))
    assert detector.intersections(crumple.World([crumple.Shape(soup(21, size=0.5), name=5)])) is not None


def test_attributes_of_a_world_match_its_arguments():
    world = three(worlds=[0, 0, -1], groups=7)
    assert len(world) == 3 and world.names == ("arm", "hand", "table") and world.index("hand") == 1
    assert world.groups.tolist() == [7, 7, 7] and world.worlds.tolist() == [0, 0, -1]
    assert world.bodies.tolist() == [0, 0, 0] and not world.self_collisions.any() and world.poses is None
    assert world.originals.tolist() == [0, 1, 2] and world.distinct == 3
    assert repr(world) == "<crumple.World: 3 bodies of 1 shapes>"
    with pytest.raises(ValueError, match="read-only"):
        world.bodies[0] = 1
    with pytest.raises(AttributeError):
        world.groups = [1, 2, 3]
    many = world.configurations(poses(8).reshape(4, 2, 3, 4))
    assert len(many) == 9 and many.names == world.names and many.distinct == 3
    assert many.worlds.tolist() == [0, 0, 1, 1, 2, 2, 3, 3, -1] and many.groups.tolist() == [7] * 9
    assert many.originals.tolist() == [0, 1] * 4 + [2] and many.bodies.tolist() == [0] * 9
    assert repr(many) == "<crumple.World: 4 configurations of 2 bodies, 9 in all>"
    assert repr(crumple.Shape(MESH, name="arm")) == "<crumple.Shape 'arm': 20 triangles>"


def test_empty_worlds_have_no_collisions(detector):
    for world in (crumple.World([]), crumple.World([MESH], []), crumple.World([(np.empty((0, 3)), [])])):
        result = detector.intersections(world, output="contacts", index=True)
        assert not result and len(result) == 0 and result.pairs.shape == (0, 2) and not result.hit.any()
        assert not detector.intersections(world, output="any")
    none = three(worlds=[0, 0, -1]).configurations(np.empty((0, 2, 3, 4)))
    assert len(none) == 1 and detector.intersections(none, output="any_by_world").world_hit.tolist() == []


def test_uninitialised_worlds_and_shapes_are_refused(detector):
    for kind in (crumple.World, crumple.Shape):
        raw = kind.__new__(kind)
        with pytest.raises(crumple.InvalidInput, match="__init__ has not been called"):
            detector.intersections(raw) if kind is crumple.World else crumple.World([raw])
    world = three()
    with pytest.raises(crumple.InvalidInput, match="__init__ has been called already"):
        world.__init__([MESH])
    assert len(world) == len(world.names) == len(world.bodies) == 3 and detector.intersections(world)
