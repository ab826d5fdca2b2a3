"""Tests that the interpreter ends with status 0, no output and no temporary files while daemon threads are in calls."""

import os
import subprocess
import sys
import textwrap

import pytest

import crumple
from conftest import soup

PREPARATION = """
    import os, sys, threading, time, warnings, numpy as np, crumple

    def loop(work):
        while True:
            started.set()
            work()

    def refused(call):
        try:
            call()
        except (crumple.Error, TypeError):
            pass

    class Foreign:
        def __init__(self, array):
            self.array = array

        def __dlpack__(self, **options):
            sum(range(100))
            return self.array.__dlpack__(**options)

        def __dlpack_device__(self):
            return self.array.__dlpack_device__()

    started = threading.Event()
    few, many = (crumple.make_scene("soup", triangles=n) for n in (300, 100_000))
    lists, foreign = [array.tolist() for array in few[:2]], [Foreign(array) for array in few[:2]]
    detector, slow = crumple.Detector(threads=2), crumple.Detector(backend="reference")
    result = crumple.Detector().intersections(few)
"""
WORK = {
    "search": "detector.intersections(few)",
    "a search that takes minutes": "slow.intersections(many)",
    "a search among lists": "detector.intersections(*lists)",
    "a search among arrays that Python exports": "detector.intersections(*foreign)",
    "partition": "detector.partition(many, count=8)",
    "read_mesh": "crumple.read_mesh('mesh.ply')",
    "write_mesh": "crumple.write_mesh('written.off', many)",
    "save": "crumple.Detector().intersections(many).save('saved.glb')",
    "make_scene": "crumple.make_scene('cloth', triangles=2000, frame=9)",
    "what is refused": "refused(lambda: detector.intersections([[0, 0, np.nan]], [[0, 0, 0]]))",
    "a file that is not there": "refused(lambda: crumple.read_mesh('none.ply'))",
    "a call that does not fit": "refused(lambda: detector.intersections(few, neighbors=0))",
}


def run(program, folder):
    command = [sys.executable, "-c", textwrap.dedent(PREPARATION) + textwrap.dedent(program)]
    process = subprocess.run(command, capture_output=True, text=True, cwd=folder, timeout=120)
    assert (process.stderr, process.returncode) == ("", 0)
    return process.stdout


@pytest.mark.parametrize("work", WORK)
def test_interpreter_exits_cleanly_during_calls_of_daemon_threads(work, tmp_path):
    crumple.write_mesh(tmp_path / "mesh.ply", soup(200_000))
    program = f"""
        sys.kept = open("kept.txt", "w")  # never closed: it is flushed when the interpreter ends
        sys.kept.write("all of it")
        for _ in range(3):
            threading.Thread(target=loop, args=(lambda: {WORK[work]},), daemon=True).start()
        started.wait()
        time.sleep(0.05)
        print("done")
    """
    for _ in range(3):
        assert run(program, tmp_path) == "done\n"
        assert (tmp_path / "kept.txt").read_text() == "all of it"
        assert not [name for name in os.listdir(tmp_path) if name.endswith(".tmp")]


def test_exit_finishes_a_file_that_is_being_written(tmp_path):
    program = """
        several = crumple.Mesh(np.tile(many.vertices, (20, 1)), np.tile(many.faces, (20, 1)))
        threading.Thread(target=loop, args=(lambda: crumple.write_mesh("mesh.off", several),), daemon=True).start()
        while not [name for name in os.listdir() if name.endswith(".tmp")]:
            time.sleep(0.001)
        print(len(several.faces))
    """
    triangles = int(run(program, tmp_path))
    assert os.listdir(tmp_path) == ["mesh.off"]
    assert len(crumple.read_mesh(tmp_path / "mesh.off").faces) == triangles


def test_exit_does_not_wait_for_blocked_writes_or_threads_lost_by_fork(tmp_path):
    """Exit waits neither for a write to a pipe without a reader nor, in a forked child, for threads of the parent."""
    os.mkfifo(tmp_path / "pipe.off")
    run(
        """
        threading.Thread(target=loop, args=(lambda: crumple.write_mesh("pipe.off", many),), daemon=True).start()
        started.wait()
        time.sleep(0.1)
        """,
        tmp_path,
    )
    program = """
        several = crumple.Mesh(np.tile(many.vertices, (20, 1)), np.tile(many.faces, (20, 1)))
        threading.Thread(target=loop, args=(lambda: crumple.write_mesh("mesh.off", several),), daemon=True).start()
        while not [name for name in os.listdir() if name.endswith(".tmp")]:
            time.sleep(0.001)
        warnings.simplefilter("ignore")  # Python tells that a child should not do much
        child = os.fork()
        if child:
            print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    """
    assert run(program, tmp_path) == "0\n"


def test_calls_during_exit_are_refused_if_the_detector_is_busy(tmp_path):
    program = """
        class Last:
            def __init__(self):
                self.call, self.arguments, self.write = slow.intersections, few, os.write

            def __del__(self):
                try:
                    self.call(self.arguments)
                except BaseException:  # of which class: crumple's errors may be gone already
                    self.write(1, b"refused")

        sys.last = Last()
        threading.Thread(target=loop, args=(lambda: slow.intersections(many),), daemon=True).start()
        started.wait()
        time.sleep(0.1)
    """
    assert run(program, tmp_path) == "refused"
