// Instances of the stages whose kernels contain parts of the query, for feature queries.

#include "backends/cuda/features/feature_records.h"
#include "backends/cuda/stages/sort_kernel.h"
#include "backends/cuda/stages/sweep_kernel.h"

namespace crumple::cuda {

template void sort_members(const Geometry&, cudaStream_t, const PreparedScene&, const Points&, int, const Segments&,
                           const Members&, const Frames&, const Ownership&, const Sorted&, const Widened<1>&,
                           const FeatureMemberRows<1>&, const List<SweepUnit>&, Counters*);
template void sort_members(const Geometry&, cudaStream_t, const PreparedScene&, const Points&, int, const Segments&,
                           const Members&, const Frames&, const Ownership&, const Sorted&, const Widened<2>&,
                           const FeatureMemberRows<2>&, const List<SweepUnit>&, Counters*);

template void sweep(const Geometry&, cudaStream_t, const PreparedScene&, const Sorted&, const List<SweepUnit>&,
                    const Ownership&, const PairSelection&, const SeparatingAxisTest<1>&, const List<Candidate>&,
                    const Slice&, Counters*);
template void sweep(const Geometry&, cudaStream_t, const PreparedScene&, const Sorted&, const List<SweepUnit>&,
                    const Ownership&, const PairSelection&, const SeparatingAxisTest<2>&, const List<Candidate>&,
                    const Slice&, Counters*);

}  // namespace crumple::cuda
