#pragma once

// Search of one scene for pairs of triangles that intersect. A search in chunks finds each pair twice: first to count
// it, then to write it to its place ([MZ] sec. 3.1).

#include <array>
#include <memory>
#include <span>

#include "backends/cuda/engine/finder.h"
#include "backends/cuda/intersections/intersection_pass.h"
#include "backends/cuda/intersections/result_on_device.h"

namespace crumple::cuda {

class IntersectionFinder final : public Finder {
   public:
    explicit IntersectionFinder(BackendState& state);

    /// Make a slot current, drop its last rows, and upload a scene, bind meshes, or bind bodies and poses. `pairs`: see
    /// Input::pose.
    void bring(const PreparedScene& scene);
    void view(std::size_t slot, const MeshView& a, const MeshView* b, bool weld, Growth growth = Growth::grows);
    void pose(std::size_t slot, const std::shared_ptr<const PosedWorlds>& worlds, const DevicePoses& poses, bool weld,
              bool pairs, Growth growth = Growth::grows);
    /// Binds the query. To be called after one of the functions above.
    void copy_from(const IntersectionQuery& query, Growth growth = Growth::grows);

    /// Returns true if there is a pair. Ends at the first one, and lists none.
    bool any();
    /// Sets the flag of each of several worlds that has a pair. Work on a world ends at its first pair.
    void flag_worlds(std::span<std::uint8_t> flags);

    /// Make the contacts if the query requests them. copy_to() then copies the whole result to the host.
    void make_contacts();
    void copy_to(Intersections& result);
    /// Returns the result of find() and make_contacts(), on the device.
    DeviceIntersections show() const;
    /// Returns the result of a replay that has not left the whole result, because a list was too short: no pairs, and
    /// the number of hits that were counted.
    DeviceIntersections show_incomplete() const;
    /// Copies a result to the host whose contacts, if requested, have been made.
    void download(Intersections& result) { answer().copy_to(scene(), query().contacts(), result); }

    void release() override;

   private:
    ResultOnDevice& answer() { return results_[current()]; }
    const ResultOnDevice& answer() const { return results_[current()]; }
    const IntersectionQuery& query() const { return queries_[current()]; }
    void cut_rows(ArenaLayout& c, std::size_t pairs) { answer().cut(c, scene(), pairs); }
    template <class Make, class Undo>
    void with_capacity(Make make, Undo undo);

    // Defined in find_any.cu:
    bool any_at_once();
    bool any_in_chunks();
    void flag_worlds_at_once(std::span<std::uint8_t> flags);
    void flag_unresolved(std::size_t n, std::span<std::uint8_t> flags);

    // Defined in intersection_chunks.cu:
    unsigned long long count_in_chunks();
    std::size_t pass_over_chunks(Hits hits);
    void require_capacity(std::size_t pairs) const;

    void bind() override;
    KernelParameters parameters() const override { return IntersectionParameters{pass_.policy}; }
    void choose_plan(Plan& plan) const override;
    void choose_chunks(Plan& plan, std::int64_t bytes) const override;
    void cut_rows(ArenaLayout& c) override { cut_rows(c, static_cast<std::size_t>(pass_.plan.hits)); }
    void clear_rows(BatchedClear& batch) const override { answer().clear(batch, scene()); }
    void narrow() override;
    bool write_rows(Counters* host_counters) override;
    void count_tests(const Counters& counters, Statistics& statistics) const override;
    std::size_t decide_unresolved(std::size_t n) override;
    void append_decided(std::size_t count, unsigned long long before) override;
    void read_rows(unsigned long long total) override { answer().total = total; }
    void find_in_chunks() override;
    void release_rows(std::size_t slot) override;

    IntersectionPass pass_;
    std::array<ResultOnDevice, LaunchQueue::slots> results_;
    std::array<IntersectionQuery, LaunchQueue::slots> queries_;  ///< without pair filters, which are in the inputs
};

}  // namespace crumple::cuda
