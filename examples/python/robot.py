"""Checks a robot arm: links are groups; adjacent links may touch (the allowed collision matrix), others may not.

python robot.py [PICTURE]
"""

import sys

import numpy as np

import crumple

BOX = np.array([[x, y, z] for x in (0, 1) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
BOX_FACES = np.array(
    [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ]
)
LINKS = ["table", "base", "upper arm", "forearm", "hand"]
ALLOWED = [(0, 1), (1, 2), (2, 3), (3, 4)]  # each link overlaps the next at its joint


def arm(angles):
    """Returns the boxes of table, base and links; each link is rotated about y at the end of the previous one."""
    meshes = [BOX * [4, 4, 0.2] - [2, 0, 0.1], BOX @ np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]) * [0.5, 0.5, 0.8]]
    joint, direction = np.array([0, 0, 0.8]), 0.0
    for length, angle in zip((1.6, 1.4, 0.6), angles):
        direction += angle
        along = np.array([np.cos(direction), 0, np.sin(direction)])
        axes = np.array([along, [0, 1, 0], [-along[2], 0, along[0]]])
        meshes.append(joint + (BOX * [length + 0.1, 0.3, 0.3] - [0.05, 0, 0]) @ axes)
        joint = joint + length * along
    return meshes


def scene(angles):
    meshes = arm(angles)
    faces = np.concatenate([BOX_FACES + len(BOX) * i for i in range(len(meshes))])
    return crumple.Mesh(np.concatenate(meshes), faces, np.repeat(np.arange(len(meshes)), len(BOX_FACES)))


def main(picture="robot.html"):
    detector = crumple.Detector(threads=1)
    between_links = crumple.PairFilter(groups="between", excluded_groups=ALLOWED)
    for angles in [(1.2, -0.8, -0.4), (2.3, -3.25, -0.05), (0.8, -2.2, -0.2)]:
        robot = scene(angles)
        result = detector.intersections(robot, output="contacts", filter=between_links)
        pairs = sorted({tuple(sorted(pair)) for pair in robot.groups[result.pairs].tolist()})
        print(angles, "is free" if not pairs else ", ".join(f"{LINKS[a]} hits {LINKS[b]}" for a, b in pairs))
        if pairs:
            result.save(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
