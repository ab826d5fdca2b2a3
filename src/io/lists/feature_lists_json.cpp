// Impacts, near pairs and candidates as one JSON object, an array for each column.

#include <cmath>

#include "io/bytes/json.h"
#include "io/lists/feature_list_view.h"

namespace crumple::io {

namespace {

/// Writes the members of an object.
class Members {
   public:
    explicit Members(Sink& sink) : sink_(sink) {}

    Sink& member(std::string_view name) {
        sink_ << (first_ ? "{\n\"" : ",\n\"") << name << "\": ";
        first_ = false;
        return sink_;
    }
    template <class T, class Write>
    void array(std::string_view name, std::span<const T> values, Write write) {
        member(name);
        write_json_array(sink_, values.size(), [&](std::size_t i) { write(values[i]); });
    }

   private:
    Sink& sink_;
    bool first_ = true;
};

void add_list(Members& members, Sink& sink, const FeatureAnswer& answer, CandidateKind kind) {
    const auto pair = [&](std::int32_t a, std::int32_t b) { sink << '[' << a << ',' << b << ']'; };
    const FeatureListView& list = answer[kind];
    if (!list.listed) return;
    write_json_array(members.member(array_of(kind)), list.pairs.size(), [&](std::size_t i) {
        const Pair p = answer.by_vertex(kind, i);
        pair(p.a, p.b);
    });
    if (answer.has_bodies())
        members.array(array_of(kind, "bodies"), list.bodies, [&](const BodyPair& p) { pair(p.first, p.second); });
    if (!answer.words.has_values()) return;
    members.array(array_of(kind, answer.words.value), list.values, [&](double value) {
        std::isfinite(value) ? sink << value : sink << "null";  // JSON has no infinity
    });
    members.array(array_of(kind, answer.words.flag), list.flags, [&](std::uint8_t flag) { sink << int{flag}; });
}

void add_edges(Members& members, Sink& sink, const FeatureAnswer& answer) {
    members.array("edges", answer.edges, [&](const Edge& e) { sink << '[' << e.a << ',' << e.b << ']'; });
    if (answer.has_bodies()) members.array("first_edge", answer.first_edge, [&](std::int64_t i) { sink << i; });
}

void add_earliest(Sink& sink, const FeatureAnswer& answer) {
    const FirstImpact& first = *answer.first;
    if (!first.found) {
        sink << "null";
        return;
    }
    const Pair pair = answer.by_vertex(kind_of(first.kind), first.pair, first.bodies);
    sink << R"({"kind":")" << feature_kind_name(first.kind) << R"(","pair":[)" << pair.a << ',' << pair.b << ']';
    if (answer.has_bodies()) sink << R"(,"bodies":[)" << first.bodies.first << ',' << first.bodies.second << ']';
    sink << R"(,"toi":)" << first.toi << R"(,"start":)" << int{first.start} << '}';
}

}  // namespace

void write_features_json(std::ostream& out, const FeatureAnswer& answer) {
    Sink sink(out);
    Members members(sink);
    for (const CandidateKind kind : all_kinds) {
        if (kind == CandidateKind::edge_edge && answer.lists_edges()) add_edges(members, sink, answer);
        add_list(members, sink, answer, kind);
    }
    if (answer.first) {
        members.member("earliest");
        add_earliest(sink, answer);
    }
    members.member("statistics") << json_of(answer.statistics) << "\n}\n";
}

}  // namespace crumple::io
