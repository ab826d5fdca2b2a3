#include "engine/cpu/stream.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "base/stopwatch.h"
#include "engine/output.h"

namespace crumple::cpu {
namespace {

// Cuts ids into ranges one behind the other, each as long as can be answered at once. answer(range) is the number of
// pairs, or more than `most` if they were too many; one(id) answers an id that has too many by itself.
template <class Answer, class One>
void for_each_range(IdRange ids, std::int64_t most, Answer answer, One one) {
    std::int64_t length = ids.size();
    while (ids.begin < ids.end) {
        const IdRange range{ids.begin, std::min(ids.end, ids.begin + length)};
        const std::int64_t pairs = answer(range);
        if (pairs > most) {
            length = range.size() / 2;
            if (length > 0) continue;
            one(range.begin);
            length = 1;
        } else {
            // Three quarters full, if the next ids are like these.
            const std::int64_t longest = 16 * range.size();
            const double share =
                0.75 * static_cast<double>(most) / static_cast<double>(std::max<std::int64_t>(pairs, 1));
            const double next = share * static_cast<double>(range.size());
            length = next < static_cast<double>(longest) ? std::max<std::int64_t>(1, static_cast<std::int64_t>(next))
                                                         : longest;
        }
        ids.begin = range.end;
    }
}

// The pairs that those of a list from `before` on stand for.
std::int64_t count(const Copies& copies, const Array<Pair>& pairs, std::size_t before) {
    if (copies.empty()) return static_cast<std::int64_t>(pairs.size() - before);
    std::int64_t sum = 0;
    for (std::size_t i = before; i < pairs.size(); ++i) sum += copies.count(pairs[i]);
    return sum;
}

// A block that is filled from any thread, and handed over when it is full.
class FillingBlock {
   public:
    FillingBlock(const IntersectCall& call, std::int64_t most, BlockSink sink)
        : call_(call), most_(static_cast<std::size_t>(most)), sink_(sink), filling_(fresh()) {}

    void add(const Array<Pair>& pairs) {
        std::unique_lock lock(mutex_);
        const auto second = static_cast<std::int32_t>(call_.scene.between ? call_.scene.triangles[0] : 0);
        for (const Pair& first : pairs)
            call_.leaves.copies().for_each(first, call_.cancellation, [&](Pair pair) {
                filling_->pairs.push_back({pair.a, pair.b - second});
                if (filling_->pairs.size() == most_) hand_over(lock);
            });
    }
    void finish() {
        std::unique_lock lock(mutex_);
        if (!filling_->pairs.empty()) hand_over(lock);
    }

   private:
    using Block = std::unique_ptr<Collisions>;

    Block fresh() {
        if (spare_.empty()) return std::make_unique<Collisions>(metered(&call_.meter));
        Block block = std::move(spare_.back());
        spare_.pop_back();
        return block;
    }
    // Others fill the next block meanwhile.
    void hand_over(std::unique_lock<std::mutex>& lock) {
        Block full = std::exchange(filling_, fresh());
        lock.unlock();
        if (call_.query.contacts)
            rational_ += contacts_of_pairs(call_.scene, *full, [&](std::size_t n, auto task) {
                for (std::size_t i = 0; i < n; ++i) task(i);
            });
        {
            const std::lock_guard turn(turn_);
            sink_(*full);
        }
        full->pairs.clear();
        lock.lock();
        spare_.push_back(std::move(full));
        call_.statistics.rational_contacts = rational_;
    }

    const IntersectCall& call_;
    const std::size_t most_;
    const BlockSink sink_;
    std::mutex mutex_;  ///< of the block that is filled, and the spare ones
    std::mutex turn_;   ///< of the sink
    std::vector<Block> spare_;
    Block filling_;
    std::atomic<std::int64_t> rational_{0};
};

}  // namespace

void stream_in_order(IntersectCall call, std::int64_t most, BlockSink sink) {
    std::atomic<std::int64_t> pairs{0};
    std::atomic<bool> enough{false};
    const auto told = [&](const Array<Pair>& found, std::size_t before) {
        const std::int64_t more = count(call.leaves.copies(), found, before);
        if (pairs.fetch_add(more, std::memory_order_relaxed) + more > most)
            enough.store(true, std::memory_order_relaxed);
    };
    const PairSink counted = told;
    PairRange range;
    call.sink = &counted;
    call.enough = &enough;
    call.range = &range;
    Collisions block = metered(&call.meter);
    const auto answer = [&] {
        pairs = 0;
        enough = false;
        search_pairs(call);
        if (enough || pairs == 0) return pairs.load();
        write_result(call, block);
        for (auto* flags : {&block.hit, &block.hit_second}) flags->clear();
        block.offsets.clear();
        sink(block);
        return pairs.load();
    };
    const std::int64_t first = call.scene.triangles[0], all = call.scene.triangle_count();
    measure(call);
    const auto seconds_of = [&](std::int64_t id) { return IdRange{call.scene.between ? first : id + 1, all}; };
    const auto of_firsts = [&](IdRange ids) {
        range = {ids, seconds_of(ids.begin)};
        return answer();
    };
    const auto of_one = [&](std::int64_t id) {
        const auto of_seconds = [&](IdRange ids) {
            range = {{id, id + 1}, ids};
            return answer();
        };
        for_each_range(seconds_of(id), most, of_seconds, [](std::int64_t) {});  // two triangles are one pair
    };
    for_each_range({0, first}, most, of_firsts, of_one);
}

void stream_as_found(IntersectCall call, std::int64_t most, BlockSink sink) {
    FillingBlock block(call, most, sink);
    const auto take = [&](Array<Pair>& found, std::size_t) {
        block.add(found);
        found.clear();
    };
    const PairSink taken = take;
    call.sink = &taken;
    measure(call);
    search_pairs(call);
    block.finish();
}

}  // namespace crumple::cpu
