"""Tables of README.md and docs/cuda.md from the figures of a GPU."""

from .blocks import block, ms, spread, table
from .results import STAGES, digits, scene

# Sizes of the growth curve that are shown along with the scenes; docs/benchmarks_tables.md has all sizes.
LARGE = ("cloth:2000000", "cloth:5000000")
QUESTIONS = {"impacts": "all impacts, exact times", "first impact": "first impact", "near": "near pairs", "candidates": "candidates"}


def measured_on_device(results):
    """Returns the rows of the scenes, then those of the growth curve."""
    return results.cuda["scenes"] + results.cuda["sizes"] if results.cuda else []


def device_scene(row):
    return "procedural cloth" if row["scene"].startswith("cloth:") else scene(row["scene"])


def shown(results):
    return [row for row in measured_on_device(results) if not row["scene"].startswith("cloth:") or row["scene"] in LARGE]


def of_cpu(results):
    return f"cpu backend, {results.machine['cpu_threads']} threads"


def where(results):
    """Returns a line that names the device, driver, compiler and commit of the figures."""
    return (f"{results.cuda['device']['name']}, driver {results.cuda['driver']}, nvcc {results.machine['nvcc']}; commit "
            f"{results.cuda['commit']}.")


def boxes_of_cubql(results):
    """Maps scenes to the time of cuBQL for pairs of boxes, in ms."""
    return {row["scene"]: row["median"] for row in (results.cubql or {"scenes": []})["scenes"]}


@block("cuda short")
def cuda_short(results):
    if not results.cuda:
        return ""
    boxes = boxes_of_cubql(results)
    rows = [[device_scene(row), f"{row['triangles']:,}", f"{row['counts']['pairs']:,} pairs", ms(row["device"]), ms(row["cpu_all_threads"]),
             f"{digits(boxes[row['scene']])} ms" if row["scene"] in boxes else ""]
            for row in shown(results) if row["scene"] != LARGE[1]]
    rows += [[scene(row["step"]), f"{row['triangles']:,}", f"{row['rows']:,} impacts", ms(row["device"]), ms(row["cpu_all_threads"]), ""]
             for row in results.cuda["steps"] if (row["step"], row["question"]) == ("unc_cloth_ball", "impacts")]
    return table(["scene", "triangles", "found", results.cuda["device"]["name"], of_cpu(results),
                  "cuBQL on the H200, boxes only"], rows)


@block("cuda frames")
def cuda_frames(results):
    if not results.cuda:
        return ""
    boxes = boxes_of_cubql(results)

    def beside(row):
        other = boxes.get(row["scene"])
        return f"{digits(other)} ({other / row['device_and_wait']['median']:.1f}x)" if other else ""

    rows = [[device_scene(row), f"{row['triangles']:,}", f"{row['counts']['pairs']:,}", spread(row["device"]),
             *(digits(row[kind]["median"]) for kind in ("device_and_wait", "from_and_to_host")), digits(row["first_milliseconds"]),
             digits(row["cpu_all_threads"]["median"]), beside(row)] for row in shown(results)]
    return where(results) + "\n\n" + table(["ms", "triangles", "pairs", "device", "with `wait`", "host to host", "first call",
                                           of_cpu(results), "cuBQL, boxes only (times `wait`)"], rows)


@block("cuda steps")
def cuda_steps(results):
    if not results.cuda:
        return ""
    rows, last = [], None
    for row in results.cuda["steps"]:
        rows.append([device_step(row["step"]) if row["step"] != last else "", QUESTIONS[row["question"]],
                     f"{row['rows']:,}" if row["question"] != "first impact" else "",
                     spread(row["device"]), digits(row["device_and_wait"]["median"]), digits(row["first_milliseconds"]),
                     digits(row["cpu_all_threads"]["median"])])
        last = row["step"]
    return table(["ms", "query", "rows", "device", "with `wait`", "first call", of_cpu(results)], rows)


def device_step(name):
    return "305 bodies, frames 18 and 19" if name == "unc_n_body" else scene(name)


@block("cuda worlds")
def cuda_worlds(results):
    if not results.cuda:
        return ""
    rows = [[row["wants"], f"{row['worlds']:,}", f"{row['triangles']:,}", f"{row['worlds_hit']:,}",
             f"{row['pairs']:,}" if row["wants"] == "pairs" else "", spread(row["on_device"]),
             digits(row["from_and_to_host"]["median"]), digits(row["first_milliseconds"]), digits(row["cpu_all_threads"])]
            for row in results.cuda["worlds"]]
    return table(["ms", "worlds", "triangles", "worlds hit", "pairs", "step on poses of the device", "host to host", "first call",
                  of_cpu(results)], rows)


@block("cuda limits")
def cuda_limits(results):
    if not results.cuda:
        return ""
    limits = results.cuda["limits"]
    rows = [["memory: peak by clock and bus width", f"{digits(limits['peak_bytes_a_second'] / 1e12)} TB/s"],
            ["memory: what a copy reaches", f"{digits(limits['copied_bytes_a_second'] / 1e12)} TB/s"],
            ["one more node in a chain of a graph", f"{digits(1e3 * limits['node_milliseconds'])} µs"],
            ["a graph of one node", f"{digits(1e3 * limits['graph_milliseconds'])} µs"],
            ["one more launch on a stream", f"{digits(1e3 * limits['launch_milliseconds'])} µs"]]
    return table(["limit", "measured"], rows)


@block("cuda stages")
def cuda_stages(results):
    if not results.cuda:
        return ""
    rows = [[device_scene(row), f"{row['triangles']:,}", *(digits(1e3 * row["stages"][stage]["median"]) for stage in STAGES),
             digits(1e3 * row["device"]["median"])] for row in shown(results)]
    return table(["µs", "triangles", *STAGES, "frame"], rows)
