"""Plans a path of a robot arm through a window by RRT-Connect; draws the path, and the straight motion, which collides.

python plan_a_path.py [PICTURE]

The robot is read from a URDF file (pip install yourdfpy). The planner tests many motions in each call. A motion that it
keeps is free at all times, however thin the obstacles are: no step size can be too large.
"""

import itertools
import sys
import tempfile
from pathlib import Path

import numpy as np

import crumple
from crumple.adapters import urdf

# Link, shape, height of its middle; joint above it, axis, height above the previous joint, limit in radians.
LINKS = [
    ("foot", '<box size="0.3 0.3 0.2"/>', 0.1, None),
    ("waist", '<cylinder radius="0.09" length="0.18"/>', 0.09, ("turn", "0 0 1", 0.21, 3.0)),
    ("upper arm", '<cylinder radius="0.06" length="0.5"/>', 0.3, ("shoulder", "0 1 0", 0.2, 1.9)),
    ("forearm", '<cylinder radius="0.045" length="0.4"/>', 0.25, ("elbow", "0 1 0", 0.6, 2.5)),
    ("wrist", '<cylinder radius="0.04" length="0.1"/>', 0.06, ("roll", "0 0 1", 0.5, 3.0)),
    ("hand", '<box size="0.16 0.04 0.16"/>', 0.12, ("pitch", "0 1 0", 0.1, 2.0)),
]


def robot_description():
    """Returns the text of a URDF file."""
    parts, below = [], None
    for link, shape, middle, joint in LINKS:
        parts.append(
            f'<link name="{link}"><collision><origin xyz="0 0 {middle}"/>'
            f"<geometry>{shape}</geometry></collision></link>"
        )
        if joint:
            name, axis, height, limit = joint
            parts.append(
                f'<joint name="{name}" type="revolute"><parent link="{below}"/><child link="{link}"/>'
                f'<origin xyz="0 0 {height}"/><axis xyz="{axis}"/>'
                f'<limit lower="{-limit}" upper="{limit}" effort="1" velocity="1"/></joint>'
            )
        below = link
    return f'<robot name="arm">{"".join(parts)}</robot>'


def wall_with_window():
    """Returns obstacles: a floor, and a wall of four slabs around a window."""
    slabs = {
        "floor": ((2, 2, 0.02), (0, 0, -0.02)),
        "sill": ((0.05, 1.6, 0.55), (0.55, 0, 0.275)),
        "lintel": ((0.05, 1.6, 0.3), (0.55, 0, 1.3)),
        "left jamb": ((0.05, 0.5, 0.6), (0.55, 0.55, 0.85)),
        "right jamb": ((0.05, 0.5, 0.6), (0.55, -0.55, 0.85)),
    }
    return urdf.Obstacles(
        {name: (urdf.box(size), np.column_stack([np.eye(3), place])) for name, (size, place) in slabs.items()}
    )


def plan(robot, start, goal, obstacles, seed=1, step=0.7, batch=48, rounds=500):
    """Returns a path of configurations, (k, joints), by RRT-Connect, or None. Each round tests a batch of motions."""
    random = np.random.default_rng(seed)
    trees = [(np.array([start]), [-1]), (np.array([goal]), [-1])]  # configurations, index of each one's parent
    for turn in range(rounds):
        nodes, parents = trees[turn % 2]
        others, other_parents = trees[1 - turn % 2]
        targets = random.uniform(*robot.limits, size=(batch, len(start)))
        near = np.linalg.norm(nodes[None] - targets[:, None], axis=2).argmin(axis=1)
        offsets = targets - nodes[near]
        length = np.linalg.norm(offsets, axis=1, keepdims=True)
        ends = nodes[near] + offsets * np.minimum(1, step / length)
        free = ~robot.collides_between(nodes[near], ends, obstacles)
        first = len(nodes)
        nodes, parents = np.concatenate([nodes, ends[free]]), [*parents, *near[free].tolist()]
        trees[turn % 2] = nodes, parents
        # Connects: from each new configuration straight to the nearest one of the other tree.
        added = nodes[first:]
        nearest = np.linalg.norm(others[None] - added[:, None], axis=2).argmin(axis=1)
        connected = np.flatnonzero(~robot.collides_between(added, others[nearest], obstacles))
        if len(connected):
            new = connected[0]
            to_root = branch(nodes, parents, first + new)
            path = np.concatenate([to_root[::-1], branch(others, other_parents, nearest[new])])
            return path if turn % 2 == 0 else path[::-1]
    return None


def branch(nodes, parents, node):
    """Returns the configurations from a node of a tree to its root."""
    made = []
    while node >= 0:
        made.append(nodes[node])
        node = parents[node]
    return np.array(made)


def shortened(robot, path, obstacles):
    """Returns the shortest path whose configurations are some of those of a path. Tests all motions in one call."""
    first, last = np.triu_indices(len(path), 1)
    free = ~robot.collides_between(path[first], path[last], obstacles)
    free |= last == first + 1  # these are known to be free
    length, before = np.full(len(path), np.inf), np.zeros(len(path), int)
    length[0] = 0
    for i, j in sorted(zip(first[free].tolist(), last[free].tolist())):
        through = length[i] + np.linalg.norm(path[j] - path[i])
        if through < length[j]:
            length[j], before[j] = through, i
    kept = [len(path) - 1]
    while kept[-1]:
        kept.append(before[kept[-1]])
    return path[kept[::-1]]


def draw(robot, path, obstacles, picture):
    """Draws the robot along a path, and where the straight motion from its start to its end first collides."""
    straight = np.linspace(path[0], path[-1], 200)
    along = [np.linspace(a, b, 3)[:-1] for a, b in itertools.pairwise(path)]
    shown = np.concatenate([*along, [path[-1], straight[robot.collides(straight, obstacles).argmax()]]])
    links = len(robot.links)
    world = crumple.World(
        [*robot.shapes.values(), *obstacles.shapes],
        [*list(range(links)) * len(shown), *range(links, links + len(obstacles))],
        poses=np.concatenate([robot.poses(shown)[:, :, :3].reshape(-1, 3, 4), obstacles.poses]),
        groups=[0] * links * len(shown) + [1] * len(obstacles),
    )
    between = crumple.PairFilter(groups="between")  # the robot with obstacles, not with itself elsewhere
    robot.detector.intersections(world, output="body_pairs", filter=between).save(picture)


def main(picture="plan_a_path.html"):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "arm.urdf"
        file.write_text(robot_description())
        robot = urdf.load(file)
    obstacles = wall_with_window()
    start, goal = np.array([2.2, 1.0, 1.2, 0, 0.5]), np.array([0, 0.72, 0.8, 0, 0])
    print("start and goal are free:", not robot.collides([start, goal], obstacles).any())
    print("the straight motion collides:", bool(robot.collides_between(start, goal, obstacles)))
    path = plan(robot, start, goal, obstacles)
    short = shortened(robot, path, obstacles)
    moves = robot.collides_between(short[:-1], short[1:], obstacles)
    print(f"a path of {len(path)} configurations, {len(short)} after shortening; {moves.sum()} of its motions collide")
    draw(robot, short, obstacles, picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
