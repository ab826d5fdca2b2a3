// A build without MPI: nobody else is there.

#include "cli/ranks/detect_ranks.h"
#include "cli/ranks/feature_ranks.h"
#include "cli/ranks/ranks.h"
#include "crumple/error.h"

namespace crumple::cli {

Ranks::Ranks(int&, char**&) {}
Ranks::~Ranks() = default;
int Ranks::count() { return 1; }

namespace {

[[noreturn]] void nobody_is_there() {
    throw Error(ErrorCode::communication, "this program was built without CRUMPLE_MPI");
}

}  // namespace

void refuse_on_ranks(const std::string&) { nobody_is_there(); }
int detect_on_ranks(const RanksDetection&) { nobody_is_there(); }
int impacts_on_ranks(const FeatureCommand&, const std::string&, const std::string&, const ImpactQuery&, bool) {
    nobody_is_there();
}
int near_on_ranks(const FeatureCommand&, const std::string&, const ProximityQuery&) { nobody_is_there(); }

}  // namespace crumple::cli
