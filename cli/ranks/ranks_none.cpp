// Stubs of ranks.h, rank_search.h and rank_overlaps.h for a build without MPI, in which each process runs alone.

#include "cli/ranks/rank_overlaps.h"
#include "cli/ranks/rank_search.h"
#include "cli/ranks/ranks.h"
#include "crumple/error.h"

namespace crumple::cli {

Ranks::Ranks(int&, char**&) {}
Ranks::~Ranks() = default;
int Ranks::count() { return 1; }

void refuse_on_ranks(const std::string&) {
    throw Error(ErrorCode::communication, "this program was built without CRUMPLE_MPI");
}
int overlaps_on_ranks(const RankOverlapSearch&) { refuse_on_ranks({}); }
template <class Query>
int search_on_ranks(const SearchCommand&, const std::vector<std::string>&, const Query&) {
    refuse_on_ranks({});
}
template int search_on_ranks(const SearchCommand&, const std::vector<std::string>&, const IntersectionQuery&);
template int search_on_ranks(const SearchCommand&, const std::vector<std::string>&, const ImpactQuery&);
template int search_on_ranks(const SearchCommand&, const std::vector<std::string>&, const ProximityQuery&);

}  // namespace crumple::cli
