#include "io/lists/pairs.h"

#include "io/bytes/json.h"

namespace crumple::io {
namespace {

constexpr std::size_t most_points = 6;
constexpr std::string_view pairs_name = "pairs";

ListArray pairs_array() {
    return {std::string(pairs_name), NumberType::int32, 2, {"triangle", "triangle"}, "pair", true};
}

void check_contacts(const Intersections& collisions) {
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

/// Writes an array of objects: {"kind":"segment","points":[[0,0,0],[1,0,0]]}.
void add_contacts(Sink& sink, const Intersections& collisions) {
    write_json_array(sink, collisions.pairs.size(), [&](std::size_t i) {
        sink << R"({"kind":")" << name_of(collisions.contacts.kinds[i]) << R"(","points":[)";
        bool first = true;
        for (const auto& [x, y, z] : points_of_pair(collisions.contacts, i)) {
            sink << (first ? "[" : ",[") << x << ',' << y << ',' << z << ']';
            first = false;
        }
        sink << "]}";
    });
}

std::vector<ListMember> members_of(const Intersections& collisions) {
    std::vector<ListMember> members{with_rows(pairs_array(), collisions.pairs.span())};
    const auto add_to_npz = [&](const char* name, NumberType type, std::size_t width, const auto& rows) {
        members.push_back(with_rows({name, type, width}, rows.span(), false));
    };
    add_to_npz("offsets", NumberType::int64, 1, collisions.offsets);
    add_to_npz("hit", NumberType::uint8, 1, collisions.hit);
    if (!collisions.hit_second.empty()) add_to_npz("hit_second", NumberType::uint8, 1, collisions.hit_second);
    if (has_contacts(collisions)) {
        const Contacts& contacts = collisions.contacts;
        add_to_npz("contact_kinds", NumberType::uint8, 1, contacts.kinds);
        add_to_npz("contact_offsets", NumberType::int64, 1, contacts.offsets);
        add_to_npz("contact_points", NumberType::float64, 3, contacts.points);
        members.push_back(json_member("contacts", [&](Sink& sink) { add_contacts(sink, collisions); }));
    }
    members.push_back(json_member("statistics", [&](Sink& sink) { sink << json_of(collisions.statistics); }));
    return members;
}

std::vector<Pair> read(const Source& source) {
    std::vector<Pair> pairs;
    const auto consume_row = [&](std::size_t, std::span<const ListValue> values) -> std::string {
        pairs.push_back({std::get<ListId>(values[0]).index, std::get<ListId>(values[1]).index});
        return {};
    };
    const auto consume_arrays = [&](const NumbersByName& arrays) {
        const auto found = arrays.find(pairs_name);
        if (found == arrays.end())
            throw Error(ErrorCode::format, source.name() + ": there is no array 'pairs' that can be read");
        const std::vector<std::int32_t>& ids = found->second.ids;
        pairs.resize(ids.size() / 2);
        for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = {ids[2 * i], ids[2 * i + 1]};
    };
    RowTable rows = pair_rows(false);
    rows.may_have_more = true;
    read_list(source, {rows, consume_row, {pairs_array()}, consume_arrays, true});
    return pairs;
}

}  // namespace

RowTable pair_rows(bool contacts) {
    RowTable table{{}, {{"", {}}}};
    const auto add = [&](const std::string& column, FieldType type, std::string_view noun = {}, bool as_text = true) {
        table.sections[0].fields.push_back({type, table.columns.size(), noun, as_text});
        table.columns.push_back(column);
    };
    add("a", FieldType::id, "triangle");
    add("b", FieldType::id, "triangle");
    if (!contacts) return table;
    add("kind", FieldType::word);
    add("points", FieldType::id, {}, false);
    for (std::size_t k = 0; k < most_points; ++k)
        for (const char axis : {'x', 'y', 'z'}) add(axis + std::to_string(k), FieldType::number);
    return table;
}

ListTable table_of(const Intersections& collisions) {
    check_contacts(collisions);
    return {"pairs", pair_rows(has_contacts(collisions)),
            [&](RowWriter& writer) { add_pairs(writer, collisions.pairs.span(), collisions.contacts); },
            [&] { return members_of(collisions); }};
}

void add_pairs(RowWriter& writer, std::span<const Pair> pairs, const Contacts& contacts) {
    std::vector<ListValue> values;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        values.assign({ListId{pairs[i].a}, ListId{pairs[i].b}});
        if (!contacts.offsets.empty()) {
            const auto points = points_of_pair(contacts, i);
            values.emplace_back(name_of(contacts.kinds[i]));
            values.emplace_back(ListId{static_cast<std::int32_t>(points.size())});
            for (const auto& point : points) values.insert(values.end(), point.begin(), point.end());
        }
        writer.add(0, values);
    }
}

void write_pairs(std::ostream& out, const Intersections& collisions, PairFormat format) {
    write_list(out, table_of(collisions), format);
}
void write_pairs(const std::filesystem::path& path, const Intersections& collisions, PairFormat format) {
    write_list(path, table_of(collisions), format);
}

struct PairWriter::Implementation {
    bool contacts;
    ListWriter writer;
};

PairWriter::PairWriter(const std::filesystem::path& path, bool contacts, PairFormat format)
    : implementation_(new Implementation{contacts, {"pairs", pair_rows(contacts), path, format}}) {}
PairWriter::PairWriter(std::ostream& out, bool contacts, PairFormat format)
    : implementation_(new Implementation{contacts, {"pairs", pair_rows(contacts), out, format}}) {}
PairWriter::~PairWriter() = default;
PairWriter::PairWriter(PairWriter&&) noexcept = default;
PairWriter& PairWriter::operator=(PairWriter&&) noexcept = default;

void PairWriter::add(const Intersections& block) {
    const ListTable table = table_of(block);
    if (implementation_->contacts != has_contacts(block) && !block.pairs.empty())
        throw Error(ErrorCode::invalid_argument,
                    "a block must have contacts if contacts were announced, and none if not");
    implementation_->writer.add(table);
}

void PairWriter::commit() { implementation_->writer.commit(); }

std::vector<Pair> read_pairs(const std::filesystem::path& path) { return read(Source(path)); }
std::vector<Pair> read_pairs(std::istream& in, const std::string& name) { return read(Source(in, name)); }

}  // namespace crumple::io
