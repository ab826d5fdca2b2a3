#pragma once

// One scene searched for pairs of triangles that intersect. In chunks each pair is found twice: counted, then written
// to its place ([MZ] sec. 3.1).

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

    /// Works on a slot, whose last rows go, and has its input bring a scene, view meshes, or pose bodies; `pairs`: see
    /// Input::pose.
    void bring(const PreparedScene& scene);
    void view(std::size_t slot, const MeshView& a, const MeshView* b, bool weld, Room room = Room::grows);
    void pose(std::size_t slot, const std::shared_ptr<const PosedWorlds>& worlds, const DevicePoses& poses, bool weld,
              bool pairs, Room room = Room::grows);
    /// Takes the query about the input, whichever way that came.
    void adopt(const IntersectionQuery& query, Room room = Room::grows);

    /// Returns true if there is a pair: the work ends at the first one, and none is written.
    bool any();
    /// Sets the flags of those worlds of several in which there is a pair; the work of each ends at the first one.
    void flag_worlds(std::span<std::uint8_t> flags);

    /// The contacts, if they are wanted; on the device, or with all of the result copied to the host.
    void make_contacts();
    void copy_to(Intersections& result);
    /// The result that find() and make_contacts() have left.
    DeviceIntersections show() const;
    /// Result of an incomplete replay.
    DeviceIntersections show_incomplete() const;
    void download(Intersections& result) { answer().copy_to(scene(), query().contacts(), result); }

    void release() override;

   private:
    Answer& answer() { return answers_[current()]; }
    const Answer& answer() const { return answers_[current()]; }
    const IntersectionQuery& query() const { return queries_[current()]; }
    void cut_rows(Cutter& c, std::size_t pairs) { answer().cut(c, scene(), pairs); }
    template <class Make, class Undo>
    void with_room_for(Make make, Undo undo);

    // find_any.cu
    bool any_at_once();
    bool any_in_chunks();
    void flag_worlds_at_once(std::span<std::uint8_t> flags);
    void flag_beyond(std::size_t n, std::span<std::uint8_t> flags);

    // intersection_chunks.cu
    unsigned long long count_in_chunks();
    std::size_t pass_over_chunks(Hits hits);
    void require_room(std::size_t pairs) const;

    void bind() override;
    KernelParameters parameters() const override { return IntersectionParameters{pass_.policy}; }
    void choose_plan(Plan& plan) const override;
    void choose_chunks(Plan& plan, std::int64_t bytes) const override;
    void cut_rows(Cutter& c) override { cut_rows(c, static_cast<std::size_t>(pass_.plan.hits)); }
    void clear_rows(Clearing& clearing) const override { answer().clear(clearing, scene()); }
    void narrow() override;
    bool write_rows(Counters* host_counters) override;
    void count_tests(const Counters& counters, Statistics& statistics) const override;
    std::size_t decide_beyond(std::size_t n) override;
    void append_decided(std::size_t count, unsigned long long before) override;
    void read_rows(unsigned long long total) override { answer().total = total; }
    void find_in_chunks() override;
    void release_rows(std::size_t slot) override;

    IntersectionPass pass_;
    std::array<Answer, Flights::slots> answers_;
    std::array<IntersectionQuery, Flights::slots> queries_;  ///< without filters, which inputs have
};

}  // namespace crumple::cuda
