// A build without MPI: nobody else is there.

#include "cli/detect_ranks.h"
#include "cli/ranks.h"
#include "crumple/error.h"

namespace crumple::cli {

Ranks::Ranks(int&, char**&) {}
Ranks::~Ranks() = default;
int Ranks::count() { return 1; }

int detect_on_ranks(const RanksDetection&) {
    throw Error(ErrorCode::communication, "this program was built without CRUMPLE_MPI");
}

}  // namespace crumple::cli
