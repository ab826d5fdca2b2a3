// crumple sequence: the frames of an animation, one after another, by one detector that stays warm.
//
// Every frame is a row, written as soon as it is known, so that what there is survives an interruption. A file is not
// touched before the first row.

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/search.h"
#include "cli/statistics_table.h"
#include "cli/terminal.h"
#include "crumple/error.h"

namespace crumple::cli {
namespace {

volatile std::sig_atomic_t stop = 0;

/// The first Ctrl-C ends the sequence after the frame at hand, the second one the process.
void catch_interrupt() {
    struct sigaction action {};
    action.sa_handler = [](int) { stop = 1; };
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
}

/// Rows of a table, as CSV or JSON.
class Rows {
   public:
    Rows(std::ostream& out, bool json) : out_(out), json_(json) {
        if (json_) {
            out_ << "[";
        } else {
            out_ << "frame,triangles,pairs,milliseconds";
            for (int i = 0; i < stage_count; ++i) out_ << ',' << stage_name(static_cast<Stage>(i));
            out_ << '\n';
        }
        out_.flush();
    }
    void add(const std::string& frame, const Statistics& s) {
        json_ ? add_json(frame, s) : add_csv(frame, s);
        out_.flush();
        ++count_;
    }
    void finish() {
        if (json_) out_ << (count_ ? "\n]\n" : "]\n");
        out_.flush();
    }

   private:
    void add_csv(const std::string& frame, const Statistics& s) {
        out_ << quoted(frame) << fmt::format(",{},{},{:.3f}", s.triangles, s.pairs, s.milliseconds);
        for (int i = 0; i < stage_count; ++i) out_ << fmt::format(",{:.3f}", s[static_cast<Stage>(i)]);
        out_ << '\n';
    }
    void add_json(const std::string& frame, const Statistics& s) {
        nlohmann::ordered_json row{{"frame", frame},
                                   {"triangles", s.triangles},
                                   {"pairs", s.pairs},
                                   {"milliseconds", rounded(s.milliseconds)}};
        for (int i = 0; i < stage_count; ++i) {
            row[std::string(stage_name(static_cast<Stage>(i)))] = rounded(s[static_cast<Stage>(i)]);
        }
        out_ << (count_ ? ",\n" : "\n") << row.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    }
    /// Clocks tell no more than microseconds.
    static double rounded(double milliseconds) { return std::round(milliseconds * 1000) / 1000; }
    static std::string quoted(const std::string& text) {
        if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
        std::string result = "\"";
        for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
        return result + '"';
    }

    std::ostream& out_;
    bool json_;
    std::size_t count_ = 0;
};

struct Sequence {
    std::vector<std::string> frames;
    std::string output;
    AnswerOptions answer;
    Options options;
    bool json = false, check = false, stats = false;

    int run() const {
        const std::string extension = extension_of(output);
        if (!output.empty() && extension != ".csv" && extension != ".json") {
            throw Error(ErrorCode::invalid_argument, output + ": a sequence is written as .csv or .json");
        }
        if (json && extension == ".csv") throw Error(ErrorCode::invalid_argument, output + ": --json writes no .csv");
        check_outputs({output}, frames, answer);
        Search search(answer, options);
        if (output.empty()) {
            int status = done;
            to_standard_output([&](std::ostream& out) {
                status = find(
                    search, [&]() -> auto& { return out; }, json);
            });
            return status;
        }
        std::ofstream file;
        const auto open = [&]() -> std::ostream& {
            file.open(output);
            if (!file) throw Error(ErrorCode::file, "cannot write " + output + ": " + std::strerror(errno));
            return file;
        };
        const int status = find(search, open, extension == ".json");
        if (!file) throw Error(ErrorCode::file, "cannot write " + output);
        return status;
    }

    /// `open` is called for the first row.
    int find(Search& search, const std::function<std::ostream&()>& open, bool as_json) const {
        catch_interrupt();
        Statistics sum;
        std::int64_t hits = 0;
        std::ostream* out = nullptr;
        std::optional<Rows> rows;
        Progress progress(frames.size());
        std::size_t i = 0;
        try {
            for (; i < frames.size() && !stop && (!out || *out); ++i) {
                progress.show(i, frames[i]);
                const Collisions& found = search.find(read_input({frames[i]}, answer));
                progress.clear();
                if (!out) rows.emplace(*(out = &open()), as_json);
                rows->add(frames[i], found.statistics);
                add(sum, found.statistics);
                hits += count_hits(found);
            }
        } catch (...) {
            progress.clear();
            if (rows) rows->finish();
            throw;
        }
        if (rows) rows->finish();
        if (stats) print_statistics(sum, hits);
        if (stop) {
            print_error(fmt::format("interrupted after {} of {} frames", i, frames.size()));
            return interrupted;
        }
        return check && sum.pairs > 0 ? collided : done;
    }
};

}  // namespace

Command add_sequence(CLI::App& app) {
    const auto sequence = std::make_shared<Sequence>();
    CLI::App& command = *app.add_subcommand("sequence", "Find the colliding pairs of every frame of an animation");
    command.add_option("FRAME", sequence->frames, "Meshes (PLY, OBJ, STL, OFF), in order; the topology may change")
        ->type_name("FRAME...")
        ->required();
    command
        .add_option(
            "-o,--output", sequence->output,
            "Table of triangles, pairs, time and stages, a row a frame, as .csv or .json; without it CSV goes to "
            "standard output")
        ->type_name("OUT");
    command.add_flag("--json", sequence->json, "JSON instead of CSV on standard output");
    add_answer_options(command, sequence->answer);
    command.add_flag("--check", sequence->check, "Exit with status 1 if anything collides in any frame");
    command.add_flag("--stats", sequence->stats, "Print times and counts, summed over all frames, to standard error");
    add_cost_options(command, sequence->options);
    command.footer(
        "Times are in milliseconds, those of the stages summed over threads; reading files is not counted.\n"
        "Example: crumple sequence frames/*.ply -o times.csv");
    return {&command, [sequence] { return sequence->run(); }};
}

}  // namespace crumple::cli
