#include "backends/cuda/intersections/intersection_pass.h"

namespace crumple::cuda {

void IntersectionPass::cut(ArenaLayout& c) {
    Pass::cut(c);
    records_.record = c.take<Record>(plan.last_members());
    undecided_ = c.take<Candidate>(plan.undecided);
    beyond_ = c.take<Pair>(plan.beyond);
    hits_ = c.take<Hit>(plan.hits);
}

void IntersectionPass::narrow(const Hits& hits) {
    cuda::narrow(geometry_, stream_, scene, sorted_, records_, points_, frames(), policy, survivors(),
                 {undecided_, &counters->undecided, plan.undecided}, {beyond_, &counters->beyond, plan.beyond}, hits,
                 &counters->doubles);
}

}  // namespace crumple::cuda
