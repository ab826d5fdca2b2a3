// Tests of the command line of a build with the cuda backend, on machines with and without a device.

#include "cli/run.h"

namespace crumple::cli::test {
namespace {

class CudaCli : public Cli {
   protected:
    CudaCli() { write("five.off", five_off); }
    Outcome without_device(const std::string& arguments) const {
        return shell("CUDA_ON_CPU_DEVICES=0 $crumple " + arguments);
    }
};

TEST_F(CudaCli, detect_runs_on_the_device) {
    const Outcome named = crumple("detect five.off --backend cuda --device 0 --stats");
    EXPECT_EQ(named.status, 0) << named.err;
    EXPECT_EQ(named.out, five_pairs);
    EXPECT_TRUE(contains(named.err, "cuda backend\n")) << named.err;
    const Outcome chosen = crumple("detect five.off --stats");
    EXPECT_EQ(chosen.out, five_pairs);
    EXPECT_TRUE(contains(chosen.err, "cuda backend\n")) << chosen.err;
}

TEST_F(CudaCli, variants_of_the_method_are_searched_on_the_cpu_or_refused) {
    for (const char* option : {"--sweep x", "--membership threshold=0"}) {
        const Outcome chosen = crumple(std::string("detect five.off ") + option);
        EXPECT_EQ(chosen.out, five_pairs) << option;
        EXPECT_TRUE(contains(chosen.err, "use the cpu backend for other methods; the cpu backend is used instead\n"))
            << chosen.err;
        const Outcome named = crumple(std::string("detect five.off --backend cuda ") + option);
        EXPECT_EQ(named.status, 2);
        EXPECT_TRUE(contains(named.err, "the cuda backend sweeps along principal axes")) << named.err;
    }
}

TEST_F(CudaCli, fallback_to_the_cpu_is_explained_in_one_line) {
    for (const char* command : {"detect five.off", "sequence five.off"}) {
        const Outcome outcome = without_device(command);
        EXPECT_EQ(outcome.status, 0);
        EXPECT_TRUE(is_error_line(outcome.err)) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "the cuda backend is not available: ")) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "; the cpu backend is used instead\n")) << outcome.err;
    }
    EXPECT_EQ(without_device("detect five.off").out, five_pairs);
    const Outcome other = crumple("detect five.off --device 1");
    EXPECT_EQ(other.out, five_pairs);
    EXPECT_TRUE(contains(other.err, "device 1 does not exist (number of devices: 1); the cpu backend")) << other.err;
    EXPECT_EQ(without_device("detect five.off --backend cpu").err, "");
}

TEST_F(CudaCli, missing_device_that_is_requested_is_an_error) {
    for (const Outcome& outcome :
         {crumple("detect five.off --backend cuda --device 7"), without_device("detect five.off --backend cuda")}) {
        EXPECT_EQ(outcome.status, 2);
        EXPECT_EQ(outcome.out, "");
        EXPECT_TRUE(is_error_line(outcome.err)) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "the cuda backend is not available: ")) << outcome.err;
    }
}

TEST_F(CudaCli, detect_accepts_several_devices_and_rejects_one_device_twice) {
    const Outcome two = shell("CUDA_ON_CPU_DEVICES=2 $crumple detect --backend cuda --device 1,0 five.off");
    EXPECT_EQ(two.status, 0) << two.err;
    EXPECT_EQ(two.out, five_pairs);
    const Outcome twice = crumple("detect five.off --backend cuda --device 0,0");
    EXPECT_TRUE(contains(twice.err, "all different")) << twice.err;
    EXPECT_NE(twice.status, 0);
    EXPECT_EQ(crumple("detect five.off --backend cpu --device 0,1").status, 2);
}

TEST_F(CudaCli, threads_can_be_set_for_what_the_host_computes) {
    const Outcome outcome = crumple("detect five.off --backend cuda --threads 2");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, five_pairs);
}

TEST_F(CudaCli, info_lists_devices) {
    const Outcome two = shell("CUDA_ON_CPU_DEVICES=2 $crumple info --devices");
    EXPECT_EQ(two.status, 0);
    EXPECT_EQ(std::count(two.out.begin(), two.out.end(), '\n'), 2) << two.out;
    EXPECT_TRUE(two.out.starts_with("0  ")) << two.out;
    EXPECT_TRUE(contains(two.out, "\n1  ")) << two.out;
    EXPECT_TRUE(contains(two.out, ", compute capability ")) << two.out;
    EXPECT_TRUE(contains(two.out, ", 4.0 GiB\n")) << two.out;
    const Outcome none = without_device("info --devices");
    EXPECT_EQ(none.status, 0);
    EXPECT_TRUE(none.out.starts_with("none: the cuda backend is not available: ")) << none.out;
}

}  // namespace
}  // namespace crumple::cli::test
