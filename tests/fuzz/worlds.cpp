// Fuzz target: worlds of bodies, each decoded from an input (decode_world.h). Broken promises besides what the
// sanitizers find: a result that differs in a byte from brute force in rational arithmetic, in any of several calls of
// one detector that caches named shapes, with and without a memory limit; an error that the other backend does not
// report.

#include <sanitizer/asan_interface.h>

#include <optional>

#include "crumple/crumple.h"
#include "fuzz/decode_world.h"
#include "fuzz/fail.h"
#include "fuzz/instruction_sets.h"
#include "fuzz/same.h"

namespace crumple::fuzz {
namespace {

void require_same(const Intersections& found, const Intersections& expected, const std::string& what) {
    require_same_bytes(found.bodies, expected.bodies, what + " bodies");
    require_same_bytes(found.pairs, expected.pairs, what + " pairs");
    if (found.any != expected.any || found.count != expected.count)
        fail(what + ": any " + std::to_string(found.any) + ", count " + std::to_string(found.count) + " instead of " +
             std::to_string(expected.any) + ", " + std::to_string(expected.count));
    require_same_bytes(found.world_hit, expected.world_hit, what + " flags of worlds");
    require_same_bytes(found.world_counts, expected.world_counts, what + " counts of worlds");
    require_same_bytes(found.world_offsets, expected.world_offsets, what + " offsets of worlds");
    require_same_bytes(found.body_offsets, expected.body_offsets, what + " offsets of bodies");
    require_same_bytes(found.first_triangle, expected.first_triangle, what + " first triangles");
    require_same_bytes(found.hit, expected.hit, what + " hit flags");
    require_same_bytes(found.contacts.kinds, expected.contacts.kinds, what + " contact kinds");
    require_same_bytes(found.contacts.offsets, expected.contacts.offsets, what + " contact offsets");
    require_same_bytes(found.contacts.points, expected.contacts.points, what + " contact points");
}

using FindOutcome = Outcome<Intersections>;

class Judge {
   public:
    Judge(const Bodies& bodies, Detector& reference) : bodies_(bodies), reference_(reference) {
        arrays_.reserve(bodies.shapes.size());
        shapes_.reserve(bodies.shapes.size());
        for (std::size_t s = 0; s < bodies.shapes.size(); ++s) {
            arrays_.emplace_back(bodies.shapes[s]);
            shapes_.emplace_back(arrays_.back().view(), bodies.names[s]);
        }
    }

    void judge() {
        Detector detector(bodies_.options);
        Options options = bodies_.options;
        options.memory_limit = 1 + bodies_.memory_limit;
        std::optional<Detector> tight;
        if (bodies_.memory_limit >= 0) tight.emplace(options);
        for (const Call& call : bodies_.calls) {
            const FindOutcome expected = run(reference_, call);
            require_outcome(run(detector, call), expected, "find");
            if (tight) check_limit(*tight, call, expected);
        }
    }

   private:
    FindOutcome run(Detector& by, const Call& call) const {
        return outcome_of<Intersections>([&]() -> const Intersections& {
            return by.find(World{shapes_, bodies_.bodies, call.poses}, call.query);
        });
    }
    /// Requires equal results, and an error where the reference reports an invalid argument. A backend may report any
    /// of several errors, and a search may skip bodies with errors (docs/worlds.md).
    static void require_outcome(const FindOutcome& found, const FindOutcome& expected, const std::string& what) {
        const Error *error = std::get_if<Error>(&found), *expected_error = std::get_if<Error>(&expected);
        if (error && !expected_error) fail(what + " throws: " + error->what());
        const bool of_call = (expected_error && expected_error->code == ErrorCode::invalid_argument) ||
                             (error && error->code == ErrorCode::invalid_argument);
        if (of_call && (!error || error->code != expected_error->code))
            fail(what + " throws " + (error ? error->what() : "nothing") + " instead of " + expected_error->what());
        if (!error && !expected_error)
            require_same(std::get<Intersections>(found), std::get<Intersections>(expected), what);
    }

    void check_limit(Detector& tight, const Call& call, const FindOutcome& expected) const {
        const FindOutcome found = run(tight, call);
        const std::int64_t limit = tight.options().memory_limit;
        const Error* error = std::get_if<Error>(&found);
        if (!error || error->code != ErrorCode::memory_limit) {
            require_outcome(found, expected, "under a limit");
            if (!error && std::get<Intersections>(found).statistics.peak_memory_bytes > limit)
                fail("a limit is exceeded");
            return;
        }
        if (error->bytes_needed <= limit) fail(std::string("under a limit: ") + error->what());
    }

    const Bodies& bodies_;
    Detector& reference_;
    std::vector<Arrays> arrays_;
    std::vector<Shape> shapes_;
};

/// Worlds under test. print_input() prints them when a sanitizer report or a broken promise ends the process.
const Bodies* running = nullptr;

void print_input() {
    if (running) std::fprintf(stderr, "\n%s\n", as_code(*running).c_str());
    running = nullptr;
}

}  // namespace
}  // namespace crumple::fuzz

// Called by UndefinedBehaviorSanitizer before it ends the process.
extern "C" __attribute__((visibility("default"))) void __ubsan_on_report() { crumple::fuzz::print_input(); }

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    crumple::fuzz::on_failure = crumple::fuzz::print_input;
    __asan_set_error_report_callback([](const char*) { crumple::fuzz::print_input(); });
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace crumple;
    using namespace crumple::fuzz;
    Bodies bodies{Bytes({data, size})};
    bodies.options.simd = present(bodies.options.simd);
    static Detector reference(Options{.backend = Backend::reference});
    running = &bodies;
    try {
        Judge(bodies, reference).judge();
    } catch (const std::exception& error) {
        fail(std::string("an exception: ") + error.what());
    }
    running = nullptr;
    return 0;
}
