// Runs the stages of the cuda backend, with blocks of 64 and of 256 threads, on a device or on one that the CPU
// emulates. The first run has neither records (data of triangles) nor the filters that read them, so that all
// candidates of the sweep can be checked. A second run of the stages from `sort` on has the records and filters of
// intersection queries.

#include <limits>
#include <stdexcept>

#include "backends/cuda/intersections/intersection_pass.h"
#include "backends/cuda/intersections/result_on_device.h"
#include "backends/cuda/stages/sort_kernel.h"
#include "backends/cuda/stages/sweep_kernel.h"
#include "cuda/device_mesh.h"
#include "stages/state.h"

namespace crumple::cuda {

struct NoRecords {
    __device__ void put(std::uint32_t, std::int32_t, const Vec3d*, const std::int32_t*, const InFrame<3>&,
                        const Frame&) const {}
};
struct KeepAll {
    struct Buffer {};
    __device__ bool keeps(bool has, const Candidate&, Buffer&) const { return has; }
};

namespace {

using test::to_host;

Pair ordered(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// Copy of a host scene's arrays on the device.
class DeviceScene {
   public:
    explicit DeviceScene(const PreparedScene& host)
        : scene(host), corners_(bytes(host.corners, 12 * host.triangle_count())) {
        scene.corners = static_cast<const std::int32_t*>(corners_.data());
        for (std::size_t side = 0; side < 2; ++side) {
            const VertexReader& reader = host.reader[side];
            const auto size = 3 * static_cast<std::int64_t>(reader.scalar_bytes()) * host.vertices[side];
            vertices_[side] = test::DeviceBytes(bytes(reader.data, size));
            scene.reader[side].data = static_cast<const std::byte*>(vertices_[side].data());
        }
        SceneBox box;
        for (int axis = 0; axis < 3; ++axis) {
            box.low[axis] = ordered_number(host.low[axis]);
            box.high[axis] = ordered_number(host.high[axis]);
        }
        box_ = test::DeviceBytes(bytes(&box, sizeof box));
    }
    const SceneBox* box() const { return static_cast<const SceneBox*>(box_.data()); }
    PreparedScene scene;

   private:
    static unsigned long long ordered_number(double x) { return cuda::ordered(x); }
    static std::vector<std::byte> bytes(const void* data, std::int64_t size) {
        const auto* begin = static_cast<const std::byte*>(data);
        return {begin, begin + size};
    }
    test::DeviceBytes corners_, vertices_[2], box_;
};

class StagesOfPass : public IntersectionPass {
   public:
    StagesOfPass(const Geometry& geometry, const Options& options, bool warm)
        : IntersectionPass(geometry, nullptr, options), warm_(warm) {}

    test::StageState run(const PreparedScene& host) {
        const DeviceScene on_device(host);
        scene = on_device.scene;
        box = on_device.box();
        const auto n = static_cast<unsigned long long>(host.triangle_count());
        plan.choose(host.triangle_count(), host.between, options_);
        plan.members[0] = plan.members[1] = 128 * n + 64 * 64 * 64;
        plan.units = plan.survivors = plan.undecided = plan.beyond = plan.hits = 64 * n * n;
        MemoryMeter meter;
        Block kept(meter), work(meter);
        place_arrays(kept, [&](ArenaLayout& c) { warm_starts.cut(c, plan); });
        place_arrays(work, [&](ArenaLayout& c) { cut(c); });
        pass_once();
        if (warm_) {
            beside = &branch_;
            plan.cold = false;
            plan.warm_started = true;
            pass_once();
        }
        test::StageState state = download_state(host);
        search(state);
        return state;
    }

   private:
    void pass_once() {
        BatchedClear batch;
        clear(batch);
        batch.launch(geometry_, stream_);
        bounds();
        subdivide_scene();
        subdivide_clusters(~std::uint64_t{0});
        align();
        sort_members(geometry_, stream_, scene, points_, plan.leaves(), members_of(last_level()),
                     members_[last_level()], frames(), ownership(), sorted_, StaticTriangle{}, NoRecords{}, units(),
                     counters);
        cuda::sweep(geometry_, stream_, scene, sorted_, units(), ownership(), wanted, KeepAll{},
                    {survivors_, &counters->survivors, plan.survivors}, {}, counters);
        if (plan.warm_started) branch_.join(stream_);
        CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
        const Counters counted = to_host(counters, 1)[0];
        if (counted.unplaced[0] + counted.unplaced[1] > 0) throw std::runtime_error("a member has no place");
    }

    // Repeats the stages from `sort` on, with the records and filters of intersection queries.
    void search(test::StageState& state) {
        policy = policy_of(Neighbours::geometric, IntersectionKind::all);
        MemoryMeter meter;
        ResultOnDevice answer(geometry_, stream_, meter);
        Block storage(meter);
        place_arrays(storage, [&](ArenaLayout& c) { answer.cut(c, scene, plan.hits); });
        BatchedClear batch;
        batch.add(counters->members, sizeof *counters - offsetof(Counters, members));
        batch.add(&counters->units, sizeof counters->units);
        cuda::clear(batch, sorted_, plan.leaves());
        answer.clear(batch, scene);
        batch.launch(geometry_, stream_);
        sort();
        sweep({});
        narrow({Hits::Mode::list, hits(), answer.output.offsets, nullptr});
        CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
        const Counters counted = to_host(counters, 1)[0];
        if (counted.beyond > 0) throw std::runtime_error("these scenes leave nothing to the host");
        std::vector<test::LeafState>& leaves = state.leaves;
        leaves.front().found.reserve(counted.hits);  // hits do not name their leaf, so all go to the first
        for (const Hit& hit : to_host(hits_, static_cast<std::int64_t>(counted.hits)))
            leaves.front().found.push_back({hit.a, hit.b});
        answer.total = counted.hits;
        answer.write(scene, hits(), counters, nullptr);
        CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
        answer.copy_to(scene, false, state.result);
    }

    // Returns the state of the first run. Rows are stored leaf by leaf, as members are.
    test::StageState download_state(const PreparedScene& host) const {
        test::StageState state;
        if (points_.f)
            for (const auto& p : to_host(points_.f, host.vertex_count())) state.point.push_back({p.x, p.y, p.z});
        else
            for (const auto& p : to_host(points_.d, host.vertex_count())) state.point.push_back({p.x, p.y, p.z});
        state.ball = to_host(balls_, host.triangle_count());

        const auto first = to_host(members_of(last_level()).first, plan.leaves() + 1);
        const auto count = to_host(members_of(last_level()).count, plan.leaves());
        const auto rows = static_cast<std::int64_t>(first.back());
        const auto row = to_host(sorted_.row, rows);
        const auto frame = to_host(warm_starts.now.frame, plan.leaves());
        const auto upper = plan.levels() == 2 ? to_host(mask_[0], host.triangle_count()) : std::vector<std::uint64_t>();
        state.leaves.resize(static_cast<std::size_t>(plan.leaves()));
        std::vector<std::size_t> leaf_of(static_cast<std::size_t>(rows));
        for (std::size_t leaf = 0; leaf < state.leaves.size(); ++leaf) {
            test::LeafState& it = state.leaves[leaf];
            it.frame = frame[leaf];
            const std::size_t leaf_end = first[leaf] + count[leaf];
            const auto cluster = leaf / static_cast<std::size_t>(std::max(1, plan.fan_out[1]));
            const std::uint64_t lower_clusters = (std::uint64_t{1} << cluster) - 1;
            for (std::size_t i = first[leaf]; i < leaf_end; ++i) {
                leaf_of[i] = leaf;
                it.member.push_back(row[i].triangle);
                constexpr double all = std::numeric_limits<double>::infinity();
                const CrossBox& b = row[i].box;
                it.box.push_back({{-all, b.low_y, b.low_z}, {all, b.high_y, b.high_z}});
                for (std::size_t j = i + 1; j < leaf_end; ++j) {
                    const auto a = static_cast<std::size_t>(row[i].triangle),
                               c = static_cast<std::size_t>(row[j].triangle);
                    const bool others = !upper.empty() && (upper[a] & upper[c] & lower_clusters);
                    if (!others && !(row[i].conflict & row[j].conflict))
                        it.owned.push_back(ordered(row[i].triangle, row[j].triangle));
                    if (j < row[i].end) it.met.push_back(ordered(row[i].triangle, row[j].triangle));
                }
            }
        }
        const Counters counted = to_host(counters, 1)[0];
        for (const Candidate& c : to_host(survivors_, static_cast<std::int64_t>(counted.survivors)))
            state.leaves[leaf_of[c.row]].candidates.push_back(ordered(row[c.row].triangle, row[c.column].triangle));
        return state;
    }

    bool warm_;
    Branch branch_{Device(0)};
};

}  // namespace
}  // namespace crumple::cuda

namespace crumple::test {

std::vector<StageBackend> stage_backends() {
    std::vector<StageBackend> backends;
    // With 256 threads the stages run twice, and the second run is warm-started from the first.
    for (const unsigned threads : {64u, 256u})
        backends.push_back({"blocks_of_" + std::to_string(threads) + (threads == 256 ? "_guided" : ""),
                            [=](const PreparedScene& scene, const Options& options) {
                                const cuda::Device device(0);
                                const cuda::Device::Current current(device);
                                cuda::Geometry geometry = device.geometry();
                                geometry.resident = geometry.resident * geometry.threads / threads;
                                geometry.threads = threads;
                                return cuda::StagesOfPass(geometry, options, threads == 256).run(scene);
                            }});
    return backends;
}

}  // namespace crumple::test
