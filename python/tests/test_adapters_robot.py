"""Robots: poses are products of matrices, results are those of each configuration, and no hit of a motion is missed."""

import itertools

import numpy as np
import pytest

import crumple
from crumple.adapters._kinematics import Joint, Tree
from crumple.adapters._obstacles import Obstacles
from crumple.adapters._primitives import box, capsule, cylinder, ellipsoid, sphere
from crumple.adapters._robot import Robot


def rotation(axis, angle):
    """Returns a rotation about an axis, (4, 4), by the formula of Rodrigues."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    made = np.eye(4)
    made[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return made


def at(*place):
    made = np.eye(4)
    made[:3, 3] = place
    return made


def naive_pose(joints, values, link):
    """Returns the pose of a link, joint by joint. `values` has the value of each joint that moves."""
    made = np.eye(4)
    while above := next((joint for joint in joints if joint.child == link), None):
        motion = np.eye(4)
        if above.kind == "revolute":
            motion = rotation(above.axis, values[above.name])
        elif above.kind == "prismatic":
            motion = at(*np.asarray(above.axis) / np.linalg.norm(above.axis) * values[above.name])
        made, link = above.origin @ motion @ made, above.parent
    return made


def mixed_joints():
    """Returns joints of all kinds with axes in all directions, children before parents, and one that mimics another."""
    random = np.random.default_rng(3)
    axes = [(0, 0, 1), (0, 0, -2), (1, 0, 0), (0, -1, 0), (1, 2, -3)]
    kinds = ["revolute", "fixed", "prismatic", "revolute", "revolute", "prismatic", "revolute"]
    joints = []
    for i, kind in enumerate(kinds):
        origin = rotation(random.normal(size=3), random.uniform(-3, 3))
        origin[:3, 3] = random.normal(size=3)
        parent = f"link {i}" if i != 5 else "link 2"  # a branch
        joints.append(Joint(f"joint {i}", parent, f"link {i + 1}", kind, origin, axes[i % 5]))
    joints[6] = joints[6]._replace(follows="joint 3", multiplier=-0.5, offset=0.25)
    return joints[::-1]


def test_poses_are_products_of_the_matrices_of_the_joints():
    joints = mixed_joints()
    tree = Tree(joints)
    assert tree.variables == ["joint 5", "joint 4", "joint 3", "joint 2", "joint 0"]
    configurations = np.random.default_rng(4).uniform(-3, 3, (20, 5))
    links = [f"link {i}" for i in (0, 3, 7, 1, 6, 2, 4, 5)]
    poses = tree.poses(configurations, links)
    for row, got in zip(configurations, poses):
        values = dict(zip(tree.variables, row))
        values["joint 6"] = -0.5 * values["joint 3"] + 0.25
        for link, pose in zip(links, got):
            np.testing.assert_allclose(pose, naive_pose(joints, values, link)[:3], atol=1e-13)


def test_poses_about_coordinate_axes_are_exact_at_zero():
    joints = [Joint("a", "0", "1", "revolute", at(1, 2, 3), (0, -1, 0)), Joint("b", "1", "2", "prismatic", at(0, 0, 5))]
    (pose,) = Tree(joints).poses(np.array([[0.0, 0.5]]), ["2"])[0]
    np.testing.assert_array_equal(pose, at(1.5, 2, 8)[:3])


def test_points_deviate_from_chords_by_no_more_than_the_bound():
    tree, random = Tree(mixed_joints()), np.random.default_rng(5)
    starts, links = random.uniform(-3, 3, (300, 5)), [f"link {i}" for i in range(8)]
    ends = starts + random.uniform(-1, 1, starts.shape) * 10 ** random.uniform(-2, 0, (300, 1))
    radius = 0.3
    bounds = tree.bends(starts, ends, links, [radius] * 8) / 8
    directions = random.normal(size=(300, 8, 3))
    points = radius * directions / np.linalg.norm(directions, axis=2, keepdims=True)

    def placed(t):
        poses = tree.poses(starts + t * (ends - starts), links)
        return np.einsum("nlij,nlj->nli", poses[..., :3], points) + poses[..., 3]

    worst = np.zeros((300, 8))
    for t in np.linspace(0, 1, 33):
        worst = np.maximum(worst, np.linalg.norm(placed(t) - (1 - t) * placed(0) - t * placed(1), axis=2))
    assert (worst <= bounds + 1e-13).all()
    assert (bounds[:, 0] == 0).all() and (worst[:, 7] > bounds[:, 7] / 20).mean() > 0.5


@pytest.mark.parametrize("max_error", [0.1, 0.001])
def test_meshes_of_primitives_contain_them_within_the_error(max_error):
    def beyond(points, radius, half):  # distance from a capsule's segment, minus its radius
        return np.linalg.norm(points - np.clip(points, [0, 0, -half], [0, 0, half]), axis=1) - radius

    for mesh, radius, half in (
        (sphere(0.7, max_error=max_error), 0.7, 0.0),
        (capsule(0.2, 0.5, max_error=max_error), 0.2, 0.25),
    ):
        assert 0 < mesh.tessellation_error <= max_error
        assert beyond(mesh.vertices, radius, half).max() <= mesh.tessellation_error + 1e-15
        assert_contains(mesh, [0, 0, half], radius)
        assert_contains(mesh, [0, 0, -half], radius)
    mesh = cylinder(0.3, 2.0, max_error=max_error)
    across = np.linalg.norm(mesh.vertices[:-2, :2], axis=1)
    assert 0 < mesh.tessellation_error <= max_error and across.max() - 0.3 <= mesh.tessellation_error + 1e-15
    assert set(mesh.vertices[:, 2]) == {-1.0, 1.0} and is_solid(mesh)
    sides = mesh.vertices[mesh.faces].mean(axis=1)
    sides = sides[np.abs(sides[:, 2]) < 1]
    assert len(sides) and np.linalg.norm(sides[:, :2], axis=1).min() > 0.3
    mesh = ellipsoid([0.5, 1, 2], max_error=max_error)
    assert_contains(crumple.Mesh(mesh.vertices / [0.5, 1, 2], mesh.faces), [0, 0, 0], 1.0)
    assert 0 < mesh.tessellation_error <= max_error
    assert is_solid(box([1, 2, 3])) and box([1, 2, 3]).tessellation_error == 0


def is_solid(mesh):
    found = crumple.Detector(threads=1).overlaps((mesh.vertices, mesh.faces))
    return bool(found.is_solid[0]) and found.body_volume[0] > 0


def assert_contains(mesh, centre, radius):
    """Checks that a closed mesh contains a ball: all planes of its faces are at least as far from the centre."""
    assert is_solid(mesh)
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces] - centre, 1, 0)
    normal = np.cross(b - a, c - a)
    assert (np.einsum("ij,ij->i", normal, a) / np.linalg.norm(normal, axis=1)).min() >= radius


def test_invalid_primitives_are_refused():
    with pytest.raises(crumple.InvalidInput, match="size must be finite and above 0"):
        box([1, 0, 1])
    with pytest.raises(crumple.InvalidInput, match="needs more than 2048 sides"):
        cylinder(1e6, 1, max_error=1e-3)
    with pytest.raises(crumple.InvalidInput, match="error must be above 0"):
        sphere(1, max_error=0)


LINKS = ("base", "upper", "fore", "hand")
SIZES = {"base": (0.4, 0.4, 0.3), "upper": (0.1, 0.12, 1), "fore": (0.08, 0.1, 0.8), "hand": (0.2, 0.05, 0.3)}


def moved(mesh, pose):
    return crumple.Mesh(mesh.vertices @ pose[:3, :3].T + pose[:3, 3], mesh.faces)


def arm(**options):
    """Returns a robot of four links that turns about z, y and y, and whose hand slides."""
    joints = [
        Joint("waist", "base", "turret", "revolute", at(0, 0, 0.2), (0, 0, 1)),
        Joint("shoulder", "turret", "upper", "revolute", at(0, 0, 0.1), (0, 1, 0)),
        Joint("elbow", "upper", "fore", "revolute", at(0, 0, 1), (0, 1, 0)),
        Joint("slide", "fore", "hand", "prismatic", at(0, 0, 0.8), (0, 0, 1)),
    ]
    meshes = {name: moved(box(size), at(0, 0, size[2] / 2 - 0.05)) for name, size in SIZES.items()}
    return Robot(joints, meshes, limits={"slide": (0, 0.2)}, threads=2, **options)


def limited(**limits):
    return Robot([Joint("slide", "a", "b", "prismatic", at(0, 0, 1))], {"b": box([1, 1, 1])}, limits=limits)


def room():
    pole = (cylinder(0.01, 3, max_error=1e-4), at(0.9, 0.9, 0.5))
    return {
        "pole": pole,
        "shelf": (box([0.5, 2, 0.04]), at(1.2, 0, 0.9)),
        "crate": (box([3, 3, 3]), at(-2.2, 0, 0)[:3]),
    }


def random_configurations(count, seed=1):
    return np.random.default_rng(seed).uniform([-3, -1.8, -2.5, 0], [3, 1.8, 2.5, 0.2], (count, 4))


def placed(robot, configuration):
    """Returns the mesh of each link in a configuration, posed in float64."""
    return {link: moved(robot.shapes[link].mesh, pose) for link, pose in zip(robot.links, robot.poses(configuration))}


def pairs_of(robot, configuration, obstacles):
    """Yields pairs of names that are tested, and their two meshes."""
    bodies, links = placed(robot, configuration), set(robot.links)
    bodies.update((name, moved(mesh, pose)) for name, (mesh, pose) in obstacles.items())
    for a, b in itertools.combinations(bodies, 2):
        if frozenset((a, b)) not in robot.allowed and not {a, b}.isdisjoint(links):
            yield (a, b), bodies[a], bodies[b]


def test_results_of_many_configurations_are_those_of_each_one():
    robot, configurations, obstacles = arm(), random_configurations(60), room()
    assert robot.links == LINKS and robot.variables == ("waist", "shoulder", "elbow", "slide")
    assert robot.limits.tolist() == [[-np.inf] * 3 + [0.0], [np.inf] * 3 + [0.2]]
    hits = robot.collides(configurations, obstacles)
    fixed = Obstacles(obstacles)
    np.testing.assert_array_equal(robot.collides(configurations, fixed), hits)
    found = robot.colliding_links(configurations, fixed)
    clearances = robot.clearances(configurations, fixed)
    assert 10 < hits.sum() < 50
    detector = crumple.Detector(threads=1)
    for i, configuration in enumerate(configurations):
        expected, least = [], np.inf
        for names, a, b in pairs_of(robot, configuration, obstacles):
            if detector.intersections(a, b, output="body_pairs", containment=True).any:
                expected.append(names)
                least = 0
            least = min(least, detector.distances(a, b).distance[0])
        assert found.of(i) == expected and hits[i] == bool(expected)
        np.testing.assert_allclose(clearances[i], least, atol=1e-12)
    near = robot.clearances(configurations, fixed, radius=0.05)
    np.testing.assert_array_equal(near, np.where(clearances <= 0.05, clearances, np.inf))


def test_world_of_configurations_is_for_any_query():
    robot, configurations, obstacles = arm(), random_configurations(40), Obstacles(room())
    world, allowed = robot.world(configurations, obstacles)
    assert len(world) == 40 * 4 + 3 and list(robot.shapes) == list(LINKS)
    found = robot.detector.overlaps(world, output="any_by_world", filter=allowed)
    np.testing.assert_array_equal(found.world_hit, robot.collides(configurations, obstacles))


def test_configurations_of_any_shape_are_accepted():
    robot, configurations = arm(), random_configurations(12)
    flat = robot.collides(configurations)
    np.testing.assert_array_equal(robot.collides(configurations.reshape(3, 4, 4)), flat.reshape(3, 4))
    assert robot.collides(configurations[0]).shape == () and robot.collides(configurations[:0]).shape == (0,)
    assert robot.poses(configurations.reshape(3, 4, 4)).shape == (3, 4, 4, 4, 4)
    assert robot.clearances(configurations[:0]).shape == (0,)
    assert robot.collides_between(configurations[:0], configurations[:0]).shape == (0,)
    assert robot.colliding_links(configurations[:0]).of(0) == []


def test_bodies_inside_others_collide_unless_only_surfaces_count():
    inside = {"vault": (box([20, 20, 20]), at(0, 0, 0))}
    open_top = {"vault": (crumple.Mesh(*box([20, 20, 20])[:2])._with(faces=box([1, 1, 1]).faces[:-1]), at(0, 0, 0))}
    straight = np.zeros(4)
    assert arm().collides(straight, inside) and arm().clearances(straight, inside) == 0
    assert not arm(solid=False).collides(straight, inside)
    assert arm(solid=False).clearances(straight, inside) > 0.5
    assert not arm().collides(straight, open_top), "an open surface has no inside"


def test_attached_object_moves_with_its_link_and_collides():
    robot, tool = arm(), box([0.05, 0.05, 0.6])
    held = robot.attach("tool", tool, "hand", at(0, 0, 0.5), touching=["fore"])
    assert held.links == (*LINKS, "tool") and robot.links == LINKS
    assert frozenset(("tool", "hand")) in held.allowed and frozenset(("tool", "fore")) in held.allowed
    configurations = random_configurations(200)
    hand, own = held.poses(configurations)[:, 3], held.poses(configurations)[:, 4]
    np.testing.assert_allclose(own, hand @ at(0, 0, 0.5), atol=1e-14)
    more = held.collides(configurations, room()) & ~robot.collides(configurations, room())
    assert more.any()
    found = held.colliding_links(configurations, room())
    assert all("tool" in pair for i in np.flatnonzero(more) for pair in found.of(i))
    on_turret = robot.attach("lamp", tool, "turret", at(0, 0, 0.1))  # a link without a mesh: adjacent to the base
    assert frozenset(("lamp", "base")) in on_turret.allowed
    assert on_turret.variables == robot.variables


def test_allowed_pairs_of_links_and_obstacles_do_not_collide():
    robot, configurations = arm(), random_configurations(100)
    obstacles = Obstacles(room(), allowed=[("fore", "crate"), ("hand", "crate")])
    every = robot.colliding_links(configurations, room())
    fewer = robot.colliding_links(configurations, obstacles)
    left_out = {("fore", "crate"), ("hand", "crate")}
    for i in range(100):
        assert fewer.of(i) == [pair for pair in every.of(i) if pair not in left_out]
    assert any(left_out & set(every.of(i)) for i in range(100))


def test_motion_through_a_thin_pole_is_found_though_both_ends_are_free():
    robot = arm()
    starts, ends = np.array([[0.2, 1.5, 0.0, 0.0]]), np.array([[1.3, 1.5, 0.0, 0.0]])
    pole = {"pole": (cylinder(0.004, 3, max_error=1e-4), at(0.9, 0.9, 0.5))}
    assert not robot.collides(starts, pole) and not robot.collides(ends, pole)
    assert robot.collides_between(starts, ends, pole)
    assert not robot.collides_between(starts, ends)


def test_margin_for_rounding_covers_the_farther_end_of_a_motion(monkeypatch):
    robot, margins = limited(slide=(0, 1e6)), []
    detector = robot.detector

    def find(world, query):
        if isinstance(query, crumple.ImpactQuery):
            margins.append(query.min_distance - 0.002)  # the coarse distance: four times half the tolerance
        return detector.find(world, query)

    monkeypatch.setattr(robot, "detector", type("Spy", (), {"find": staticmethod(find)}))
    obstacle = {"far": (box([1, 1, 1]), at(9, 9, 9))}
    for starts, ends in (([[0.0]], [[1e6]]), ([[1e6]], [[0.0]])):
        assert not robot.collides_between(starts, ends, obstacle, tolerance=1e-3)
    assert len(margins) == 2 and min(margins) > 2.0**-40 * 1e6


@pytest.mark.parametrize("tolerance", [0.05, 0.002])
def test_no_collision_of_a_motion_is_missed_and_reported_ones_are_near(tolerance):
    robot, obstacles = arm(), Obstacles(room())
    starts, random = random_configurations(150, 7), np.random.default_rng(8)
    ends = starts + random.uniform(-1, 1, starts.shape) * [1.5, 1, 1, 0.1]
    hits = robot.collides_between(starts, ends, obstacles, tolerance=tolerance)
    times = np.linspace(0, 1, 201)[:, None, None]
    path = starts + times * (ends - starts)
    clearance = robot.clearances(path, obstacles, radius=4 * tolerance).min(axis=0)
    free_at_ends = ~robot.collides(starts, obstacles) & ~robot.collides(ends, obstacles)
    assert not (clearance[~hits] == 0).any()
    # A sample is at most 1/400 of the motion away from the time of the least distance, which is then a little less.
    assert (clearance[hits] < tolerance + 0.02).all()
    assert (hits & free_at_ends).sum() > 5 and (~hits).sum() > 20


def test_error_names_what_is_wrong():
    robot, one = arm(), np.zeros((1, 4))
    for call, message in (
        (
            lambda: robot.collides(np.zeros((2, 3))),
            r"configurations must have shape \(..., 4\), one value for each of waist",
        ),
        (lambda: robot.collides([[0, 0, np.nan, 0]]), "configuration 0 has a value that is not finite"),
        (lambda: robot.collides(one, [1]), "obstacles must be Obstacles or a mapping, not list"),
        (lambda: robot.collides(one, {"a": (box([1, 1, 1]), np.eye(3))}), r"obstacle 'a': its pose must have shape"),
        (
            lambda: robot.collides(one, {"a": (box([1, 1, 1]), np.nan * np.eye(4))}),
            "obstacle 'a': its pose must be finite",
        ),
        (lambda: robot.collides(one, {"fore": box([1, 1, 1])}), "obstacle 'fore' has the name of a link; rename it"),
        (
            lambda: robot.collides(one, Obstacles({"a": box([1, 1, 1])}, [("hnad", "a")])),
            "called 'hnad'. Did you mean 'hand'",
        ),
        (
            lambda: robot.collides(one, Obstacles({"a": box([1, 1, 1])}, [("fore", "b")])),
            r"allowed pair \('b', 'fore'\): no link or obstacle is called 'b'",
        ),
        (lambda: arm(allowed=[("fore", "turret")]), "no link with a mesh is called 'turret'"),
        (lambda: robot.collides_between(one, np.zeros((2, 4))), "starts and ends must have the same shape"),
        (lambda: robot.collides_between(one, one, tolerance=0), "tolerance must be finite and above 0"),
        (lambda: robot.attach("hand", box([1, 1, 1]), "fore"), "'hand' is already the name of a link"),
        (lambda: robot.attach("tool", box([1, 1, 1]), "hnad"), "no link 'hnad'"),
        (lambda: robot.attach("tool", box([1, 1, 1]), "hand", 2 * np.eye(4)), "'tool': its pose is not a rotation"),
        (
            lambda: robot.attach("tool", box([1, 1, 1]), "hand", np.diag([1, 1, -1, 1])),
            "'tool': its pose is not a rotation",
        ),
        (lambda: robot.attach("tool", box([1, 1, 1]), "hand", touching=["fire"]), "is called 'fire'"),
        (lambda: limited(slied=(0, 1)), "limits: no joint is called 'slied'. Did you mean 'slide'"),
        (lambda: limited(slide=(0, np.nan)), "limits of joint 'slide' must be its lowest and its highest value"),
        (lambda: arm(allowed=[("hand", "hand")]), "must have two different names"),
        (
            lambda: Tree([Joint("a", "0", "1", "fixed", np.eye(4)), Joint("b", "2", "1", "fixed", np.eye(4))]),
            "several joints",
        ),
        (
            lambda: Tree([Joint("a", "0", "1", "fixed", np.eye(4)), Joint("b", "2", "3", "fixed", np.eye(4))]),
            "links 0, 2 have no parent; connect them by joints",
        ),
        (
            lambda: Tree([Joint("a", "0", "1", "fixed", np.eye(4)), Joint("b", "1", "0", "fixed", np.eye(4))]),
            "the joints form a cycle",
        ),
        (
            lambda: Tree([Joint("a", "0", "1", "fixed", np.eye(4)), Joint("b", "1", "0", "fixed", np.eye(4))], "0"),
            "link '0' cannot be the base, because it is the child of a joint",
        ),
        (lambda: Tree([]), "there are no joints; pass base="),
        (
            lambda: Tree([Joint("a", "0", "1", "fixed", np.eye(4)), Joint("a", "1", "2", "fixed", np.eye(4))]),
            "several joints are called 'a'",
        ),
        (
            lambda: Tree([Joint("x", "0", "1", "continuous", np.eye(4))]),
            r"joint 'x': kind must be fixed, revolute \(also for continuous joints\) or prismatic, not 'continuous'",
        ),
        (
            lambda: Tree([Joint("x", "0", "1", "fixed", np.eye(3))]),
            r"joint 'x': its origin must have shape \(3, 4\) or",
        ),
        (lambda: Tree([Joint("x", "0", "1", "fixed", 2 * np.eye(4))]), "joint 'x': its origin is not a rotation with"),
        (lambda: Tree([Joint("a", "0", "1", "revolute", np.eye(4), (0, 0, 0))]), "its axis must be finite and not 0"),
        (lambda: Tree([Joint("a", "0", "1", "revolute", np.eye(4), follows="a")]), "mimics 'a'"),
    ):
        with pytest.raises(crumple.InvalidInput, match=message):
            call()
