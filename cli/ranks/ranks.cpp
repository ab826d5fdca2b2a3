#include "cli/ranks/ranks.h"

#include <cstdlib>
#include <string_view>

#include "cli/terminal.h"
#include "crumple/mpi.h"

namespace crumple::cli {
namespace {

int rank_count = 1;

/// True if environment variables show that an MPI launcher has started this process, unless CRUMPLE_MPI is 0. If false,
/// MPI is not initialised, because that takes time, and may fail on a machine that is not set up for MPI.
bool was_launched() {
    const char* const setting = std::getenv("CRUMPLE_MPI");
    if (setting && std::string_view(setting) == "0") return false;
    for (const char* const name : {
             "OMPI_COMM_WORLD_SIZE",  // mpirun of Open MPI
             "PMI_RANK", "PMI_SIZE",  // mpiexec of MPICH and Intel MPI, srun --mpi=pmi2
             "PMIX_RANK",             // prterun, srun --mpi=pmix
             "MV2_COMM_WORLD_SIZE",   // mpirun_rsh of MVAPICH2
             "MPI_LOCALNRANKS",       // mpiexec of MPICH and Intel MPI
         }) {
        if (std::getenv(name)) return true;
    }
    return false;
}

}  // namespace

Ranks::Ranks(int& argument_count, char**& arguments) {
    if (!was_launched()) return;
    int level = MPI_THREAD_SINGLE, rank = 0;
    MPI_Init_thread(&argument_count, &arguments, MPI_THREAD_FUNNELED, &level);
    MPI_Comm_size(MPI_COMM_WORLD, &rank_count);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    if (rank > 0) be_silent();
}

Ranks::~Ranks() {
    int initialised = 0, finalised = 0;
    MPI_Initialized(&initialised);
    MPI_Finalized(&finalised);
    if (initialised && !finalised) MPI_Finalize();
}

int Ranks::count() { return rank_count; }

}  // namespace crumple::cli
