// The cuda backend: owns the memory, plans passes, brings scenes in and answers out.
//
// A plan gives each list a capacity. After a pass the host reads the counters; if a list was too short, it grows and
// the pass is run again (layout.h). Where that does not fit the memory limit or the device, clusters are done one after
// another, in slices, and each twice: pairs are counted, then written to their places ([MZ] sec. 3.1).

#include "pipeline/backend.h"

#include <cstring>
#include <limits>
#include <memory>
#include <string>

#include "crumple/error.h"
#include "cuda/device.h"
#include "cuda/pass.h"
#include "geometry/decide.h"
#include "pipeline/output.h"
#include "pipeline/part.h"
#include "pipeline/wanted.h"

namespace crumple {
namespace cuda {
namespace {

class CudaBackend final : public BackendBase {
   public:
    CudaBackend(const Options& options, MemoryMeter& meter, Cancellation& cancellation)
        : options_(options),
          cancellation_(cancellation),
          meter_(meter),
          device_(options.device),
          geometry_(device_.geometry()),
          input_(meter),
          state_(meter),
          work_(meter),
          result_(meter),
          pass_(geometry_, stream_.get(), options_),
          rule_(&meter),
          part_masks_(&meter),
          packed_(&meter) {}

    void find(const Scene& scene, const Query& query, const Part* part, Collisions& result) override {
        const Device::Current current(device_);
        result.statistics = {};
        result.statistics.backend = "cuda";
        const auto in_chunks = [&] {
            too_many_ = scene.triangle_count();
            find_in_chunks(scene, query, part, result);
        };
        if (scene.triangle_count() >= too_many_) {
            in_chunks();
        } else {
            try {
                find_at_once(scene, query, part, result);
            } catch (const MemoryMeter::Exceeded&) {
                in_chunks();
            } catch (const OutOfDeviceMemory&) {
                in_chunks();
            }
        }
        if (query.contacts) contacts_of_pairs(scene, result);
    }

    std::int64_t bytes_needed(const Scene& scene, const Query& query, const Part* part) override {
        const Device::Current current(device_);
        release();
        meter_.peak = meter_.used.load();
        Statistics unused;
        const std::int64_t pairs = count_in_chunks(scene, query, part, unused);
        Cutter cutter;
        cut_result(cutter, scene, static_cast<std::size_t>(pairs));
        return meter_.peak + static_cast<std::int64_t>(cutter.used()) + result_bytes(scene, query, pairs);
    }

    bool any(const Scene& scene, const Query& query) override {
        Collisions unused;
        Query without_contacts = query;
        without_contacts.contacts = false;
        find(scene, without_contacts, nullptr, unused);
        return !unused.pairs.empty();
    }

    void release() override {
        const Device::Current current(device_);
        for (Block* block : {&input_, &state_, &work_, &result_}) block->release();
        rule_ = GroupRule(&meter_);
        part_masks_ = Array<std::uint64_t>(&meter_);
        packed_ = Array<std::byte>(&meter_);
        planned_for_ = -1;
        too_many_ = std::numeric_limits<std::int64_t>::max();
    }

   private:
    void find_at_once(const Scene& host, const Query& query, const Part* part, Collisions& result) {
        prepare(host, query, part);
        if (planned_for_ != host.triangle_count()) pass_.plan.choose(host.triangle_count(), options_);
        planned_for_ = -1;  // until this call succeeds
        Counters counters{};
        for (bool accepted = false; !accepted;) {
            cancellation_.check();
            lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
            lay_out(result_, [&](Cutter& c) { cut_result(c, host, pass_.plan.hits); });
            clear_offsets();
            pass_.clear_counters();
            watch_.begin(Stage::bounds, stream_.get());
            pass_.bounds(false);
            watch_.begin(Stage::subdivide, stream_.get());
            pass_.subdivide_scene();
            pass_.subdivide_clusters(~std::uint64_t{0});
            watch_.begin(Stage::align, stream_.get());
            pass_.align();
            watch_.begin(Stage::sort, stream_.get());
            pass_.sort();
            watch_.begin(Stage::sweep, stream_.get());
            pass_.sweep({});
            watch_.begin(Stage::narrow, stream_.get());
            pass_.narrow(list_hits());
            counters = read_counters();
            accepted = pass_.plan.accepts(counters, host.triangle_count(), options_);
            if (accepted && decide_beyond(host, query, counters, list_hits(), result.statistics)) {
                counters = read_counters();
                accepted = pass_.plan.accepts(counters, host.triangle_count(), options_);
            }
        }
        watch_.begin(Stage::output, stream_.get());
        make_offsets(stream_.get(), pass_.scene, output_);
        fill_buckets(geometry_, stream_.get(), pass_.scene, pass_.hits(), output_);
        order_buckets(geometry_, stream_.get(), pass_.scene, output_, pass_.counters);
        watch_.end(stream_.get());
        download(host, counters.hits, result);
        count(counters, result.statistics);
        watch_.read(result.statistics);
        pass_.plan.cold = false;
        planned_for_ = host.triangle_count();
    }

    void find_in_chunks(const Scene& host, const Query& query, const Part* part, Collisions& result) {
        for (Block* block : {&work_, &result_}) block->release();
        Statistics counting;
        const auto total = static_cast<std::size_t>(count_in_chunks(host, query, part, counting));
        // The offsets wait in the host's result while their block grows.
        const std::size_t n = static_cast<std::size_t>(host.triangles[0]) + 1;
        auto* offsets = reinterpret_cast<unsigned long long*>(result.offsets.resize_discard(n));
        copy(offsets, output_.offsets, n, cudaMemcpyDeviceToHost);
        work_.release();
        lay_out(result_, [&](Cutter& c) { cut_result(c, host, total); });
        copy(output_.offsets, offsets, n, cudaMemcpyHostToDevice);
        copy(output_.next, offsets, n, cudaMemcpyHostToDevice);
        pass_over_chunks(host, query, {Hits::Mode::fill, {}, output_.next, output_.second}, result.statistics);
        order_buckets(geometry_, stream_.get(), pass_.scene, output_, pass_.counters);
        download(host, total, result);
    }

    std::int64_t count_in_chunks(const Scene& host, const Query& query, const Part* part, Statistics& statistics) {
        prepare(host, query, part);
        planned_for_ = -1;
        pass_.plan.choose_chunks(host.triangle_count(), options_);
        lay_out(result_, [&](Cutter& c) { cut_result(c, host, 0); });
        clear_offsets();
        pass_over_chunks(host, query, {Hits::Mode::count, {}, output_.offsets, nullptr}, statistics);
        make_offsets(stream_.get(), pass_.scene, output_);
        unsigned long long total = 0;
        copy(&total, output_.offsets + host.triangles[0], 1, cudaMemcpyDeviceToHost);
        return static_cast<std::int64_t>(total);
    }

    // Cluster by cluster, each in as many slices as the lists demand.
    void pass_over_chunks(const Scene& host, const Query& query, Hits hits, Statistics& statistics) {
        bool laid_out = false;
        for (int k = 0; k < pass_.plan.fan_out[0];) {
            if (!laid_out) {
                lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
                pass_.clear_counters();
                pass_.bounds(false);
                pass_.subdivide_scene();
                pass_.plan.cold = true;  // each pass makes the same clusters
                laid_out = true;
            }
            pass_.clear_counters();
            pass_.subdivide_clusters(std::uint64_t{1} << k);
            laid_out = pass_.plan.accepts_chunk(read_counters());
            if (!laid_out) continue;
            pass_.align();
            pass_.sort();
            count(read_counters(), statistics);
            hits.list.count = &pass_.counters->hits;
            for (Slice slice{}; slice.index < slice.count;) {
                cancellation_.check();
                pass_.clear_counters();
                pass_.sweep(slice);
                if (read_counters().survivors > pass_.plan.survivors) {
                    slice = {2 * slice.index, 2 * slice.count};
                    continue;
                }
                pass_.narrow(hits);
                const Counters counters = read_counters();
                count(counters, statistics);
                decide_beyond(host, query, counters, hits, statistics);
                ++slice.index;
            }
            ++k;
        }
    }

    // Brings in the scene, what the query wants, and the kept centres.
    void prepare(const Scene& host, const Query& query, const Part* part) {
        rule_.prepare(query);
        if (part)
            part_masks(host, part->centres, part_masks_);
        else
            part_masks_.clear();
        Scene& scene = pass_.scene;
        scene = host;
        std::int32_t *corners = nullptr, *groups = nullptr;
        std::uint64_t *mask = nullptr, *excluded = nullptr;
        std::byte* vertices[2] = {nullptr, nullptr};
        const std::size_t triangles = static_cast<std::size_t>(host.triangle_count());
        lay_out(input_, [&](Cutter& c) {
            pass_.box = c.take<SceneBox>(1);
            for (int side = 0; side < 2; ++side) vertices[side] = c.take<std::byte>(bytes_of(host, side));
            corners = c.take<std::int32_t>(3 * triangles);
            groups = c.take<std::int32_t>(host.groups ? triangles : 0);
            mask = c.take<std::uint64_t>(part_masks_.size());
            excluded = c.take<std::uint64_t>(rule_.excluded().size());
        });
        lay_out(state_, [&](Cutter& c) { pass_.centres.cut(c); });
        SceneBox box;
        for (int axis = 0; axis < 3; ++axis)
            box.low[axis] = ordered(host.low[axis]), box.high[axis] = ordered(host.high[axis]);
        copy(pass_.box, &box, 1, cudaMemcpyHostToDevice);
        for (int side = 0; side < 2; ++side) {
            copy(vertices[side], packed(host, side), bytes_of(host, side), cudaMemcpyHostToDevice);
            const auto size = static_cast<std::int64_t>(host.reader[side].scalar_bytes());
            scene.reader[side] = {vertices[side], 3 * size, size, host.reader[side].float32};
        }
        copy(corners, host.corners, 3 * triangles, cudaMemcpyHostToDevice);
        scene.corners = corners;
        if (host.groups) copy(groups, host.groups, triangles, cudaMemcpyHostToDevice);
        scene.groups = host.groups ? groups : nullptr;
        copy(mask, part_masks_.data(), part_masks_.size(), cudaMemcpyHostToDevice);
        copy(excluded, rule_.excluded().data(), rule_.excluded().size(), cudaMemcpyHostToDevice);
        pass_.part_mask = part ? mask : nullptr;
        pass_.part = part ? part->index : 0;
        pass_.rules = {query.neighbours == Neighbours::skip,
                       query.intersections == Intersections::proper,
                       !rule_.trivial(),
                       query.wanted == Wanted::between,
                       query.wanted == Wanted::within,
                       excluded,
                       static_cast<int>(rule_.excluded().size())};
    }

    static std::size_t bytes_of(const Scene& scene, int side) {
        return 3 * static_cast<std::size_t>(scene.vertices[side]) * scene.reader[side].scalar_bytes();
    }
    // The vertices of one mesh, row by row without gaps.
    const std::byte* packed(const Scene& scene, int side) {
        const VertexReader& reader = scene.reader[side];
        if (reader.contiguous()) return reader.data;
        const std::size_t size = reader.scalar_bytes();
        std::byte* out = packed_.resize_discard(bytes_of(scene, side));
        for (std::int64_t v = 0; v < scene.vertices[side]; ++v)
            for (int axis = 0; axis < 3; ++axis, out += size)
                std::memcpy(out, reader.data + v * reader.row_stride + axis * reader.column_stride, size);
        return packed_.data();
    }

    // Pairs that even expansions could not hold, in rational arithmetic. Returns whether there were any.
    bool decide_beyond(const Scene& host, const Query& query, const Counters& counters, const Hits& hits,
                       Statistics& statistics) {
        const auto n = static_cast<std::size_t>(counters.beyond);
        if (n == 0) return false;
        Array<Pair> pairs(&meter_);
        pairs.resize_discard(n);
        copy(pairs.data(), pass_.beyond(), n, cudaMemcpyDeviceToHost);
        std::size_t found = 0;
        for (const Pair pair : pairs) {
            DecisionCounts counts;
            if (collide(host.triangle(pair.a), host.triangle(pair.b), query.neighbours, query.intersections, counts))
                pairs[found++] = pair;
        }
        statistics.rational_tests += static_cast<std::int64_t>(n);
        copy(pass_.beyond(), pairs.data(), found, cudaMemcpyHostToDevice);
        add_hits(geometry_, stream_.get(), pass_.scene, pass_.beyond(), found, hits);
        CRUMPLE_CUDA(cudaStreamSynchronize(stream_.get()));
        return found > 0;
    }

    void cut_result(Cutter& c, const Scene& scene, std::size_t pairs) {
        const auto first = static_cast<std::size_t>(scene.triangles[0]);
        output_.offsets = c.take<unsigned long long>(first + 1);
        output_.next = c.take<unsigned long long>(first + 1);
        output_.hit = c.take<std::uint8_t>((first + 3) / 4 * 4);
        output_.hit_second = c.take<std::uint8_t>((static_cast<std::size_t>(scene.triangles[1]) + 3) / 4 * 4);
        output_.capacity = pairs;
        output_.pairs = c.take<Pair>(pairs);
        output_.second = c.take<std::int32_t>(pairs);
        output_.long_capacity = long_row_capacity(pairs);
        output_.long_rows = c.take<std::int32_t>(output_.long_capacity);
        output_.scan_bytes = output_scratch_bytes(scene.triangles[0]);
        output_.scan = c.take<std::byte>(output_.scan_bytes);
    }

    void clear_offsets() {
        const auto n = static_cast<std::size_t>(pass_.scene.triangles[0]) + 1;
        CRUMPLE_CUDA(cudaMemsetAsync(output_.offsets, 0, n * sizeof *output_.offsets, stream_.get()));
    }
    Hits list_hits() const { return {Hits::Mode::list, pass_.hits(), output_.offsets, nullptr}; }

    void download(const Scene& host, unsigned long long total, Collisions& result) {
        const auto first = static_cast<std::size_t>(host.triangles[0]),
                   second = static_cast<std::size_t>(host.triangles[1]);
        copy(result.pairs.resize_discard(total), output_.pairs, total, cudaMemcpyDeviceToHost);
        copy(reinterpret_cast<unsigned long long*>(result.offsets.resize_discard(first + 1)), output_.offsets,
             first + 1, cudaMemcpyDeviceToHost);
        copy(result.hit.resize_discard(first), output_.hit, first, cudaMemcpyDeviceToHost);
        copy(result.hit_second.resize_discard(second), output_.hit_second, second, cudaMemcpyDeviceToHost);
        result.contacts.kinds.clear();
        result.contacts.offsets.clear();
        result.contacts.points.clear();
    }

    Counters read_counters() {
        copy(counters_.get(), pass_.counters, 1, cudaMemcpyDeviceToHost);
        return *counters_;
    }

    void count(const Counters& c, Statistics& s) const {
        s.clusters = pass_.plan.fan_out[0];
        s.leaves = pass_.plan.leaves();
        s.members += static_cast<std::int64_t>(c.members[pass_.plan.levels() - 1]);
        s.interval_tests += static_cast<std::int64_t>(c.interval_tests);
        s.box_overlaps += static_cast<std::int64_t>(c.box_overlaps);
        s.edge_tests += static_cast<std::int64_t>(c.survivors);
        s.double_tests += static_cast<std::int64_t>(c.survivors);
        s.exact_tests += static_cast<std::int64_t>(c.undecided);
    }

    /// Done when it returns, whichever side the memory is on.
    template <class T>
    void copy(T* to, const T* from, std::size_t n, cudaMemcpyKind kind) {
        if (n == 0) return;
        CRUMPLE_CUDA(cudaMemcpyAsync(to, from, n * sizeof(T), kind, stream_.get()));
        CRUMPLE_CUDA(cudaStreamSynchronize(stream_.get()));
    }

    const Options& options_;
    Cancellation& cancellation_;
    MemoryMeter& meter_;
    Device device_;
    Geometry geometry_;
    Stream stream_ = make_stream();
    Stopwatch watch_;
    Pinned<Counters> counters_;
    Block input_, state_, work_, result_;
    Pass pass_;
    Output output_{};
    GroupRule rule_;
    Array<std::uint64_t> part_masks_;
    Array<std::byte> packed_;
    std::int64_t planned_for_ = -1;  ///< triangles of the scene that the plan has served
    std::int64_t too_many_ = std::numeric_limits<std::int64_t>::max();  ///< triangles that did not fit at once
};

}  // namespace
}  // namespace cuda

std::unique_ptr<BackendBase> make_cuda_backend(const Options& options, MemoryMeter& meter, Cancellation& cancellation) {
    return std::make_unique<cuda::CudaBackend>(options, meter, cancellation);
}

}  // namespace crumple
