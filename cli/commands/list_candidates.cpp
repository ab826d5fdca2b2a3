#include "cli/commands/list_candidates.h"

#include <string>

#include "cli/choice.h"

namespace crumple::cli {
namespace {

Choices<CandidateKind> kinds_by_name() {
    Choices<CandidateKind> choices;
    for (int k = 0; k < candidate_kinds; ++k) {
        const auto kind = static_cast<CandidateKind>(k);
        choices.emplace_back(candidate_kind_name(kind), kind);
    }
    return choices;
}

}  // namespace

CandidateQuery CandidateOptions::query(const QueryOptions& query_options) const {
    CandidateQuery query;
    if (!kinds.empty()) query.kinds = kinds;
    query.inflation = inflation;
    query.neighbours = neighbours;
    query.weld = query_options.weld.value_or(false);
    query.filter.groups = query_options.filter.value_or(PairScope::both);
    return query;
}

std::vector<const CLI::Option*> add_candidate_options(CLI::App& app, CandidateOptions& options,
                                                      const std::string& with) {
    const CLI::Option* const inflation =
        add_number_option(
            app, "--inflation", [&options](double value) { options.inflation = value; }, any_distance,
            ("With " + with + ": by how much each box is inflated on all sides; 0 by default").c_str())
            ->type_name("R");
    const auto add = [&options](const std::vector<std::string>& names) {
        for (const std::string& name : names) options.kinds.push_back(chosen("--kinds", name, kinds_by_name()));
    };
    const CLI::Option* const kinds =
        app.add_option_function<std::vector<std::string>>(
               "--kinds", add,
               "With " + with + ": kinds of pairs to list, separated by commas: " + words_of(kinds_by_name()) +
                   "; vertex_face,edge_edge by default")
            ->type_name("KIND,...")
            ->delimiter(',')
            ->allow_extra_args(false);
    const CLI::Option* const neighbours = app.add_flag(
        "--with-neighbours", options.neighbours,
        "With " + with + ": also list pairs with a common vertex, such as an edge and a face that contains it");
    return {inflation, kinds, neighbours};
}

}  // namespace crumple::cli
