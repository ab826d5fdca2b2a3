// Plain C++ for the kernels of questions about features. The arithmetic for one triangle or pair is in
// questions/features/, shared with devices.

#include "engine/cpu/align.h"
#include "questions/features/cpu/kernels.h"
#include "questions/features/feature_filters.h"
#include "questions/features/length.h"
#include "questions/features/separation.h"

namespace crumple::cpu {
namespace {

template <int moments>
void build(const BuildInput& in, const SceneFeatures& features, FeatureRecord<moments>* record, Boxes& boxes,
           LeafBounds& bounds) {
    bounds = {};
    for (std::int64_t i = 0; i < in.members; ++i) {
        const std::int32_t t = in.triangle[i];
        const std::int32_t* corner = in.corners + 3 * std::int64_t{t};
        Vec3d p[3 * moments];
        float way = 0;
        for (int k = 0; k < 3; ++k) {
            p[k] = in.points[corner[k]];
            if constexpr (moments == 2) {
                p[3 + k] = in.points[static_cast<std::int32_t>(corner[k] + in.ends)];
                way = max(way, length(to_float(p[3 + k] - p[k])));
            }
        }
        InFrame<3 * moments> member(p, in.frame);
        const float more = in.inflation.of(t)(way);
        member.low = member.low - Vec3f{more, more, more};
        member.high = member.high + Vec3f{more, more, more};
        member.reach += more;
        FeatureRecord<moments>& r = record[i];
        write_geometry<moments>(p, member, r);
        const TriangleEdges& edges = features.edges_of(t);
        for (std::size_t k = 0; k < 3; ++k) r.vertex[k] = corner[k], r.edge[k] = edges[k];
        r.triangle = t;
        r.owned = features.owned(t);
        add_box(member, i, boxes, bounds);
    }
}

template <int moments>
void scatter(const FeatureRecord<moments>* record, std::int64_t n, const std::int32_t* position,
             FeatureRecord<moments>* sorted) {
    for (std::int64_t i = 0; i < n; ++i) sorted[position[i]] = record[i];
}

template <int moments>
std::size_t separate(const FeatureRecord<moments>* record, const Candidates& candidates, float gap,
                     std::uint32_t* left) {
    const FeatureRecord<moments>* rows = record + candidates.rows;
    const FeatureRecord<moments>* columns = record + candidates.columns;
    std::size_t count = 0;
    for (std::int64_t k = 0; k < candidates.count; ++k) {
        const std::uint32_t i = candidates.row[k], j = candidates.column[k];
        if (j == candidates.dummy) continue;
        left[count] = j << 16 | i;
        count += !surely_apart(rows[i], columns[j], gap);
    }
    return count;
}

template <FeatureKind kind, int moments>
std::size_t filter(const PointRows& points, std::int64_t ends, AskedDistance distance, FeatureTest* test,
                   std::size_t count) {
    std::size_t left = 0;
    for (std::size_t i = 0; i < count; ++i) {
        SeenFeatures<moments> seen;
        for (int m = 0; m < moments; ++m) {
            const auto at = [&](int k) { return points[static_cast<std::int32_t>(test[i].vertex[k] + m * ends)]; };
            for (int k = 0; k < 3; ++k) seen.to[m][k] = to_float(at(k + 1) - at(0));
        }
        if (!surely_far<kind>(seen, distance.of(i))) test[left++] = test[i];
    }
    return left;
}

template <int moments>
constexpr FeatureKernels<moments> table{
    build<moments>,
    scatter<moments>,
    separate<moments>,
    {filter<FeatureKind::vertex_face, moments>, filter<FeatureKind::edge_edge, moments>,
     filter<FeatureKind::vertex_face, moments>, filter<FeatureKind::vertex_face, moments>}};

}  // namespace

const FeatureTables scalar_features{table<1>, table<2>};

}  // namespace crumple::cpu
