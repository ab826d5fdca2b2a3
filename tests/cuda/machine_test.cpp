// What only the machine that plays the device can show: no device, no driver, no memory.

#include <gtest/gtest.h>

#include "agreement/compare.h"
#include "crumple/error.h"
#include "cuda_on_cpu/machine/settings.h"
#include "scenes/scenes.h"

namespace crumple::test {
namespace {

using cuda_on_cpu::settings;

class CudaMachine : public testing::Test {
   protected:
    void TearDown() override {
        settings() = {};
        settings().multiprocessors = 1;
    }
    static std::string message() {
        try {
            Detector({.backend = Backend::cuda});
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::backend_unavailable);
            return std::string(error.what()).substr(0, 37);
        }
        return "no error";
    }
};

TEST_F(CudaMachine, may_have_no_device) {
    settings().devices = 0;
    EXPECT_EQ(message(), "the cuda backend is not available: no");  // CUDA has its own words for the reason
}

TEST_F(CudaMachine, may_have_no_driver) {
    settings().driver = false;
    EXPECT_EQ(message().substr(0, 34), "the cuda backend is not available:");
}

TEST_F(CudaMachine, may_not_have_the_device_asked_for) {
    try {
        Detector({.backend = Backend::cuda, .device = 3});
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "the cuda backend is not available: device 3 of 1 does not exist");
    }
}

TEST_F(CudaMachine, lists_its_devices_or_says_why_there_are_none) {
    settings().devices = 2;
    const DeviceList two = list_devices();
    ASSERT_EQ(two.devices.size(), 2u);
    EXPECT_EQ(two.reason, "");
    EXPECT_EQ(two.devices[1].number, 1);
    EXPECT_NE(two.devices[1].name, "");
    EXPECT_GE(two.devices[1].major, 7);
    EXPECT_EQ(two.devices[1].memory_bytes, static_cast<std::int64_t>(settings().device_bytes));
    settings().devices = 0;
    EXPECT_TRUE(list_devices().devices.empty());
    EXPECT_TRUE(list_devices().reason.starts_with("the cuda backend is not available: ")) << list_devices().reason;
    settings().devices = 1;
    settings().driver = false;
    EXPECT_TRUE(list_devices().devices.empty());
    EXPECT_TRUE(list_devices().reason.starts_with("the cuda backend is not available: ")) << list_devices().reason;
}

TEST_F(CudaMachine, is_taken_by_the_automatic_backend_if_it_has_a_device) {
    const io::TriangleMesh mesh = scenes::make("cloth", {.triangles = 100, .frame = 40});
    const auto chosen = [&](const Options& options) {
        Detector detector(options);
        const std::string backend(detector.find_self(mesh.view()).statistics.backend);
        return backend + (detector.fallback().empty() ? "" : ": " + std::string(detector.fallback()));
    };
    EXPECT_EQ(chosen({}), "cuda");
    EXPECT_EQ(chosen({.backend = Backend::cpu}), "cpu");
    EXPECT_EQ(chosen({.device = 1}), "cpu: the cuda backend is not available: device 1 of 1 does not exist");
    settings().devices = 0;
    EXPECT_EQ(chosen({}).substr(0, 40), "cpu: the cuda backend is not available: ");
}

TEST_F(CudaMachine, may_run_out_of_memory_anywhere) {
    const io::TriangleMesh mesh = scenes::make("cloth", {.triangles = 300, .frame = 93});
    for (const Query& query : {Query{}, Query{.contacts = true}}) {
        const Collisions expected = Detector({.backend = Backend::cpu}).find_self(mesh.view(), query);
        int failures = 0;
        for (int allocations = 0; allocations < 14; ++allocations) {
            Detector detector({.backend = Backend::cuda});
            settings().allocations_before_failure = allocations;
            try {
                EXPECT_TRUE(same_answer(detector.find_self(mesh.view(), query), expected));
            } catch (const Error& error) {
                ++failures;
                EXPECT_EQ(error.code, ErrorCode::device) << error.what();
            }
            settings().allocations_before_failure = -1;
            EXPECT_TRUE(same_answer(detector.find_self(mesh.view(), query), expected)) << "after " << allocations;
        }
        EXPECT_LT(failures, 8);
    }
}

// As much memory as a limit that suffices is enough, too.
TEST_F(CudaMachine, may_have_little_memory) {
    const io::TriangleMesh mesh = scenes::make("cloth", {.triangles = 600, .frame = 93});
    const Query query{.contacts = true};
    const Collisions expected = Detector({.backend = Backend::cpu}).find_self(mesh.view(), query);
    const auto most = Detector({.backend = Backend::cuda}).find_self(mesh.view(), query).statistics.peak_memory_bytes;
    int answers = 0, failures = 0;
    for (std::int64_t bytes = most; bytes > 10'000; bytes -= bytes / 5) {
        SCOPED_TRACE(testing::Message() << bytes << " bytes");
        const auto answers_with = [&](const Options& options) {
            try {
                Detector detector(options);
                EXPECT_TRUE(same_answer(detector.find_self(mesh.view(), query), expected));
                return true;
            } catch (const Error& error) {
                EXPECT_EQ(error.code, options.memory_limit ? ErrorCode::memory_limit : ErrorCode::device);
                return false;
            }
        };
        const bool within_limit = answers_with({.backend = Backend::cuda, .memory_limit = bytes});
        settings().device_bytes = static_cast<std::size_t>(bytes);
        const bool within_device = answers_with({.backend = Backend::cuda});
        settings().device_bytes = std::size_t{1} << 30;
        EXPECT_GE(within_device, within_limit);
        ++(within_device ? answers : failures);
    }
    EXPECT_GT(answers, 2);
    EXPECT_GT(failures, 2);
}

}  // namespace
}  // namespace crumple::test
