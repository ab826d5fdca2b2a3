"""Tables of README.md and docs/, except for those of docs/benchmarks_tables.md and of GPU figures."""

from statistics import mean

from .blocks import block, ms, span, table
from .results import digits, scene


def contest(results, question, peers):
    """Makes a row for each workload: crumple's time, then each peer's time and ratio."""
    ours = results.fastest(question, "crumple")
    theirs = {title: results.fastest(question, name) for name, title in peers.items() if name in results.peers(question)}
    rows = []
    for workload, (race, way) in ours.items():
        cells = [scene(workload), f"{race['triangles']:,}"]
        if question != "any":
            cells.append(f"{race['pairs']:,}")
        cells.append(ms(way["milliseconds"]))
        for peer in theirs.values():
            other = peer[workload][1] if workload in peer else None
            cells.append(f"{ms(other['milliseconds'])} ({other['ratio']['median']:.1f}x)" if other else "")
        rows.append(cells)
    counts = ["triangles"] if question == "any" else ["triangles", "pairs"]
    return table(["scene", *counts, "Crumple", *theirs], rows)


def named(results, peer):
    """Returns the peer's name with the first two numbers of its version."""
    return f"{peer} {'.'.join(results.version(peer).split('.')[:2])}"


@block("self", "self")
def self_contest(results):
    return contest(results, "self", {"CGAL": named(results, "CGAL") + ", exact",
                                     "MeshLib": named(results, "MeshLib") + ", float32",
                                     "Embree": named(results, "Embree") + ", boxes only",
                                     "IPC Toolkit LBVH, from Python": "IPC Toolkit LBVH, boxes only"})


@block("between", "between")
def between_contest(results):
    return contest(results, "between", {"FCL": named(results, "FCL") + ", build and collide",
                                        "FCL, trees built": "FCL, trees built",
                                        "MeshLib": named(results, "MeshLib") + ", float32",
                                        "Embree": named(results, "Embree") + ", boxes only"})


@block("any", "any")
def any_contest(results):
    return contest(results, "any", {"CGAL": named(results, "CGAL") + ", exact",
                                    "IPC Toolkit has_intersections": "IPC Toolkit `has_intersections`"})


@block("growth", studies=["growth"])
def growth(results):
    rows = [[f"{size['triangles']:,.0f}", f"{size['pairs']:,}", digits(size["one_thread"]["median"]),
             digits(size["all_threads"]["median"]), digits(size["bytes_a_triangle"])] for size in results.sizes()]
    return table(["triangles", "pairs", "one thread, ms", "two threads, ms", "memory, bytes a triangle"], rows)


@block("first call", studies=["first_call"])
def first_call(results):
    rows = [[scene(row["workload"]), *(ms(row[kind]) for kind in ("making", "new_process", "new_detector", "warm"))]
            for row in results.study("first_call")]
    return table(["scene", "new process: making a detector", "its first call", "another detector's first call",
                  "a warm call"], rows)


@block("sequences", studies=["sequences"])
def sequences(results):
    rows = []
    for s in results.sequences().values():
        every, one = (s["kinds"][kind] for kind in ("warm, all threads", "warm"))
        ours = dict(zip(s["frames"], every["milliseconds"]))
        ours = mean(ours[frame] for frame in s["peer_frames"])
        theirs = {peer["name"]: f"{mean(peer['milliseconds']) / ours:.1f}x" for peer in s["peers"]}
        rows.append([scene(s["sequence"]), len(s["frames"]), f"{max(s['triangles']):,}", f"{max(s['pairs']):,}",
                     digits(mean(one["milliseconds"])), digits(mean(every["milliseconds"])),
                     digits(every["summary"]["percentile_99"]), theirs.get("CGAL", ""), theirs.get("Embree", "")])
    return table(["sequence", "frames", "triangles", "most pairs", "one thread, ms", "two threads, ms", "99th percentile, ms",
                  "CGAL, exact", "Embree, boxes only"], rows)


def best_fixed_axis(ways):
    """Returns the figures of the fastest sweep along x, y or z. `ways` maps directions to figures."""
    return min((ways[axis] for axis in "xyz"), key=lambda way: way["milliseconds"]["median"])


@block("sweep direction", studies=["axes"])
def sweep_direction(results):
    """Makes a table of the time of a sweep along principal components, divided by that along the fastest of x, y and z."""
    ratios = {}
    for figure in results.study("axes"):
        ways = {way["direction"]: way for way in figure["ways"]}
        ratio = ways["PCA"]["milliseconds"]["median"] / best_fixed_axis(ways)["milliseconds"]["median"]
        ratios.setdefault(figure["workload"], {})[figure["parts"]] = f"{ratio:.2f}"
    rows = [[scene(workload), *by_parts.values()] for workload, by_parts in ratios.items()]
    titles = ["whole scene" if parts == 1 else f"{parts} parts" for parts in next(iter(ratios.values()), ())]
    return table(["PCA / best fixed axis", *titles], rows)


@block("whole clusters", studies=["two_clusters"])
def whole_clusters(results):
    rows = []
    for figure in results.study("two_clusters"):
        leaves, *whole = figure["cuts"]
        rows.append([scene(figure["workload"]), ms(leaves["all_threads"]),
                     *(f"{cut['all_threads']['median'] / leaves['all_threads']['median']:.2f}" for cut in whole)])
    return table(["scene", "leaves", "one, whole", "two, whole", "four, whole"], rows)


@block("prefix sum", studies=["two_clusters"])
def prefix_sum(results):
    """Makes a table of sizes in MiB: lists of overlapping intervals, which [MZ] fig. 2 allocates ([MZ] is the paper that Crumple
    follows), for two clusters and for leaves; lists of the overlapping boxes and the colliding pairs; the detector's peak
    memory."""
    rows = []
    for figure in results.study("two_clusters"):
        cuts = {cut["cut"]: cut for cut in figure["cuts"]}
        whole, leaves = cuts["2 whole"], cuts["leaves (default)"]
        sizes = (whole["predicted_bytes"], leaves["predicted_bytes"], 8 * leaves["candidates"], 8 * leaves["pairs"],
                 leaves["peak_bytes"])
        rows.append([scene(figure["workload"]), *(digits(size / 2**20) for size in sizes)])
    return table(["MiB", "list of overlapping intervals, two clusters", "the same, leaves", "of these, boxes overlap",
                  "colliding pairs", "most that the detector owns"], rows)


@block("simd", studies=["simd"])
def simd(results):
    """Makes a table of times: a column for each instruction set that the machine has."""
    names = {"avx512": "AVX-512", "avx2": "AVX2", "sse4": "SSE4", "scalar": "scalar"}
    rows = [(scene(figure["workload"]), {value["value"]: value["milliseconds"] for value in figure["values"]})
            for figure in results.study("simd")]
    measured = [name for name in names if name in rows[0][1]]
    return table(["", *(names[name] for name in measured)],
                 [[title, *(ms(times[name]) for name in measured)] for title, times in rows])


@block("option")
def option(results, study):
    """Makes a table of times relative to the default: a row for each value, a column for each scene."""
    figures = results.study(study)
    labels = [scene(figure["workload"].removesuffix(", new detector")) for figure in figures]
    rows = [[rows_of[0]["value"], *(f"{value['relative']['median']:.2f}" for value in rows_of)]
            for rows_of in zip(*(figure["values"] for figure in figures))]
    return table(["value", *labels], rows)


@block("box overlaps", studies=["cost_per_box_overlap"])
def box_overlaps(results):
    rows = [[scene(row["workload"]), f"{row['overlapping_boxes']:,}", ms(row["milliseconds"]),
             digits(row["nanoseconds_a_box_pair"]), f"{row['relative']:.2f}"]
            for row in results.study("cost_per_box_overlap")]
    return table(["scene", "overlapping boxes", "time", "ns an overlap", "times Cloth on Ball"], rows)


@block("ground", studies=["ground"])
def ground(results):
    rows = [[scene(row["workload"]), ms(row["without"]), ms(row["with"]), f"{row['ratio']['median']:.2f}"]
            for row in results.study("ground")]
    return table(["scene", "without ground", "with ground", "ratio"], rows)


@block("pieces", studies=["virtual_subdivision"])
def pieces(results):
    rows = [[scene(figure["workload"]), row["longest_edge"], f"{row['pieces']:,}", f"{row['members']:,}",
             f"{row['box_overlaps']:,}", ms(row["until_sweep"])]
            for figure in results.study("virtual_subdivision") for row in figure["rows"]]
    return table(["scene", "longest edge", "pieces", "members", "box overlaps", "time up to `sweep`"], rows)


@block("pairs")
def pairs(results, sequence, *frames):
    """Makes a table of the numbers of colliding pairs in some frames of a sequence."""
    found = results.sequences().get(sequence)
    if not found:
        return ""
    counts = dict(zip(found["frames"], found["pairs"]))
    return table(["frame", *frames], [["pairs", *(f"{counts[int(frame)]:,}" for frame in frames)]])


@block("simulated")
def simulated(results):
    """Makes a table of the simulated sequences: numbers of frames and triangles, and the most colliding pairs of a frame."""
    known = results.sequences()
    found = [known[name] for name in ("cloth_on_ball", "funnel", "cutting") if name in known]
    rows = [[scene(s["sequence"]), len(s["frames"]), span(s["triangles"]), f"{max(s['pairs']):,}"] for s in found]
    return table(["scene", "frames", "triangles", "most colliding pairs"], rows)
