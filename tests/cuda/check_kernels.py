#!/usr/bin/env python3
"""Compiles one CUDA source for sm_90 and holds its kernels to their budgets of local memory: what a thread cannot keep
in registers lies in memory, and a hot kernel that does so is slow. Usage: check_kernels.py NVCC FLAGS... SOURCE"""

import re
import subprocess
import sys
import tempfile

# Bytes of a thread's stack, spills included, by the beginning of the kernel's name. Expansions need room; few pairs
# reach them. The sweep spills nothing but convergence barriers.
BUDGET = {"exact_kernel": 8192, "contact_kernel": 8192, "filter_kernel": 512, "frame_kernel": 256, "sweep_kernel": 32}
OTHERS = 16


def main() -> int:
    with tempfile.NamedTemporaryFile(suffix=".cubin") as cubin:
        run = subprocess.run([*sys.argv[1:-1], "-Xptxas=-v", "-cubin", "-o", cubin.name, sys.argv[-1]],
                             capture_output=True, text=True, check=False)
    if run.returncode:
        print(run.stderr)
        return run.returncode
    failures = 0
    pattern = r"Compiling entry function '(\S+)'.*?(\d+) bytes stack frame, (\d+) bytes spill stores"
    for name, stack, spills in re.findall(pattern, run.stderr, re.S):
        kernel = next((k for k in BUDGET if k in name), None)
        budget = BUDGET[kernel] if kernel else OTHERS
        used = int(stack)
        if used > budget:
            failures += 1
            print(f"{name}: {used} bytes of stack ({spills} bytes of spills), budget {budget}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
