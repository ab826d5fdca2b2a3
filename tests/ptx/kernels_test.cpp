// Compares the kernels that decide, as compiled by nvcc to PTX, with the cpu backend, bit by bit. The C++ of the other
// kernels runs as in other tests and provides the cases.

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "agreement/compare.h"
#include "agreement/hard_soups.h"
#include "backends/cuda/comparison_cases.h"
#include "crumple/crumple.h"
#include "cuda_on_cpu/machine/settings.h"
#include "features/compare_features.h"
#include "features/moving_soups.h"
#include "overlaps/closed_bodies.h"
#include "ptx/kernels.h"
#include "rounds.h"

namespace crumple::test {
namespace {

using cuda_on_cpu::settings;

/// Returns the fat binaries or PTX texts in the variable CRUMPLE_PTX, otherwise those that the tests of kernels'
/// budgets have written.
std::vector<std::string> ptx_files() {
    const char* chosen = std::getenv("CRUMPLE_PTX");
    std::istringstream list(chosen ? chosen : CRUMPLE_PTX_FILES);
    std::vector<std::string> files;
    for (std::string file; std::getline(list, file, ':');) files.push_back(file);
    return files;
}

/// True if a kernel decides about codimensional edges and points, according to a template argument in its name.
bool is_codimensional(const std::string& kernel) { return kernel.find("ELb1E") != kernel.npos; }

class PtxKernels : public testing::Test {
   protected:
    PtxKernels() {
        settings().run_instead = [this](const cuda_on_cpu::Kernel& launch) { return kernels_.run(launch); };
    }
    ~PtxKernels() override { settings().run_instead = nullptr; }
    void expect_same(const MeshView& mesh) {
        for (const IntersectionKind intersections : {IntersectionKind::all, IntersectionKind::proper}) {
            const IntersectionQuery query{.output = Output::contacts, .kind = intersections};
            const Intersections& found = cuda_.find(mesh, query);
            EXPECT_TRUE(same_result(found, cpu_.find(mesh, query)));
            exact_tests_ += found.statistics.exact_tests;
            contacts_ += found.statistics.pairs;
        }
    }
    template <class Scalar>
    void expect_same(const MovingSoup<Scalar>& soup, double unit) {
        for (const double min_distance : {0., 0.75 * unit}) {
            const ImpactQuery query{.min_distance = min_distance};
            const Impacts& found = cuda_.find(soup.view().moving_to(soup.end_view()), query);
            EXPECT_TRUE(same_features(found, cpu_.find(soup.view().moving_to(soup.end_view()), query)));
            impacts_ += found.count;
        }
        for (const double radius : {unit, 1.5 * unit}) {  // on a grid many distances equal the first radius
            const ProximityQuery query{.radius = radius};
            const Proximities& found = cuda_.find(soup.view(), query);
            EXPECT_TRUE(same_features(found, cpu_.find(soup.view(), query)));
            near_ += found.count;
        }
    }

    ptx::Kernels kernels_{ptx_files(),
                          {"exact_kernel", "contact_kernel", "decide_kernel", "close_kernel", "crossing_kernel"}};
    Detector cpu_{{.backend = Backend::cpu}};
    Detector cuda_{{.backend = Backend::cuda}};  // created before kernels run from their PTX
    std::int64_t exact_tests_ = 0, contacts_ = 0, impacts_ = 0, near_ = 0;
};

TEST_F(PtxKernels, comparison_with_the_host_passes_and_launches_every_deciding_kernel) {
    cuda::reset_comparison_cases();
    Detector({.backend = Backend::cuda});  // throws if a result of the comparison differs
    ASSERT_FALSE(kernels_.launches.empty());
    // Kernels of codimensional features are launched only to reserve their stacks.
    for (const auto& [name, launches] : kernels_.launches) {
        EXPECT_GT(launches, is_codimensional(name) ? 0 : 1) << name;
    }
}

TEST_F(PtxKernels, hard_soups_match_the_cpu) {
    for (const NamedMesh& scene : hard_soups()) {
        SCOPED_TRACE(scene.name);
        expect_same(scene.mesh.view());
    }
    for (int seed = 10; seed < 10 + scaled_rounds(3); ++seed) {
        SCOPED_TRACE(seed);
        expect_same(grid_soup(3 + seed % 4, 40, 60, static_cast<std::uint64_t>(seed)).mesh<double>(1. / 3).view());
        expect_same(random_soup<double>(80, 0.8, static_cast<unsigned>(seed)).view());
    }
    EXPECT_GE(exact_tests_, 10'000);
    EXPECT_GE(contacts_, 10'000);
}

TEST_F(PtxKernels, hard_motions_and_distances_match_the_cpu) {
    for (const auto& move : moving_soups<double>(0.1)) {
        SCOPED_TRACE(move.name);
        if (move.unit < 1e300) expect_same(move.soup, move.unit);
    }
    for (unsigned seed = 1; seed <= static_cast<unsigned>(scaled_rounds(1)); ++seed) {
        SCOPED_TRACE(seed);
        expect_same(moving_grid(5, 60, 60, seed), 1);
        expect_same(changed<double>(moving_through_a_line(40, 40, seed), [](double x) { return x / 3; }), 1);
        expect_same(in_general(60, 0.5, 0.5, seed), 0.1);
    }
    EXPECT_GE(impacts_, 10'000);
    EXPECT_GE(near_, 10'000);
}

TEST_F(PtxKernels, overlaps_of_closed_bodies_match_the_cpu) {
    std::int64_t rows = 0;
    for (unsigned seed = 1; seed <= static_cast<unsigned>(scaled_rounds(40)); ++seed) {
        SCOPED_TRACE(seed);
        const ClosedBodies bodies = closed_bodies(seed, 4, seed % 4 != 0, seed % 4 == 0);
        const OverlapQuery query{.self_overlaps = true, .curves = true};
        const Overlaps& found = cuda_.find(bodies.view(), query);
        EXPECT_EQ(difference(found, cpu_.find(bodies.view(), query)), "");
        rows += found.count;
    }
    EXPECT_GE(rows, 100);
    for (const auto& [name, launches] : kernels_.launches) {
        if (name.find("crossing_kernel") != name.npos) {
            EXPECT_GE(launches, 30) << name;
        }
    }
}

// Codimensional edges and points, which belong to no triangle, are decided by separate kernels.
TEST_F(PtxKernels, codimensional_features_match_the_cpu) {
    for (unsigned seed = 1; seed <= static_cast<unsigned>(scaled_rounds(3)); ++seed) {
        SCOPED_TRACE(seed);
        MovingSoup<> soup = moving_grid(4, 60, 20, seed);
        soup.edges.emplace();
        soup.points.emplace();
        for (std::int32_t v = 0; v < 60; v += 3) {
            soup.edges->push_back({v, v + 1});
            soup.points->push_back(v + 2);
        }
        expect_same(soup, 1);
    }
    int codimensional = 0;
    for (const auto& [name, launches] : kernels_.launches) {
        if (is_codimensional(name)) {
            ++codimensional;
            EXPECT_GT(launches, 1) << name;
        }
    }
    EXPECT_GT(codimensional, 0);
}

}  // namespace
}  // namespace crumple::test
