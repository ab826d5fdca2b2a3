// CGAL's box_self_intersection_d and box_intersection_d: pairs of overlapping boxes by the streamed segment tree of
// Zomorodian and Edelsbrunner, adjacent triangles included. Boxes are float64 and closed, and made in each call; each
// thread has an output of its own. Two ways are contestants: sorting the boxes themselves, and sorting pointers to
// them.

#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/box_intersection_d.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <memory>
#include <type_traits>

#include "peers/peers.h"

namespace crumple::benchmark {
namespace {

using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::int32_t>;

const Box& box(const Box& b) { return b; }
const Box& box(const Box* b) { return *b; }

/// Boxes of a mesh, and the handles that are sorted: the boxes themselves or pointers to them.
template <class Handle>
struct Input {
    std::vector<double> xyz;
    std::vector<std::int32_t> triangles;
    std::vector<Box> boxes;
    std::vector<Handle> handles;

    explicit Input(const io::TriangleMesh& mesh) : xyz(coordinates<double>(mesh)), triangles(mesh.triangles) {}

    std::vector<Handle>& make_boxes() {
        boxes.clear();
        boxes.reserve(triangles.size() / 3);
        for (std::size_t t = 0; t < triangles.size() / 3; ++t) {
            std::array<double, 3> low, high;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto at = [&](std::size_t k) {
                    return xyz[3 * static_cast<std::size_t>(triangles[3 * t + k]) + axis];
                };
                low[axis] = std::min({at(0), at(1), at(2)});
                high[axis] = std::max({at(0), at(1), at(2)});
            }
            boxes.emplace_back(low.data(), high.data(), static_cast<std::int32_t>(t));
        }
        if constexpr (std::is_same_v<Handle, Box>) {
            return boxes;
        } else {
            handles.clear();
            for (const Box& b : boxes) handles.push_back(&b);
            return handles;
        }
    }
};

template <class Handle, class Concurrency>
class Collider {
   public:
    explicit Collider(const Workload& workload) : question_(workload.query), a_(workload.a), b_(workload.b) {}

    void operator()() {
        for (auto& list : found_) list.clear();
        const auto report = [&](const Handle& a, const Handle& b) {
            found_.local().push_back({box(a).info(), box(b).info()});
        };
        std::vector<Handle>& a = a_.make_boxes();
        if (question_ == Query::self) {
            CGAL::box_self_intersection_d<Concurrency>(a.begin(), a.end(), report);
        } else {
            std::vector<Handle>& b = b_.make_boxes();
            CGAL::box_intersection_d<Concurrency>(a.begin(), a.end(), b.begin(), b.end(), report);
        }
    }

    std::vector<Pair> pairs() const {
        std::vector<Pair> pairs;
        for (const auto& list : found_) pairs.insert(pairs.end(), list.begin(), list.end());
        return pairs;
    }

   private:
    Query question_;
    Input<Handle> a_, b_;
    tbb::enumerable_thread_specific<std::vector<Pair>> found_;
};

template <class Handle, class Concurrency>
void add(const Workload& workload, std::string way, std::vector<Contestant>& contestants) {
    const auto collider = std::make_shared<Collider<Handle, Concurrency>>(workload);
    contestants.push_back(
        {"CGAL boxes", std::move(way), "overlapping boxes", [=] { (*collider)(); }, [=] { return collider->pairs(); }});
}

}  // namespace

std::vector<Contestant> cgal_box_contestants(const Workload& workload) {
    std::vector<Contestant> contestants;
    if (workload.query == Query::any) return contestants;
    add<Box, CGAL::Sequential_tag>(workload, "sequential, values", contestants);
    add<const Box*, CGAL::Sequential_tag>(workload, "sequential, pointers", contestants);
    add<Box, CGAL::Parallel_tag>(workload, "parallel, values", contestants);
    add<const Box*, CGAL::Parallel_tag>(workload, "parallel, pointers", contestants);
    return contestants;
}

}  // namespace crumple::benchmark
