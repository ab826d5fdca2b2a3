"""Seeds of the fuzz targets `search`, `features`, `worlds` and `overlaps`: scenes made by hand and at random."""

import random


def search_inputs():
    """Yields inputs as decode.cpp reads them: options, query, two layouts, excluded groups, frames, meshes."""
    choose = random.Random(7)

    def header(between=False, contacts=True, how=0, size=13, extras=0, options=bytes(6), reused=0, wild=0):
        flags = how | (8 if contacts else 0) | (64 if between else 0)
        more = (extras & 1) + (extras & 24 == 24)  # a count of parts, a memory limit
        layouts = bytes([1, 0, 0, 0, 0]) * 2  # float32, int32, contiguous, no groups
        return (bytes([reused, size, wild]) + options + bytes([flags, 0, extras]) +
                bytes(choose.randrange(64) for _ in range(more)) + layouts + bytes([0, 0]))

    def mesh(vertices, triangles, soup=False, scale=0, shift=0):
        data = bytes([scale, shift, len(triangles), len(vertices), int(soup)])
        data += b"".join(vertices) + b"".join(bytes(t) for t in triangles if not soup)
        return data

    def on_grid(x, y, z):
        return bytes([1, x, y, z])

    crossing = mesh([on_grid(0, 0, 1), on_grid(4, 0, 1), on_grid(0, 4, 1), on_grid(1, 1, 0), on_grid(1, 1, 2),
                     on_grid(3, 0, 2)], [(0, 1, 2), (3, 4, 5)])
    fold = mesh([on_grid(0, 0, 0), on_grid(4, 0, 0), on_grid(2, 4, 0), on_grid(2, 2, 0)], [(0, 1, 2), (0, 1, 3)])
    copies = mesh([on_grid(0, 0, 0), on_grid(4, 0, 0), on_grid(2, 4, 0)], [(0, 1, 2), (1, 2, 0), (0, 1, 1), (2, 2, 2)])
    for scene in (crossing, fold, copies):
        for how in range(8):
            yield header(how=how) + scene
            yield header(between=True, how=how) + scene + crossing
        for options in (bytes([0, simd, clusters, leaf, 0, 0]) for simd in range(5) for clusters in (0, 3, 6)
                        for leaf in (0, 2, 5)):
            yield header(options=options, extras=choose.choice([0, 1, 5, 24])) + scene
    for length in (40, 80, 160, 320, 640):
        for _ in range(12):
            scene = header(choose.random() < 0.4, choose.random() < 0.5, choose.randrange(256), choose.randrange(16),
                           choose.randrange(256), bytes(choose.randrange(256) for _ in range(6)),
                           choose.randrange(2), 7 * (choose.random() < 0.2))
            yield scene + bytes(choose.randrange(256) for _ in range(length))


def overlap_inputs():
    """Yields inputs as overlaps.cpp reads them: random bytes, half of them after default options."""
    choose = random.Random(9)
    for length in (60, 120, 240):
        for number in range(60):
            some = bytes(choose.randrange(256) for _ in range(length))
            yield bytes(8 if number % 2 else 0) + some


def feature_inputs():
    """Yields inputs as features.cpp reads them: random bytes, half of them after default options."""
    choose = random.Random(10)
    for length in (60, 120, 240):
        for number in range(60):
            some = bytes(choose.randrange(256) for _ in range(length))
            yield bytes(6 if number % 2 else 0) + some


def world_inputs():
    """Yields inputs as decode_world.cpp reads them: random bytes, half of them after default options."""
    choose = random.Random(8)
    for length in (60, 120, 240, 480):
        for number in range(60):
            some = bytes(choose.randrange(256) for _ in range(length))
            yield bytes(6 if number % 2 else 0) + bytes([choose.randrange(248), choose.randrange(256)]) + some
