// Embree: a bounding volume hierarchy over the triangles' boxes, built anew in each call, and rtcCollide. It yields
// pairs of overlapping boxes, adjacent triangles included; tests of triangles would cost extra.
//
// Build quality is LOW for the scene and for the geometry (Morton codes). This is the fastest build, and makes leaves
// of one primitive. With the geometry's default quality leaves have several primitives, and rtcCollide reports all
// pairs of two leaves, even if boxes of the primitives do not overlap. Each thread has an output of its own, because a
// shared counter would ruin the scaling.

#include <embree3/rtcore.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>

#include "peers/peers.h"

namespace crumple::benchmark {
namespace {

/// Return the nearest float32 that is not above (rounded_down) or not below (rounded_up) `x`.
float rounded_down(double x) {
    const auto f = static_cast<float>(x);
    return f > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float rounded_up(double x) { return -rounded_down(-x); }

/// Callback of Embree's builder: writes the box of a triangle of a mesh with coordinates of type `Scalar`.
template <class Scalar>
void bounds(const RTCBoundsFunctionArguments* arguments) {
    const auto& mesh = *static_cast<const io::TriangleMesh*>(arguments->geometryUserPtr);
    const Scalar* xyz = std::get<std::vector<Scalar>>(mesh.vertices).data();
    const std::int32_t* corners = mesh.triangles.data() + 3 * static_cast<std::size_t>(arguments->primID);
    const Scalar *p = xyz + 3L * corners[0], *q = xyz + 3L * corners[1], *r = xyz + 3L * corners[2];
    const auto low = [=](int axis) { return rounded_down(std::min(p[axis], std::min(q[axis], r[axis]))); };
    const auto high = [=](int axis) { return rounded_up(std::max(p[axis], std::max(q[axis], r[axis]))); };
    RTCBounds& box = *arguments->bounds_o;
    box.lower_x = low(0), box.lower_y = low(1), box.lower_z = low(2);
    box.upper_x = high(0), box.upper_y = high(1), box.upper_z = high(2);
}

/// Lists of the pairs of boxes of the current call, one list for each thread that finds any.
class Outputs {
   public:
    void start() {
        static std::atomic<std::uint64_t> calls = 0;
        call_ = ++calls;
        used_ = 0;
        for (auto& list : lists_) list->clear();
    }
    std::vector<RTCCollision>& mine() {
        thread_local std::uint64_t call = 0;
        thread_local std::vector<RTCCollision>* list = nullptr;
        if (call != call_) {
            const std::lock_guard lock(mutex_);
            if (used_ == lists_.size()) lists_.push_back(std::make_unique<std::vector<RTCCollision>>());
            list = lists_[used_++].get();
            call = call_;
        }
        return *list;
    }
    std::vector<Pair> pairs() const {
        std::vector<Pair> pairs;
        for (const auto& list : lists_) {
            for (const RTCCollision& c : *list)
                pairs.push_back({static_cast<std::int32_t>(c.primID0), static_cast<std::int32_t>(c.primID1)});
        }
        return pairs;
    }

   private:
    std::uint64_t call_ = 0;
    std::mutex mutex_;
    std::size_t used_ = 0;
    std::vector<std::unique_ptr<std::vector<RTCCollision>>> lists_;
};

/// Embree device, with one scene for each mesh.
class Collider {
   public:
    explicit Collider(const Workload& workload) : device_(rtcNewDevice("")) {
        add(workload.a);
        if (workload.query == Query::between) add(workload.b);
    }
    Collider(const Collider&) = delete;
    Collider& operator=(const Collider&) = delete;
    ~Collider() {
        for (RTCScene scene : scenes_) rtcReleaseScene(scene);
        rtcReleaseDevice(device_);
    }

    void operator()() {
        outputs_.start();
        for (RTCScene scene : scenes_) {
            rtcCommitGeometry(
                rtcGetGeometry(scene, 0));  // marks the geometry as changed, so that the hierarchy is rebuilt
            rtcCommitScene(scene);
        }
        const auto append = [](void* outputs, RTCCollision* collisions, unsigned count) {
            auto& mine = static_cast<Outputs*>(outputs)->mine();
            mine.insert(mine.end(), collisions, collisions + count);
        };
        rtcCollide(scenes_.front(), scenes_.back(), append, &outputs_);
    }
    std::vector<Pair> pairs() const { return outputs_.pairs(); }

   private:
    void add(const io::TriangleMesh& mesh) {
        RTCScene scene = rtcNewScene(device_);
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_LOW);
        rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(mesh.triangle_count()));
        rtcSetGeometryUserData(geometry, const_cast<io::TriangleMesh*>(&mesh));
        const bool single = mesh.precision() == ScalarType::float32;
        rtcSetGeometryBoundsFunction(geometry, single ? bounds<float> : bounds<double>, nullptr);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, 0);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene);
        scenes_.push_back(scene);
    }

    RTCDevice device_;
    std::vector<RTCScene> scenes_;
    Outputs outputs_;
};

}  // namespace

std::vector<Contestant> embree_contestants(const Workload& workload) {
    std::vector<Contestant> contestants;
    if (workload.query == Query::any) return contestants;
    const auto collider = std::make_shared<Collider>(workload);
    const auto pairs = [=] { return collider->pairs(); };
    const auto one_thread = [=] {
        // The device's own number of threads has no effect here: all devices of a process use the largest one of them.
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
        (*collider)();
    };
    const std::string computes = "overlapping boxes";
    contestants.push_back({"Embree", "1 thread", computes, one_thread, pairs});
    contestants.push_back({"Embree", "all threads", computes, [=] { (*collider)(); }, pairs});
    return contestants;
}

}  // namespace crumple::benchmark
