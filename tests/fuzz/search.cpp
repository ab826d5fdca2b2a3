// Fuzz target: searches, each decoded from an input (decode.h). Broken promises besides what the sanitizers find: a
// result that differs in a byte from brute force in rational arithmetic, in find, any, streamed blocks, the union of
// parts, or under a memory limit, with reused detectors and with new ones; a memory error although less memory than it
// names suffices; a contact that is not the correctly rounded rational one; an error that the other backend does not
// report.

#include <sanitizer/asan_interface.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <variant>

#include "crumple/crumple.h"
#include "exact/intersection/contact.h"
#include "exact/intersection/exact_intersection.h"
#include "fuzz/decode.h"
#include "fuzz/fail.h"
#include "fuzz/instruction_sets.h"
#include "fuzz/print.h"
#include "fuzz/same.h"

namespace crumple::fuzz {
namespace {

using Input = std::vector<std::uint8_t>;

/// Views of the meshes of a frame, as passed to the detector.
class Views {
   public:
    explicit Views(const Frame& frame) : a_(frame[0]) {
        if (frame.size() > 1) b_.emplace(frame[1]);
    }
    const Intersections& find(Detector& by, const IntersectionQuery& query) const {
        return b_ ? by.find({a(), b()}, query) : by.find(a(), query);
    }
    bool any(Detector& by, const IntersectionQuery& query) const {
        return b_ ? by.any({a(), b()}, query) : by.any(a(), query);
    }
    void stream(Detector& by, FunctionRef<void(const Intersections&)> consume, const IntersectionQuery& query,
                std::int64_t rows) const {
        if (b_)
            by.stream({a(), b()}, query, consume, rows);
        else
            by.stream(a(), query, consume, rows);
    }
    std::vector<Part> partition(Detector& by, int count) const {
        return b_ ? by.partition({a(), b()}, {}, count) : by.partition(a(), {}, count);
    }

   private:
    const MeshView& a() const { return a_.view(); }
    const MeshView& b() const { return b_->view(); }
    Arrays a_;
    std::optional<Arrays> b_;
};

std::string difference(const Array<Pair>& found, const Array<Pair>& expected) {
    std::string text;
    const auto list = [&](const char* what, const Array<Pair>& of, const Array<Pair>& without) {
        for (const Pair& pair : of)
            if (!std::binary_search(without.begin(), without.end(), pair))
                text += std::string(what) + " (" + std::to_string(pair.a) + ", " + std::to_string(pair.b) + ")";
    };
    list(" missing", expected, found);
    list(" extra", found, expected);
    return text.empty() ? " out of order" : text;
}

void require_same(const Intersections& found, const Intersections& expected, const std::string& what) {
    if (!std::ranges::equal(found.pairs, expected.pairs)) fail(what + difference(found.pairs, expected.pairs));
    require_same_bytes(found.offsets, expected.offsets, what + " offsets");
    require_same_bytes(found.hit, expected.hit, what + " hit flags");
    require_same_bytes(found.hit_second, expected.hit_second, what + " hit flags of the second mesh");
    require_same_bytes(found.contacts.kinds, expected.contacts.kinds, what + " contact kinds");
    require_same_bytes(found.contacts.offsets, expected.contacts.offsets, what + " contact offsets");
    require_same_bytes(found.contacts.points, expected.contacts.points, what + " contact points");
}

void require_same(const Outcome<Intersections>& found, const Outcome<Intersections>& expected,
                  const std::string& what) {
    compare(found, expected, what,
            [](const Intersections& f, const Intersections& e, const std::string& w) { require_same(f, e, w); });
}

/// Checks of one search: every query on each frame, and blocks, parts and the memory limit on the last one.
class Judge {
   public:
    Judge(const Search& search, Detector& reference, Detector& detector)
        : search_(search), reference_(reference), detector_(detector) {}

    void judge() {
        for (const Frame& frame : search_.frames) {
            const Views views(frame);
            const Outcome<Intersections> expected = outcome_of<Intersections>(
                [&]() -> const Intersections& { return views.find(reference_, search_.query); });
            check_find(detector_, views, expected);
            const auto* result = std::get_if<Intersections>(&expected);
            if (!result) continue;
            if (search_.query.contacts()) check_contacts(frame, *result);
            if (&frame != &search_.frames.back()) continue;
            if (search_.block_rows > 0) check_blocks(views, *result);
            if (search_.parts > 0) check_parts(views, frame, *result);
            if (search_.memory_limit >= 0) check_limit(views, *result);
        }
    }

   private:
    void check_find(Detector& detector, const Views& views, const Outcome<Intersections>& expected) const {
        const Outcome<Intersections> found =
            outcome_of<Intersections>([&]() -> const Intersections& { return views.find(detector, search_.query); });
        require_same(found, expected, "find");
        if (std::holds_alternative<Error>(expected)) return;
        const bool any = !std::get<Intersections>(expected).pairs.empty();
        if (views.any(detector, search_.query) != any) fail("has_collision");
    }

    static Triangle triangle(const Mesh& mesh, std::int32_t t) {
        Triangle result{{}, {0, 1, 2}};
        for (std::size_t c = 0; c < 3; ++c) {
            const auto& p = mesh.vertices[static_cast<std::size_t>(mesh.triangles[static_cast<std::size_t>(t)][c])];
            result.point[c] = {p[0], p[1], p[2]};
        }
        return result;
    }

    /// Checks contacts against rational arithmetic, since backends use faster arithmetic where it suffices.
    void check_contacts(const Frame& frame, const Intersections& result) const {
        for (std::size_t i = 0; i < result.pairs.size(); ++i) {
            const Contact truth = contact(intersect_rationally(triangle(frame.front(), result.pairs[i].a),
                                                               triangle(frame.back(), result.pairs[i].b)));
            const auto begin = static_cast<std::size_t>(result.contacts.offsets[i]);
            const auto count = static_cast<std::size_t>(result.contacts.offsets[i + 1]) - begin;
            const auto bytes = count * sizeof result.contacts.points[0];
            if (count != static_cast<std::size_t>(truth.count) || result.contacts.kinds[i] != truth.kind() ||
                (count > 0 && std::memcmp(&result.contacts.points[begin], truth.points.data(), bytes) != 0))
                fail("the contact of pair " + std::to_string(i));
        }
    }

    /// Requires the contacts of `found` to equal those of the whole result byte by byte.
    static void require_contacts_of(const Intersections& whole, const Intersections& found) {
        const Contacts &theirs = whole.contacts, &ours = found.contacts;
        for (std::size_t i = 0; i < ours.kinds.size(); ++i) {
            const auto w = std::ranges::lower_bound(whole.pairs, found.pairs[i]) - whole.pairs.begin();
            if (w == static_cast<std::ptrdiff_t>(whole.pairs.size()))
                continue;  // the caller reports such an extra pair
            const std::int64_t begin = ours.offsets[i], count = ours.offsets[i + 1] - begin;
            const auto bytes = static_cast<std::size_t>(count) * sizeof ours.points[0];
            require(ours.kinds[i] == theirs.kinds[w] && count == theirs.offsets[w + 1] - theirs.offsets[w] &&
                        std::memcmp(&ours.points[begin], &theirs.points[theirs.offsets[w]], bytes) == 0,
                    "a part's contact");
        }
    }

    /// Checks that the blocks together have the rows of the result.
    void check_blocks(const Views& views, const Intersections& whole) const {
        Array<Pair> all;
        std::int64_t points = 0;
        const auto consume = [&](const Intersections& block) {
            require(static_cast<std::int64_t>(block.pairs.size()) <= search_.block_rows, "a block's size");
            for (const Pair& pair : block.pairs) all.push_back(pair);
            if (search_.query.contacts()) require_contacts_of(whole, block);
            points += static_cast<std::int64_t>(block.contacts.points.size());
        };
        views.stream(detector_, consume, search_.query, search_.block_rows);
        std::sort(all.begin(), all.end());
        if (!std::ranges::equal(all, whole.pairs)) fail("the blocks:" + difference(all, whole.pairs));
        require(points == static_cast<std::int64_t>(whole.contacts.points.size()), "the blocks' contacts");
    }

    void check_parts(const Views& views, const Frame& frame, const Intersections& whole) const {
        const std::vector<Part> parts = views.partition(detector_, search_.parts);
        require(static_cast<int>(parts.size()) == search_.parts, "as many parts as asked for");
        Array<Pair> all;
        for (std::size_t p = 0; p < parts.size(); ++p) {
            const Part& part = parts[p];
            require(part.index == static_cast<std::int32_t>(p), "a part's index");
            require(part.second.has_value() == (frame.size() > 1), "a part's second mesh");
            const std::vector<std::int32_t>&first = part.mesh.ids, &second = part.second ? part.second->ids : first;
            const Intersections& found = detector_.find(part, search_.query);
            for (const Pair& pair : found.pairs) {
                require(std::ranges::binary_search(first, pair.a) && std::ranges::binary_search(second, pair.b),
                        "a part owns a pair of triangles that it does not hold");
                all.push_back(pair);
            }
            require_contacts_of(whole, found);
            if (p == parts.size() / 2) require_same(reference_.find(part, search_.query), found, "a part");
        }
        std::sort(all.begin(), all.end());
        if (!std::ranges::equal(all, whole.pairs)) fail("the union of parts:" + difference(all, whole.pairs));
    }

    void check_limit(const Views& views, const Intersections& expected) const {
        const auto find = [&](Detector& by) {
            return outcome_of<Intersections>([&]() -> const Intersections& { return views.find(by, search_.query); });
        };
        Options options = search_.options;
        options.memory_limit = 1 + search_.memory_limit;
        Detector tight(options);
        for (int call = 0; call < 2; ++call) {  // the second call starts with the caches of the first
            const Outcome<Intersections> found = find(tight);
            if (const auto* error = std::get_if<Error>(&found)) {
                check_bounds(find, options, *error, expected);
                break;
            }
            const Intersections& result = std::get<Intersections>(found);
            require_same(result, expected, "under a limit");
            require(result.statistics.peak_memory_bytes <= options.memory_limit, "a limit is exceeded");
        }
        try {
            require(views.any(tight, search_.query) == !expected.pairs.empty(), "has_collision under a limit");
        } catch (const Error& error) {
            require(error.code == ErrorCode::memory_limit, "has_collision under a limit throws another error");
        }
    }

    /// Checks an error under a memory limit: a search fails under a limit of bytes_needed - 1, and succeeds after the
    /// limit has been doubled often enough.
    template <class Find>
    void check_bounds(Find find, Options options, const Error& error, const Intersections& expected) const {
        if (error.code != ErrorCode::memory_limit || error.bytes_needed <= options.memory_limit)
            fail(std::string("under a limit: ") + error.what());
        while (true) {
            options.memory_limit = std::max(2 * options.memory_limit, error.bytes_needed);
            Detector larger(options);
            const Outcome<Intersections> found = find(larger);
            const auto* refused = std::get_if<Error>(&found);
            if (refused && refused->code == ErrorCode::memory_limit) continue;
            require_same(found, expected, "under a limit that suffices");
            break;
        }
        options.memory_limit = error.bytes_needed - 1;
        Detector insufficient(options);
        if (std::holds_alternative<Intersections>(find(insufficient)))
            fail("less than " + std::to_string(error.bytes_needed) + " bytes suffice");
    }

    const Search& search_;
    Detector &reference_, &detector_;
};

bool same_options(const Options& a, const Options& b) {
    return a.threads == b.threads && a.simd == b.simd && a.clusters == b.clusters && a.leaf_size == b.leaf_size &&
           a.fuzzy_c_means == b.fuzzy_c_means;
}

/// A detector that several inputs use, and these inputs: all of them are needed to reproduce a failure.
struct ReusedDetector {
    std::unique_ptr<Detector> detector;
    std::vector<Input> history;
};

ReusedDetector& reused_for(const Options& options) {
    constexpr std::size_t most_inputs = 32;
    static ReusedDetector slots[64];
    const auto key =
        static_cast<std::size_t>(options.threads + 2 * static_cast<int>(options.simd) + 7 * options.clusters +
                                 5 * options.leaf_size + 3 * options.fuzzy_c_means.max_iterations);
    ReusedDetector& reused = slots[key % 64];
    const bool fits = reused.detector && same_options(reused.detector->options(), options);
    if (!fits || reused.history.size() == most_inputs) reused = {std::make_unique<Detector>(options), {}};
    return reused;
}

/// Search under test, and the earlier inputs of its detector. print_input() prints them when a sanitizer report or a
/// broken promise ends the process.
const Search* running = nullptr;
const std::vector<Input>* earlier = nullptr;

void print_input() {
    if (!running) return;
    std::fprintf(stderr, "\n%s\n", as_code(*running).c_str());
    for (const Input& input : earlier ? *earlier : std::vector<Input>{}) {
        std::fprintf(stderr, "the detector has seen ");
        for (const std::uint8_t byte : input) std::fprintf(stderr, "%02x", byte);
        std::fprintf(stderr, "\n");
    }
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
    Search search{Bytes({data, size})};
    search.options.simd = present(search.options.simd);
    static Detector reference = [] {
        Options options;
        options.backend = Backend::reference;
        return Detector(options);
    }();
    running = &search;
    try {
        if (search.reused) {
            ReusedDetector& reused = reused_for(search.options);
            earlier = &reused.history;
            Judge(search, reference, *reused.detector).judge();
            reused.history.emplace_back(data, data + size);
        } else {
            earlier = nullptr;
            Detector fresh(search.options);
            Judge(search, reference, fresh).judge();
        }
    } catch (const std::exception& error) {
        fail(std::string("an exception: ") + error.what());
    }
    running = nullptr;
    return 0;
}
