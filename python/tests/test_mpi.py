"""Tests of scenes on MPI ranks: mpirun starts ranks, which run one function of mpi_ranks.py or mpi_failures.py."""

import inspect
import os
import pickle
import re
import subprocess
import sys
from pathlib import Path

import pytest

import crumple
import mpi

FILES = [Path(__file__).with_name(name) for name in ("mpi_ranks.py", "mpi_failures.py")]
FILE_OF = {case: file for file in FILES for case in re.findall(r"^def (\w+)\(\):$", file.read_text(), flags=re.M)}
# Numbers of ranks on which some cases run; all others run on three. A single rank is a special case: it does not
# communicate.
RANKS_OF = {
    "intersections_match_a_single_detector": (1, 3),
    "impacts_match_a_single_detector": (1, 3),
    "all_ranks_fail_together_and_stay_usable": (1, 3),
    "closed_detector_refuses_calls": (1, 3),
    "groups_of_ranks_can_search_their_own_scenes": (1, 3),
    "a_signal_ends_a_search_early": (1,),
}
needs_mpi = pytest.mark.skipif(bool(mpi.missing()), reason=mpi.missing())


def run(*command, **options):
    environment = {**os.environ, **mpi.ENVIRONMENT}
    return subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment, **options)


def python(code):
    return run(sys.executable, "-c", code)


def test_cases_with_their_own_numbers_of_ranks_exist():
    assert len(FILE_OF) >= 8 and set(RANKS_OF) <= set(FILE_OF)


@needs_mpi
@pytest.mark.parametrize("case, ranks", [(case, ranks) for case in FILE_OF for ranks in RANKS_OF.get(case, (3,))])
def test_case_passes_on_all_ranks(case, ranks):
    # `-m mpi4py` ends all ranks if one of them fails.
    done = run("mpirun", "-n", str(ranks), sys.executable, "-m", "mpi4py", FILE_OF[case], case)
    assert done.returncode == 0 and "passed" in done.stdout, done.stdout + done.stderr


def test_import_error_without_mpi_explains_how_to_build_it():
    done = python("import sys; sys.modules['crumple._mpi'] = None; import crumple.mpi")
    assert "ImportError: crumple was built without MPI: install it by `pip install . --config" in done.stderr


def test_import_of_crumple_needs_no_mpi():
    done = python("import sys; sys.modules['mpi4py'] = None; import crumple; print(*sys.modules)")
    assert done.returncode == 0 and "crumple._mpi" not in done.stdout.split()


@needs_mpi
def test_import_error_names_missing_mpi4py():
    done = python("import sys; sys.modules['mpi4py'] = None; import crumple.mpi")
    assert "ImportError: crumple.mpi needs mpi4py: " in done.stderr


@needs_mpi
@pytest.mark.parametrize(
    "change, sentence",
    [
        (
            "MPI.Get_library_version = lambda: 'Another MPI 9, of 2030\\0'",
            "crumple.mpi uses .+, but mpi4py uses Another MPI 9: build",
        ),
        (
            "MPI.Get_library_version = lambda v=MPI.Get_library_version(): v + 'x'",
            "crumple.mpi and mpi4py use different libraries",
        ),
        ("MPI._sizeof = lambda _: 3", "crumple.mpi and mpi4py use different libraries, both "),
        ("MPI._handleof = lambda _: 64", "crumple.mpi and mpi4py use different libraries, both "),
    ],
)
def test_an_mpi4py_with_another_mpi_is_refused(change, sentence):
    done = python(f"from mpi4py import MPI; {change}; import crumple.mpi")
    assert done.returncode == 1 and re.search(f"^ImportError: {sentence}", done.stderr, flags=re.M), done.stderr


@needs_mpi
def test_uninitialised_or_finalised_mpi_is_refused():
    begin = "import mpi4py; mpi4py.rc.initialize = {}; from mpi4py import MPI; import crumple.mpi\n"
    for before in begin.format(False), begin.format(True) + "MPI.Finalize()\n":
        done = python(before + "crumple.mpi.Detector(MPI.COMM_WORLD)")
        assert "crumple._errors.Error: MPI is not initialised: call MPI.Init() first" in done.stderr, done.stderr


@needs_mpi
def test_mpi_detector_has_the_options_of_a_detector_except_devices():
    done = python(
        "import inspect, crumple.mpi\n"
        "one, many = (inspect.signature(d.__init__).parameters for d in (crumple.Detector, crumple.mpi.Detector))\n"
        "of_each = [name for name in one if name != 'devices']\n"  # each rank has one device
        "assert list(many)[:4] == ['self', 'comm', 'parts', 'batch_bytes'] and list(many)[4:] == of_each[1:]\n"
        "assert all(many[name] == one[name] for name in of_each)\n"
        "for call in 'intersections', 'impacts', 'proximities':\n"
        "    one = inspect.signature(getattr(crumple.Detector, call)).parameters\n"
        "    many = inspect.signature(getattr(crumple.mpi.Detector, call)).parameters\n"
        "    assert set(one) - set(many) <= {'copy', 'edges', 'points'}, call\n"
        "    assert set(many) - set(one) == {'triangle_ids', 'vertex_ids', 'body_ids'}, call\n"
        "    assert all(many[name].default == one[name].default for name in one if name in many), call\n"
    )
    assert done.returncode == 0, done.stderr


@needs_mpi
def test_everything_public_in_crumple_mpi_is_documented():
    done = python(
        "import inspect, crumple.mpi\n"
        "for name in crumple.mpi.__all__:\n"
        "    thing = getattr(crumple.mpi, name)\n"
        "    assert inspect.getdoc(thing), name\n"
        "    for member in vars(thing):\n"
        "        assert member.startswith('_') or inspect.getdoc(getattr(thing, member)), (name, member)\n"
    )
    assert done.returncode == 0, done.stderr


def test_errors_have_a_rank_and_pickling_keeps_it():
    assert inspect.signature(crumple.Error).parameters["rank"].default == -1
    with pytest.raises(crumple.InvalidInput) as caught:
        crumple.Detector().intersections([[0.0, 0, 0]], [[0, 0, 1]])
    assert caught.value.rank == -1
    for error in crumple.Error("no", rank=2), crumple.MemoryLimit("no", rank=2), crumple.FileError("no", rank=2):
        assert pickle.loads(pickle.dumps(error)).rank == 2
