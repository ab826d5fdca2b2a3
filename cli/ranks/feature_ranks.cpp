#include "cli/ranks/feature_ranks.h"

#include "cli/commands.h"
#include "cli/ranks/rank_command.h"
#include "cli/ranks/rank_features.h"
#include "cli/ranks/rank_input.h"
#include "cli/ranks/rank_output.h"
#include "cli/ranks/rank_statistics.h"
#include "crumple/mpi.h"

namespace crumple::cli {
namespace {

void check_is_shared(const FeatureCommand& command) {
    check_shared_groups(command.answer);
    if (command.stream) refuse_on_ranks("--stream");
    check_shared_outputs(command.outputs.paths, command.outputs.format);
    command.answer.check();
    check_cost_options(command.options);
}

/// Collective. Of all ranks, whose rows are counted here.
template <class Answer>
Tally tally_of_all(RankLink& link, const Answer& found, double milliseconds) {
    Tally tally{found.count, {}, milliseconds};
    for (std::size_t kind = 0; kind < tally.by_kind.size(); ++kind)
        tally.by_kind[kind] = link.sum(static_cast<std::int64_t>(found.lists[kind].pairs.size()));
    return tally;
}

void write(std::ostream& out, const Impacts& all, io::PairFormat format) { io::write_impacts(out, all, format); }
void write(const std::string& path, const Impacts& all, io::PairFormat format) { io::write_impacts(path, all, format); }
void write(std::ostream& out, const Proximities& all, io::PairFormat format) { io::write_near(out, all, format); }
void write(const std::string& path, const Proximities& all, io::PairFormat format) {
    io::write_near(path, all, format);
}

/// Collective. complete(all) adds what the lists leave open.
template <class All, class Found, class Complete>
void write_lists(RankLink& link, const FeatureOutputs& outputs, const RankInput& input, const Found& found,
                 io::ListKind of, Complete complete) {
    const OrderedRows rows = in_order(link, found);
    const auto text = [&](io::PairFormat format) { return text_of(link, rows, of, format); };
    const auto lists = [&] {
        All all;
        collect(link, rows, input, all);
        complete(all);
        return all;
    };
    write_list(link, outputs.paths, outputs.format, text, lists,
               [](auto& to, const All& all, io::PairFormat format) { write(to, all, format); });
}

/// Collective. The list of one impact, which rank 0 writes.
template <class Complete>
void write_first(RankLink& link, const FeatureOutputs& outputs, const RankInput& input, Complete complete) {
    Impacts all;
    complete(all);
    all.edges = collect_edges(link, input);
    link.agree([&] {
        if (!link.is_first()) return;
        all.first_edge.assign(1, 0);
        all.first_edge.push_back(static_cast<std::int64_t>(all.edges.size()));
        const Impacts one = only_first(all);
        outputs.write([&](auto& to, io::PairFormat format) { write(to, one, format); });
    });
}

/// What either command does before and after its question.
class FeaturesOnRanks {
   public:
    FeaturesOnRanks(RankLink& link, const FeatureCommand& command, const std::vector<std::string>& inputs)
        : link_(link), command_(command), steps_(command.progress) {
        link.agree([&] {
            if (link.is_first()) check_outputs(command.outputs.paths, inputs, command.answer);
        });
    }
    mpi::Detector detector() const {
        DistributedOptions options;
        options.detector = feature_options(command_.options);
        mpi::Detector detector(MPI_COMM_WORLD, options);
        tell_phases(detector, steps_);
        return detector;
    }
    /// Counts what has been found on all ranks, and prints it for --stats. `remark`: instead of the kinds.
    template <class Found>
    void take(const mpi::Detector& detector, const Found& found, std::int64_t triangles, const char* remark = nullptr) {
        const RankTotals totals =
            total(link_, found.statistics, triangles, found.count, detector.options().detector.threads);
        statistics_ = totals.statistics.search;
        tally_ = tally_of_all(link_, found, totals.statistics.milliseconds);
        if (command_.stats) print_statistics(link_, totals, remark ? remark : kinds_of(tally_));
    }
    const Steps& steps() const { return steps_; }
    const Statistics& statistics() const { return statistics_; }
    const Tally& tally() const { return tally_; }

   private:
    RankLink& link_;
    const FeatureCommand& command_;
    Steps steps_;
    Statistics statistics_;
    Tally tally_;
};

int impacts(RankLink& link, const FeatureCommand& command, const std::string& start, const std::string& end,
            const ImpactQuery& question, bool earliest) {
    FeaturesOnRanks ranks(link, command, {start, end});
    const auto threads = allowed_threads(command.options);
    ranks.steps().begin("read");
    const RankInput input = read_step_on_ranks(link, start, end, command.answer);
    mpi::Detector detector = ranks.detector();
    const DistributedImpacts& found = about_input(start + " to " + end, [&]() -> const DistributedImpacts& {
        return detector.find(input.share().moving_to(input.end.view().vertices), question);
    });
    if (question.output != Output::any)
        ranks.take(detector, found, input.triangles.rows, earliest ? only_first_remark : nullptr);
    if (command.only_status()) return report_on_ranks(link, found.any, "something touches", "nothing touches");
    const auto complete = [&](Impacts& all) {
        all.any = found.any;
        all.first = found.first;
        all.statistics = ranks.statistics();
    };
    ranks.steps().begin("write");
    if (earliest)
        write_first(link, command.outputs, input, complete);
    else
        write_lists<Impacts>(link, command.outputs, input, found, io::ListKind::impacts, complete);
    return command.finish(found.any, summary_of_impacts(ranks.tally(), found.first, earliest, input.triangles.rows));
}

int near(RankLink& link, const FeatureCommand& command, const std::string& file, const ProximityQuery& question) {
    FeaturesOnRanks ranks(link, command, {file});
    const auto threads = allowed_threads(command.options);
    ranks.steps().begin("read");
    const RankInput input = read_features_on_ranks(link, file, command.answer);
    mpi::Detector detector = ranks.detector();
    const DistributedProximities& found =
        about_input(file, [&]() -> const DistributedProximities& { return detector.find(input.share(), question); });
    if (question.output != Output::any) ranks.take(detector, found, input.triangles.rows);
    if (command.only_status()) return report_on_ranks(link, found.any, "something is near", "nothing is near");
    ranks.steps().begin("write");
    write_lists<Proximities>(link, command.outputs, input, found, io::ListKind::near, [&](Proximities& all) {
        all.any = found.any;
        all.statistics = ranks.statistics();
    });
    return command.finish(found.any, summary_of_near(ranks.tally(), input.triangles.rows));
}

}  // namespace

int impacts_on_ranks(const FeatureCommand& command, const std::string& start, const std::string& end,
                     const ImpactQuery& question, bool earliest) {
    check_is_shared(command);
    return run_on_ranks([&](RankLink& link) { return impacts(link, command, start, end, question, earliest); });
}

int near_on_ranks(const FeatureCommand& command, const std::string& file, const ProximityQuery& question) {
    check_is_shared(command);
    return run_on_ranks([&](RankLink& link) { return near(link, command, file, question); });
}

}  // namespace crumple::cli
