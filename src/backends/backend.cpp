#include "backends/backend.h"

#include <string>

#include "crumple/error.h"

namespace crumple {
namespace {

[[noreturn]] void refuse() {
    throw Error(ErrorCode::invalid_argument, "meshes in device memory need the cuda backend (Options::backend)",
                Element::option);
}
[[noreturn]] void refuse_worlds() {
    throw Error(ErrorCode::invalid_argument, "poses in device memory need the cuda backend (Options::backend)",
                Element::option);
}
[[noreturn]] void refuse_blocks() {
    throw Error(ErrorCode::invalid_argument, "answers in blocks need the cpu backend (Options::backend)",
                Element::option);
}

}  // namespace

void fail_unprepared_capture(Asked question) {
    throw Error(ErrorCode::invalid_argument,
                std::string("a launch in a capture needs two calls before it, outside of the capture, with ") +
                    (question == Asked::worlds ? "the same bodies and the same question"
                                               : "meshes of the same shape and the same query") +
                    ": they make its lists");
}

void BackendBase::stream(const PreparedScene&, const IntersectionQuery&, const Streaming&, BlockSink, Statistics&) {
    refuse_blocks();
}
void BackendBase::visit(const PreparedScene& scene, const IntersectionQuery& query, BlockSink take,
                        Statistics& statistics) {
    stream(scene, query, {.ordered = false}, take, statistics);
}
void BackendBase::stream(const PreparedScene&, const FeatureRequest&, const Streaming&, FeatureSink, Statistics&) {
    refuse_blocks();
}
void BackendBase::stream_candidates(const PreparedScene&, const CandidateRequest&, const Streaming&, CandidateSink,
                                    Statistics&) {
    refuse_blocks();
}
void BackendBase::find(const MeshView&, const MeshView*, const IntersectionQuery&, Intersections&) { refuse(); }
bool BackendBase::any(const MeshView&, const MeshView*, const IntersectionQuery&) { refuse(); }
std::vector<Part> BackendBase::partition(const MeshView&, const MeshView*, int) { refuse(); }
void BackendBase::launch(const MeshView&, const MeshView*, const IntersectionQuery&) { refuse(); }
const DeviceIntersections& BackendBase::wait() { refuse(); }
void BackendBase::download(Intersections&) { refuse(); }
DeviceFeatureCalls& BackendBase::features_there() { refuse(); }
bool BackendBase::find(const World&, const IntersectionQuery&, Intersections&) { refuse_worlds(); }
std::vector<Pose> BackendBase::poses_of(const DevicePoses&) { refuse_worlds(); }
void BackendBase::launch(const World&, const IntersectionQuery&) { refuse_worlds(); }

}  // namespace crumple
