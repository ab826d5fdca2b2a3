// Tests of the comparison of a device with the host (known-answer tests), on an emulated device whose kernels can be
// made to fail.

#include <gtest/gtest.h>

#include <array>
#include <cfenv>
#include <string>

#include "backends/cuda/comparison_case_data.h"
#include "backends/cuda/comparison_cases.h"
#include "crumple/crumple.h"
#include "crumple/error.h"
#include "cuda_on_cpu/machine/launch.h"
#include "cuda_on_cpu/machine/settings.h"
#include "error_of.h"
#include "exact/impact/filtered_impact.h"
#include "exact/intersection/contact_on_line.h"
#include "exact/intersection/intersection_decision.h"
#include "exact/proximity/filtered_distance.h"

namespace crumple::test {
namespace {

using cuda_on_cpu::settings;

class KnownAnswersOnEmulatedDevice : public testing::Test {
   protected:
    KnownAnswersOnEmulatedDevice() { cuda::reset_comparison_cases(); }
    ~KnownAnswersOnEmulatedDevice() override {
        settings().run_instead = nullptr;
        cuda::reset_comparison_cases();
    }
    // Makes the kernel launch after the first `before` ones do nothing.
    static void break_launch(int before) {
        settings().run_instead = [before](const cuda_on_cpu::Kernel&) mutable { return before-- == 0; };
    }
    std::string difference() const { return cuda::find_difference_from_host(device_, stream_.get()); }

    cuda::Device device_{0};
    cuda::Stream stream_ = cuda::make_stream(device_);
};

TEST_F(KnownAnswersOnEmulatedDevice, comparison_takes_at_most_nine_launches_and_two_copies) {
    const cuda_on_cpu::WorkCount before = cuda_on_cpu::work_count();
    EXPECT_EQ(difference(), "");
    EXPECT_LE(cuda_on_cpu::work_count().launches - before.launches, 9u);
    EXPECT_EQ(cuda_on_cpu::work_count().copies - before.copies, 2u);
}

TEST_F(KnownAnswersOnEmulatedDevice, comparison_passes_and_preserves_the_callers_upward_rounding) {
    std::fesetround(FE_UPWARD);
    const std::string found = difference();
    EXPECT_EQ(std::fegetround(), FE_UPWARD);
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(found, "");
}

TEST_F(KnownAnswersOnEmulatedDevice, known_answers_are_compared_once_per_process) {
    const auto launches = [] {
        const std::size_t before = cuda_on_cpu::work_count().launches;
        Detector({.backend = Backend::cuda});
        return cuda_on_cpu::work_count().launches - before;
    };
    const std::size_t first = launches(), second = launches();
    EXPECT_EQ(first - second, 9u);
    EXPECT_EQ(launches(), second);
}

TEST_F(KnownAnswersOnEmulatedDevice, comparison_names_the_result_of_a_kernel_that_does_nothing) {
    for (const auto& [launch, expected] : {std::pair{0, "the intersection"},
                                           {1, "the intersection"},
                                           {2, "the contact"},
                                           {3, "the crossing"},
                                           {4, "the distance"},
                                           {5, "the distance"},
                                           {6, "the impact"},
                                           {7, "the impact"},
                                           {8, "the impact"}}) {
        SCOPED_TRACE(launch);
        break_launch(launch);
        EXPECT_EQ(difference().substr(0, std::string(expected).size()), expected);
    }
}

TEST_F(KnownAnswersOnEmulatedDevice, wrong_results_make_the_backend_unavailable) {
    const auto break_exact_decision = [] {
        settings().run_instead = [begin = cuda_on_cpu::work_count().launches](const cuda_on_cpu::Kernel&) {
            return cuda_on_cpu::work_count().launches - begin > 9;  // the first nine launches reserve stacks, and run
        };
    };
    break_exact_decision();
    const Error error = error_of([] { Detector({.backend = Backend::cuda}); });
    EXPECT_EQ(error.code, ErrorCode::backend_unavailable);
    const std::string reason =
        "the cuda backend is not available: device 0, its driver or the compiler of its code computes wrong results (";
    EXPECT_EQ(std::string(error.what()).substr(0, reason.size()), reason);

    settings().run_instead = nullptr;  // kernels work again, but the device stays excluded
    Detector automatic;
    EXPECT_EQ(automatic.backend(), Backend::cpu);
    EXPECT_EQ(automatic.fallback().substr(0, reason.size()), reason);
}

// Counts which code paths the comparison's cases take when the host computes them.
TEST_F(KnownAnswersOnEmulatedDevice, comparison_cases_cover_every_verdict) {
    const cuda::ComparisonCases cases = cuda::make_comparison_cases(96);
    int collide = 0, apart = 0, undecided_pairs = 0, expanded = 0, shared = 0;
    int rounded = 0, open_contacts = 0;
    std::array<int, 3> impacts{}, at_start{}, distances{};
    for (std::size_t i = 0; i < cases.count(); ++i) {
        const auto triangle = [&](std::size_t first) {
            Triangle t;
            for (std::size_t k = 0; k < 3; ++k) {
                t.vertex[k] = cases.corners[6 * i + first + k];
                t.point[k] = cases.start[static_cast<std::size_t>(t.vertex[k])];
            }
            return t;
        };
        const Triangle a = triangle(0), b = triangle(3);
        ExactSigns signs;
        const Verdict verdict = decide(a, b, Neighbours::geometric, IntersectionKind::all, signs);
        collide += verdict == Verdict::collides;
        apart += verdict == Verdict::apart;
        undecided_pairs += verdict == Verdict::undecided;
        expanded += signs.expanded();
        shared += Sharing(a, b).count > 0;
        Contact contact;
        const bool is_known = contact_on_line(a, b, NothingExact{}, contact);
        rounded += is_known && contact.count > 0;
        open_contacts += !is_known;
        const auto moving = [&](std::size_t k) { return MovingPoint{cases.start[6 * i + k], cases.end[6 * i + k]}; };
        const FourPoints points{moving(3), moving(0), moving(1), moving(2)};
        const FilteredImpact impact = filtered_impact<FeaturePair::vertex_face>(points);
        ++impacts[static_cast<std::size_t>(impact.verdict)];
        at_start[static_cast<std::size_t>(contact_at_start<FeaturePair::vertex_face>(points) > 0)]++;
        const FilteredDistance distance(
            {FeatureKinds::vertex_face, {points[0].start, points[1].start, points[2].start, points[3].start}});
        ++distances[static_cast<std::size_t>(distance.compare({1, 0}))];
    }
    EXPECT_GE(collide, 30);
    EXPECT_GE(apart, 20);
    EXPECT_EQ(undecided_pairs, 1);
    EXPECT_GE(expanded, 30);
    EXPECT_GE(shared, 18);
    EXPECT_GE(rounded, 10);
    EXPECT_GE(open_contacts, 10);
    for (const int n : impacts) EXPECT_GE(n, 5);
    EXPECT_GE(at_start[1], 5);
    for (const int n : distances) EXPECT_GE(n, 1);
}

}  // namespace
}  // namespace crumple::test
