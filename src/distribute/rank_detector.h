#pragma once

// The detector of one rank, over any transport: it knows the order of the phases.
//
//     question   ranks ask the same                     search  each rank searches the parts that it owns
//     input      each checks what it brings             rows    rows go to who brought their first triangle
//     ids        each element once, copies equal        output  each puts its rows in order
//     place      centres, if those at hand do not serve
//     members    each finds parts of its triangles
//     room       owners make room, and are told what is new

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "base/stopwatch.h"
#include "crumple/distributed.h"
#include "distribute/agreement.h"
#include "distribute/assembled_part.h"
#include "distribute/directory.h"
#include "distribute/found_rows.h"
#include "distribute/members.h"
#include "distribute/part_search.h"
#include "distribute/placement.h"
#include "distribute/rounds.h"
#include "distribute/share.h"

namespace crumple::distribute {

class RankDetector {
   public:
    /// Collective. The transport must outlive this.
    RankDetector(Transport& transport, const DistributedOptions& options);

    const DistributedCollisions& find_self(const MeshShare& share, const Query& query, std::stop_token stop = {});
    std::int64_t count(const MeshShare& share, const Query& query, std::stop_token stop = {});
    bool has_collision(const MeshShare& share, const Query& query, std::stop_token stop = {});

    const DistributedOptions& options() const { return options_; }
    const DistributedStatistics& statistics() const { return result_.statistics; }
    /// What tells how long a search took, in milliseconds; by default the time of day.
    void set_clock(double (*clock)()) { clock_ = clock; }
    /// Called at the beginning of each phase, where what it throws is settled.
    void set_hook(std::function<void(Phase)> hook) { hook_ = std::move(hook); }

   private:
    enum class Wants : std::uint8_t { any, count, pairs };

    void answer(const MeshShare& share, const Query& query, Wants wants, std::stop_token stop);
    void ask(const MeshShare& share, const Query& query, Wants wants);
    void read(const MeshShare& share);
    void settle_ids();
    void place();
    void list_members();
    void give_out();
    void give_out_anew();
    void own_parts();
    void deliver();
    void search(const Query& query, Wants wants);
    void finish(const Query& query, Wants wants);
    void expect_work(Wants wants);
    void forget();
    void drop_parts();

    int parts_wanted() const;
    bool on_any_rank(bool here);
    void reduce(std::span<std::int64_t> numbers, Reduction how) { transport_.reduce(numbers, how); }

    Transport& transport_;
    DistributedOptions options_;
    Rounds rounds_;
    Agreement agree_;
    std::function<void(Phase)> hook_;
    std::stop_token stop_;
    double (*clock_)();
    Stopwatch watch_;
    Phase phase_ = Phase::question;

    // Of this call:
    bool float32_ = true, groups_ = false, triangle_ids_ = false, vertex_ids_ = false, same_ = false;
    std::vector<std::int64_t> counts_;
    Box box_;
    std::optional<FoundRows> found_;
    std::int64_t found_here_ = 0;
    std::vector<std::int64_t> work_;  ///< nanoseconds of each part

    // From call to call:
    std::optional<PartSearch> engine_;
    Share share_;
    SharedVertices copies_;
    Placement placement_;
    Owners owners_;
    Members members_;
    std::vector<AssembledPart> mine_;
    std::vector<std::int64_t> expected_work_;  ///< nanoseconds of each part; empty: not known
    std::int64_t reserved_ = 0;                ///< bytes of parts, as the meter has them
    DistributedCollisions result_;
};

}  // namespace crumple::distribute
