#include <memory>

#include "crumple/detector.h"
#include "peers/peers.h"

namespace crumple::benchmark {

std::vector<Contestant> crumple_contestants(const Workload& workload) {
    std::vector<Contestant> contestants;
    for (const int threads : {1, 0}) {
        Options options;
        options.threads = threads;
        const auto detector = std::make_shared<Detector>(options);
        const auto answer = std::make_shared<const Intersections*>(nullptr);
        const MeshView a = workload.a.view(), b = workload.b.view();
        Contestant contestant{"crumple", threads == 1 ? "1 thread" : "all threads", "exact pairs, sorted", {}, {}};
        if (workload.query == Query::any) {
            contestant.computes = "exact yes or no";
            contestant.call = [=] { detector->any(a); };
        } else {
            const bool self = workload.query == Query::self;
            contestant.call = [=] { *answer = self ? &detector->find(a) : &detector->find({a, b}); };
            contestant.pairs = [=] { return std::vector<Pair>((*answer)->pairs.begin(), (*answer)->pairs.end()); };
        }
        contestants.push_back(std::move(contestant));
    }
    return contestants;
}

}  // namespace crumple::benchmark
