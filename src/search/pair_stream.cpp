#include "search/pair_stream.h"

#include <atomic>
#include <memory>

#include "results/intersection_output.h"
#include "results/ordered_blocks.h"

namespace crumple {
namespace {

void append_pairs(Intersections& to, const Intersections& piece, std::size_t begin, std::size_t end) {
    to.pairs.grow_by(end - begin);
    for (std::size_t i = begin; i < end; ++i) to.pairs.push_back(piece.pairs[i]);
    const Contacts& from = piece.contacts;
    if (from.kinds.empty()) return;
    if (to.contacts.offsets.empty()) to.contacts.offsets.push_back(0);
    for (std::size_t i = begin; i < end; ++i) {
        to.contacts.kinds.push_back(from.kinds[i]);
        for (std::int64_t p = from.offsets[i]; p < from.offsets[i + 1]; ++p)
            to.contacts.points.push_back(from.points[static_cast<std::size_t>(p)]);
        to.contacts.offsets.push_back(static_cast<std::int64_t>(to.contacts.points.size()));
    }
}

/// Converts pairs that the backend delivers to pieces of blocks (results/ordered_blocks.h), with contacts if requested.
class PairPieces final : public PairStream {
   public:
    PairPieces(const PreparedScene& scene, bool contacts, MemoryMeter& meter, OrderedBlocks<Intersections>& blocks)
        : scene_(scene), contacts_(contacts), meter_(meter), blocks_(blocks) {}

    void add(std::int64_t unit, Array<Pair>& rows) override {
        if (rows.empty()) return;
        auto piece = std::make_unique<Intersections>(metered(&meter_));
        piece->pairs.swap_elements(rows);
        if (contacts_)
            rational += contacts_of_pairs(scene_, *piece, [](std::size_t n, auto task) {
                for (std::size_t i = 0; i < n; ++i) task(i);
            });
        blocks_.add(unit, std::move(piece));
    }
    void finish(std::int64_t unit) override { blocks_.finish(unit); }
    void fail() override { blocks_.fail(); }

    std::atomic<std::int64_t> rational{0};  ///< number of contacts computed in rational arithmetic

   private:
    const PreparedScene& scene_;
    bool contacts_;
    MemoryMeter& meter_;
    OrderedBlocks<Intersections>& blocks_;
};

}  // namespace

void stream_pairs(BackendBase& backend, const PreparedScene& scene, const IntersectionQuery& query, std::int64_t most,
                  MemoryMeter& meter, Cancellation& cancellation, FunctionRef<void(const Intersections& block)> take,
                  Statistics& statistics) {
    OrderedBlocks<Intersections> blocks(most, cancellation,
                                        {.make = [&] { return std::make_unique<Intersections>(metered(&meter)); },
                                         .size = [](const Intersections& block) { return block.pairs.size(); },
                                         .append = append_pairs,
                                         .take =
                                             [&](Intersections& block) {
                                                 block.count = static_cast<std::int64_t>(block.pairs.size());
                                                 block.any = true;
                                                 take(block);
                                             },
                                         .clear = [](Intersections& block) { clear(block); }});
    PairPieces pieces(scene, query.contacts(), meter, blocks);
    backend.stream(scene, query, pieces, statistics);
    blocks.finish();
    statistics.rational_contacts = pieces.rational;
}

}  // namespace crumple
