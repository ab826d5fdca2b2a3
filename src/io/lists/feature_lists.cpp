// Impacts, near pairs and candidates as text and CSV; the format by extension.

#include <algorithm>

#include "base/float_environment.h"
#include "io/bytes/atomic_file.h"
#include "io/bytes/sink.h"
#include "io/formats.h"
#include "io/lists/feature_list_view.h"

namespace crumple::io {

namespace {

void add_id(Sink& sink, const CandidateRow& row, bool has_bodies, std::size_t k) {
    if (has_bodies) sink << (k < first_ids(row.kind) ? row.bodies.first : row.bodies.second) << ':';
    sink << row.ids[k];
}

}  // namespace

void add_txt(Sink& sink, const FeatureAnswer& answer) {
    const bool has_bodies = answer.has_bodies();
    for_each_row(answer, [&](const FeatureRow& row) {
        sink << short_name(row.kind);
        for (std::size_t k = 0; k < id_count(row.kind); ++k) {
            sink << ' ';
            add_id(sink, row, has_bodies, k);
        }
        if (answer.words.has_values()) sink << ' ' << row.value;
        if (answer.words.text_has_flag) sink << ' ' << (row.flag ? '1' : '0');
        sink << '\n';
    });
}

void begin_csv(Sink& sink, const FeatureWords& words) {
    sink << "kind,vertex,face,a,b,c,d";
    if (words.has_values()) sink << ',' << words.value << ',' << words.flag;
    sink << '\n';
}

void add_csv(Sink& sink, const FeatureAnswer& answer) {
    const bool has_bodies = answer.has_bodies(), has_values = answer.words.has_values();
    for_each_row(answer, [&](const FeatureRow& row) {
        sink << short_name(row.kind);
        const auto columns = id_columns(row.kind);
        for (std::size_t column = 0; column < most_id_columns; ++column) {
            sink << ',';
            const auto k =
                static_cast<std::size_t>(std::find(columns.begin(), columns.end(), column) - columns.begin());
            if (k < columns.size()) add_id(sink, row, has_bodies, k);
        }
        if (has_values) sink << ',' << row.value << ',' << (row.flag ? '1' : '0');
        sink << '\n';
    });
}

namespace {

void write(std::ostream& out, const FeatureAnswer& answer, PairFormat format) {
    if (format == PairFormat::json) return write_features_json(out, answer);
    if (format == PairFormat::npz) return write_features_npz(out, answer);
    Sink sink(out);
    if (format != PairFormat::csv) return add_txt(sink, answer);
    begin_csv(sink, answer.words);
    add_csv(sink, answer);
}

void write_list(std::ostream& out, const FeatureAnswer& answer, PairFormat format) {
    write(out, answer, format);
    if (!out.flush()) throw Error(ErrorCode::file, "cannot write " + std::string(answer.words.what) + " to the stream");
}

void write_list(const std::filesystem::path& path, const FeatureAnswer& answer, PairFormat format) {
    if (format == PairFormat::automatic) format = pair_format_of(extension_of(path));
    if (format == PairFormat::automatic)
        throw Error(ErrorCode::invalid_argument, "cannot write " + path.string() + ": " +
                                                     std::string(answer.words.what) +
                                                     " are written as .txt, .csv, .json or .npz");
    AtomicFile file(path);
    write(file.stream(), answer, format);
    file.commit();
}

}  // namespace

void write_impacts(std::ostream& out, const Impacts& impacts, PairFormat format) {
    const FloatEnvironment environment;
    write_list(out, view(impacts), format);
}
void write_impacts(const std::filesystem::path& path, const Impacts& impacts, PairFormat format) {
    const FloatEnvironment environment;
    write_list(path, view(impacts), format);
}

void write_triangle_pairs(std::ostream& out, const Impacts& impacts, PairFormat format) {
    const FloatEnvironment environment;
    write_list(out, view_of_triangle_pairs(impacts), format);
}
void write_triangle_pairs(const std::filesystem::path& path, const Impacts& impacts, PairFormat format) {
    const FloatEnvironment environment;
    write_list(path, view_of_triangle_pairs(impacts), format);
}

void write_near(std::ostream& out, const Proximities& nearby, PairFormat format) {
    const FloatEnvironment environment;
    write_list(out, view(nearby), format);
}
void write_near(const std::filesystem::path& path, const Proximities& nearby, PairFormat format) {
    const FloatEnvironment environment;
    write_list(path, view(nearby), format);
}

void write_candidates(std::ostream& out, const Candidates& candidates, PairFormat format) {
    const FloatEnvironment environment;
    write_list(out, view(candidates), format);
}
void write_candidates(const std::filesystem::path& path, const Candidates& candidates, PairFormat format) {
    const FloatEnvironment environment;
    write_list(path, view(candidates), format);
}

}  // namespace crumple::io
