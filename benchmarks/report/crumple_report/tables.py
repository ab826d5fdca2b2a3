"""Tables in Markdown, and the blocks of README.md and docs/ that show them.

A block stands between `<!-- figures: NAME -->` and `<!-- end -->`, so that no figure is typed.
"""

from .results import TOP, Results, digits, scene

# The study of a block, where its name is another.
STUDIES = {"first call": "first_call", "box overlaps": "cost_per_box_overlap", "pieces": "virtual_subdivision"}

PAGES = [TOP / "README.md", *sorted((TOP / "docs").glob("*.md"))]


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows])


def span(counts):
    """The least and the greatest, or one of them if they are the same."""
    low, high = f"{min(counts):,}", f"{max(counts):,}"
    return low if low == high else f"{low} to {high}"


def stage_names():
    """[MZ] figs. 7 and 8 beside ours."""
    return table(["[MZ] figs. 7 and 8", "here"], [
        ["Clustering and PCA", "`bounds` (centroids and radii), `subdivide`, and the frame of `align`"],
        ["Compute AABBs", "the boxes of `align`"],
        ["Sort AABBs", "`sort`"],
        ["Collect overlapping intervals", "`sweep`"],
        ["Tri-Tri intersection", "`narrow`"],
        ["", "`output`: the sorted list, offsets and flags"],
    ])


class Tables(Results):
    def contest(self, question, peers):
        """A row for each workload: crumple's time, then each peer's and its ratio."""
        ours = self.fastest(question, "crumple")
        theirs = {title: self.fastest(question, name) for name, title in peers.items() if name in self.peers(question)}
        rows = []
        for workload, (contest, way) in ours.items():
            cells = [scene(workload), f"{contest['triangles']:,}"]
            if question != "any":
                cells.append(f"{contest['pairs']:,}")
            cells.append(f"{digits(way['milliseconds']['median'])} ms")
            for peer in theirs.values():
                if workload in peer:
                    other = peer[workload][1]
                    cells.append(f"{digits(other['milliseconds']['median'])} ms ({other['ratio']['median']:.1f}x)")
                else:
                    cells.append("")
            rows.append(cells)
        counts = ["triangles"] if question == "any" else ["triangles", "pairs"]
        return table(["scene", *counts, "Crumple", *theirs], rows)

    def named(self, peer, otherwise):
        """With the first two numbers of its version; older results do not have it."""
        version = self.version(peer)
        return f"{peer} {'.'.join(version.split('.')[:2])}" if version else otherwise

    def self_contest(self):
        return self.contest("self", {"CGAL": self.named("CGAL", "CGAL 5.5") + ", exact",
                                     "MeshLib": self.named("MeshLib", "MeshLib 3.1") + ", float32",
                                     "Embree": self.named("Embree", "Embree 3") + ", boxes only",
                                     "IPC Toolkit LBVH, from Python": "IPC Toolkit LBVH, boxes only"})

    def between_contest(self):
        return self.contest("between", {"FCL": self.named("FCL", "FCL 0.7") + ", build and collide",
                                        "FCL, trees built": "FCL, trees built",
                                        "MeshLib": self.named("MeshLib", "MeshLib 3.1") + ", float32",
                                        "Embree": self.named("Embree", "Embree 3") + ", boxes only"})

    def any_contest(self):
        return self.contest("any", {"CGAL": self.named("CGAL", "CGAL 5.5") + ", exact",
                                    "IPC Toolkit has_intersections": "IPC Toolkit `has_intersections`"})

    def growth(self):
        rows = [[f"{size['triangles']:,.0f}", f"{size['pairs']:,}", digits(size["one_thread"]["median"]),
                 digits(size["all_threads"]["median"]), digits(size["bytes_a_triangle"])]
                for size in self.studies["growth"]["sizes"]]
        return table(["triangles", "pairs", "one thread, ms", "two threads, ms", "memory, bytes a triangle"], rows)

    def first_call(self):
        rows = [[scene(row["workload"]),
                 *(f"{digits(row[kind]['median'])} ms" for kind in ("making", "new_process", "new_detector", "warm"))]
                for row in self.studies["first_call"]]
        return table(["scene", "new process: making a detector", "its first call", "another detector's first call",
                      "a warm call"], rows)

    def simd(self):
        names = {"avx512": "AVX-512", "avx2": "AVX2", "sse4": "SSE4", "scalar": "scalar"}
        rows = []
        for figure in self.studies["simd"]:
            values = {value["value"]: value["milliseconds"]["median"] for value in figure["values"]}
            rows.append([scene(figure["workload"]), *(f"{digits(values[name])} ms" for name in names)])
        return table(["", *names.values()], rows)

    def option(self, study):
        """Times relative to the default: a row for each value, a column for each scene."""
        figures = self.studies[study]
        label = {figure["workload"]: scene(figure["workload"].removesuffix(", new detector")) for figure in figures}
        values = [value["value"] for value in figures[0]["values"]]
        rows = [[value, *(f"{figure['values'][i]['relative']['median']:.2f}" for figure in figures)]
                for i, value in enumerate(values)]
        return table(["value", *label.values()], rows)

    def box_overlaps(self):
        rows = [[scene(row["workload"]), f"{row['overlapping_boxes']:,}", f"{digits(row['milliseconds']['median'])} ms",
                 digits(row["nanoseconds_a_box_pair"]), f"{row['relative']:.2f}"]
                for row in self.studies["cost_per_box_overlap"]]
        return table(["scene", "overlapping boxes", "time", "ns an overlap", "times Cloth on Ball"], rows)

    def ground(self):
        rows = [[scene(row["workload"]), f"{digits(row['without']['median'])} ms", f"{digits(row['with']['median'])} ms",
                 f"{row['ratio']['median']:.2f}"] for row in self.studies["ground"]]
        return table(["scene", "without ground", "with ground", "ratio"], rows)

    def pieces(self):
        rows = [[scene(figure["workload"]), row["longest_edge"], f"{row['pieces']:,}", f"{row['members']:,}",
                 f"{row['box_overlaps']:,}", f"{digits(row['until_sweep']['median'])} ms"]
                for figure in self.studies["virtual_subdivision"] for row in figure["rows"]]
        return table(["scene", "longest edge", "pieces", "members", "box overlaps", "time up to `sweep`"], rows)

    def stages(self):
        stages = ["bounds", "subdivide", "align", "sort", "sweep", "narrow", "output", "total"]
        rows = [[scene(figure["workload"]), *(digits(figure["milliseconds"][stage]) for stage in stages)]
                for figure in self.studies["stages"]]
        return table(["ms", *stages], rows)

    def pairs(self, sequence, *frames):
        """Colliding pairs in some frames of a sequence."""
        found = next(s for s in self.studies["sequences"] if s["sequence"] == sequence)
        pairs = dict(zip(found["frames"], found["pairs"]))
        return table(["frame", *frames], [["pairs", *(f"{pairs[int(frame)]:,}" for frame in frames)]])

    def simulated(self):
        """Size and length of the sequences that are simulated."""
        sequences = {s["sequence"]: s for s in self.studies["sequences"]}
        rows = [[scene(s["sequence"]), len(s["frames"]), span(s["triangles"]), f"{max(s['pairs']):,}"]
                for s in map(sequences.get, ("cloth_on_ball", "funnel", "cutting"))]
        return table(["scene", "frames", "triangles", "most colliding pairs"], rows)

    def block(self, name):
        """A table, and what disturbed it."""
        busy = self.busy(name, [STUDIES.get(name, name.removeprefix("option "))])
        return self.rows_of(name) + (f"\n\n{busy}" if busy else "")

    def rows_of(self, name):
        kind, *arguments = name.split()
        if kind in ("option", "pairs"):
            return getattr(self, kind)(*arguments)
        return {"self": self.self_contest, "between": self.between_contest, "any": self.any_contest,
                "growth": self.growth, "first call": self.first_call, "simd": self.simd, "stages": self.stages,
                "box overlaps": self.box_overlaps, "ground": self.ground, "pieces": self.pieces,
                "simulated": self.simulated}[name]()


def rewrite(text, tables):
    parts = text.split("<!-- figures: ")
    for i, part in enumerate(parts[1:], 1):
        name, rest = part.split(" -->", 1)
        parts[i] = f"{name} -->\n{tables.block(name)}\n<!-- end -->" + rest.split("<!-- end -->", 1)[1]
    return "<!-- figures: ".join(parts)


def pages(tables):
    """Each page that shows figures, and what should be in it."""
    for page in PAGES:
        text = page.read_text()
        if "<!-- figures: " in text:
            yield page, rewrite(text, tables)
