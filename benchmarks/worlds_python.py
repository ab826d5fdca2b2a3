"""Times worlds (docs/worlds.md) against Coal, a library of simulators and planners, in one process, alternately.

    python worlds_python.py [--quick] [--json OUT]

Needs crumple's Python package and Coal in one environment, which scripts/test_python.sh --all makes. Both are called
from Python, on one thread except for rows that name another number. Coal's trees (OBBRSS) and its transforms and requests are
made before the clock starts. Crumple's shapes are named, so that it caches their trees; its measured time includes reading
poses from NumPy arrays. Coal is compared in its fastest configuration: with or without contacts, and with other choices of
some rows.

Times are medians; on one thread they are CPU times of the thread, which other load on the machine disturbs less. A ratio is
computed for each pose, or for each round if one call processes all poses; its median and quartiles are reported.
Results are compared: Coal decides in float64 with rounding errors, crumple exactly, for posed vertices that are rounded
to float32, so the two may disagree about triangles that hardly touch.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time

import numpy as np
import rigid_scenes as scenes
from timed_rows import Row, judge, show

import crumple

try:
    import coal
except ImportError as error:
    sys.exit(f"worlds_python.py compares with Coal, which is not installed ({error}): pip install coal")


def tree(vertices, faces):
    points, corners = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for point in vertices.astype(float):
        points.append(point)
    for face in faces.tolist():
        corners.append(coal.Triangle(*face))
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(faces), len(vertices))
    model.addSubModel(points, corners)
    model.endModel()
    return model


def transforms(poses):
    return [coal.Transform3s(np.ascontiguousarray(p[:, :3]), p[:, 3].copy()) for p in poses.reshape(-1, 3, 4)]


def request(most, contacts):
    made = coal.CollisionRequest()
    made.num_max_contacts, made.enable_contact = most, contacts
    return made


WAYS = {"Coal, with contacts": True, "Coal, without contacts": False}
ALL = 2**62


def pairs_differ(answers):
    """Describes how the pairs differ. The argument has (set of crumple's pairs, set of the peer's pairs) for each pose."""
    found, missing, extra = map(sum, zip(*((len(a), len(a - b), len(b - a)) for a, b in answers)))
    return f"{found} pairs; the peer lacks {missing}, has {extra} more"


def flags_differ(ours, theirs):
    ours, theirs = np.asarray(ours, bool), np.asarray(theirs, bool)
    return f"{ours.sum()} of {ours.size} collide; the peer differs in {(ours != theirs).sum()}"


def ball_and_cloth(quick):
    """Returns four rows about a ball and a cloth: all pairs, and yes or no, each with a ball that collides with the cloth and one
    above it."""
    vertices, faces = scenes.ball(16)
    cloth = scenes.cloth(20_000 if quick else 200_000)
    shapes = [crumple.Shape(vertices, faces, name="ball"), crumple.Shape(cloth.vertices, cloth.faces, name="cloth")]
    detector, world = crumple.Detector(threads=1), crumple.World(shapes, self_collisions=False)
    touching = np.tile(np.eye(3, 4), (10 if quick else 100, 2, 1, 1))
    touching[:, 0] = scenes.on_the_cloth(cloth, len(touching), 1.0)
    clear = touching.copy()
    clear[:, 0, 2, 3] = float(cloth.vertices[:, 2].max()) + 2
    trees = tree(vertices, faces), tree(cloth.vertices, cloth.faces)

    def row(name, poses, output, most):
        given = [tuple(transforms(p)) for p in poses]

        def ours(i):
            world.poses = poses[i]
            return detector.any(world) if output == "any" else detector.intersections(world)

        def collide(i, contacts):
            result = coal.CollisionResult()
            coal.collide(trees[0], given[i][0], trees[1], given[i][1], request(most, contacts), result)
            return result

        def compare(way):
            answers = [(ours(i), collide(i, WAYS[way])) for i in range(len(poses))]
            if output == "any":
                return flags_differ([a for a, _ in answers], [b.isCollision() for _, b in answers])
            return pairs_differ(
                (set(map(tuple, a.pairs.tolist())), {(c.b1, c.b2) for c in map(b.getContact, range(b.numContacts()))})
                for a, b in answers
            )

        theirs = {way: lambda i, contacts=contacts: collide(i, contacts) for way, contacts in WAYS.items()}
        return Row(name, ours, theirs, len(poses), compare)

    thousands = f"{round(len(cloth.faces), -3):,}"
    return [
        row(f"ball of 5,120 on a cloth of {thousands} triangles, all pairs", touching, "pairs", ALL),
        row("the same, yes or no", touching, "any", 1),
        row("the ball lifted clear, yes or no", clear, "any", 1),
        row("the ball lifted clear, all pairs", clear, "pairs", ALL),
    ]


def robot(quick):
    """Returns two rows: configurations of a chain of 8 links among obstacles, on one thread and on two. Adjacent links
    may touch."""
    links, length = 8, 1.5
    count = 100 if quick else 1000
    vertices, faces = scenes.link(25, 41, length, 0.2)
    room = scenes.obstacles(20_000 if quick else 200_000)
    free = np.random.default_rng(4).uniform(room.vertices.min(0), room.vertices.max(0), size=(count, 3))
    poses = scenes.arm(count, links, length, free, 0.9)
    shapes = [*(crumple.Shape(vertices, faces, name=f"link {k}") for k in range(links))]
    shapes.append(crumple.Shape(room.vertices, room.faces, name="obstacles"))
    robot = crumple.World(shapes, worlds=[0] * links + [-1], self_collisions=False)
    world = robot.configurations(poses)
    allowed = crumple.PairFilter(excluded_bodies=[(k, k + 1) for k in range(links - 1)])
    pairs = [(a, b) for a in range(links) for b in range(a + 2, links)]
    link_trees, room_tree = [tree(vertices, faces) for _ in range(links)], tree(room.vertices, room.faces)
    given, identity = [transforms(p) for p in poses], coal.Transform3s.Identity()

    def ours(detector):
        return lambda turn: detector.intersections(world, output="any_by_world", filter=allowed)

    def self_collides(placed, asked, result):
        for a, b in pairs:
            if coal.collide(link_trees[a], placed[a], link_trees[b], placed[b], asked, result):
                return True
        return False

    def by_hand(contacts):
        asked, result = request(1, contacts), coal.CollisionResult()

        def collides(placed):
            result.clear()
            for link, place in zip(link_trees, placed):
                if coal.collide(link, place, room_tree, identity, asked, result):
                    return True
            return self_collides(placed, asked, result)

        return lambda turn: [collides(placed) for placed in given]

    # Coal's manager: a tree of boxes over the obstacles, each of which also has a tree of its own triangles.
    pieces = []
    for group in np.unique(room.groups):
        used, renamed = np.unique(room.faces[room.groups == group], return_inverse=True)
        pieces.append(coal.CollisionObject(tree(room.vertices[used], renamed.reshape(-1, 3))))
    manager = coal.DynamicAABBTreeCollisionManager()
    for piece in pieces:
        manager.registerObject(piece)
    manager.setup()
    moving = [coal.CollisionObject(link) for link in link_trees]

    def by_manager(contacts):
        asked, result, callback = request(1, contacts), coal.CollisionResult(), coal.CollisionCallBackDefault()
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
            return self_collides(placed, asked, result)

        return lambda turn: [collides(placed) for placed in given]

    theirs = {way: by_hand(contacts) for way, contacts in WAYS.items()}
    theirs.update({f"{way}, dynamic AABB tree": by_manager(contacts) for way, contacts in WAYS.items()})
    rows = []
    for threads in (1, 2):
        mine = ours(crumple.Detector(threads=threads))
        clock = time.thread_time if threads == 1 else time.perf_counter
        name = f"robot of 8 links of 2,000 among {len(room.faces):,}, {count} configurations, {threads} thread"
        compare = lambda way, mine=mine: flags_differ(mine(0).world_hit, theirs[way](0))  # noqa: E731
        rows.append(Row(name + "s" * (threads > 1), mine, theirs, 1, compare, count, clock=clock))
    return rows


def planner(quick):
    """Returns three rows with one configuration per call, as motion planners check them: is a chain of 9 links within 0.05 of
    obstacles? Crumple excludes pairs of links by name; Coal's collide is called for each link, with a security margin."""
    links, length, count, margin = 9, 1.5, 20 if quick else 200, 0.05
    vertices, faces = scenes.link(12, 21, length, 0.2)
    room = scenes.obstacles(20_000 if quick else 40_000)
    free = np.random.default_rng(4).uniform(room.vertices.min(0), room.vertices.max(0), size=(count, 3))
    poses = scenes.arm(count, links, length, free, 0.9).reshape(count, links, 3, 4)
    poses = np.concatenate([poses, np.tile(np.eye(3, 4), (count, 1, 1, 1))], axis=1)
    shapes = [*(crumple.Shape(vertices, faces, name=f"planner link {k}") for k in range(links))]
    shapes.append(crumple.Shape(room.vertices, room.faces, name="planner obstacles"))
    names = [*(f"link {k}" for k in range(links)), "room"]
    detector, world = crumple.Detector(threads=1), crumple.World(shapes, self_collisions=False, names=names)
    excluded = [(names[a], names[b]) for b in range(links) for a in range(b)]
    allowed = crumple.PairFilter(excluded_bodies=excluded)
    near = crumple.ProximityQuery(radius=margin, output="any", filter=allowed)
    clearance = crumple.DistanceQuery(radius=margin, output="nearest", filter=allowed)
    link_tree, room_tree = tree(vertices, faces), tree(room.vertices, room.faces)
    given, identity, asked = [transforms(p[:links]) for p in poses], coal.Transform3s.Identity(), request(1, False)
    asked.security_margin = margin

    def ours(i):
        return detector.any(world.at(poses[i]), near)

    def by_clearance(i):
        return len(detector.find(world.at(poses[i]), clearance)) > 0

    def theirs(i):
        result = coal.CollisionResult()
        return any(coal.collide(link_tree, place, room_tree, identity, asked, result) for place in given[i])

    def compare(_):
        return flags_differ([ours(i) for i in range(count)], [theirs(i) for i in range(count)])

    name = f"one configuration a call: 9 links within {margin} of {len(room.faces):,}, pairs excluded by name"
    clear = [i for i in range(count) if not ours(i)]
    return [
        Row(name, ours, {"Coal": theirs}, count, compare),
        Row("the same, by its clearance", by_clearance, {"Coal": theirs}, count, compare),
        Row("the same, clear ones", lambda i: ours(clear[i]), {"Coal": lambda i: theirs(clear[i])}, len(clear), compare),
    ]


def point_cloud(quick):
    """Returns a row about configurations of a chain of 9 links: is any link within 0.05 of a cloud of 20,000 points, which lie on
    obstacles? Coal gets each point as a triangle without extent."""
    links, length, count, margin = 9, 1.5, 20 if quick else 100, 0.05
    vertices, faces = scenes.link(12, 21, length, 0.2)
    room = scenes.obstacles(40_000)
    random = np.random.default_rng(4)
    free = random.uniform(room.vertices.min(0), room.vertices.max(0), size=(count, 3))
    poses = scenes.arm(count, links, length, free, 0.9).reshape(count, links, 3, 4)
    corners = room.vertices[room.faces[random.integers(len(room.faces), size=20_000)]]
    points = np.einsum("ik,ikd->id", random.dirichlet((1, 1, 1), size=len(corners)), corners).astype(np.float32)
    shapes = [crumple.Shape(vertices, faces, name=f"cloud link {k}") for k in range(links)]
    shapes.append(crumple.Shape(points, points=np.arange(len(points)), name="cloud"))
    robot = crumple.World(shapes, worlds=[0] * links + [-1], self_collisions=False)
    allowed = crumple.PairFilter(excluded_bodies=[(a, b) for b in range(links) for a in range(b)])
    detector, world = crumple.Detector(threads=1), robot.configurations(poses)
    link_tree, cloud_tree = tree(vertices, faces), tree(points, np.arange(len(points))[:, None].repeat(3, 1))
    given, identity, asked = [transforms(p) for p in poses], coal.Transform3s.Identity(), request(1, False)
    asked.security_margin = margin

    def ours(turn):
        return detector.proximities(world, radius=margin, output="any_by_world", filter=allowed)

    def theirs(turn):
        result, hits = coal.CollisionResult(), []
        for placed in given:
            result.clear()
            hits.append(any(coal.collide(link_tree, place, cloud_tree, identity, asked, result) for place in placed))
        return hits

    name = f"{count} configurations of {links} links, within {margin} of a cloud of {len(points):,} points, yes or no for each"
    return [Row(name, ours, {"Coal": theirs}, 1, lambda way: flags_differ(ours(0).world_hit, theirs(0)), a_turn=count)]


def many_worlds(quick):
    """Returns two rows about worlds of two balls each, about half of which collide. The first compares with Coal, the second with
    crumple itself if each world lies in a different place; otherwise all worlds lie in the same place."""
    count = 500 if quick else 10_000
    vertices, faces = scenes.ball(5)
    shapes = [crumple.Shape(vertices, faces, name=f"small ball {k}") for k in range(2)]
    poses = scenes.beside_each_other(count, (1, 3))
    far = scenes.spread(poses, 10.0)
    columns = {"bodies": [0, 1] * count, "worlds": np.repeat(np.arange(count), 2), "self_collisions": False}
    detector, world = crumple.Detector(threads=1), crumple.World(shapes, **columns)
    a, b = tree(vertices, faces), tree(vertices, faces)
    point = tree(np.eye(3, dtype=np.float32), np.array([[0, 1, 2]]))
    given = [tuple(transforms(p)) for p in poses]
    aside = [(coal.Transform3s.Identity(), coal.Transform3s(np.full(3, 100.0)))] * count
    near, spread = poses.reshape(-1, 3, 4), far.reshape(-1, 3, 4)

    def ours(at):
        return lambda turn: detector.intersections(world.at(at), output="any_by_world")

    def loop(first, second, placed, contacts):
        asked, result, collide = request(1, contacts), coal.CollisionResult(), coal.collide

        def run(turn):
            hit = []
            for p, q in placed:
                result.clear()
                hit.append(collide(first, p, second, q, asked, result))
            return hit

        return run

    theirs = {way: loop(a, b, given, contacts) for way, contacts in WAYS.items()}
    name = f"{count:,} worlds of two balls of 500, yes or no for each"
    return [
        Row(
            name + ", less Coal's loop",
            ours(near),
            theirs,
            1,
            lambda way: flags_differ(ours(near)(0).world_hit, theirs[way](0)),
            a_turn=count,
            less=loop(point, point, aside, False),
        ),
        Row(
            "the same",
            ours(near),
            {"crumple, each world at a place of its own": ours(spread)},
            1,
            lambda way: flags_differ(ours(near)(0).world_hit, ours(spread)(0).world_hit),
            a_turn=count,
        ),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small scenes and few rounds, to check that everything works")
    parser.add_argument("--json", help="file for the figures")
    arguments = parser.parse_args()
    rounds = 3 if arguments.quick else 11
    load = os.getloadavg()[0]
    print(f"crumple {crumple.__version__}, Coal {coal.__version__}, {os.cpu_count()} processors, load {load:.1f}")
    figures = []
    for make in (ball_and_cloth, robot, planner, point_cloud, many_worlds):
        figures += [judge(row, rounds) for row in make(arguments.quick)]
    show(figures)
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(figures, file, indent=1)


if __name__ == "__main__":
    main()
