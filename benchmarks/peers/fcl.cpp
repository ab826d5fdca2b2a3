// FCL: two meshes as trees of bounding volumes, all pairs of triangles that intersect by its floating-point test,
// without contact points. FCL uses one thread. Contestants combine both scalar types with each bounding volume for
// which FCL has a mesh traversal; the fastest combination stands for FCL. Contestants named "FCL" build the trees in
// each call, as for deforming meshes; those named "FCL, trees built" build them before the timed calls, as for rigid
// bodies.

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/AABB.h>
#include <fcl/math/bv/OBB.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/bv/RSS.h>
#include <fcl/math/bv/kDOP.h>
#include <fcl/narrowphase/collision.h>

#include <limits>
#include <memory>

#include "peers/peers.h"

namespace crumple::benchmark {
namespace {

template <class Volume>
class Collider {
    using Scalar = typename Volume::S;

   public:
    explicit Collider(const Workload& workload) {
        add(workload.a);
        add(workload.b);
        build();
    }

    void build() {
        for (Input& input : inputs_) {
            input.tree = std::make_unique<fcl::BVHModel<Volume>>();
            input.tree->beginModel(static_cast<int>(input.triangles.size()), static_cast<int>(input.vertices.size()));
            input.tree->addSubModel(input.vertices, input.triangles);
            input.tree->endModel();
        }
    }

    void collide() {
        const auto identity = fcl::Transform3<Scalar>::Identity();
        fcl::CollisionRequest<Scalar> request(std::numeric_limits<std::size_t>::max(), false);
        result_.clear();
        fcl::collide(inputs_[0].tree.get(), identity, inputs_[1].tree.get(), identity, request, result_);
    }

    std::vector<Pair> pairs() const {
        std::vector<Pair> pairs;
        for (std::size_t i = 0; i < result_.numContacts(); ++i) {
            const auto& contact = result_.getContact(i);
            pairs.push_back({static_cast<std::int32_t>(contact.b1), static_cast<std::int32_t>(contact.b2)});
        }
        return pairs;
    }

   private:
    struct Input {
        std::vector<fcl::Vector3<Scalar>> vertices;
        std::vector<fcl::Triangle> triangles;
        std::unique_ptr<fcl::BVHModel<Volume>> tree;
    };

    void add(const io::TriangleMesh& mesh) {
        Input& input = inputs_.emplace_back();
        const auto xyz = coordinates<Scalar>(mesh);
        for (std::size_t v = 0; v < xyz.size(); v += 3) input.vertices.emplace_back(xyz[v], xyz[v + 1], xyz[v + 2]);
        for (std::size_t c = 0; c < mesh.triangles.size(); c += 3) {
            input.triangles.emplace_back(static_cast<std::size_t>(mesh.triangles[c]),
                                         static_cast<std::size_t>(mesh.triangles[c + 1]),
                                         static_cast<std::size_t>(mesh.triangles[c + 2]));
        }
    }

    std::vector<Input> inputs_;
    fcl::CollisionResult<Scalar> result_;
};

template <class Volume>
void add(const Workload& workload, const std::string& volume, std::vector<Contestant>& contestants) {
    const bool twofold = sizeof(typename Volume::S) == sizeof(double);
    const std::string way = volume + (twofold ? ", float64" : ", float32");
    const auto collider = std::make_shared<Collider<Volume>>(workload);
    const auto pairs = [=] { return collider->pairs(); };
    const std::string computes = "pairs, rounding errors";
    contestants.push_back({"FCL", way, computes, [=] { collider->build(), collider->collide(); }, pairs});
    contestants.push_back({"FCL, trees built", way, computes, [=] { collider->collide(); }, pairs});
}

template <class Scalar>
void add_volumes(const Workload& workload, std::vector<Contestant>& contestants) {
    add<fcl::AABB<Scalar>>(workload, "AABB", contestants);
    add<fcl::OBB<Scalar>>(workload, "OBB", contestants);
    add<fcl::RSS<Scalar>>(workload, "RSS", contestants);
    add<fcl::OBBRSS<Scalar>>(workload, "OBBRSS", contestants);
    add<fcl::KDOP<Scalar, 16>>(workload, "16-DOP", contestants);
    add<fcl::KDOP<Scalar, 24>>(workload, "24-DOP", contestants);
}

}  // namespace

std::vector<Contestant> fcl_contestants(const Workload& workload) {
    std::vector<Contestant> contestants;
    if (workload.query != Query::between) return contestants;
    add_volumes<double>(workload, contestants);
    add_volumes<float>(workload, contestants);
    return contestants;
}

}  // namespace crumple::benchmark
