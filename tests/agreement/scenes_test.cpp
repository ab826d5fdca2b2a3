// Compares the tested backend under many combinations of options and queries with brute force, byte by byte, on
// procedural scenes and on soups with exact special cases.

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <sstream>
#include <vector>

#ifndef CRUMPLE_STD_THREADS
#include <tbb/global_control.h>
#endif

#include "agreement/compare.h"
#include "agreement/hard_soups.h"
#include "crumple/error.h"
#include "error_of.h"
#include "halves.h"
#include "memory_limit.h"
#include "rounds.h"
#include "scenes/scenes.h"
#include "tested_backend.h"

namespace crumple::test {
namespace {

#ifndef CRUMPLE_STD_THREADS
// Allows an arena of 16 threads on any machine.
const tbb::global_control sixteen_threads(tbb::global_control::max_allowed_parallelism, 16);
#endif

// The meshes of the tests are the soups, followed by small procedural scenes. A scene is made when a test first uses
// it: each shard of the tests is a process, which uses only some scenes, and simulated ones take long to make.
const std::vector<NamedMesh>& soups() {
    static const std::vector<NamedMesh> all = hard_soups();
    return all;
}

std::size_t mesh_count() { return soups().size() + scenes::descriptions().size(); }

std::string mesh_name(std::size_t i) {
    return i < soups().size() ? soups()[i].name : std::string(scenes::descriptions()[i - soups().size()].name);
}

const io::TriangleMesh& mesh_of(std::size_t i) {
    if (i < soups().size()) return soups()[i].mesh;
    static std::map<std::size_t, io::TriangleMesh> made;
    auto found = made.find(i);
    if (found == made.end()) {
        const scenes::Description& scene = scenes::descriptions()[i - soups().size()];
        const std::int64_t triangles = scene.name == "funnel" ? 600 : 200;  // fewer make no folds
        found = made.emplace(i, scenes::make(scene.name, {.triangles = triangles, .frame = scene.frames - 1})).first;
    }
    return found->second;
}

const bool on_cpu = tested_backend == Backend::cpu;
// Numbers of options, queries and parts to test. They are highest if thorough() is true, and lowest under
// sanitizers and for a device emulated on the CPU (`played`): these runs are slow, and larger numbers would find no
// further memory errors or data races.
constexpr std::size_t cpu_options = sanitized ? 6 : 24;
const std::size_t query_step = thorough() ? 1 : played ? 4 : 2;
const std::vector<int> part_counts = [] {
    if (played) return thorough() ? std::vector{1, 3, 13} : std::vector{3};
    if (sanitized) return std::vector{2, 70};
    return thorough() ? std::vector{1, 2, 3, 8, 31, 64, 150} : std::vector{1, 3, 64};
}();
const std::size_t option_count = on_cpu ? cpu_options : 4;
const std::int64_t limit_step = on_cpu ? 3 : 20;

struct NamedQuery {
    std::string name;
    IntersectionQuery query;
};

/// Returns the queries to test; for a mesh without groups, none that needs groups. Unless thorough() is true, a
/// half or a quarter of the queries, which depends on the number of triangles.
std::vector<NamedQuery> queries(const io::TriangleMesh& mesh) {
    static const std::vector<GroupPair> excluded{{1, -1}, {0, 0}};
    std::vector<NamedQuery> all(1);
    all[0].name = "default";
    const auto add = [&](const char* name, auto change) {
        all.push_back({name, {}});
        change(all.back().query);
    };
    add("contacts", [](IntersectionQuery& q) { q.output = Output::contacts; });
    add("skip", [](IntersectionQuery& q) { q.neighbours = Neighbours::skip; });
    add("proper", [](IntersectionQuery& q) { q.kind = IntersectionKind::proper; });
    add("proper, skip, contacts", [](IntersectionQuery& q) {
        q.neighbours = Neighbours::skip;
        q.kind = IntersectionKind::proper;
        q.output = Output::contacts;
    });
    add("welded", [](IntersectionQuery& q) { q.weld = true; });
    add("welded, skip", [](IntersectionQuery& q) {
        q.weld = true;
        q.neighbours = Neighbours::skip;
    });
    add("between groups", [](IntersectionQuery& q) { q.filter.groups = PairScope::between; });
    add("within groups, contacts", [](IntersectionQuery& q) {
        q.filter.groups = PairScope::within;
        q.output = Output::contacts;
    });
    add("excluded groups", [](IntersectionQuery& q) { q.filter.excluded_groups = excluded; });
    add("between groups, some excluded, welded", [](IntersectionQuery& q) {
        q.filter.groups = PairScope::between;
        q.filter.excluded_groups = excluded;
        q.weld = true;
    });
    const auto needs_groups = [](const NamedQuery& q) {
        return q.query.filter.groups == PairScope::between || !q.query.filter.excluded_groups.empty();
    };
    if (mesh.groups.empty()) std::erase_if(all, needs_groups);
    std::vector<NamedQuery> some;
    for (auto i = static_cast<std::size_t>(mesh.triangle_count()) % query_step; i < all.size(); i += query_step)
        some.push_back(all[i]);
    return some;
}

std::string describe(const Options& o) {
    std::ostringstream text;
    text << o.clusters << " clusters, leaves of " << o.leaf_size << ", " << o.threads << " threads, simd "
         << static_cast<int>(o.simd);
    return text.str();
}

/// Returns default options, and combinations of 1 to 64 clusters, leaf sizes from 1 to 3,000, 1 to 16 threads, and
/// instruction sets. Small leaves give two levels of clusters.
std::vector<Options> option_list() {
    std::vector<Options> list(1);
    list[0].backend = tested_backend;
    constexpr std::array clusters{1, 2, 3, 5, 16, 33, 64};
    constexpr std::array leaves{1, 4, 16, 60, 200, 3000};
    constexpr std::array threads{1, 2, 3, 7, 16};
    constexpr std::array instructions{Simd::automatic, Simd::scalar, Simd::sse4, Simd::avx2, Simd::avx512, Simd::neon};
    for (std::size_t i = 0; i < option_count; ++i) {
        Options o;
        o.backend = tested_backend;
        o.clusters = clusters[i % clusters.size()];
        o.leaf_size = leaves[i % leaves.size()];
        o.threads = threads[i % threads.size()];
        o.simd = instructions[(i + i / 6) % instructions.size()];
        list.push_back(o);
    }
    return list;
}

struct Subject {
    Options options;
    Detector detector;
};

/// Returns a detector for each set of options that the machine supports.
std::vector<Subject> subjects() {
    std::vector<Subject> list;
    for (const Options& o : option_list()) {
        try {
            list.push_back({o, Detector(o)});
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::backend_unavailable) << error.what();
        }
    }
    return list;
}

/// Returns a fifth of the list. Five successive values of `turn` give all five fifths.
std::span<Subject> share(std::vector<Subject>& list, std::size_t turn) {
    constexpr std::size_t parts = 5;
    const std::size_t part = turn % parts, begin = part * list.size() / parts;
    return std::span(list).subspan(begin, (part + 1) * list.size() / parts - begin);
}

class Agreement : public testing::TestWithParam<std::size_t> {
   protected:
    const io::TriangleMesh& scene() const { return mesh_of(GetParam()); }
    std::string scene_name() const { return mesh_name(GetParam()); }
    MeshView view() const { return scene().view(); }
    /// True for more than 1,000 triangles: brute force, at 20 us for each pair of overlapping boxes, would take too
    /// long.
    bool too_large_for_brute_force() const { return scene().triangle_count() > 1'000; }

    Detector reference{{.backend = Backend::reference}};
};

// Each detector runs several queries, so that state kept from one query would show in the next.
TEST_P(Agreement, varied_options_give_brute_force_result) {
    if (too_large_for_brute_force()) GTEST_SKIP() << scene_name();
    std::vector<Subject> list = subjects();
    std::size_t turn = 0;
    for (const auto& [name, query] : queries(scene())) {
        const Intersections& expected = reference.find(view(), query);
        for (auto& [options, detector] : share(list, turn++)) {
            SCOPED_TRACE(testing::Message() << scene_name() << ", " << name << ", " << describe(options));
            EXPECT_TRUE(same_result(detector.find(view(), query), expected));
            EXPECT_EQ(detector.any(view(), query), !expected.pairs.empty());
        }
        EXPECT_EQ(reference.any(view(), query), !expected.pairs.empty()) << scene_name() << ", " << name;
    }
}

TEST_P(Agreement, two_meshes_give_brute_force_result) {
    if (too_large_for_brute_force()) GTEST_SKIP() << scene_name();
    const Halves half(view());
    std::vector<Subject> list = subjects();
    std::size_t turn = 0;
    for (const auto& [name, query] : queries(scene())) {
        const Intersections& expected = reference.find({half.a, half.b}, query);
        for (auto& [options, detector] : share(list, turn++)) {
            SCOPED_TRACE(testing::Message() << scene_name() << ", " << name << ", " << describe(options));
            EXPECT_TRUE(same_result(detector.find({half.a, half.b}, query), expected));
            EXPECT_EQ(detector.any({half.a, half.b}, query), !expected.pairs.empty());
        }
    }
}

/// Joined results of parts: pairs in order, contacts with their pairs.
struct Union {
    struct Contact {
        ContactKind kind;
        std::vector<std::array<double, 3>> points;
        friend bool operator==(const Contact&, const Contact&) = default;
    };
    std::map<Pair, Contact> pairs;

    void add(const Intersections& result) {
        for (std::size_t i = 0; i < result.pairs.size(); ++i) {
            Contact contact{};
            if (!result.contacts.kinds.empty()) {
                contact.kind = result.contacts.kinds[i];
                const auto* points = result.contacts.points.data();
                contact.points.assign(points + result.contacts.offsets[i], points + result.contacts.offsets[i + 1]);
            }
            const bool fresh = pairs.emplace(result.pairs[i], contact).second;
            EXPECT_TRUE(fresh) << "two parts own " << testing::PrintToString(result.pairs[i]);
        }
    }
    std::vector<Pair> list() const {
        std::vector<Pair> result;
        for (const auto& [pair, contact] : pairs) result.push_back(pair);
        return result;
    }
};

TEST_P(Agreement, pairs_and_contacts_of_parts_add_up_to_those_of_the_whole) {
    Detector parted({.backend = tested_backend, .leaf_size = 100});
    IntersectionQuery query;
    query.output = Output::contacts;
    Union whole, whole_between;
    const Halves half(view());
    whole.add(parted.find(view(), query));
    whole_between.add(parted.find({half.a, half.b}, query));
    for (const int count : part_counts) {
        SCOPED_TRACE(testing::Message() << scene_name() << ", " << count << " parts");
        const std::vector<Part> parts = parted.partition(view(), {}, count),
                                between = parted.partition({half.a, half.b}, {}, count);
        ASSERT_EQ(parts.size(), static_cast<std::size_t>(count));
        Union joined, joined_between, joined_reference;
        // Joins parts from the last to the first: their order must not matter.
        for (auto part = parts.rbegin(); part != parts.rend(); ++part) joined.add(parted.find(*part, query));
        for (const Part& part : between) joined_between.add(parted.find(part, query));
        ASSERT_EQ(difference(whole.list(), joined.list()), "");
        ASSERT_TRUE(whole.pairs == joined.pairs) << "contacts differ";
        ASSERT_EQ(difference(whole_between.list(), joined_between.list()), "");
        ASSERT_TRUE(whole_between.pairs == joined_between.pairs) << "contacts between meshes differ";
        if (count > 3 || too_large_for_brute_force()) continue;
        for (const Part& part : parts) joined_reference.add(reference.find(part, query));
        ASSERT_EQ(difference(whole.list(), joined_reference.list()), "") << "reference";
    }
}

TEST_P(Agreement, limited_call_gives_same_result_or_names_larger_limit) {
    IntersectionQuery query;
    query.output = Output::contacts;
    const Options unlimited{.backend = tested_backend, .leaf_size = 100};
    const Intersections expected = Detector(unlimited).find(view(), query);
    for (std::int64_t limit = expected.statistics.peak_memory_bytes; limit > 3'000; limit /= limit_step) {
        SCOPED_TRACE(testing::Message() << scene_name() << ", " << limit << " bytes");
        Options options = unlimited;
        options.memory_limit = limit;
        Detector detector(options);
        try {
            EXPECT_TRUE(same_result(detector.find(view(), query), expected));
        } catch (const Error& error) {
            ASSERT_EQ(error.code, ErrorCode::memory_limit) << error.what();
            EXPECT_GT(error.bytes_needed, limit);
            sufficient_limit(options,
                             [&](Detector& enough) { EXPECT_TRUE(same_result(enough.find(view(), query), expected)); });
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Agreement, testing::Range<std::size_t>(0, mesh_count()),
                         [](const auto& info) { return test_name(mesh_name(info.param)); });

}  // namespace
}  // namespace crumple::test
