"""Environment variables for MPI ranks, and a check that ranks can be started."""

import importlib.util
import shutil

# Lets Open MPI run as root, and run more ranks than there are cores. Ranks that wait then yield their core.
ENVIRONMENT = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "OMPI_MCA_pml": "ob1",  # halves the time to start, because no network is searched for
}


def missing():
    """Returns the reason why no ranks can be started; "" if they can."""
    if importlib.util.find_spec("crumple._mpi") is None:
        return "crumple was built without MPI; scripts/test_python.sh --mpi builds it"
    if importlib.util.find_spec("mpi4py") is None:
        return "mpi4py is not installed"
    return "" if shutil.which("mpirun") else "mpirun is not installed"
