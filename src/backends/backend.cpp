#include "backends/backend.h"

#include <mutex>
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
    throw Error(ErrorCode::invalid_argument, "results in blocks need the cpu backend (Options::backend)",
                Element::option);
}

}  // namespace

void fail_unprepared_capture(bool of_worlds) {
    throw Error(ErrorCode::invalid_argument,
                std::string("a launch in a capture needs two calls before it, outside of the capture, with ") +
                    (of_worlds ? "the same bodies and the same query" : "meshes of the same sizes and the same query") +
                    ": they allocate its lists");
}

Clustering BackendBase::cluster(const PreparedScene&) {
    throw Error(ErrorCode::invalid_argument, "clusters need the cpu backend (Options::backend)", Element::option);
}
void BackendBase::stream(const PreparedScene&, const IntersectionQuery&, PairStream&, Statistics&) { refuse_blocks(); }
void BackendBase::stream(const PreparedScene&, const FeatureRequest&, FeatureStream&, Statistics&) { refuse_blocks(); }
void BackendBase::visit(const PreparedScene& scene, const IntersectionQuery& query,
                        FunctionRef<void(const Array<Pair>& some)> take, Statistics& statistics) {
    struct Visit final : PairStream {
        explicit Visit(FunctionRef<void(const Array<Pair>& some)> visit) : take(visit) {}
        void add(std::int64_t, Array<Pair>& rows) override {
            const std::lock_guard lock(mutex);
            take(rows);
            rows.clear();
        }
        void finish(std::int64_t) override {}
        void fail() override {}
        FunctionRef<void(const Array<Pair>& some)> take;
        std::mutex mutex;
    } each(take);
    stream(scene, query, each, statistics);
}
void BackendBase::find(const MeshView&, const MeshView*, const IntersectionQuery&, Intersections&) { refuse(); }
bool BackendBase::any(const MeshView&, const MeshView*, const IntersectionQuery&) { refuse(); }
std::vector<Part> BackendBase::partition(const MeshView&, const MeshView*, int) { refuse(); }
LaunchNumber BackendBase::launch(const MeshView&, const MeshView*, const IntersectionQuery&) { refuse(); }
const DeviceIntersections& BackendBase::wait(LaunchNumber) { refuse(); }
void BackendBase::download(LaunchNumber, Intersections&) { refuse(); }
DeviceFeatureCalls& BackendBase::device_feature_calls() { refuse(); }
bool BackendBase::find(const World&, const IntersectionQuery&, Intersections&) { refuse_worlds(); }
std::vector<Pose> BackendBase::poses_of(const DevicePoses&) { refuse_worlds(); }
LaunchNumber BackendBase::launch(const World&, const IntersectionQuery&) { refuse_worlds(); }

}  // namespace crumple
