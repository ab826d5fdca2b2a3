#include "results/owned_features.h"

#include <vector>

#include "partition/levels.h"

namespace crumple {
namespace {

/// Triangle that owns each feature of the part; -1: the owner is not in the part.
struct OwnersInPart {
    std::vector<std::int32_t> points, edges;

    OwnersInPart(const PreparedScene& scene, const SceneFeatures& features)
        : points(static_cast<std::size_t>(features.points()), -1), edges(features.edges().size(), -1) {
        for (std::int32_t t = 0; t < scene.triangle_count(); ++t) {
            const std::uint8_t owned = features.owned(t);
            for (int k = 0; k < 3; ++k) {
                if (owned >> k & 1) points[static_cast<std::size_t>(features.point_of(t, k))] = t;
                if (!(owned >> (3 + k) & 1)) continue;
                edges[static_cast<std::size_t>(features.edges_of(t)[static_cast<std::size_t>(k)])] = t;
            }
        }
    }
    std::int32_t of(FeatureType type, std::int32_t feature) const {
        if (type == FeatureType::face) return feature;
        return (type == FeatureType::edge ? edges : points)[static_cast<std::size_t>(feature)];
    }
};

}  // namespace

void keep_owned(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result) {
    const Levels levels(request.part);
    const OwnersInPart owners(scene, request.features);
    result.any = false;
    result.first = {};
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const auto kind = static_cast<FeatureKind>(k);
        const FeatureTypes types = types_of(kind);
        FeatureRows& rows = result.rows[kind];
        std::size_t kept = 0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const FeatureHit hit = rows[i];
            if (!levels.own(owners.of(types.first, hit.pair.a), owners.of(types.second, hit.pair.b))) continue;
            rows.set(kept++, hit);
            result.any = true;
            if (request.criterion == Criterion::impact && request.extent != Extent::any &&
                (!result.first.found || hit.value < result.first.toi))
                result.first = {true, kind, hit.pair, {}, hit.value, hit.flag != 0};
        }
        rows.resize(request.extent == Extent::all ? kept : 0);
    }
}

}  // namespace crumple
