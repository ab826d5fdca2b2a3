// Colliding pairs as text and CSV; the format by extension.

#include "io/pairs.h"

#include "base/float_environment.h"
#include "io/atomic_file.h"
#include "io/formats.h"
#include "io/sink.h"

namespace crumple::io {

namespace {

constexpr std::size_t most_points = 6;

void write_txt(std::ostream& out, const Collisions& collisions) {
    Sink sink(out);
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

void write_csv(std::ostream& out, const Collisions& collisions) {
    Sink sink(out);
    sink << "a,b";
    if (has_contacts(collisions)) {
        sink << ",kind,points";
        for (std::size_t k = 0; k < most_points; ++k) sink << ",x" << k << ",y" << k << ",z" << k;
    }
    sink << '\n';
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

void validate(const Collisions& collisions) {
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

void write(std::ostream& out, const Collisions& collisions, PairFormat format) {
    switch (format) {
        case PairFormat::csv:
            return write_csv(out, collisions);
        case PairFormat::json:
            return write_pairs_json(out, collisions);
        case PairFormat::npz:
            return write_pairs_npz(out, collisions);
        default:
            return write_txt(out, collisions);
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

void write_pairs(std::ostream& out, const Collisions& collisions, PairFormat format) {
    const FloatEnvironment environment;
    validate(collisions);
    write(out, collisions, format);
    if (!out.flush()) throw Error(ErrorCode::file, "cannot write pairs to the stream");
}

void write_pairs(const std::filesystem::path& path, const Collisions& collisions, PairFormat format) {
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

}  // namespace crumple::io
