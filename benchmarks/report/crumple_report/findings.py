"""What the figures say: a table, a paragraph, or both for each section; an empty string where nothing was measured.

Sentences are written so that they hold whatever the numbers are; the numbers decide which scene is named.
"""

from statistics import mean, median

from .fit import explained, fitted
from .results import digits, scene
from .tables import table

FINDINGS = {}


def finding(function):
    FINDINGS[function.__name__] = function
    return function


def ms(summary):
    return f"{digits(summary['median'])} ms"


def spread(summary):
    return f"{digits(summary['median'])} ({digits(summary['lower_quartile'])} to {digits(summary['upper_quartile'])})"


def percent(share):
    return f"{digits(100 * share)} %"


def extremes(values, form="{:.1f}"):
    """Of (number, name) pairs: "a (name) to b (name)", or one of them if there is only one."""
    low, high = (f"{form.format(number)} ({name})" for number, name in (min(values), max(values)))
    return low if len(values) == 1 else f"{low} to {high}"


def span(values, unit=""):
    """"a to b", or one of them if they read the same."""
    low, high = digits(min(values)), digits(max(values))
    return f"{low}{unit}" if low == high else f"{low}{unit} to {high}{unit}"


@finding
def peers(results):
    entries = results.data.get("peers")
    if not entries:
        return ""
    here = [[p["name"], p["version"], p["scalar"], p["threads"], p["computes"]] for p in entries if "version" in p]
    text = table(["peer", "version", "coordinates", "threads", "computes"], here)
    absent = [f"{p['name']} ({p['left_out']})" for p in entries if "left_out" in p]
    return text + (f"\n\nLeft out: {'; '.join(absent)}." if absent else "")


def stops_at_boxes(results, question, name):
    """Whether a peer stops at boxes."""
    return any("boxes" in way["computes"] for _, way in results.fastest(question, name).values())


def contest_table(results, question):
    ours = results.fastest(question, "crumple")
    if not ours:
        return ""
    rows = []
    for workload, (contest, way) in ours.items():
        size = f"{contest['triangles']:,}" + (f", {contest['pairs']:,} pairs" if question != "any" else "")
        rows.append([f"**{scene(workload)}** ({size})", "Crumple", way["way"], way["computes"], spread(way["milliseconds"]), "", "", ""])
        for name in results.peers(question):
            found = results.fastest(question, name).get(workload)
            if not found:
                continue
            other = found[1]
            rows.append(["", " ".join(filter(None, [name, results.version(name)])), other["way"], other["computes"],
                         spread(other["milliseconds"]), f"{other['ratio']['median']:.1f}x",
                         *(f"{other[key]:,}" if key in other else "" for key in ("missing", "extra"))])
    text = table(["scene", "", "fastest way", "computes", "ms", "times Crumple", "missing", "extra"], rows)

    kinds = {}
    for name in results.peers(question):
        kind = "built" if "built" in name else "boxes" if stops_at_boxes(results, question, name) else "whole"
        for workload, (_, other) in results.fastest(question, name).items():
            kinds.setdefault(kind, {}).setdefault(workload, []).append((other["ratio"]["median"], name))
    sentences = []
    for kind, what in (("whole", "that tests triangles and is given nothing beforehand"),
                       ("built", "whose trees were built beforehand"), ("boxes", "that stops at boxes")):
        if kind in kinds:
            nearest = [(min(entries), scene(workload)) for workload, entries in kinds[kind].items()]
            times = extremes([(ratio, f"{name}, {workload}") for (ratio, name), workload in nearest])
            sentences.append(f"The fastest peer {what} takes {times} times as long as Crumple.")
    lossy = sorted({name for name in results.peers(question) for _, way in results.fastest(question, name).values()
                    if way.get("missing")})
    if lossy:
        sentences.append("Pairs are missing from the answers of " + ", ".join(lossy) + (
            ", which leave neighbours out." if all("IPC" in name for name in lossy) else "."))
    return text + "\n\n" + " ".join([*sentences, *absences(results, question)])


def absences(results, question):
    """Who did not race on which scene, and why."""
    contests = [contest for contest in results.data["contests"] if contest["question"] == question]
    sentences = []
    for contest in contests:
        by_reason = {}
        for name, reason in contest.get("left_out", {}).items():
            by_reason.setdefault(reason, []).append(name)
        if by_reason:
            who = "; ".join(f"{', '.join(names)} ({reason})" for reason, names in by_reason.items())
            sentences.append(f"Left out of {scene(contest['workload'])}: {who}.")
    elsewhere = {contest["workload"] for contest in contests if not results.in_one_process(contest)}
    for workload, (contest, _) in results.fastest(question, "crumple").items():
        boxes = [contest["pairs"] + way["extra"] for way in contest["contestants"]
                 if "boxes" in way["computes"] and "extra" in way]
        if elsewhere and boxes and workload not in elsewhere:
            sentences.append(f"Peers from PyPI did not race on {scene(workload)} in this run: several would return each of its "
                             f"{max(boxes):,} overlapping boxes as a Python object.")
    return sentences


for _question in ("self", "between", "any"):
    FINDINGS[_question] = lambda results, question=_question: contest_table(results, question)


def mean_of_sequence(results, name, kind="warm, all threads"):
    """Milliseconds, or nothing if the sequence was not measured."""
    sequence = results.sequences().get(name)
    return digits(mean(sequence["kinds"][kind]["milliseconds"])) if sequence else ""


@finding
def paper(results):
    """Each figure of [MZ]: what it shows, the command that makes ours, and where ours stands."""
    benchmark, pictures = "crumple_benchmark --study {}", "scripts/report.sh --pictures"
    averages = "; ".join(f"{scene(name)} {time} ms ([MZ] on a GTX 480: {published} ms)"
                         for name, published in (("cloth_on_ball", 20.24), ("funnel", 6.53))
                         if (time := mean_of_sequence(results, name)))
    one_thread = "; ".join(f"{scene(name)} {time} ms" for name in ("cloth_on_ball", "funnel")
                           if (time := mean_of_sequence(results, name, "warm")))
    rows = [
        ["fig. 1", "the sweep direction by PCA", benchmark.format("axes"), "[the sweep direction](#the-sweep-direction)"],
        ["fig. 2", "prefix sums predict the work", benchmark.format("two_clusters"),
         "[the prefix sum's prediction](#the-prefix-sums-prediction)"],
        ["fig. 3", "objects in two clusters and in sixteen", pictures, "[clusters](#clusters)"],
        ["fig. 4", "why clusters overlap", benchmark.format("membership"), "[membership](#membership)"],
        ["fig. 5", "frames of Cloth on Ball and of Funnel", pictures, "[sequences](#sequences)"],
        ["fig. 6", "mean time of a frame", benchmark.format("sequences") + " --scene cloth_on_ball",
         f"[on all threads](#sequences): {averages}" if averages else "[sequences](#sequences)"],
        ["figs. 7, 8", "time of each stage, frame by frame", benchmark.format("sequences") + " --scene funnel",
         "[by stage](#time-per-frame-by-stage)" + (f", on one thread: {one_thread}" if one_thread else "")],
        ["sec. 6.1", "two clusters, or four", benchmark.format("two_clusters"), "[two clusters](#two-clusters)"],
    ]
    return (table(["[MZ]", "what it shows", "command", "ours"], [[a, b, f"`{c}`", d] for a, b, c, d in rows]) +
            "\n\n[MZ] has no tables. `scripts/bench.sh`, which measures all of this page in some 25 minutes on two cores, builds "
            "`crumple_benchmark` in `build-bench/benchmarks/`.")


@finding
def published(results):
    found = [s for name, s in results.sequences().items() if name in ("cloth_on_ball", "funnel")]
    if not found:
        return "Crumple and peers here: single frames of the UNC animations that [MZ] measured whole, on this machine."
    peers = " and ".join(f"{len(s['peer_frames'])} frames of {scene(s['sequence'])}" for s in found)
    return ("Solid bars are not the same scenes: [MZ] measured UNC's animations, of which few frames are to be had; here are this project's "
            f"simulations of the same story and about the same size ([scenes](scenes.md)). Crumple is averaged over all frames, peers over "
            f"{peers}; ratios on the same frames are under [Sequences](#sequences).")


def cuda_frames(cuda):
    measured = cuda["scenes"] + cuda.get("growth", {}).get("sizes", [])
    rows = [[scene(row["scene"]), f"{row['triangles']:,}", f"{row['counts']['pairs']:,}", spread(row["device"]),
             ms(row["device_and_wait"]), ms(row["from_and_to_host"]), ms(row["cpu_all_threads"]),
             f"{row['counts']['double_tests']:,}"] for row in measured]
    device, growth = cuda["device"], cuda.get("growth", {})
    text = (f"{device['name']}, CUDA {cuda['cuda_runtime'] // 1000}, commit `{cuda['commit'][:12]}`, "
            f"medians of {cuda['frames']} frames.\n\n" +
            table(["scene", "triangles", "pairs", "device to device, ms", "with `wait`", "host to host", "cpu backend",
                   "pairs that reach float64"], rows))
    if "exponent" in growth:
        text += f"\n\nFrom 200,000 triangles on, time grows as triangles^{growth['exponent']:.3f}."
    return text


def cuda_bounds(cuda):
    """Microseconds of each stage beside what bandwidth and launches allow: of each scene, and of the largest cloth."""
    limits, rows = cuda["limits"], []
    for figure in cuda["scenes"] + cuda.get("growth", {}).get("sizes", [])[-1:]:
        for i, row in enumerate(figure["bounds"]):
            rows.append([f"**{scene(figure['scene'])}**" if i == 0 else "", row["stage"],
                         digits(1e3 * row["milliseconds"]), digits(row["bytes"] / 1e6),
                         digits(1e3 * row["by_bandwidth_milliseconds"]), row["nodes"],
                         digits(1e3 * row["by_launches_milliseconds"]), digits(row["ratio"])])
    bandwidth = limits["peak_bytes_a_second"] or limits["copied_bytes_a_second"]
    return (table(["scene", "stage", "µs", "MB", "µs by bandwidth", "nodes", "µs by launches", "ratio"], rows) +
            f"\n\nBounds ([cuda](cuda.md) says how they are made) at {digits(bandwidth / 1e9)} GB/s and "
            f"{digits(1e3 * limits['node_milliseconds'])} µs a node of a graph. A stage is measured without the graph, where a "
            f"launch takes {digits(1e3 * limits['launch_milliseconds'])} µs; `frame` is the graph.")


def cuda_race(contests):
    rows = []
    for contest in contests:
        for way in contest["contestants"]:
            if way["fastest_way"]:
                ratio = f"{way['ratio']['median']:.1f}x" if "ratio" in way else ""
                rows.append([scene(contest["workload"]), way["name"], way["computes"], spread(way["milliseconds"]),
                             ratio, *(f"{way[key]:,}" if key in way else "" for key in ("missing", "extra"))])
    return table(["scene", "", "computes", "ms", "times Crumple", "missing", "extra"], rows)


@finding
def cuda(results):
    if not results.cuda:
        return ""
    parts = [cuda_frames(results.cuda)]
    if results.cuda.get("limits") and results.cuda["scenes"]:
        parts.append(cuda_bounds(results.cuda))
    if results.cuda_peers:
        parts += ["On the same device, taking turns, by the host's clock:", cuda_race(results.cuda_peers["contests"])]
    return "\n\n".join(parts)


@finding
def scenes(results):
    figures = results.study("scenes")
    if not figures:
        return ""
    rows = []
    for figure in figures:
        for i, way in enumerate(figure["ways"]):
            rows.append([f"**{scene(figure['workload'])}** ({figure['question']}, {figure['scalar']}, {figure['triangles']:,})" if i == 0 else "",
                         way["backend"], way["simd"], way["threads"], spread(way["warm"]), digits(way["warm"]["percentile_99"]),
                         spread(way["cold"]), f"{way['peak_bytes'] / 2**20:.1f}" if way["peak_bytes"] else ""])
    text = table(["scene", "backend", "instructions", "threads", "warm, ms", "99th percentile", "cold, ms", "peak, MiB"], rows)
    gains = []
    for figure in figures:
        ways = {(way["simd"], way["threads"]): way["warm"]["median"] for way in figure["ways"]}
        gains += [ways["AVX2", t] / time for (simd, t), time in ways.items() if simd == "AVX-512" and ("AVX2", t) in ways]
    if gains:
        text += f"\n\nWith AVX2 alone a warm call takes {span(gains)} times as long as with AVX-512."
    return text


@finding
def sequences(results):
    figures = results.study("sequences")
    if not figures:
        return ""
    rows = []
    peaks = any("peak_bytes" in kind for s in figures for kind in s["kinds"].values())
    ratios = {"CGAL": [], "Embree": []}
    for s in figures:
        ours = dict(zip(s["frames"], s["kinds"]["warm, all threads"]["milliseconds"]))
        ours = mean([ours[frame] for frame in s["peer_frames"]])
        first = f"**{scene(s['sequence'])}** ({len(s['frames'])} frames, {max(s['triangles']):,} triangles, up to {max(s['pairs']):,} pairs)"
        for kind, label in (("warm, all threads", "Crumple, all threads"), ("warm", "Crumple, 1 thread"),
                            ("new, all threads", "Crumple, a new detector in each frame")):
            run = s["kinds"][kind]
            rows.append([first, label, "exact pairs, sorted", digits(mean(run["milliseconds"])), spread(run["summary"]),
                         digits(run["summary"]["percentile_99"]), ""])
            if peaks:
                rows[-1].append(f"{run['peak_bytes'] / 2**20:.1f}" if "peak_bytes" in run else "")
            first = ""
        for p in s["peers"]:
            ratio = mean(p["milliseconds"]) / ours
            ratios.get(p["name"], []).append(ratio)
            rows.append(["", f"{p['name']}, {p['way']}", p["computes"], digits(mean(p["milliseconds"])),
                         spread(p["summary"]), digits(p["summary"]["percentile_99"]), f"{ratio:.1f}x", *[""] * peaks])
    text = table(["sequence", "", "computes", "mean, ms", "median (quartiles), ms", "99th percentile, ms",
                  "same frames", *["peak, MiB"] * peaks], rows)
    text += "\n\n*Same frames*: a peer's mean over that of Crumple on all threads, in the frames that the peer answers."
    for name, of_sequences in ratios.items():
        if of_sequences:
            text += f" {name} takes {span(of_sequences)} times as long, {mean(of_sequences):.1f} times on average."
    return text


COUNTS = {"interval_tests": "interval tests", "box_overlaps": "box overlaps", "edge_tests": "edge tests",
          "double_tests": "float64 tests", "exact_tests": "exact tests"}


def explained_by_counts(found):
    """Of sequences with counts of each frame: what their slowest frames have more of, and what no count explains."""
    rows, shares, above = [], [], []
    for s in found:
        warm, times = s["kinds"]["warm"], s["kinds"]["warm"]["milliseconds"]
        columns = {name: warm["counts"][name] for name in COUNTS if name in warm["counts"]}
        predicted = fitted(times, [s["triangles"], *columns.values()])
        shares.append(100 * explained(times, predicted))
        excess, frame = max((t / p, frame) for t, p, frame in zip(times, predicted, s["frames"]))
        above.append((excess, f"{scene(s['sequence'])}, frame {frame}"))
        slowest = times.index(max(times))
        ratios = [f"{values[slowest] / median(values):.2f}" if median(values) else ""
                  for values in (times, *map(columns.get, COUNTS))]
        rows.append([scene(s["sequence"]), s["frames"][slowest], *ratios,
                     f"{shares[-1]:.1f} %", f"{excess:.2f} (frame {frame})"])
    return ("The slowest frame of each sequence, beside the median of all its frames; how much of the times' variance a linear function "
            "of these counts and of the triangles explains; and the frame that takes longest beside what that function predicts.\n\n" +
            table(["sequence", "slowest frame", "time", *COUNTS.values(), "explained", "longest / predicted"], rows) +
            f"\n\nCounts explain {span(shares, ' %')} of the variance; no frame takes more than {max(above)[0]:.2f} times what its "
            f"counts predict ({max(above)[1]}).")


@finding
def stages(results):
    found = list(results.sequences().values())
    if not found:
        return ""
    sums = [sum(map(sum, warm["stages"].values())) / sum(warm["milliseconds"])
            for warm in (s["kinds"]["warm"] for s in found)]
    text = (f"The stages' times add up to {span([100 * share for share in sums], ' %')} of the call's, each a median of its own; the rest "
            "is spent between stages.")
    counted = [s for s in found if "counts" in s["kinds"]["warm"]]
    return f"{text}\n\n{explained_by_counts(counted)}" if counted else text


@finding
def warm_start(results):
    found = [s for s in results.sequences().values() if "cold" in s["kinds"]]
    if not found:
        return ""
    rows = []
    for s in found:
        for i, kind in enumerate(("warm", "cold", "fixed")):
            run = s["kinds"][kind]
            rows.append([scene(s["sequence"]) if i == 0 else "", kind, digits(mean(run["stages"]["subdivide"])), spread(run["summary"]),
                         f"{run['members']:,.0f}", f"{run['candidates']:,.0f}"])
    gain = [mean(s["kinds"]["cold"]["milliseconds"]) / mean(s["kinds"]["warm"]["milliseconds"]) for s in found]
    still = [mean(s["kinds"]["fixed"]["milliseconds"]) / mean(s["kinds"]["warm"]["milliseconds"]) for s in found]
    return (table(["sequence", "centres", "subdivide, ms", "call, ms", "members", "candidates"], rows) +
            f"\n\nOver whole sequences a call with cold centres takes {span(gain)} times as long as a warm one; with centres that never "
            f"move it takes {span(still)} times as long.")


@finding
def growth(results):
    figures = results.study("growth")
    if not figures:
        return ""
    sizes = figures["sizes"]
    rows = [[f"{s['triangles']:,.0f}", f"{s['pairs']:,}", spread(s["one_thread"]), spread(s["all_threads"]),
             digits(1e6 * s["all_threads"]["median"] / s["triangles"]), digits(s["bytes_a_triangle"])] for s in sizes]
    return (table(["triangles", "pairs", "one thread, ms", "all threads, ms", "ns a triangle", "bytes a triangle"], rows) +
            f"\n\nTime grows as triangles to the power {figures['exponent_one_thread']:.2f} on one thread and "
            f"{figures['exponent_all_threads']:.2f} on all. From {sizes[0]['triangles']:,.0f} to {sizes[-1]['triangles']:,.0f} triangles the "
            f"detector's memory falls from {digits(sizes[0]['bytes_a_triangle'])} to {digits(sizes[-1]['bytes_a_triangle'])} bytes a triangle.")


@finding
def threads(results):
    figures = results.study("threads")
    if not figures:
        return ""
    gains = [(row["values"][0]["milliseconds"]["median"] / row["values"][-1]["milliseconds"]["median"], scene(row["workload"]))
             for row in figures]
    count = str(figures[0]["values"][-1]["value"]).removesuffix(" (default)")
    return f"On {count} threads a call is {extremes(gains, '{:.2f}')} times as fast as on one."


@finding
def parts(results):
    figures = results.study("parts")
    if not figures:
        return ""
    rows = []
    for row in figures:
        for i, size in enumerate(row["counts"]):
            rows.append([scene(row["workload"]) if i == 0 else "", size["parts"], digits(size["partition"]),
                         f"{size['members'] / row['triangles']:.2f}", f"{size['most_members'] * size['parts'] / size['members']:.2f}",
                         *(digits(size[kind][value]) for kind in ("alone", "owning") for value in ("inflation", "most_speed_up"))])
    best = [max((size["alone"]["most_speed_up"], size["parts"]) for size in row["counts"]) for row in figures]
    own = [max((size["owning"]["most_speed_up"], size["parts"]) for size in row["counts"]) for row in figures]
    sentences = [f"{scene(row['workload'])}: at most {digits(b[0])} times as fast on {b[1]} machines that hold a mesh of their own, "
                 f"{digits(o[0])} times on {o[1]} that read the whole one." for row, b, o in zip(figures, best, own)]
    return (table(["scene", "parts", "partition, ms", "members / triangles", "largest part / mean", "own mesh: sum / whole", "speed-up at most",
                   "whole mesh read: sum / whole", "speed-up at most"], rows) + "\n\n" + " ".join(sentences) +
            " Cutting the scene, sending it and joining the answers are not in these numbers.")


@finding
def axes(results):
    figures = results.study("axes")
    if not figures:
        return ""
    rows, gain, turned, third = [], [], [], []
    for figure in figures:
        ways = {way["direction"]: way for way in figure["ways"]}
        fixed = min((ways[axis] for axis in "xyz"), key=lambda way: way["milliseconds"]["median"])
        pca, edges, two = ways["PCA"], ways["PCA, turned to edges"], ways["PCA, two axes"]
        rows.append([scene(figure["workload"]), figure["parts"], f"{pca['interval_overlaps']:,}", f"{pca['false_positives']:,}",
                     f"{pca['interval_overlaps'] / fixed['interval_overlaps']:.2f}",
                     f"{pca['false_positives'] / max(1, fixed['false_positives']):.2f}",
                     f"{pca['milliseconds']['median'] / fixed['milliseconds']['median']:.2f}",
                     f"{edges['false_positives'] / max(1, pca['false_positives']):.2f}",
                     f"{edges['milliseconds']['median'] / pca['milliseconds']['median']:.2f}",
                     f"{two['false_positives'] / max(1, pca['false_positives']):.1f}",
                     f"{two['milliseconds']['median'] / pca['milliseconds']['median']:.2f}"])
        gain.append((pca["milliseconds"]["median"] / fixed["milliseconds"]["median"], f"{scene(figure['workload'])}, {figure['parts']} part{'s' * (figure['parts'] > 1)}"))
        turned.append(edges["false_positives"] / max(1, pca["false_positives"]))
        third.append(two["false_positives"] / max(1, pca["false_positives"]))
    return (table(["scene", "parts", "PCA: intervals", "false positives", "intervals / best fixed axis", "false positives / best", "time / best",
                   "turned to edges: false positives / PCA", "time / PCA", "two axes: false positives / three", "time / three"], rows) +
            f"\n\nThe best fixed axis is known only afterwards. Against it, principal components take "
            f"{extremes(gain, '{:.2f}')} times as long. Turning y and z about the first "
            f"one so that edges lie along them multiplies false positives by {span(turned)}, leaving out the third axis by {span(third)}.")


@finding
def membership(results):
    figures = results.study("membership")
    if not figures:
        return ""
    rows, losers, cost = [], {}, {}
    for figure in figures:
        for i, rule in enumerate(figure["rules"]):
            first = f"{scene(figure['workload'])}, {figure['clusters']} clusters ({figure['pairs']:,} pairs)"
            rows.append([first if i == 0 else "", rule["rule"], percent(rule["members_added"] / figure["triangles"]),
                         spread(rule["milliseconds"]), f"{rule['relative']['median']:.2f}", f"{rule['pairs_lost']:,}"])
            if rule["pairs_lost"]:
                losers.setdefault(rule["rule"], []).append(rule["pairs_lost"] / figure["pairs"])
            cost.setdefault(rule["rule"], []).append(rule["relative"]["median"])
    lost = "; ".join(f"*{rule}* loses up to {percent(max(shares))} of a scene's pairs" for rule, shares in losers.items())
    safe = [rule for rule in cost if rule not in losers and rule != "bisector"]
    kept = "; ".join(f"*{rule}* {span(cost[rule])} times" for rule in safe)
    return (table(["scene", "rule", "members added", "all parts, ms", "times bisector", "pairs lost"], rows) + f"\n\n{lost[:1].upper() + lost[1:]}. "
            f"None lost here, and time relative to *bisector*: {kept}. Only *eq. 5, R each side*, *local 2r* and *bisector* are proven to lose none "
            "([subdivide](subdivide.md)).")


@finding
def two_clusters(results):
    figures = results.study("two_clusters")
    if not figures:
        return ""
    rows, gain = [], []
    for figure in figures:
        base = figure["cuts"][0]
        for i, cut in enumerate(figure["cuts"]):
            rows.append([scene(figure["workload"]) if i == 0 else "", cut["cut"], cut["leaves"], f"{cut['members']:,}",
                         f"{cut['interval_overlaps']:,}", f"{cut['candidates']:,}", spread(cut["one_thread"]), spread(cut["all_threads"])])
            if cut["cut"] == "2 whole":
                gain.append((cut["all_threads"]["median"] / base["all_threads"]["median"], scene(figure["workload"])))
    return (table(["scene", "cut", "leaves", "members", "overlapping intervals", "candidates", "one thread, ms", "all threads, ms"], rows) +
            f"\n\nOn all threads two whole clusters take {extremes(gain, '{:.2f}')} times as long as leaves.")


@finding
def memory(results):
    figures = results.study("two_clusters")
    if not figures:
        return ""
    ratios = []
    for figure in figures:
        cuts_ = {cut["cut"]: cut for cut in figure["cuts"]}
        ratios.append((cuts_["2 whole"]["predicted_bytes"] / cuts_["leaves (default)"]["peak_bytes"], scene(figure["workload"])))
    survive = [cut["pairs"] / cut["interval_overlaps"] for figure in figures for cut in figure["cuts"] if cut["cut"] == "2 whole"]
    return (f"With two clusters the predicted list alone would take {extremes(ratios)} times what the detector owns at most, result "
            f"included; {span([100 * s for s in survive], ' %')} of its entries collide.")


def option(results, study):
    """Of each scene: the best and the worst value against the default."""
    rows = []
    for figure in results.study(study):
        best = min(figure["values"], key=lambda value: value["relative"]["median"])
        worst = max(figure["values"], key=lambda value: value["relative"]["median"])
        rows.append([scene(figure["workload"])])
        for value in (best, worst):
            rows[-1] += [value["value"], f"{value['relative']['median']:.2f}"]
    return table(["scene", "best value", "time / default's", "worst value", "time / default's"], rows) if rows else ""


def what_to_lose(results, study, what):
    """What the default, the worst value and the safest one cost, beside the best value of each scene."""
    costs = {}
    for figure in results.study(study):
        best = min(value["relative"]["median"] for value in figure["values"])
        for value in figure["values"]:
            cost = value["relative"]["median"] / best
            costs.setdefault(str(value["value"]), []).append((cost, scene(figure["workload"])))
    at_worst = {value: max(entries) for value, entries in costs.items()}
    default = next(value for value in costs if value.endswith(" (default)"))
    worst, safest = max(at_worst, key=at_worst.get), min(at_worst, key=at_worst.get)
    text = (f"{what}: beside the best value of each scene the default takes {extremes(costs[default], '{:.2f}')} times as long, the "
            f"worst, {worst}, up to {at_worst[worst][0]:.2f} times ({at_worst[worst][1]}). ")
    if safest == default:
        return text + "No other value has less to lose."
    return text + f"Least to lose has {safest}: {at_worst[safest][0]:.2f} times at most ({at_worst[safest][1]})."


@finding
def cuts(results):
    clusters, leaves = option(results, "clusters"), option(results, "leaf_size")
    if not (clusters and leaves):
        return ""
    return (f"Clusters:\n\n{clusters}\n\nTriangles a leaf:\n\n{leaves}\n\n{what_to_lose(results, 'clusters', 'Clusters')} "
            f"{what_to_lose(results, 'leaf_size', 'Triangles a leaf')} Every value is in [options](options.md).")


@finding
def fuzziness(results):
    values = option(results, "fuzziness")
    return f"{values}\n\n{what_to_lose(results, 'fuzziness', 't')} Every value is in [options](options.md)." if values else ""
