#include "distributed/part_layout.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

namespace crumple::distribute {
namespace {

/// Centroid of a sampled triangle, and its index in the sample.
struct SampleRow {
    std::int32_t number;
    Vec3f centroid;
};

// Returns the box, enlarged on each side by a quarter of its extent, but only as far as its bounds stay finite.
Box widened(const Box& box) {
    constexpr double most = std::numeric_limits<double>::max();
    Box reach = box;
    for (int axis = 0; axis < 3; ++axis) {
        const double margin = 0.25 * box.high[axis] - 0.25 * box.low[axis];
        reach.low[axis] = max(-most, box.low[axis] - margin);
        reach.high[axis] = min(most, box.high[axis] + margin);
    }
    return reach;
}

}  // namespace

void PartLayout::make(MessageBatches& batches, CollectiveCheck& agree, const RankMesh& local, int parts, const Box& box,
                      ParallelFor& workers) {
    Transport& transport = batches.transport();
    constexpr int root = 0;
    const bool here = transport.rank() == root;
    reach_ = widened(box);
    parts_ = parts;
    normalise_ = Normaliser(reach_.low, reach_.high);
    const std::int64_t all = local.triangles().all;
    std::vector<SampleRow> mine;
    std::optional<PartSample> sample;
    agree(Phase::place, [&] {
        sample.emplace(all, parts);
        const auto size = static_cast<std::int64_t>(sample->size());
        for (std::int64_t t = 0; t < local.scene().triangle_count(); ++t) {
            const std::int64_t id = local.triangles()(t), i = (id * size + all - 1) / all;
            if (i < size && sample->triangle(static_cast<std::size_t>(i)) == id)
                mine.push_back(
                    {static_cast<std::int32_t>(i), PartSample::centroid(local.scene().triangle(t), normalise_)});
        }
    });
    Traffic traffic(transport.size());
    traffic.out[root] = static_cast<std::int64_t>(mine.size());
    transport.all_to_all(traffic.out, traffic.in);
    batches.exchange<SampleRow>(
        traffic,
        [&](int, std::int64_t first, std::span<SampleRow> rows) {
            std::copy_n(mine.begin() + static_cast<std::ptrdiff_t>(first), rows.size(), rows.begin());
        },
        [&](int, std::int64_t, std::span<const SampleRow> rows) {
            for (const SampleRow& row : rows) sample->set(static_cast<std::size_t>(row.number), row.centroid);
        });
    std::vector<std::byte> bytes;
    agree(Phase::place, [&] {
        if (!here) return;
        centres_.emplace(parts, sample->centroids(), normalise_, workers);
        bytes = centres_->bytes();
    });
    auto size = static_cast<std::int64_t>(bytes.size());
    transport.broadcast(std::as_writable_bytes(std::span(&size, 1)), root);
    agree(Phase::place, [&] { bytes.resize(static_cast<std::size_t>(size)); });
    transport.broadcast(bytes, root);
    agree(Phase::place, [&] {
        if (!here) centres_.emplace(bytes, normalise_);
    });
}

bool PartLayout::serves(int parts, const Box& box) const {
    if (!centres_ || parts != parts_) return false;
    for (int axis = 0; axis < 3; ++axis)
        if (box.low[axis] < reach_.low[axis] || box.high[axis] > reach_.high[axis]) return false;
    return true;
}

std::vector<std::int32_t> Owners::parts_of(int rank) const {
    std::vector<std::int32_t> parts;
    for (std::size_t k = 0; k < owner_.size(); ++k)
        if (owner_[k] == rank) parts.push_back(static_cast<std::int32_t>(k));
    return parts;
}

void Owners::give_out(std::span<const std::int64_t> work, int ranks, Near near) {
    std::vector<std::size_t> order(work.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return work[a] > work[b]; });
    const std::int64_t all = std::accumulate(work.begin(), work.end(), std::int64_t{0});
    const std::int64_t fair = all / ranks + all / (20 * ranks);
    std::vector<std::int64_t> load(static_cast<std::size_t>(ranks), 0);
    std::set<std::pair<std::int64_t, int>> by_load;
    for (int r = 0; r < ranks; ++r) by_load.emplace_hint(by_load.end(), 0, r);
    owner_.assign(work.size(), 0);
    for (const std::size_t k : order) {
        int owner = by_load.begin()->second;
        for (const int r : near(k)) {
            const std::int64_t before = load[static_cast<std::size_t>(r)];
            if (before > 0 && before + work[k] > fair) continue;
            owner = r;
            break;
        }
        owner_[k] = owner;
        std::int64_t& loaded = load[static_cast<std::size_t>(owner)];
        by_load.erase({loaded, owner});
        loaded += work[k];
        by_load.emplace(loaded, owner);
    }
}

double Owners::balance(std::span<const std::int64_t> work, int ranks) const {
    std::vector<std::int64_t> load(static_cast<std::size_t>(ranks), 0);
    std::int64_t all = 0;
    for (std::size_t k = 0; k < work.size(); ++k) load[static_cast<std::size_t>(owner_[k])] += work[k], all += work[k];
    if (all == 0) return 1;
    return static_cast<double>(*std::max_element(load.begin(), load.end())) * ranks / static_cast<double>(all);
}

}  // namespace crumple::distribute
