"""docs/benchmarks.md: plots, tables, and a paragraph of finding for each, whose numbers come from the figures.

A section whose figures are not there says so, so that a page made from a short run is honest, too.
"""

import textwrap

from .findings import FINDINGS
from .results import TOP
from .tables import stage_names

IMAGES = TOP / "docs/images/benchmarks"
PAGE = TOP / "docs/benchmarks.md"

HEAD = """# Benchmarks

This page is made by `scripts/report.sh` from [{file}](../benchmarks/results/{file}); no figure is typed. `scripts/bench.sh` measures \
on your machine. What is compared and how is in [benchmarks](../benchmarks/README.md); [MZ] is *Collision Detection Based on Fuzzy \
Scene Subdivision* by D. Mainzer and G. Zachmann.

{machine}

Each time is a median of calls that took turns with those of the others, in brackets or shaded its quartiles. Only ratios within one \
run count. {again}
"""

# Heading, picture (name without variant, alt text) or None, text that stands before the finding.
SECTIONS = [
    ("## Figures of [MZ]", None, "", "paper"),
    ("## Against other libraries", None, ""),
    ("### What each computes", None, "", "peers"),
    ("### One mesh against itself", ("peers_self", "Bars: time of Crumple and its peers on each scene, one mesh against itself"),
     "Every peer at the fastest of its ways. *Missing* and *extra* compare its pairs with Crumple's as sets; for boxes, extra is what a "
     "triangle test would have to remove. Plots show measured milliseconds but of peers from PyPI: these race in processes of their own "
     "against one of Crumple's and stand at its time above multiplied by their ratio.", "self"),
    ("### One mesh against another", ("peers_between", "Bars: time of Crumple and its peers on each pair of meshes"), "", "between"),
    ("### Is there any collision?", ("peers_any", "Bars: time of Crumple and its peers to tell that nothing collides"), "", "any"),
    ("### [MZ] fig. 6", ("published", "Bars: published averages on Cloth on Ball and Funnel beside Crumple and peers on this machine"),
     "Hatched bars are the published averages of [MZ] fig. 6, on the GPUs and processors of their authors (a GeForce GTX 480 for [MZ]), "
     "some of them for continuous detection. They say what was thought fast when the method was new, not who would win today.", "published"),
    ("## On a GPU", None, "The cuda backend on meshes that lie on the device, by `scripts/gpu_check.sh`.", "cuda"),
    ("## Every scene", None, "Warm: a detector that has seen the scene. Cold: a new one, in a process that has run before. Peak memory is "
     "the detector's own, the result included.", "scenes"),
    ("## Sequences", ("frames.png", "Rendered frames: above, a cloth that falls on a ball and crumples; below, a cloth that a ball pushes "
                      "through a funnel; what collides is red"),
     "[MZ] fig. 5, on this project's simulations: frames 0, 10, 40, 60 and 93 of Cloth on Ball, and frames 0, 125, 200, 375 and 500 of "
     "Funnel. What collides is red.", None),
    ("", None, "Frame by frame, as in a simulation; every call counts, so the 99th percentile is that of moving scenes. Peers "
     "answer every few frames.", "sequences"),
    ("### Time per frame by stage", ("stages", "Stacked areas: milliseconds of each stage over the frames of {0}, with the number of "
                                     "colliding pairs below"),
     "[MZ] figs. 7 and 8, on one thread. Their names map to these:\n\n" + stage_names(), "stages"),
    ("### Warm start", ("warm_start", "Lines: time of subdivide and of the whole call over the frames, for warm, cold and fixed centres"),
     "*Warm* goes on from the centres of the frame before, *cold* starts them anew in each frame with buffers kept, *fixed* keeps those of "
     "the first frame.", "warm_start"),
    ("## Growth", ("growth", "Log-log plot: time over the number of triangles, and memory for each triangle"),
     "The procedural cloth at several sizes; memory without input and output.", "growth"),
    ("## Threads", ("threads", "Lines: speed-up over the number of threads"), "", "threads"),
    ("## Parts", ("parts", "Lines: how much faster the largest of 2 to 64 parts is than the whole scene, and how the sum of the parts' "
                  "work grows"),
     "What several machines or GPUs that share a scene could gain at most: each part is answered alone, on one thread. Solid: the part is "
     "a mesh of its own; dashed: `find_self(mesh, part)`, which reads the whole mesh.", "parts"),
    ("## Studies of the method", None, ""),
    ("### Clusters", ("clusters.png", "Rendered models, each coloured by its 2 clusters above and by its 16 clusters below; triangles of several "
                      "clusters are dark"),
     "[MZ] fig. 3: 2 clusters above, 16 below; triangles that belong to several are dark. The pelvis model of [MZ] is not to be had; "
     "what is shown stands in for it.", None),
    ("### The sweep direction", ("sweep_direction", "Drawing: six slanted triangles with their boxes and intervals along x and along the "
                                 "first principal component, where none overlap"),
     "[MZ] fig. 1. The same triangles, once with boxes along x and y, once along the principal components of their centroids.", None),
    ("", ("axes", "Dots: overlapping intervals, false positives and time for fixed axes, principal components, these turned to the "
          "edges, and principal components with two axes only"),
     "A plain sweep, the same for all, once over the whole scene and once in parts. Turned to the edges: what the library does "
     "([align](align.md)). Two axes: [MZ] sec. 5 leaves the third one to the triangle test.", "axes"),
    ("### Membership", ("overlap", "Drawing: two triangles that collide across the border of two clusters share none if each belongs to its "
                        "nearest centre only, and share both if balls decide"),
     "[MZ] fig. 4. A triangle belongs to the cluster of its nearest centre, and to others whose region it reaches.", None),
    ("", ("membership", "Dots: members added, time and pairs lost under seven rules of membership"),
     "Rules around the same centres; each part is answered alone, and the answers united. *Exactly two* and *two across* read [MZ] sec. "
     "5.1's overlap of exactly two primitives by the letter and as a width; *eq. 5* takes the largest radius R of the scene as the width of "
     "the whole band or of each side; *local 2r* and *bisector* go by each triangle's own radius.", "membership"),
    ("### Two clusters", ("two_clusters", "Dots: time of one, two and four clusters swept whole, relative to leaves"),
     "[MZ] sec. 6.1 found two clusters best on one GPU, four where objects are far apart, each swept whole; Crumple cuts on, down to "
     "leaves that fit a cache.", "two_clusters"),
    ("### The prefix sum's prediction", ("memory", "Dots: memory for the list of overlapping intervals, for boxes and pairs that "
                                         "survive, and what the detector owns"),
     "[MZ] fig. 2 sizes its arrays by the sum of overlapping intervals, 8 bytes each. Crumple sweeps and decides a chunk at a time, so "
     "no such list exists.", "memory"),
    ("### Clusters and leaf size", ("cuts", "Lines: time over the number of clusters and over the size of leaves, relative to the default"),
     "", "cuts"),
    ("### Fuzziness", ("fuzziness", "Lines: time over the fuzziness t, relative to the default"), "", "fuzziness"),
]

# Studies that a block shows, where they are not one of its name.
STUDIES = {"warm_start": ["sequences"], "stages": ["sequences"], "memory": ["two_clusters"], "cuts": ["clusters", "leaf_size"]}

# Blocks of sections that are left out, not said to be missing, where nothing was measured: most machines have no GPU.
IF_MEASURED = {"cuda"}


def picture(name, alt):
    if name.endswith(".png"):
        return f"![{alt}](images/benchmarks/{name})"
    folder = f"images/benchmarks/{name}"
    return (f'<picture><source media="(prefers-color-scheme: dark)" srcset="{folder}-dark.svg">'
            f'<img alt="{alt}" src="{folder}-light.svg"></picture>')


def describe_machine(data):
    machine = data["machine"]
    rows = [f"{machine['cpu']}, {machine['cpus']} processors, {machine['memory_gib']} GiB, {machine['architecture']}",
            data["compiler"].strip(), f"commit `{data['commit'][:12]}`, {data['date'][:10]}"]
    minutes = round(data.get("seconds", 0) / 60)
    return " · ".join(rows) + (f"\n\nThe whole run took {minutes} minutes." if minutes else "")


def measured_again(data):
    """Which figures come from a later run. The oldest files do not tell; theirs were put together by hand."""
    if "measured_again" not in data:
        return ("Contests and studies that others disturbed were measured again at the same commit, and the quieter run was kept; what is "
                "still disturbed says so.")
    if not data["measured_again"]:
        return "All are from one run."
    return f"Measured again at the same commit, and the quieter run kept: {', '.join(data['measured_again'])}."


def pictures_of(entry, results, drawn):
    """Names and alt texts of a section's pictures that exist."""
    name, alt = entry
    if name == "stages":
        from .results import plain

        return [(f"stages_{s.replace(':', '_')}", alt.format(plain(s))) for s in results.sequences()]
    return [(name, alt)] if name.endswith(".png") or name in drawn(results) else []


def drawn(results):
    """Plots that these figures allow; known without drawing them."""
    found = {"sweep_direction", "overlap", "published"}
    needs = {"peers_self": results.fastest("self", "crumple"), "peers_between": results.fastest("between", "crumple"),
             "peers_any": results.fastest("any", "crumple"), "growth": results.study("growth"), "threads": results.study("threads"),
             "parts": results.study("parts"), "axes": results.study("axes"), "membership": results.study("membership"),
             "two_clusters": results.study("two_clusters"), "memory": results.study("two_clusters"),
             "cuts": results.study("clusters") and results.study("leaf_size"), "fuzziness": results.study("fuzziness"),
             "warm_start": [s for s in results.sequences().values() if "cold" in s["kinds"]]}
    return found | {name for name, figures in needs.items() if figures}


def wrapped(text):
    """Prose at most as wide as the other pages; tables and pictures as they are."""
    lines = [line if line.startswith(("|", "<", "#", "!")) else
             textwrap.fill(line, 120, break_long_words=False, break_on_hyphens=False) for line in text.split("\n")]
    return "\n".join(lines)


def page(results):
    parts = [HEAD.format(file=results.path.name, machine=describe_machine(results.data),
                         again=measured_again(results.data)).rstrip()]
    for heading, image, text, *block in SECTIONS:
        images = pictures_of(image, results, drawn) if image else []
        body = FINDINGS[block[0]](results) if block and block[0] else ""
        if block and block[0] in IF_MEASURED and not body:
            continue
        parts.append(heading)
        parts.append(text)
        if (image and not images) or (block and block[0] and not body):
            parts.append("*Not measured in this run.*")
        parts += [picture(*entry) for entry in images]
        parts.append(body)
        if body:
            parts.append(results.busy(block[0], STUDIES.get(block[0], [block[0]])))
    return wrapped("\n\n".join(part for part in parts if part)) + "\n"
