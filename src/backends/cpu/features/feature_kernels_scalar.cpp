// Kernels of queries about features in plain C++. The arithmetic for one triangle or pair is in filters/features/,
// shared with devices.

#include "backends/cpu/features/feature_kernels.h"
#include "backends/cpu/features/feature_member.h"
#include "backends/cpu/stages/align.h"
#include "filters/features/feature_filters.h"
#include "filters/features/separating_direction.h"

namespace crumple::cpu {
namespace {

template <int moments>
void build(const BuildInput& in, const SceneFeatures& features, FeatureRecord<moments>* record, Boxes& boxes,
           LeafBounds& bounds) {
    bounds = {};
    for (std::int64_t i = 0; i < in.members; ++i) {
        Vec3d p[3 * moments];
        corners_of<moments>(in, in.triangle[i], p);
        const auto member = widened<moments>(in, in.triangle[i], p);
        write_geometry<moments>(p, member, record[i]);
        write_feature_ids(in, in.triangle[i], features, record[i]);
        add_box(member, i, boxes, bounds);
    }
}

template <int moments>
void scatter(const FeatureRecord<moments>* record, std::int64_t n, const std::int32_t* position,
             FeatureRecord<moments>* sorted) {
    for (std::int64_t i = 0; i < n; ++i) sorted[position[i]] = record[i];
}

template <int moments>
std::size_t separate(const FeatureRecord<moments>* record, const CandidateChunk& candidates, const NeededGap& gap,
                     std::uint32_t* left) {
    const FeatureRecord<moments>* rows = record + candidates.rows;
    const FeatureRecord<moments>* columns = record + candidates.columns;
    std::size_t count = 0;
    for (std::int64_t k = 0; k < candidates.count; ++k) {
        const std::uint32_t i = candidates.row[k], j = candidates.column[k];
        if (j == candidates.dummy) continue;
        left[count] = j << 16 | i;
        count += !surely_apart(rows[i], columns[j], gap.of(rows[i], columns[j]));
    }
    return count;
}

template <int moments>
void list(const PairsLeft<moments>& pairs, const std::int32_t* names, TestList& vertex_face, TestList& edge_edge) {
    const auto name = [&](std::int32_t vertex) { return names ? names[vertex] : vertex; };
    const auto add = [](TestList& listed, std::size_t pair, unsigned bits) {
        for (; bits; bits &= bits - 1)
            listed.test[listed.count++] =
                static_cast<std::uint32_t>(pair << 4) | static_cast<unsigned>(__builtin_ctz(bits));
    };
    for (std::size_t pair = 0; pair < pairs.count; ++pair) {
        const TestsOfPair tests = tests_of_pair(pairs.row(pair), pairs.column(pair), name);
        add(vertex_face, pair, tests.vertex_face);
        add(edge_edge, pair, tests.edge_edge);
    }
}

template <FeatureKind kind, int moments>
std::size_t filter(const PointRows& points, std::int64_t ends, RequestedDistance distance, FeatureTest* test,
                   std::size_t count) {
    std::size_t left = 0;
    for (std::size_t i = 0; i < count; ++i) {
        FeatureVectors<moments> seen;
        for (int m = 0; m < moments; ++m) {
            const auto at = [&](int k) { return points[static_cast<std::int32_t>(test[i].vertex[k] + m * ends)]; };
            for (int k = 0; k < 3; ++k) seen.to[m][k] = to_float(at(k + 1) - at(0));
        }
        if (!surely_far<kind>(seen, distance.template of<kind>(i, seen))) test[left++] = test[i];
    }
    return left;
}

template <FeatureKind kind, int moments>
std::size_t filter_list(const PointRows& points, std::int64_t ends, RequestedDistance distance,
                        const PairsLeft<moments>& pairs, TestList& listed, FeatureTest* test) {
    for (std::size_t i = 0; i < listed.count; ++i) write_test<kind>(pairs, listed, i, test[i]);
    return filter<kind, moments>(points, ends, distance, test, listed.count);
}

template <int moments>
constexpr FeatureKernels<moments> table{
    build<moments>,
    scatter<moments>,
    separate<moments>,
    list<moments>,
    {filter_list<FeatureKind::vertex_face, moments>, filter_list<FeatureKind::edge_edge, moments>},
    {filter<FeatureKind::vertex_face, moments>, filter<FeatureKind::edge_edge, moments>,
     filter<FeatureKind::vertex_face, moments>, filter<FeatureKind::vertex_face, moments>}};

}  // namespace

const FeatureTables scalar_features{table<1>, table<2>, leave_unresolved};

}  // namespace crumple::cpu
