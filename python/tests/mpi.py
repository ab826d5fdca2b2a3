"""Environment of ranks of MPI, and whether ranks can be started."""

import importlib.util
import shutil

# Lets Open MPI run as root, and more ranks than cores, of which those that wait yield.
ENVIRONMENT = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "OMPI_MCA_pml": "ob1",  # starts in half the time, for it looks for no network
}


def missing():
    """Returns why no ranks can be started; "" if they can."""
    if importlib.util.find_spec("crumple._mpi") is None:
        return "crumple was built without MPI; scripts/test_python.sh --mpi builds it"
    if importlib.util.find_spec("mpi4py") is None:
        return "mpi4py is not installed"
    return "" if shutil.which("mpirun") else "mpirun is not installed"
