"""Tables of docs/benchmarks_tables.md: all measurements that are in no shorter table."""

from statistics import mean

from .blocks import beside_median, block, mebibytes, ms, percent, spread, table
from .device_tables import device_scene, measured_on_device
from .results import STAGES, digits, scene
from .tables import best_fixed_axis


@block("peers")
def peers(results):
    entries = results.data.get("peers", [])
    rows = [[p["name"], p["version"], p["scalar"], p["threads"], p["computes"]] if "version" in p
            else [p["name"], "", "", "", f"left out: {p['left_out']}"] for p in entries]
    return table(["peer", "version", "coordinates", "threads", "computes"], rows)


def every_peer(results, question):
    """Makes a row for crumple, for each peer in its fastest configuration, and for each peer that was left out."""
    rows = []
    for workload, (race, way) in results.fastest(question, "crumple").items():
        size = f"{race['triangles']:,}" + (f", {race['pairs']:,} pairs" if question != "any" else "")
        rows.append([f"**{scene(workload)}** ({size})", "Crumple", way["way"], way["computes"], spread(way["milliseconds"]), "", "", ""])
        for name in results.peers(question):
            found = results.fastest(question, name).get(workload)
            if not found:
                continue
            other = found[1]
            rows.append(["", " ".join(filter(None, [name, results.version(name)])), other["way"], other["computes"],
                         spread(other["milliseconds"]), f"{other['ratio']['median']:.1f}x",
                         *(f"{other[key]:,}" if key in other else "" for key in ("missing", "extra"))])
        for race in results.data["contests"]:
            if (race["workload"], race["question"]) == (workload, question):
                rows += [["", name, "", f"left out: {reason}", "", "", "", ""] for name, reason in race.get("left_out", {}).items()]
    return table(["scene", "", "fastest way", "computes", "ms", "times Crumple", "missing", "extra"], rows)


for _question in ("self", "between", "any"):
    block(f"all {_question}", _question)(lambda results, question=_question: every_peer(results, question))


@block("scenes", studies=["scenes"])
def scenes(results):
    rows = []
    for figure in results.study("scenes"):
        first = f"**{scene(figure['workload'])}** ({figure['question']}, {figure['scalar']}, {figure['triangles']:,})"
        for way in figure["ways"]:
            rows.append([first, way["backend"], way["simd"], way["threads"], spread(way["warm"]), digits(way["warm"]["percentile_99"]),
                         spread(way["cold"]), mebibytes(way["peak_bytes"]) if way["peak_bytes"] else ""])
            first = ""
    return table(["scene", "backend", "instructions", "threads", "warm, ms", "99th percentile", "cold, ms", "peak, MiB"], rows)


@block("all sequences", studies=["sequences"])
def sequences(results):
    rows = []
    for s in results.sequences(1).values():
        ours = dict(zip(s["frames"], s["kinds"]["warm, all threads"]["milliseconds"]))
        ours = mean(ours[frame] for frame in s["peer_frames"])
        first = (f"**{scene(s['sequence'])}** ({len(s['frames'])} frames, {max(s['triangles']):,} triangles, "
                 f"up to {max(s['pairs']):,} pairs)")
        for kind, label in (("warm, all threads", "Crumple, all threads"), ("warm", "Crumple, 1 thread"),
                            ("new, all threads", "Crumple, a new detector in each frame")):
            run = s["kinds"][kind]
            rows.append([first, label, "exact pairs, sorted", digits(mean(run["milliseconds"])), spread(run["summary"]),
                         digits(run["summary"]["percentile_99"]), "", mebibytes(run["peak_bytes"])])
            first = ""
        for p in s["peers"]:
            rows.append(["", f"{p['name']}, {p['way']}", p["computes"], digits(mean(p["milliseconds"])), spread(p["summary"]),
                         digits(p["summary"]["percentile_99"]), f"{mean(p['milliseconds']) / ours:.1f}x", ""])
    return table(["sequence", "", "computes", "mean, ms", "median (quartiles), ms", "99th percentile, ms", "same frames", "peak, MiB"],
                 rows)


@block("slowest frames", studies=["sequences"])
def slowest_frames(results):
    names = {"interval_tests": "interval tests", "box_overlaps": "box overlaps", "edge_tests": "edge tests",
             "double_tests": "float64 tests", "exact_tests": "exact tests"}
    rows = []
    for s in results.sequences().values():
        warm = s["kinds"]["warm"]
        slowest = warm["milliseconds"].index(max(warm["milliseconds"]))
        rows.append([scene(s["sequence"]), s["frames"][slowest], beside_median(warm["milliseconds"], slowest),
                     *(beside_median(warm["counts"][name], slowest) for name in names)])
    return table(["sequence", "slowest frame", "time", *names.values()], rows)


@block("stages", studies=["stages"])
def stages(results):
    rows = [[scene(figure["workload"]), *(digits(figure["milliseconds"][name]) for name in (*STAGES, "total"))]
            for figure in results.study("stages")]
    return table(["ms", *STAGES, "whole call"], rows)


@block("stages of sequences", studies=["sequences"])
def stages_of_sequences(results):
    rows = []
    for s in results.sequences().values():
        warm = s["kinds"]["warm"]
        rows.append([scene(s["sequence"]), *(digits(mean(warm["stages"][stage])) for stage in STAGES),
                     digits(mean(warm["milliseconds"]))])
    return table(["ms", *STAGES, "whole call"], rows)


@block("warm start", studies=["sequences"])
def warm_start(results):
    rows = []
    for s in results.sequences().values():
        for i, kind in enumerate(("warm", "cold", "fixed")):
            run = s["kinds"].get(kind)
            if run:
                rows.append([scene(s["sequence"]) if i == 0 else "", kind, digits(mean(run["stages"]["subdivide"])),
                             digits(mean(run["milliseconds"])), spread(run["summary"]), f"{run['members']:,.0f}",
                             f"{run['candidates']:,.0f}"])
    return table(["sequence", "centres", "subdivide, mean ms", "call, mean ms", "call, ms", "members", "candidates"], rows)


@block("all growth", studies=["growth"])
def growth(results):
    rows = [[f"{s['triangles']:,.0f}", f"{s['pairs']:,}", spread(s["one_thread"]), spread(s["all_threads"]),
             digits(1e6 * s["all_threads"]["median"] / s["triangles"]), digits(s["bytes_a_triangle"])] for s in results.sizes()]
    return table(["triangles", "pairs", "one thread, ms", "all threads, ms", "ns a triangle", "bytes a triangle"], rows)


@block("threads", studies=["threads"])
def threads(results):
    rows = [[scene(figure["workload"]), *(spread(figure["values"][i]["milliseconds"]) for i in (0, -1)),
             f"{figure['values'][0]['milliseconds']['median'] / figure['values'][-1]['milliseconds']['median']:.2f}"]
            for figure in results.study("threads")]
    return table(["scene", "one thread, ms", "all threads, ms", "speed-up"], rows)


@block("parts", studies=["parts"])
def parts(results):
    rows = []
    for row in results.study("parts"):
        for i, size in enumerate(row["counts"]):
            rows.append([scene(row["workload"]) if i == 0 else "", size["parts"], digits(size["partition"]),
                         f"{size['members'] / row['triangles']:.2f}", f"{size['most_members'] * size['parts'] / size['members']:.2f}",
                         *(digits(size[kind][value]) for kind in ("alone", "owning") for value in ("inflation", "most_speed_up"))])
    return table(["scene", "parts", "partition, ms", "members / triangles", "largest part / mean", "own mesh: sum / whole",
                  "speed-up at most", "`find(part)`: sum / whole", "speed-up at most"], rows)


@block("axes", studies=["axes"])
def axes(results):
    rows = []
    for figure in results.study("axes"):
        ways = {way["direction"]: way for way in figure["ways"]}
        fixed, pca, edges, two = best_fixed_axis(ways), ways["PCA"], ways["PCA, turned to edges"], ways["PCA, two axes"]

        def times(way, other):
            return way["milliseconds"]["median"] / other["milliseconds"]["median"]

        def false_positives(way, other):
            return way["false_positives"] / max(1, other["false_positives"])

        rows.append([scene(figure["workload"]), figure["parts"], f"{pca['interval_overlaps']:,}", f"{pca['false_positives']:,}",
                     f"{pca['interval_overlaps'] / fixed['interval_overlaps']:.2f}", f"{false_positives(pca, fixed):.2f}",
                     f"{times(pca, fixed):.2f}", f"{false_positives(edges, pca):.2f}", f"{times(edges, pca):.2f}",
                     f"{false_positives(two, pca):.1f}", f"{times(two, pca):.2f}"])
    return table(["scene", "parts", "PCA: intervals", "false positives", "intervals / best fixed axis", "false positives / best",
                  "time / best", "turned to edges: false positives / PCA", "time / PCA", "two axes: false positives / three",
                  "time / three"], rows)


@block("membership", studies=["membership"])
def membership(results):
    rows = []
    for figure in results.study("membership"):
        first = f"{scene(figure['workload'])}, {figure['clusters']} clusters ({figure['pairs']:,} pairs)"
        for rule in figure["rules"]:
            rows.append([first, rule["rule"], percent(rule["members_added"] / figure["triangles"]),
                         spread(rule["milliseconds"]), f"{rule['relative']['median']:.2f}", f"{rule['pairs_lost']:,}"])
            first = ""
    return table(["scene", "rule", "members added", "all parts, ms", "times bisector", "pairs lost"], rows)


@block("two clusters", studies=["two_clusters"])
def two_clusters(results):
    rows = [[scene(figure["workload"]) if i == 0 else "", cut["cut"], cut["leaves"], f"{cut['members']:,}",
             f"{cut['interval_overlaps']:,}", f"{cut['candidates']:,}", spread(cut["one_thread"]), spread(cut["all_threads"])]
            for figure in results.study("two_clusters") for i, cut in enumerate(figure["cuts"])]
    return table(["scene", "cut", "leaves", "members", "overlapping intervals", "candidates", "one thread, ms", "all threads, ms"], rows)


@block("cuda")
def cuda(results):
    rows = [[device_scene(row), f"{row['triangles']:,}", f"{row['counts']['pairs']:,}", spread(row["device"]),
             ms(row["device_and_wait"]), ms(row["from_and_to_host"]), ms(row["cpu_all_threads"]),
             f"{row['counts']['double_tests']:,}", row["frames"]] for row in measured_on_device(results)]
    return table(["scene", "triangles", "pairs", "device to device, ms", "with `wait`", "host to host",
                  "cpu backend", "pairs that reach float64", "frames"], rows)


@block("cuda bounds")
def cuda_bounds(results):
    """Makes a table of the microseconds of each stage and the bounds by bandwidth and launches."""
    rows = [[device_scene(figure) if i == 0 else "", row["stage"], digits(1e3 * row["milliseconds"]), digits(row["bytes"] / 1e6),
             digits(1e3 * row["by_bandwidth_milliseconds"]), row["nodes"], digits(1e3 * row["by_launches_milliseconds"]),
             digits(row["ratio"])]
            for figure in measured_on_device(results) for i, row in enumerate(figure["bounds"])]
    return table(["scene", "stage", "µs", "MB", "µs by bandwidth", "nodes", "µs by launches", "ratio"], rows)


@block("cuda peers")
def cuda_peers(results):
    contests = (results.cuda_peers or {}).get("contests", [])
    rows = [[scene(contest["workload"]), way["name"], way["computes"], spread(way["milliseconds"]),
             f"{way['ratio']['median']:.1f}x" if "ratio" in way else "",
             *(f"{way[key]:,}" if key in way else "" for key in ("missing", "extra"))]
            for contest in contests for way in contest["contestants"] if way["fastest_way"]]
    return table(["scene", "", "computes", "ms", "times Crumple", "missing", "extra"], rows)
