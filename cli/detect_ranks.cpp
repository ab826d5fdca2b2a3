#include "cli/detect_ranks.h"

#include <algorithm>
#include <exception>
#include <new>
#include <optional>

#include "cli/commands.h"
#include "cli/rank_input.h"
#include "cli/rank_output.h"
#include "cli/rank_rows.h"
#include "cli/rank_statistics.h"
#include "cli/search.h"
#include "cli/statistics_table.h"
#include "cli/terminal.h"
#include "cli/threads.h"
#include "crumple/mpi.h"
#include "io/formats.h"

namespace crumple::cli {
namespace {

/// Names the file in an Error, as Search does.
template <class Ask>
decltype(auto) about_file(const std::string& file, Ask ask) {
    try {
        return ask();
    } catch (const Error& error) {
        throw with_name(file, RankLink::as_of_one_process(error));
    }
}

class DetectOnRanks {
   public:
    explicit DetectOnRanks(const RanksDetection& asked) : asked_(asked) {}

    int run() {
        link_.agree([&] {
            if (link_.is_first()) check_outputs(asked_.outputs, asked_.files, asked_.answer);
        });
        const std::optional<AllowedThreads> threads =
            asked_.options.threads ? std::optional<AllowedThreads>(std::in_place, asked_.options.threads)
                                   : std::nullopt;
        const RankInput input = read_on_ranks(link_, asked_.files[0], asked_.answer);
        Query query = query_of(asked_.answer);
        query.weld = query.weld || input.weld;
        DistributedOptions options;
        options.detector = asked_.options;
        mpi::Detector detector(MPI_COMM_WORLD, options);
        if (asked_.check && asked_.outputs.empty() && !asked_.stats)
            return report(about_file(asked_.files[0], [&] { return detector.has_collision(input.share(), query); }));
        const DistributedCollisions& found = about_file(asked_.files[0], [&]() -> const DistributedCollisions& {
            return detector.find_self(input.share(), query);
        });
        const std::int64_t hits = count_hits(link_, found, input.triangles);
        const RankTotals totals =
            total(link_, found.statistics, input.triangles.rows, found.total, detector.options().detector.threads);
        if (asked_.stats) print_statistics(link_, totals, hits);
        if (asked_.check && asked_.outputs.empty()) return report(found.total > 0);
        write(found, input.triangles, totals.statistics.search);
        if (!asked_.stats && !std::all_of(asked_.outputs.begin(), asked_.outputs.end(), is_standard))
            say(summary_of_pairs(found.total, hits, input.triangles.rows, "triangles", totals.statistics.milliseconds));
        return asked_.check && found.total > 0 ? collided : done;
    }

   private:
    int report(bool collides) {
        link_.agree([&] {
            if (!link_.is_first()) return;
            to_standard_output(
                [&](std::ostream& out) { out << (collides ? "something collides\n" : "nothing collides\n"); });
        });
        return collides ? collided : done;
    }

    void write(const DistributedCollisions& found, io::Blocks triangles, const Statistics& statistics) {
        const auto text = [&](io::PairFormat format) { return RankText(link_, found, asked_.answer.contacts, format); };
        if (asked_.outputs.empty()) print_on_ranks(link_, text(io::PairFormat::txt));
        std::optional<Collisions> all;
        for (const std::string& path : asked_.outputs) {
            const io::PairFormat format = io::pair_format_of(extension_of(path, asked_.format));
            if (format == io::PairFormat::txt || format == io::PairFormat::csv) {
                is_standard(path) ? print_on_ranks(link_, text(format)) : write_on_ranks(link_, path, text(format));
                continue;
            }
            if (!all) {
                all = collect(link_, found, triangles);
                all->statistics = statistics;
            }
            link_.agree([&] {
                if (!link_.is_first()) return;
                if (!is_standard(path)) return io::write_pairs(path, *all, format);
                to_standard_output([&](std::ostream& out) { io::write_pairs(out, *all, format); });
            });
        }
    }

    const RanksDetection& asked_;
    RankLink link_;
};

void refuse(const std::string& what) {
    throw Error(ErrorCode::invalid_argument, what + " is not shared among ranks: run it in one process",
                Element::option);
}

void check_is_shared(const RanksDetection& asked) {
    if (asked.answer.of_bodies()) refuse("--groups bodies");
    if (asked.answer.groups == "components") refuse("--groups components");
    if (asked.files.size() > 1) refuse("a second mesh");
    if (asked.answer.polygons) refuse("--polygons");
    if (asked.answer.part) refuse("--part");
    if (asked.stream) refuse("--stream");
    for (const std::string& path : asked.outputs) {
        const std::string extension = extension_of(path, asked.format);
        if (io::pair_format_of(extension) == io::PairFormat::automatic) refuse("a coloured " + extension);
    }
}

}  // namespace

int detect_on_ranks(const RanksDetection& asked) {
    check_is_shared(asked);
    asked.answer.check();
    check_cost_options(asked.options);
    try {
        return DetectOnRanks(asked).run();
    } catch (const Error& error) {
        if (error.rank >= 0) throw RankLink::as_of_one_process(error);  // all have it
        abort_all_ranks(error.what(), failed);
    } catch (const std::bad_alloc&) {
        abort_all_ranks("the machine does not have enough memory", out_of_memory);
    } catch (const std::exception& error) {
        abort_all_ranks(error.what(), failed);
    }
}

}  // namespace crumple::cli
