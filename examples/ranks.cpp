// A sheet of cloth, distributed over MPI ranks in blocks of rows, for some frames: each rank gets the pairs of its
// triangles.
//
//     mpirun -n 2 example_ranks

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "crumple/mpi.h"

namespace {

constexpr std::int64_t rows = 160, columns = 120;

/// Block of rows of the sheet's quadrilaterals, two triangles each. Both of two adjacent blocks have the vertices on
/// their common boundary.
struct Block {
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::vector<std::int64_t> vertex_ids, triangle_ids;  // ids over all ranks

    Block(std::int64_t first, std::int64_t last) {
        for (std::int64_t id = first * (columns + 1); id < (last + 1) * (columns + 1); ++id) vertex_ids.push_back(id);
        vertices.resize(vertex_ids.size());
        for (std::int64_t id = 2 * first * columns; id < 2 * last * columns; ++id) triangle_ids.push_back(id);
        constexpr auto side = static_cast<std::int32_t>(columns + 1);
        for (std::int32_t row = 0; row < last - first; ++row)
            for (std::int32_t v = row * side; v < row * side + side - 1; ++v) {
                triangles.push_back({v, v + 1, v + side});
                triangles.push_back({v + 1, v + side + 1, v + side});
            }
    }
    /// Moves the sheet, which hangs from a bar, in folds that pass along it and cut through it.
    void move(int frame) {
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            const double along = static_cast<double>(vertex_ids[i] / (columns + 1)) / rows;
            const double across = static_cast<double>(vertex_ids[i] % (columns + 1)) / columns;
            const double wave = 40 * along - 0.3 * frame;
            vertices[i] = {static_cast<float>(across), static_cast<float>(along + 0.03 * std::sin(wave + 3 * across)),
                           static_cast<float>(0.01 * std::cos(wave + 2 * across))};
        }
    }
};

/// Returns true if there is any pair in the last frame; the same on all ranks.
bool run() {
    crumple::mpi::Detector detector(MPI_COMM_WORLD);
    Block block(rows * detector.rank() / detector.ranks(), rows * (detector.rank() + 1) / detector.ranks());
    const crumple::LocalMesh local{{block.vertices, block.triangles}, block.triangle_ids, block.vertex_ids};
    bool any = false;
    for (int frame = 0; frame < 4; ++frame) {
        block.move(frame);
        const crumple::DistributedIntersections& found = detector.find(local);
        std::printf("frame %d, rank %d: %zu of %lld pairs\n", frame, detector.rank(), found.pairs.size(),
                    static_cast<long long>(found.count));
        any = found.count > 0;
    }
    detector.close();
    return any;
}

}  // namespace

int main(int count, char** arguments) {
    int level = 0;
    MPI_Init_thread(&count, &arguments, MPI_THREAD_FUNNELED, &level);
    int status = 1;
    try {
        status = run() ? 0 : 1;
    } catch (const crumple::Error& error) {  // the same one on all ranks
        std::fprintf(stderr, "%s\n", error.what());
    }
    MPI_Finalize();
    return status;
}
