"""Times whether configurations of the Panda robot collide (docs/robots.md) against Coal and a model of spheres.

    python robots_python.py [--quick] [--configurations N] [--json OUT]

Needs crumple's Python package with yourdfpy, Coal and PyYAML in one environment, and the folder motionbenchmaker in the folder
that CRUMPLE_DATA names: the robot, and planning problems of MotionBenchMaker (C. Chamzas et al., 2021). Two sets of configurations
are decided, of which each has the obstacles of a problem: random ones, the same in seven problems, one of each family; and those of
the problems: start, goal, and the straight motion between them, which often collides.

Crumple gets arrays of joint values, so its time includes the poses of the links and the search for pairs. Coal is called in two
ways. *Pairs given*: it gets transforms that were made before, and only the pairs whose axis-aligned boxes overlap, found before; it is
called pair by pair until the first hit, and the time of the Python loop is subtracted, measured as that of as many calls for two
triangles that are far apart. So this is less than any program needs with Coal. *Manager*: obstacles are in its dynamic AABB tree,
against which links are tested one by one, and pairs of links are tested by hand; transforms were made before, and the Python loop
counts. So this is more than a C++ program needs. Coal's obstacles are its own boxes and cylinders; crumple's are meshes that contain
them, with a tessellation error of 0.1 mm. Coal's links are trees of triangles (OBBRSS) or convex hulls.

Spheres are those of panda_spherized.urdf, as the planner VAMP uses them, in float64 by NumPy. Their times are those of NumPy, not of
VAMP, which evaluates them by SIMD instructions; its package cannot be built without access to other sites. Their verdicts are compared
with those of crumple for the meshes.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import sys
import tarfile
import time
from pathlib import Path

import numpy as np
import yaml
from timed_rows import Row, judge, show
from worlds_python import coal, request, transforms, tree

import crumple
from crumple.adapters import urdf

DATA = Path(os.environ.get("CRUMPLE_DATA", Path(__file__).parents[2] / "shared" / "data")) / "motionbenchmaker"
BETWEEN = 64  # configurations of each problem, from start to goal


def rotation(x, y, z, w):
    """Returns the rotation of a quaternion, (3, 3)."""
    x, y, z, w = np.array([x, y, z, w]) / np.linalg.norm([x, y, z, w])
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


class Problem:
    """Planning problem: boxes and cylinders as (kind, size, pose), a start and a goal."""

    def __init__(self, name, scene, request_, variables):
        self.name, self.primitives = name, []
        for body in scene["world"]["collision_objects"]:
            for primitive, at in zip(body["primitives"], body["primitive_poses"], strict=True):
                pose = np.column_stack([rotation(*at["orientation"]), at["position"]])
                self.primitives.append((primitive["type"], primitive["dimensions"], pose))
        joints = request_["start_state"]["joint_state"]
        start = dict(zip(joints["name"], joints["position"]))
        goal = {g["joint_name"]: g["position"] for g in request_["goal_constraints"][0]["joint_constraints"]}
        self.start = np.array([start[name] for name in variables], float)
        self.goal = np.array([goal[name] for name in variables], float)

    def obstacles(self):
        made = {}
        for i, (kind, size, pose) in enumerate(self.primitives):
            mesh = urdf.box(size) if kind == "box" else urdf.cylinder(size[1], size[0], max_error=1e-4)
            made[f"{kind} {i}"] = mesh, pose
        return urdf.Obstacles(made)


def read_problems(most, variables):
    """Returns up to `most` problems of each family, by family."""
    texts = {}
    with tarfile.open(DATA / "problems.tar.bz2") as archive:
        for member in archive:
            if member.isfile() and member.name.endswith(".yaml"):
                texts[member.name.split("/", 1)[1]] = archive.extractfile(member).read()
    load = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    families = {}
    for path in sorted(name for name in texts if "/scene" in name):
        family, file = path.split("/")
        other = f"{family}/{file.replace('scene', 'request')}"
        if other in texts and len(families.setdefault(family, [])) < most:
            scene, request_ = (yaml.load(texts[name], load) for name in (path, other))
            families[family].append(Problem(path, scene, request_, variables))
    return families


def boxes_of(mesh):
    vertices = np.asarray(mesh.vertices)
    low, high = vertices.min(0), vertices.max(0)
    return (low + high) / 2, (high - low) / 2


class CoalRobot:
    """Links as Coal's geometries of one kind: "triangles" or "convex hulls"."""

    def __init__(self, robot, kind):
        self.links, self.boxes = [], []
        for shape in robot.shapes.values():
            model = tree(shape.mesh.vertices, np.asarray(shape.mesh.faces))
            if kind == "convex hulls":
                model.buildConvexHull(True, "Qt")
            self.links.append(model.convex if kind == "convex hulls" else model)
            self.boxes.append(boxes_of(shape.mesh))
        places = {link: i for i, link in enumerate(robot.links)}
        allowed = {tuple(sorted(places[link] for link in pair)) for pair in robot.allowed}
        self.own = [pair for pair in itertools.combinations(range(len(places)), 2) if pair not in allowed]

    def bind(self, problem, poses):
        """Returns for each configuration its calls: (geometry, transform, geometry, transform) of each pair whose boxes overlap."""
        geometries = list(self.links)
        fixed, obstacle_boxes = [], []
        for kind, size, pose in problem.primitives:
            geometries.append(coal.Box(*size) if kind == "box" else coal.Cylinder(size[1], size[0]))
            fixed += transforms(pose[None])
            half = np.array(size if kind == "box" else [2 * size[1], 2 * size[1], size[0]]) / 2
            obstacle_boxes.append((pose[:, 3], np.abs(pose[:, :3]) @ half))
        centres = np.stack([poses[:, i, :, :3] @ c + poses[:, i, :, 3] for i, (c, _) in enumerate(self.boxes)], axis=1)
        halves = np.stack([np.abs(poses[:, i, :, :3]) @ h for i, (_, h) in enumerate(self.boxes)], axis=1)
        links = len(self.links)
        pairs = [*self.own, *((i, links + j) for i in range(links) for j in range(len(fixed)))]
        near = np.empty((len(poses), len(pairs)), bool)
        for p, (a, b) in enumerate(pairs):
            centre, half = (centres[:, b], halves[:, b]) if b < links else obstacle_boxes[b - links]
            near[:, p] = (np.abs(centres[:, a] - centre) <= halves[:, a] + half).all(axis=1)
        calls = []
        for row, flags in zip(poses, near):
            placed = [*transforms(row), *fixed]
            chosen = [pairs[p] for p in np.flatnonzero(flags)]
            calls.append([(geometries[a], placed[a], geometries[b], placed[b]) for a, b in chosen])
        return calls

    def managed(self, problem, poses):
        """Returns a function that decides all configurations by a manager of the obstacles."""
        obstacles = []
        for kind, size, pose in problem.primitives:
            shape = coal.Box(*size) if kind == "box" else coal.Cylinder(size[1], size[0])
            obstacles.append(coal.CollisionObject(shape, transforms(pose[None])[0]))
        manager = coal.DynamicAABBTreeCollisionManager()
        for obstacle in obstacles:
            manager.registerObject(obstacle)
        manager.setup()
        moving, given = [coal.CollisionObject(link) for link in self.links], [transforms(row) for row in poses]
        asked, result, callback = request(1, False), coal.CollisionResult(), coal.CollisionCallBackDefault()
        callback.data.request = asked

        def collides(placed):
            for link, place in zip(moving, placed):
                link.setTransform(place)
                link.computeAABB()
                callback.init()
                manager.collide(link, callback)
                if callback.data.result.isCollision():
                    return True
            result.clear()
            return any(
                moving[a].getAABB().overlap(moving[b].getAABB()) and coal.collide(moving[a], moving[b], asked, result)
                for a, b in self.own
            )

        return lambda: [collides(placed) for placed in given], obstacles


def collide_all(configurations):
    """Returns whether each configuration collides, given the calls for it."""
    asked, result, collide, hits = request(1, False), coal.CollisionResult(), coal.collide, []
    for calls in configurations:
        result.clear()
        hit = False
        for a, at_a, b, at_b in calls:
            if collide(a, at_a, b, at_b, asked, result):
                hit = True
                break
        hits.append(hit)
    return hits


def loops_of(configurations):
    """Returns calls for two triangles that are far apart, as many for each configuration as Coal makes until the first hit."""
    point = tree(np.eye(3), np.array([[0, 1, 2]]))
    apart = point, coal.Transform3s.Identity(), point, coal.Transform3s(np.full(3, 100.0))
    asked, result, made = request(1, False), coal.CollisionResult(), []
    for calls in configurations:
        count = 0
        for a, at_a, b, at_b in calls:
            result.clear()
            count += 1
            if coal.collide(a, at_a, b, at_b, asked, result):
                break
        made.append([apart] * count)
    return made


class Spheres:
    """Model of spheres: those of panda_spherized.urdf."""

    def __init__(self, robot):
        import yourdfpy

        model = yourdfpy.URDF.load(str(DATA / "panda_spherized.urdf"), build_scene_graph=False, load_meshes=False)
        of, centres, radii = [], [], []
        for link in model.robot.links:
            for collision in link.collisions:
                of.append(robot.links.index(link.name))
                centres.append(collision.origin[:3, 3])
                radii.append(collision.geometry.sphere.radius)
        self.of, self.centres, self.radii = np.array(of), np.array(centres), np.array(radii)
        allowed = {frozenset(robot.links.index(link) for link in pair) for pair in robot.allowed}
        first, second = np.triu_indices(len(of), 1)
        a, b = self.of[first], self.of[second]
        kept = [x != y and frozenset((x, y)) not in allowed for x, y in zip(a.tolist(), b.tolist())]
        self.first, self.second = first[kept], second[kept]
        self.least = (self.radii[self.first] + self.radii[self.second]) ** 2

    def collide(self, robot, problem, configurations):
        parts = [
            self._collide(robot.poses(configurations[i : i + 1024]), problem) for i in range(0, len(configurations), 1024)
        ]
        return np.concatenate(parts)

    def _collide(self, poses, problem):
        frames = poses[:, self.of]
        points = np.einsum("nsij,sj->nsi", frames[..., :3, :3], self.centres) + frames[..., :3, 3]
        apart = points[:, self.first] - points[:, self.second]
        hit = (np.einsum("npi,npi->np", apart, apart) <= self.least).any(axis=1)
        for kind, size, pose in problem.primitives:
            local = (points - pose[:, 3]) @ pose[:, :3]
            if kind == "box":
                beyond = np.maximum(np.abs(local) - np.array(size) / 2, 0)
            else:
                across = np.linalg.norm(local[..., :2], axis=2) - size[1]
                beyond = np.maximum(np.stack([across, np.abs(local[..., 2]) - size[0] / 2], axis=2), 0)
            hit |= (np.einsum("nsi,nsi->ns", beyond, beyond) <= self.radii**2).any(axis=1)
        return hit


def verdicts(ours, theirs):
    """Describes how verdicts differ. `theirs` and `ours` are lists of arrays of bool; ours are exact for the meshes."""
    ours, theirs = np.concatenate(ours), np.concatenate([np.asarray(t, bool) for t in theirs])
    wrong, missed = (theirs & ~ours).sum(), (ours & ~theirs).sum()
    share = 100 * wrong / max(1, (~ours).sum()), 100 * missed / max(1, ours.sum())
    return (
        f"{ours.sum()} of {len(ours)} collide; the peer reports {wrong} of the free ones ({share[0]:.2g} %), "
        f"and misses {missed} of those that collide ({share[1]:.2g} %)"
    )


def rows_of(name, robots, spheres, problems, sets):
    """Returns rows about problems, each with the configurations of `sets`. `robots` has one robot for each number of threads."""
    robot, turns, count = robots[1], len(problems), len(sets[0])
    obstacles = [problem.obstacles() for problem in problems]

    def ours(threads):
        return lambda turn: robots[threads].collides(sets[turn], obstacles[turn])

    exact = [ours(1)(turn).copy() for turn in range(turns)]
    for kind in ("triangles", "convex hulls"):
        coal_robot = CoalRobot(robot, kind)
        bound = [coal_robot.bind(p, robot.poses(q)[:, :, :3]) for p, q in zip(problems, sets)]
        loops = [loops_of(calls) for calls in bound]
        yield Row(
            f"{name}, Coal with {kind}, pairs given",
            ours(1),
            {"Coal": lambda turn, bound=bound: collide_all(bound[turn])},
            turns,
            lambda _, bound=bound: verdicts(exact, [collide_all(calls) for calls in bound]),
            a_turn=count,
            less=lambda turn, loops=loops: collide_all(loops[turn]),
        )
        managed = [coal_robot.managed(p, robot.poses(q)[:, :, :3]) for p, q in zip(problems, sets)]
        yield Row(
            f"{name}, Coal with {kind}, manager",
            ours(1),
            {"Coal": lambda turn, managed=managed: managed[turn][0]()},
            turns,
            lambda _, managed=managed: verdicts(exact, [call() for call, _ in managed]),
            a_turn=count,
        )
    by_spheres = lambda turn: spheres.collide(robot, problems[turn], sets[turn])  # noqa: E731
    compare = lambda _: verdicts(exact, [by_spheres(turn) for turn in range(turns)])  # noqa: E731
    yield Row(f"{name}, spheres by NumPy", ours(1), {"spheres": by_spheres}, turns, compare, a_turn=count)
    alone = {"crumple, one thread": ours(1)}
    both = lambda _: verdicts(exact, [ours(2)(turn) for turn in range(turns)])  # noqa: E731
    clock = time.perf_counter
    yield Row(f"{name}, two threads, wall clock", ours(2), alone, turns, both, a_turn=count, clock=clock)


def motions_of(robot, problems, count, steps=(0.05, 0.1, 0.2), fine=0.001):
    """Returns rows about motions: collides_between, against `collides` at configurations that are a step (radians) apart."""
    random = np.random.default_rng(2)
    starts = random.uniform(*robot.limits, size=(count, len(robot.variables)))
    ends = starts + random.normal(size=starts.shape) * 0.3
    obstacles = [problem.obstacles() for problem in problems]

    def by_steps(turn, size, chosen):
        length = np.linalg.norm(ends[chosen] - starts[chosen], axis=1)
        counts = np.ceil(length / size).astype(int) + 1
        first = np.cumsum(counts) - counts
        share = (np.arange(counts.sum()) - np.repeat(first, counts)) / np.repeat(counts - 1, counts)
        of = np.repeat(chosen, counts)
        hits = robot.collides(starts[of] + share[:, None] * (ends - starts)[of], obstacles[turn])
        return np.logical_or.reduceat(hits, first)

    def compare(step):
        total = differ = found = missed = 0
        for turn in range(len(problems)):
            ours = robot.collides_between(starts, ends, obstacles[turn])
            theirs = by_steps(turn, step, np.arange(count))
            odd = np.flatnonzero(ours & ~theirs)
            total, differ, missed = total + ours.sum(), differ + len(odd), missed + (theirs & ~ours).sum()
            if len(odd):
                found += by_steps(turn, fine, odd).sum()
        return (
            f"{total} of {count * len(problems)} collide or come closer than 1 mm; steps report {differ} of these as free, "
            f"of which steps of {fine} find {found} that collide; collides_between misses {missed}"
        )

    name = f"{count * len(problems):,} motions of 0.8 radians, tolerance 1 mm"
    ours = lambda turn: robot.collides_between(starts, ends, obstacles[turn])  # noqa: E731
    for step in steps:
        theirs = {f"crumple, steps of {step}": lambda turn, step=step: by_steps(turn, step, np.arange(count))}
        yield Row(name, ours, theirs, len(problems), lambda _, step=step: compare(step), a_turn=count)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="few configurations and rounds, to check that everything works")
    parser.add_argument("--configurations", type=int, default=20_000, help="number of random configurations, about")
    parser.add_argument("--json", help="file for the figures")
    arguments = parser.parse_args()
    if not DATA.is_dir():
        sys.exit(f"robots_python.py needs the folder {DATA}")
    robots = {n: urdf.load(DATA / "panda.urdf", DATA / "panda.srdf", threads=n) for n in (1, 2)}
    robot, spheres = robots[1], Spheres(robots[1])
    families = read_problems(2 if arguments.quick else 100, robot.variables)
    processor = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "?")
    print(f"crumple {crumple.__version__}, Coal {coal.__version__}, {processor}, {os.cpu_count()} processors")
    print(f"load {os.getloadavg()[0]:.1f} at the start; {sum(map(len, families.values()))} problems")

    random, count = np.random.default_rng(1), 300 if arguments.quick else arguments.configurations // len(families)
    first = [problems[0] for problems in families.values()]
    uniform = random.uniform(*robot.limits, size=(count, len(robot.variables)))
    every = [problem for problems in families.values() for problem in problems]
    chosen = every if arguments.quick else every[::10]
    motions = [np.linspace(p.start, p.goal, BETWEEN) for p in chosen]
    ends = np.array([robot.collides([p.start, p.goal], p.obstacles()) for p in every])
    of_spheres = np.array([spheres.collide(robot, p, np.array([p.start, p.goal])) for p in every])
    print(f"of {len(every)} problems, {ends[:, 0].sum()} starts and {ends[:, 1].sum()} goals collide;", end=" ")
    print(f"by spheres {of_spheres[:, 0].sum()} and {of_spheres[:, 1].sum()}")
    rounds, figures = 3 if arguments.quick else 5, []
    for name, problems, sets in (
        (f"{len(first) * count:,} random configurations in {len(first)} problems", first, [uniform] * len(first)),
        (f"{len(chosen) * BETWEEN:,} configurations of {len(chosen)} problems", chosen, motions),
    ):
        figures += [judge(row, rounds) for row in rows_of(name, robots, spheres, problems, sets)]
    figures += [judge(row, rounds) for row in motions_of(robot, first, 50 if arguments.quick else 1000)]
    show(figures)
    print(f"load {os.getloadavg()[0]:.1f} at the end")
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(figures, file, indent=1)


if __name__ == "__main__":
    main()
