// Fuzz target: searches, each decoded from an input (decode.h). Broken promises besides what the sanitizers see: an
// answer that differs in a byte from brute force in rational arithmetic, in find, any, the union of parts,
// under a memory limit, with kept detectors and with new ones; a limit that does not suffice though an error named it;
// a contact that is not the rational one, correctly rounded; an error that the other backend does not give.

#include <sanitizer/asan_interface.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <variant>

#include "crumple/crumple.h"
#include "exact/intersection/contact.h"
#include "exact/intersection/rational_intersection.h"
#include "fuzz/decode.h"
#include "fuzz/fail.h"
#include "fuzz/instruction_sets.h"
#include "fuzz/print.h"
#include "fuzz/same.h"

namespace crumple::fuzz {
namespace {

using Input = std::vector<std::uint8_t>;

/// The meshes of a frame as the detector is given them.
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
    void stream(Detector& by, FunctionRef<void(const Intersections&)> take, const IntersectionQuery& query,
                std::int64_t rows) const {
        if (b_)
            by.stream({a(), b()}, query, take, rows);
        else
            by.stream(a(), query, take, rows);
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

/// One search, all its questions.
class Judge {
   public:
    Judge(const Search& search, Detector& reference, Detector& detector)
        : search_(search), reference_(reference), detector_(detector) {}

    void judge() {
        for (const Frame& frame : search_.frames) {
            const Views views(frame);
            const Outcome<Intersections> expected = outcome_of<Intersections>(
                [&]() -> const Intersections& { return views.find(reference_, search_.query); });
            ask(detector_, views, expected);
            const auto* answer = std::get_if<Intersections>(&expected);
            if (!answer) continue;
            if (search_.query.contacts()) check_contacts(frame, *answer);
            if (&frame != &search_.frames.back()) continue;
            if (search_.block_rows > 0) check_blocks(views, *answer);
            if (search_.parts > 0) check_parts(views, frame, *answer);
            if (search_.memory_limit >= 0) check_limit(views, *answer);
        }
    }

   private:
    void ask(Detector& detector, const Views& views, const Outcome<Intersections>& expected) const {
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

    /// No backend rounds contacts by rational arithmetic where less suffices.
    void check_contacts(const Frame& frame, const Intersections& answer) const {
        for (std::size_t i = 0; i < answer.pairs.size(); ++i) {
            const Contact truth = contact(intersect_rationally(triangle(frame.front(), answer.pairs[i].a),
                                                               triangle(frame.back(), answer.pairs[i].b)));
            const auto begin = static_cast<std::size_t>(answer.contacts.offsets[i]);
            const auto count = static_cast<std::size_t>(answer.contacts.offsets[i + 1]) - begin;
            const auto bytes = count * sizeof answer.contacts.points[0];
            if (count != static_cast<std::size_t>(truth.count) || answer.contacts.kinds[i] != truth.kind() ||
                (count > 0 && std::memcmp(&answer.contacts.points[begin], truth.points.data(), bytes) != 0))
                fail("the contact of pair " + std::to_string(i));
        }
    }

    /// Contacts are those of the whole answer, byte by byte.
    static void require_contacts_of(const Intersections& whole, const Intersections& found) {
        const Contacts &theirs = whole.contacts, &ours = found.contacts;
        for (std::size_t i = 0; i < ours.kinds.size(); ++i) {
            const auto w = std::ranges::lower_bound(whole.pairs, found.pairs[i]) - whole.pairs.begin();
            if (w == static_cast<std::ptrdiff_t>(whole.pairs.size())) continue;  // reported by the caller
            const std::int64_t begin = ours.offsets[i], count = ours.offsets[i + 1] - begin;
            const auto bytes = static_cast<std::size_t>(count) * sizeof ours.points[0];
            require(ours.kinds[i] == theirs.kinds[w] && count == theirs.offsets[w + 1] - theirs.offsets[w] &&
                        std::memcmp(&ours.points[begin], &theirs.points[theirs.offsets[w]], bytes) == 0,
                    "a part's contact");
        }
    }

    /// Blocks together have the rows of the result.
    void check_blocks(const Views& views, const Intersections& whole) const {
        Array<Pair> all;
        std::int64_t points = 0;
        const auto take = [&](const Intersections& block) {
            require(static_cast<std::int64_t>(block.pairs.size()) <= search_.block_rows, "a block's size");
            for (const Pair& pair : block.pairs) all.push_back(pair);
            if (search_.query.contacts()) require_contacts_of(whole, block);
            points += static_cast<std::int64_t>(block.contacts.points.size());
        };
        views.stream(detector_, take, search_.query, search_.block_rows);
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
        for (int call = 0; call < 2; ++call) {  // the second one with what the first one has left
            const Outcome<Intersections> found = find(tight);
            if (const auto* error = std::get_if<Error>(&found)) {
                check_bounds(find, options, *error, expected);
                break;
            }
            const Intersections& answer = std::get<Intersections>(found);
            require_same(answer, expected, "under a limit");
            require(answer.statistics.peak_memory_bytes <= options.memory_limit, "a limit is exceeded");
        }
        try {
            require(views.any(tight, search_.query) == !expected.pairs.empty(), "has_collision under a limit");
        } catch (const Error& error) {
            require(error.code == ErrorCode::memory_limit, "has_collision under a limit throws another error");
        }
    }

    /// Checks an error under a limit: what it says is needed is, and limits that are doubled suffice in the end.
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

/// A detector that several inputs use, and which these were: together they are what a finding needs.
struct Kept {
    std::unique_ptr<Detector> detector;
    std::vector<Input> history;
};

Kept& kept_for(const Options& options) {
    constexpr std::size_t most_inputs = 32;
    static Kept slots[64];
    const auto key =
        static_cast<std::size_t>(options.threads + 2 * static_cast<int>(options.simd) + 7 * options.clusters +
                                 5 * options.leaf_size + 3 * options.fuzzy_c_means.max_iterations);
    Kept& kept = slots[key % 64];
    const bool fits = kept.detector && same_options(kept.detector->options(), options);
    if (!fits || kept.history.size() == most_inputs) kept = {std::make_unique<Detector>(options), {}};
    return kept;
}

/// Tells of the search that runs when the process ends: sanitizers and broken promises alike.
const Search* running = nullptr;
const std::vector<Input>* earlier = nullptr;

void tell() {
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
extern "C" __attribute__((visibility("default"))) void __ubsan_on_report() { crumple::fuzz::tell(); }

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    crumple::fuzz::tell_more = crumple::fuzz::tell;
    __asan_set_error_report_callback([](const char*) { crumple::fuzz::tell(); });
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
        if (search.kept) {
            Kept& kept = kept_for(search.options);
            earlier = &kept.history;
            Judge(search, reference, *kept.detector).judge();
            kept.history.emplace_back(data, data + size);
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
