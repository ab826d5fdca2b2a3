// Uses the installed library with MPI: each rank has two crossing triangles far from those of other ranks, which give
// one pair per rank.

#include <array>
#include <cstdio>
#include <vector>

#include "crumple/mpi.h"

int main(int count, char** arguments) {
    int level = 0;
    MPI_Init_thread(&count, &arguments, MPI_THREAD_FUNNELED, &level);
    crumple::mpi::Detector detector(MPI_COMM_WORLD);
    const auto x = 10 * static_cast<float>(detector.rank());
    const std::vector<std::array<float, 3>> vertices{
        {x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}, {x + 0.2f, 0.2f, -1}, {x + 0.2f, 0.2f, 1}, {x + 2, 2, 0}};
    const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {3, 4, 5}};
    const crumple::DistributedIntersections& found = detector.find(crumple::LocalMesh{{vertices, triangles}, {}, {}});
    const bool one = found.pairs.size() == 1 && found.count == detector.ranks();
    if (!one) std::printf("rank %d found %zu pairs\n", detector.rank(), found.pairs.size());
    detector.close();
    MPI_Finalize();
    return one ? 0 : 1;
}
