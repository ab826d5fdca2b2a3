#include "cli/commands/sequence_output.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/command_options.h"
#include "cli/numbered.h"
#include "crumple/error.h"

namespace crumple::cli {
namespace {

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
    return result + '"';
}

/// Counts of the stages, in the order of the columns.
constexpr std::pair<const char*, std::int64_t Statistics::*> counts[]{
    {"clusters", &Statistics::clusters},         {"leaves", &Statistics::leaves},
    {"members", &Statistics::members},           {"interval_tests", &Statistics::interval_tests},
    {"box_overlaps", &Statistics::box_overlaps}, {"edge_tests", &Statistics::edge_tests},
    {"double_tests", &Statistics::double_tests}, {"exact_tests", &Statistics::exact_tests}};

std::string csv_header(bool impacts) {
    std::string line = std::string("frame,triangles,") + (impacts ? "impacts,earliest" : "pairs") + ",milliseconds";
    for (int i = 0; i < stage_count; ++i) line += fmt::format(",{}", stage_name(static_cast<Stage>(i)));
    for (const auto& [name, count] : counts) line += fmt::format(",{}", name);
    return line + ",repeats,least,greatest\n";
}

/// Returns a row of a .csv table. `first`: first impact of a step; null if the row is a frame.
std::string csv_row(const std::string& frame, const Statistics& s, const Repeats& repeats, const FirstImpact* first) {
    std::string line = quoted(frame) + fmt::format(",{},{}", s.triangles, s.pairs);
    if (first) line += first->found ? fmt::format(",{}", first->toi) : ",";
    line += fmt::format(",{:.3f}", s.milliseconds);
    for (int i = 0; i < stage_count; ++i) line += fmt::format(",{:.3f}", s[static_cast<Stage>(i)]);
    for (const auto& [name, count] : counts) line += fmt::format(",{}", s.*count);
    return line + fmt::format(",{},{:.3f},{:.3f}\n", repeats.count, repeats.least, repeats.greatest);
}

/// Rounds to whole microseconds.
double rounded(double milliseconds) { return std::round(milliseconds * 1000) / 1000; }

std::string json_row(const std::string& frame, const Statistics& s, const Repeats& repeats, const FirstImpact* first) {
    nlohmann::ordered_json row{{"frame", frame}, {"triangles", s.triangles}, {first ? "impacts" : "pairs", s.pairs}};
    if (first) row["earliest"] = first->found ? nlohmann::json(first->toi) : nlohmann::json();
    row["milliseconds"] = rounded(s.milliseconds);
    for (int i = 0; i < stage_count; ++i) {
        row[std::string(stage_name(static_cast<Stage>(i)))] = rounded(s[static_cast<Stage>(i)]);
    }
    for (const auto& [name, count] : counts) row[name] = s.*count;
    row["repeats"] = repeats.count;
    row["least"] = rounded(repeats.least);
    row["greatest"] = rounded(repeats.greatest);
    return row.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

void StatisticsTable::add(const std::string& frame, const Statistics& statistics, const Repeats& repeats,
                          const FirstImpact& first) {
    const FirstImpact* const of_step = impacts_ ? &first : nullptr;
    if (!out_) {
        file_ = std::make_unique<io::AtomicFile>(path_);
        out_ = &file_->stream();
    }
    if (json_) {
        *out_ << (count_ ? ",\n" : "[\n") << json_row(frame, statistics, repeats, of_step);
    } else {
        *out_ << (count_ ? "" : csv_header(impacts_)) << csv_row(frame, statistics, repeats, of_step);
    }
    out_->flush();
    ++count_;
}

void StatisticsTable::end_rows() {
    if (json_) *out_ << "\n]\n";
    out_->flush();
}

void StatisticsTable::finish() {
    if (count_ == 0) return;
    end_rows();
    if (file_) file_->commit();
}

void StatisticsTable::give_up() {
    if (count_ > 0 && !file_) end_rows();
}

Pictures::Pictures(const std::vector<std::string>& outputs, std::ostream* stream, std::size_t frames)
    : stream_(stream), frames_(frames) {
    for (const std::string& path : outputs) (extension_of(path) == ".glb" ? animated_ : numbered_).push_back(path);
    if (!animated_.empty() || stream) animation_.emplace();
}

void Pictures::add(const InputMeshes& input, const Intersections& found) {
    for (const std::string& path : numbered_) {
        io::write_coloured(numbered(path, count_, frames_), input.first, input.second_or_null(), found);
    }
    if (animation_) animation_->add(input.first, input.second_or_null(), found);
    ++count_;
}

void Pictures::finish() {
    if (count_ == 0) return;
    for (const std::string& path : animated_) animation_->write(path);
    if (stream_) animation_->write(*stream_);
}

}  // namespace crumple::cli
