// Queries about the features of a mesh in device memory. The host finds edges and owners from the triangles, which it
// downloads once. In each call the device compares its triangles with those; if they have changed, the host downloads
// them again. Everything else stays on the device.

#include <optional>
#include <type_traits>
#include <variant>

#include "crumple/error.h"
#include "search/feature_search.h"

namespace crumple {
namespace {

bool rules_there(const Shape& shape, const PairFilter& rules) {
    // The groups of features that no triangle names are known in scenes of bodies only.
    const bool by_groups = rules.groups != PairScope::both || !rules.excluded_groups.empty();
    return rules.bodies == PairScope::both && rules.excluded_bodies.empty() &&
           !(by_groups && (shape.edges || shape.points));
}

/// Throws for queries that find() would run on a copy on the host: launches do not.
template <class Question>
void refuse_what_is_not_there(const Shape& shape, const Question& question) {
    if (FeatureSearch::answers_there(shape, question)) return;
    throw Error(ErrorCode::invalid_argument,
                std::is_same_v<Question, ImpactQuery>
                    ? "launches make no triangle pairs, weld nothing, and know no rules about groups where edges or "
                      "points are listed: find() does, with a copy on the host"
                : std::is_same_v<Question, ProximityQuery>
                    ? "launches tell no closest points and no least distances, weld nothing, and know no rules about "
                      "groups where edges or points are listed: find() does, with a copy on the host"
                    : "launches weld nothing, and know no rules about groups where edges or points are listed: "
                      "find() does, with a copy on the host",
                Element::option);
}

}  // namespace

bool FeatureSearch::answers_there(const Shape& shape, const ImpactQuery& question) {
    return !question.weld && !question.triangle_pairs && rules_there(shape, question.filter);
}
bool FeatureSearch::answers_there(const Shape& shape, const ProximityQuery& question) {
    return !question.weld && !question.closest && !question.least && rules_there(shape, question.filter);
}
bool FeatureSearch::answers_there(const Shape& shape, const CandidateQuery& question) {
    return !question.weld && rules_there(shape, question.filter);
}

// Makes the features of the mesh's current contents.
void FeatureSearch::know(BackendBase& backend, const DeviceShape& mesh) {
    HostShape host;
    backend.features_there().copy_to_host(mesh, Copied::topology, host);
    const Shape& shape = host.shape;
    const PreparedScene scene =
        prepare_scene(MeshView(shape.vertices, shape.triangles), nullptr, false, backend, buffers_);
    features_.prepare(scene, false, backend, checked_lists(shape, ""));
}

// Calls ask(request) until the device confirms that the features are current.
template <class Question, class Ask>
auto FeatureSearch::ask_there(BackendBase& backend, const DeviceShape& mesh, const Question& question, Ask ask) {
    rule_.prepare(question.filter);
    if (!features_.has_counts_of(mesh.shape)) know(backend, mesh);
    for (;; know(backend, mesh)) {
        cancellation_.check();
        FeatureRequest request = request_of(question, frugal_, features_, rule_);
        if constexpr (is_near<Question>) near_input_.tell(mesh.shape.vertices.rows, backend, cancellation_, request);
        if (auto answer = ask(request)) return answer;
    }
}

template <class Query>
void FeatureSearch::find_rows_there(BackendBase& backend, const Query& query) {
    ask_there(backend, *there_, query,
              [&](const FeatureRequest& request) { return backend.features_there().find(*there_, request, found_); });
}

template <class Query>
void FeatureSearch::find_there(BackendBase& backend, const DeviceShape& mesh, const Query& query, bool frugal,
                               typename Query::Result& result) {
    bodies_ = false;
    frugal_ = frugal;
    const Body body{.self = true};
    struct There {
        const DeviceShape*& there;
        ~There() { there = nullptr; }
    } const there{there_ = &mesh};
    search(backend, {{&mesh.shape, 1}, {&body, 1}, {}, {}}, query, result);
}

// Reads the inputs of a launch, or of one that is run again.
template <class Question>
void FeatureSearch::look_there(BackendBase& backend, const DeviceShape& mesh, const Question& question) {
    frugal_ = false;
    const Body body{.self = true};
    read({{&mesh.shape, 1}, {&body, 1}, {}, {}}, question.filter);
    if constexpr (is_near<Question>) {
        near_input_.begin(outline_, question, false, false, backend, buffers_);
        near_input_.place(mesh.shape);
    }
}

template <class Question>
LaunchNumber FeatureSearch::launch(BackendBase& backend, const DeviceShape& mesh, const Question& question) {
    DeviceFeatureCalls& there = backend.features_there();
    refuse_what_is_not_there(mesh.shape, question);
    look_there(backend, mesh, question);
    if (there.is_captured(mesh) && !features_.has_counts_of(mesh.shape)) fail_unprepared_capture(false);
    const LaunchNumber launched =
        ask_there(backend, mesh, question, [&](const auto& query) { return there.launch(mesh, query); });
    launched_[launched % most_in_flight] = {mesh, question};
    return launched;
}

DeviceAnswer FeatureSearch::wait(BackendBase& backend, LaunchNumber launch) {
    DeviceFeatureCalls& there = backend.features_there();
    const Launched& launched = launched_[launch % most_in_flight];
    std::optional<DeviceAnswer> answer = there.wait(launch);
    if (!answer)
        answer = std::visit(
            [&](const auto& question) {
                look_there(backend, launched.mesh, question);
                return ask_there(backend, launched.mesh, question,
                                 [&](const auto& query) { return there.find_again(launch, launched.mesh, query); });
            },
            launched.question);
    answer->statistics.triangles = launched.mesh.shape.triangles.rows;
    answer->statistics.pairs = answer->count;
    return *answer;
}

template void FeatureSearch::find_there(BackendBase&, const DeviceShape&, const ImpactQuery&, bool, Impacts&);
template void FeatureSearch::find_there(BackendBase&, const DeviceShape&, const ProximityQuery&, bool, Proximities&);
template void FeatureSearch::find_there(BackendBase&, const DeviceShape&, const CandidateQuery&, bool, Candidates&);
template void FeatureSearch::find_rows_there(BackendBase&, const ImpactQuery&);
template void FeatureSearch::find_rows_there(BackendBase&, const ProximityQuery&);
template void FeatureSearch::find_rows_there(BackendBase&, const CandidateQuery&);
template LaunchNumber FeatureSearch::launch(BackendBase&, const DeviceShape&, const ImpactQuery&);
template LaunchNumber FeatureSearch::launch(BackendBase&, const DeviceShape&, const ProximityQuery&);
template LaunchNumber FeatureSearch::launch(BackendBase&, const DeviceShape&, const CandidateQuery&);

}  // namespace crumple
