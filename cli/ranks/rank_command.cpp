#include "cli/ranks/rank_command.h"

#include <chrono>
#include <exception>
#include <new>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/terminal.h"
#include "io/bytes/gzip.h"
#include "io/formats.h"

namespace crumple::cli {

void refuse_on_ranks(const std::string& what) {
    throw Error(ErrorCode::invalid_argument, what + " is not shared among ranks: run it in one process",
                Element::option);
}

void check_shared_groups(const AnswerOptions& answer) {
    if (answer.of_bodies()) refuse_on_ranks("--groups bodies");
    if (answer.groups == "components") refuse_on_ranks("--groups components");
}

void check_shared_outputs(const std::vector<std::string>& outputs, const std::string& format) {
    for (const std::string& path : outputs) {
        if (io::has_gzip_name(path)) refuse_on_ranks("-o " + path + ", a compressed file,");
        const std::string extension = extension_of(path, format);
        if (io::pair_format_of(extension) == io::PairFormat::automatic) refuse_on_ranks("a coloured " + extension);
    }
}

int run_on_ranks(const std::function<int(RankLink&)>& command) {
    try {
        RankLink link;
        return command(link);
    } catch (const Error& error) {
        if (error.rank >= 0) throw RankLink::as_of_one_process(error);  // all have it
        abort_all_ranks(error.what(), failed);
    } catch (const std::bad_alloc&) {
        abort_all_ranks("the machine does not have enough memory", out_of_memory);
    } catch (const std::exception& error) {
        abort_all_ranks(error.what(), failed);
    }
}

void tell_phases(mpi::Detector& detector, const Steps& steps) {
    using Clock = std::chrono::steady_clock;
    detector.set_progress([&steps, told = Clock::time_point()](const DistributedProgress& progress) mutable {
        const bool begins = progress.parts_done == 0;
        // A part may take minutes, or no time.
        if (!begins && Clock::now() - told < std::chrono::seconds(1)) return;
        told = Clock::now();
        steps.begin(begins ? std::string(phase_name(progress.phase))
                           : fmt::format("{}, {} of {} parts done", phase_name(progress.phase), progress.parts_done,
                                         progress.parts));
    });
}

int report_on_ranks(RankLink& link, bool any, const char* yes, const char* no) {
    link.agree([&] {
        if (link.is_first()) to_standard_output([&](std::ostream& out) { out << (any ? yes : no) << '\n'; });
    });
    return any ? collided : done;
}

}  // namespace crumple::cli
