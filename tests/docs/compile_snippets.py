"""Compiles the C++ snippets of the documentation:
    compile_snippets.py SOURCE_FOLDER OUTPUT COMPILER [OPTIONS ...]
Each snippet becomes a function that sees the names of CONTEXT. Programs with a main() are compiled and run elsewhere. Messages
of the compiler have the page and the line. Snippets about ranks need -DCRUMPLE_MPI among the options.
"""

import re
import subprocess
import sys
from pathlib import Path

# Names that pages leave to the reader: a mesh, bodies, buffers, and functions that use results.
CONTEXT = """
#include <array>
#include <cmath>
#include <span>
#include <vector>
#include "crumple/crumple.h"
extern crumple::Detector detector;
extern crumple::MeshView mesh, room, arm;
extern crumple::VertexView end, as_cut;
extern std::vector<crumple::Shape> shapes;
extern std::vector<crumple::Body> bodies;
extern std::vector<crumple::Pose> poses;
extern crumple::Pose pose_of_arm;
extern std::vector<std::array<double, 3>> vertices;
extern std::vector<std::array<int, 3>> triangles;
extern std::vector<double> radii;
extern double thickness, distance;
extern std::size_t i;
template <class... Values> void use(const Values&...);
"""
# Names in the snippets of one page, which hide those above; a word after the page limits them to snippets with that word.
OF_PAGE = {
    "cuda.md": "extern void* stream; extern crumple::VertexView next;",
    "distributed.md": """extern crumple::mpi::Detector detector; extern int argc; extern char** argv; extern int level;
        extern std::vector<std::int64_t> vertex_ids, body_ids; extern crumple::LocalMesh local;
        template <class... Values> void respond(const Values&...);
        template <class... Values> void apply_forces(const Values&...); void step(crumple::MeshView&);""",
    "given_pairs.md": "extern crumple::VertexView start, points;",
    "motion.md": """extern std::vector<crumple::Edge> edges; extern std::vector<std::int32_t> points;""",
    "motion.md cut_rigid_motion": "extern std::vector<crumple::Pose> start, end;",
}
# Matches snippets that are left out: calls of CUDA, which only nvcc compiles, and the compiler bug of nvcc.
LEFT_OUT = re.compile(r"\bcuda(Stream|Graph)|<<<|\bstruct Expansion\b")


def main():
    folder, output, command = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:]
    with_ranks = "-DCRUMPLE_MPI" in command
    source = [CONTEXT]
    if with_ranks:
        source.append('#include "crumple/mpi.h"')
    count = 0
    for page in [folder / "README.md", *sorted((folder / "docs").glob("*.md"))]:
        text = page.read_text()
        for match in re.finditer(r"^```cpp\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
            snippet = match.group(1)
            if "int main(" in snippet or LEFT_OUT.search(snippet):
                continue
            if page.name == "distributed.md" and not with_ranks:
                continue
            names = [of for key, of in OF_PAGE.items() if key.split()[0] == page.name and all(
                word in snippet for word in key.split()[1:])]
            line = text.count("\n", 0, match.start()) + 2
            code = re.sub(r"^#include.*$", "", snippet, flags=re.MULTILINE)
            count += 1
            source.append(f'namespace snippet_{count} {{\n{" ".join(names)}\nvoid run() {{\n#line {line} "{page}"\n{code}}}\n}}')
    if count < 15:
        sys.exit(f"only {count} snippets were found")
    output.write_text("\n".join(source) + "\n")
    sys.exit(subprocess.run([*command, "-fsyntax-only", str(output)]).returncode)


main()
