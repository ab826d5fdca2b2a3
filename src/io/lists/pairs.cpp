// Colliding pairs as text and CSV; the format by extension.

#include "io/lists/pairs.h"

#include <optional>

#include "base/float_environment.h"
#include "io/bytes/atomic_file.h"
#include "io/bytes/sink.h"
#include "io/formats.h"

namespace crumple::io {

namespace {

constexpr std::size_t most_points = 6;

void add_txt(Sink& sink, const Intersections& collisions) {
    for (std::size_t i = 0; i < collisions.pairs.size(); ++i) {
        sink << collisions.pairs[i].a << ' ' << collisions.pairs[i].b;
        if (has_contacts(collisions)) {
            sink << ' ' << name_of(collisions.contacts.kinds[i]);
            for (const auto& point : points_of_pair(collisions, i)) {
                for (const double x : point) sink << ' ' << x;
            }
        }
        sink << '\n';
    }
}

void begin_csv(Sink& sink, bool contacts) {
    sink << "a,b";
    if (contacts) {
        sink << ",kind,points";
        for (std::size_t k = 0; k < most_points; ++k) sink << ",x" << k << ",y" << k << ",z" << k;
    }
    sink << '\n';
}

void add_csv(Sink& sink, const Intersections& collisions) {
    for (std::size_t i = 0; i < collisions.pairs.size(); ++i) {
        sink << collisions.pairs[i].a << ',' << collisions.pairs[i].b;
        if (has_contacts(collisions)) {
            const auto points = points_of_pair(collisions, i);
            sink << ',' << name_of(collisions.contacts.kinds[i]) << ',' << points.size();
            for (const auto& point : points) {
                for (const double x : point) sink << ',' << x;
            }
            for (std::size_t k = points.size(); k < most_points; ++k) sink << ",,,";
        }
        sink << '\n';
    }
}

void validate(const Intersections& collisions) {
    if (!has_contacts(collisions)) return;
    const Contacts& contacts = collisions.contacts;
    const std::size_t pairs = collisions.pairs.size();
    bool consistent = contacts.kinds.size() == pairs && contacts.offsets.size() == pairs + 1 &&
                      contacts.offsets[0] == 0 &&
                      contacts.offsets[pairs] == static_cast<std::int64_t>(contacts.points.size());
    for (std::size_t i = 0; consistent && i < pairs; ++i) {
        const std::int64_t points = contacts.offsets[i + 1] - contacts.offsets[i];
        consistent = points >= 1 && points <= static_cast<std::int64_t>(most_points);
    }
    if (!consistent) throw Error(ErrorCode::invalid_argument, "the contacts are not those of the pairs");
}

void write(std::ostream& out, const Intersections& collisions, PairFormat format) {
    switch (format) {
        case PairFormat::json:
            return write_pairs_json(out, collisions);
        case PairFormat::npz:
            return write_pairs_npz(out, collisions);
        case PairFormat::csv: {
            Sink sink(out);
            begin_csv(sink, has_contacts(collisions));
            return add_csv(sink, collisions);
        }
        default: {
            Sink sink(out);
            add_txt(sink, collisions);
        }
    }
}

}  // namespace

PairFormat pair_format_of(std::string_view extension) {
    if (extension == ".txt") return PairFormat::txt;
    if (extension == ".csv") return PairFormat::csv;
    if (extension == ".json") return PairFormat::json;
    if (extension == ".npz") return PairFormat::npz;
    return PairFormat::automatic;
}

void write_pairs(std::ostream& out, const Intersections& collisions, PairFormat format) {
    const FloatEnvironment environment;
    validate(collisions);
    write(out, collisions, format);
    if (!out.flush()) throw Error(ErrorCode::file, "cannot write pairs to the stream");
}

void write_pairs(const std::filesystem::path& path, const Intersections& collisions, PairFormat format) {
    const FloatEnvironment environment;
    if (format == PairFormat::automatic) format = pair_format_of(extension_of(path));
    if (format == PairFormat::automatic) {
        throw Error(ErrorCode::invalid_argument,
                    "cannot write " + path.string() + ": pairs are written as .txt, .csv, .json or .npz");
    }
    validate(collisions);
    AtomicFile file(path);
    write(file.stream(), collisions, format);
    file.commit();
}

void write_heading_of_pairs(std::ostream& out, bool contacts, PairFormat format) {
    const FloatEnvironment environment;
    Sink sink(out);
    if (format == PairFormat::csv) begin_csv(sink, contacts);
}

void write_rows_of_pairs(std::ostream& out, const Intersections& block, PairFormat format) {
    const FloatEnvironment environment;
    Sink sink(out);
    format == PairFormat::csv ? add_csv(sink, block) : add_txt(sink, block);
}

struct PairWriter::Implementation {
    std::optional<AtomicFile> file;
    std::ostream* out = nullptr;
    bool csv = false, contacts = false;

    Implementation(PairFormat format, bool with_contacts) : csv(format == PairFormat::csv), contacts(with_contacts) {
        if (format != PairFormat::csv && format != PairFormat::txt)
            throw Error(ErrorCode::invalid_argument, "pairs are written block by block as .txt or .csv");
    }
    void begin() const { write_heading_of_pairs(*out, contacts, csv ? PairFormat::csv : PairFormat::txt); }
};

PairWriter::PairWriter(const std::filesystem::path& path, bool contacts, PairFormat format)
    : implementation_(std::make_unique<Implementation>(
          format == PairFormat::automatic ? pair_format_of(extension_of(path)) : format, contacts)) {
    implementation_->out = &implementation_->file.emplace(path).stream();
    implementation_->begin();
}

PairWriter::PairWriter(std::ostream& out, bool contacts, PairFormat format)
    : implementation_(
          std::make_unique<Implementation>(format == PairFormat::automatic ? PairFormat::txt : format, contacts)) {
    implementation_->out = &out;
    implementation_->begin();
}

PairWriter::~PairWriter() = default;
PairWriter::PairWriter(PairWriter&&) noexcept = default;
PairWriter& PairWriter::operator=(PairWriter&&) noexcept = default;

void PairWriter::add(const Intersections& block) {
    const FloatEnvironment environment;
    Implementation& to = *implementation_;
    validate(block);
    if (to.contacts != has_contacts(block) && !block.pairs.empty())
        throw Error(ErrorCode::invalid_argument, "a block has contacts, or lacks them, unlike what was announced");
    write_rows_of_pairs(*to.out, block, to.csv ? PairFormat::csv : PairFormat::txt);
    if (*to.out) return;
    if (to.file) to.file->complete();  // says why not
    throw Error(ErrorCode::file, "cannot write pairs to the stream");
}

void PairWriter::commit() {
    if (implementation_->file) return implementation_->file->commit();
    if (!implementation_->out->flush()) throw Error(ErrorCode::file, "cannot write pairs to the stream");
}

}  // namespace crumple::io
