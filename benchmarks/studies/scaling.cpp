// Study of the scaling of ranks as if each had a machine of its own: times of searches and of other computation, and
// counts of the communication of a frame. Ranks are threads of this process, timed by the CPU time of each thread
// outside its calls of the transport. Each makes its own block of a cloth, which moves. benchmarks/predict_ranks.py
// reads these figures.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <thread>

#include <time.h>

#include "crumple/error.h"
#include "distributed/rank_detector.h"
#include "distributed/transport/in_process.h"
#include "report.h"
#include "scenes/cloth.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

double time_of_thread() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Figures of one rank in one frame.
struct RankFigures {
    double work = 0, rest = 0;                       // milliseconds of search, and of all else outside the transport
    double bytes = 0, messages = 0, neighbours = 0;  // sent in exchanges, and number of receiving ranks
    double reductions = 0, reduced = 0, broadcasts = 0, all_to_alls = 0, exchanges = 0;  // counts; `reduced`: bytes
    double members = 0;
    double moved = 0;  // DistributedStatistics::moved as 0 or 1
};
constexpr std::array<std::pair<const char*, double RankFigures::*>, 12> columns{
    {{"work", &RankFigures::work},
     {"rest", &RankFigures::rest},
     {"bytes", &RankFigures::bytes},
     {"messages", &RankFigures::messages},
     {"neighbours", &RankFigures::neighbours},
     {"reductions", &RankFigures::reductions},
     {"reduced", &RankFigures::reduced},
     {"broadcasts", &RankFigures::broadcasts},
     {"all_to_alls", &RankFigures::all_to_alls},
     {"exchanges", &RankFigures::exchanges},
     {"members", &RankFigures::members},
     {"moved", &RankFigures::moved}}};

/// Decorator of the in-process transport that counts calls and measures their time.
class Counted final : public distribute::Transport {
   public:
    Counted(std::shared_ptr<distribute::Hub> hub, int rank) : inner_(std::move(hub), rank), spoken_to_(inner_.size()) {}
    int rank() const override { return inner_.rank(); }
    int size() const override { return inner_.size(); }
    void reduce(std::span<std::int64_t> numbers, distribute::Reduction how) override {
        ++told_.reductions;
        told_.reduced += static_cast<double>(numbers.size_bytes());
        apart([&] { inner_.reduce(numbers, how); });
    }
    void broadcast(std::span<std::byte> bytes, int root) override {
        ++told_.broadcasts;
        apart([&] { inner_.broadcast(bytes, root); });
    }
    void all_to_all(std::span<const std::int64_t> to, std::span<std::int64_t> from) override {
        ++told_.all_to_alls;
        apart([&] { inner_.all_to_all(to, from); });
    }
    void exchange(std::span<const distribute::Outgoing> out, std::span<const distribute::Incoming> in) override {
        ++told_.exchanges;
        for (const distribute::Outgoing& message : out) {
            if (message.bytes.empty()) continue;
            ++told_.messages;
            told_.bytes += static_cast<double>(message.bytes.size());
            spoken_to_[static_cast<std::size_t>(message.rank)] = true;
        }
        apart([&] { inner_.exchange(out, in); });
    }

    /// Returns the figures of the frame that ends here, and resets them.
    RankFigures end(double milliseconds, const DistributedStatistics& statistics) {
        told_.work = statistics.work_milliseconds;
        told_.rest = milliseconds - inside_ - told_.work;
        told_.moved = statistics.moved;
        told_.members = static_cast<double>(statistics.members);
        told_.neighbours = static_cast<double>(std::ranges::count(spoken_to_, true));
        inside_ = 0;
        std::fill(spoken_to_.begin(), spoken_to_.end(), false);
        return std::exchange(told_, {});
    }

   private:
    template <class Call>
    void apart(Call call) {
        const double begin = time_of_thread();
        call();
        inside_ += time_of_thread() - begin;
    }
    distribute::InProcess inner_;
    std::vector<bool> spoken_to_;
    RankFigures told_;
    double inside_ = 0;
};

constexpr int frames = 9, warm = 3;  // the first `warm` frames, which make and assign parts, do not count

/// Block of a rank's triangles of the cloth, in the last two frames of its animation. Calls alternate between them.
struct MovingBlock {
    std::array<scenes::MeshBlock, 2> blocks;
    std::vector<std::int64_t> vertex_ids;

    MovingBlock(scenes::Parameters parameters, int rank, int ranks) {
        for (const int f : {0, 1}) {
            parameters.frame = scenes::cloth_frames - 2 + f;
            blocks[static_cast<std::size_t>(f)] = scenes::cloth_block(parameters, rank, ranks);
            blocks[static_cast<std::size_t>(f)].mesh.groups = {};
        }
        vertex_ids.resize(static_cast<std::size_t>(blocks[0].mesh.vertex_count()));
        std::iota(vertex_ids.begin(), vertex_ids.end(), blocks[0].first_vertex);
    }
    LocalMesh local_mesh(int frame) const {
        return {blocks[static_cast<std::size_t>(frame % 2)].mesh.view(), {}, vertex_ids};
    }
};

/// Returns the largest value and the mean of each column over all ranks.
nlohmann::json over_ranks(const std::vector<RankFigures>& ranks) {
    nlohmann::json row;
    for (const auto& [name, member] : columns) {
        double largest = 0, sum = 0;
        for (const RankFigures& told : ranks) largest = std::max(largest, told.*member), sum += told.*member;
        row[name] = {{"largest", largest}, {"mean", sum / static_cast<double>(ranks.size())}};
    }
    return row;
}

/// Returns the median of each column over the frames of one rank.
RankFigures median_of(const std::vector<RankFigures>& told) {
    RankFigures median;
    for (const auto& [name, member] : columns) {
        std::vector<double> values;
        for (const RankFigures& one : told) values.push_back(one.*member);
        median.*member = summarise(std::move(values)).median;
    }
    return median;
}

nlohmann::json frames_of(const scenes::Parameters& parameters, int ranks) {
    const auto hub = std::make_shared<distribute::Hub>(ranks);
    std::vector<RankFigures> first(static_cast<std::size_t>(ranks)), later(first);
    std::vector<std::thread> threads;
    std::int64_t pairs = 0;
    for (int r = 0; r < ranks; ++r)
        threads.emplace_back([&, r] {
            Counted transport(hub, r);
            DistributedOptions options;
            options.detector.backend = Backend::cpu;
            options.detector.threads = 1;
            const MovingBlock block(parameters, r, ranks);
            distribute::RankDetector detector(transport, options);
            detector.set_clock(time_of_thread);
            std::vector<RankFigures> told;
            for (int frame = 0; frame < frames; ++frame) {
                const double begin = time_of_thread();
                const std::int64_t total = detector.find(block.local_mesh(frame)).count;
                told.push_back(transport.end(time_of_thread() - begin, detector.statistics()));
                if (r == 0) pairs = total;
            }
            const auto at = static_cast<std::size_t>(r);
            first[at] = told.front();
            later[at] = median_of({told.begin() + warm, told.end()});
        });
    for (std::thread& thread : threads) thread.join();
    return {{"ranks", ranks}, {"pairs", pairs}, {"first", over_ranks(first)}, {"frame", over_ranks(later)}};
}

}  // namespace

nlohmann::json study_scaling(const StudySettings& settings) {
    struct Series {
        std::int64_t triangles;  // per rank if of_rank, else in the whole scene
        bool of_rank;
        std::vector<int> ranks;
    };
    std::vector<Series> series{{100'000, true, {1, 2, 4, 8, 16, 32, 64}},
                               {10'000, true, {1, 4, 16, 64, 256, 1024}},
                               {10'000'000, false, {2, 4, 8, 16, 32, 64, 256, 1024}}};
    if (settings.quick) series = {{2000, true, {1, 2, 4, 8}}};
    if (!settings.scenes.empty()) series.clear();
    for (const std::string& name : settings.scenes) {
        const auto [scene, parameters] = parse(name);
        if (scene != "cloth" || parameters.triangles == 0)
            throw Error(ErrorCode::invalid_argument, "study scaling takes cloth:TRIANGLES");
        series.push_back({parameters.triangles, false, {16, 64, 256, 1024}});
    }
    nlohmann::json rows = nlohmann::json::array();
    for (const auto& [triangles, of_rank, counts] : series) {
        Table table(fmt::format("scaling: cloth, {} triangles {}; a frame", triangles, of_rank ? "a rank" : "in all"),
                    {"ranks", "largest work ms", "mean", "largest rest ms", "mean", "members a rank", "largest MB",
                     "messages", "neighbours", "collectives", "exchanges"});
        for (const int ranks : counts) {
            scenes::Parameters parameters;
            parameters.triangles = of_rank ? triangles * ranks : triangles;
            nlohmann::json& row = rows.emplace_back(frames_of(parameters, ranks));
            row["triangles"] = parameters.triangles;
            const auto of = [&](const char* name, const char* which) {
                return row["frame"][name][which].get<double>();
            };
            table.row({std::to_string(ranks), number(of("work", "largest")), number(of("work", "mean")),
                       number(of("rest", "largest")), number(of("rest", "mean")), number(of("members", "mean")),
                       number(1e-6 * of("bytes", "largest")), number(of("messages", "largest")),
                       number(of("neighbours", "largest")),
                       number(of("reductions", "mean") + of("broadcasts", "mean") + of("all_to_alls", "mean")),
                       number(of("exchanges", "mean"))});
        }
        table.print();
    }
    return rows;
}

}  // namespace crumple::benchmark
