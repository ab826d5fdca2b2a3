#!/usr/bin/env python3
"""Compiles one CUDA source for sm_90 and checks what keeps its kernels fast: budgets of local memory and of
registers, loads of 16 bytes where rows and records are read, and no loads of single bytes. Usage: check_kernels.py PTX
[ccache] NVCC FLAGS... SOURCE. It writes the kernels' PTX to the file PTX. With CRUMPLE_LIST_KERNELS set, it prints what it
found."""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

# Most bytes of a thread's stack, including spills, by a part of the kernel's name. Kernels with large budgets use
# expansions, but for few pairs only. The sweep spills only convergence barriers. The filters index corners of records at
# run time, which takes stack.
STACK = {"exact_kernel": 8192, "contact_kernel": 8192, "close_kernel": 8192, "crossing_kernel": 8192, "segments_kernel": 640,
         "decide_kernel": 896, "codimensional_tests_kernel": 576, "list_kernel": 80, "pair_kernel": 96, "within_kernel": 96,
         "filter_kernel": 256, "frame_kernel": 256, "sweep_kernel": 32}
OTHER_STACKS = 16
# Most registers of a thread, by a part of the kernel's name; the first name that matches counts. With 32 registers eight
# blocks of 256 threads fit on a multiprocessor, with 40 six, 48 five, 64 four, 80 three. Kernels of feature queries read
# six corners (a trajectory) per triangle, twice as many per pair. Those of candidates write a record of 64 words at once.
REGISTERS = {"SeparatingAxisTest": 120, "FeatureMemberRows": 96, "CandidateMembers": 120, "widened_bounds": 72, "WidenedILi2": 72,
             "exact_kernel": 255, "contact_kernel": 255, "close_kernel": 255, "decide_kernel": 255, "crossing_kernel": 255,
             "segments_kernel": 255, "faces_kernel": 128, "codimensional_tests_kernel": 80,
             "list_kernel": 80, "pack_kernel": 64, "pair_kernel": 80, "within_kernel": 64, "sweep_kernel": 64,
             "filter_kernel": 80, "frame_kernel": 128, "DeviceScanKernel": 128, "bin_kernel": 48, "offsets_kernel": 56, "place_kernel": 72,
             "check_kernel": 40, "pose_kernel": 48, "bounds_kernel": 64, "members_kernel": 48}
OTHER_REGISTERS = 40
# Least number of loads of 16 bytes, and of copies to shared memory, in kernels that read records or rows.
WIDE_LOADS = {"OverlapAlone": 3, "sweep_kernel": 11, "filter_kernel": 20, "bin_kernel": 3, "place_kernel": 3,
              "pose_kernel": 1}
# Kernels that may load single bytes: those for unaligned arrays (whose template argument is `false`), one that copies
# kinds of contacts, rarely used ones that read coordinates in any layout, those that decide about features, which check
# alignment at run time, and those that read flags of the features that a triangle owns.
BYTES = re.compile(r"(check|bounds|join|corners|rest)_kernelI\w*Lb0E|(exact|contact|gather|part|weld|fill_table)_kernel|HostContact"
                   r"|(decide|close|pack|codimensional_tests|pair|within)_kernel|FeatureMemberRows|CandidateMembers")


def kernels(ptx_file, nvcc, source, folder):
    """Returns a dictionary: kernel name -> (bytes of stack, registers, body in PTX)."""
    # Makes one file with both machine code and PTX (as plain text), so that ccache works, which caches one file and the
    # printed output.
    run = subprocess.run([*nvcc, "-gencode=arch=compute_90,code=[compute_90,sm_90]", "-Xptxas=-v", "-c", "-fatbin",
                          "-no-compress", "-o", f"{folder}/out", source], capture_output=True, text=True, check=False)
    if run.returncode:
        sys.exit(run.stderr)
    used = {}
    for part in run.stderr.split("Compiling entry function '")[1:]:
        stack, registers = re.search(r"(\d+) bytes stack frame", part), re.search(r"Used (\d+) registers", part)
        used[part.split("'")[0]] = int(stack[1]), int(registers[1])
    ptx = re.search(rb"\.version [0-9].*?(?=\0)", Path(folder, "out").read_bytes(), re.S)
    if not ptx:
        sys.exit("no PTX beside the machine code")
    Path(ptx_file).write_bytes(ptx[0])
    # PTX is not indented, so only the beginning of the next kernel or function ends a kernel.
    parts = re.split(r"^(?:\.\w+ )*\.(?=entry |func )", ptx[0].decode(), flags=re.M)
    bodies = (part.split("(", 1) for part in parts if part.startswith("entry "))
    return {name: (*used[name], body) for name, body in ((head[6:], body) for head, body in bodies) if name in used}


def value(table, name, otherwise):
    return next((limit for kernel, limit in table.items() if kernel in name), otherwise)


def complaints(name, stack, registers, body):
    wide = len(re.findall(r"\bld\.global(?:\.nc)?\.v(?:4\.[bfsu]32|2\.[bfsu]64)|\bcp\.async\.c[ag]\.shared\.global", body))
    if "CRUMPLE_LIST_KERNELS" in os.environ:
        print(f"{name[-60:]:60} {stack:5} bytes of stack {registers:4} registers {wide:3} wide loads")
    if stack > (most := value(STACK, name, OTHER_STACKS)):
        yield f"{stack} bytes of stack, budget {most}"
    if registers > (most := value(REGISTERS, name, OTHER_REGISTERS)):
        yield f"{registers} registers, budget {most}"
    if wide < (least := value(WIDE_LOADS, name, 0)):
        yield f"{wide} loads of 16 bytes, wanted {least}"
    if "cub" not in name and not BYTES.search(name) and re.search(r"\bld\.global(?:\.nc)?\.[bsu]8", body):
        yield "loads of single bytes"


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        found = kernels(sys.argv[1], sys.argv[2:-1], sys.argv[-1], folder)
    wrong = [f"{name}: {text}" for name, kernel in found.items() for text in complaints(name, *kernel)]
    print(*wrong, sep="\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
