// Instances of the stages whose kernels contain parts of the query, for intersections.

#include "backends/cuda/intersections/intersection_records.h"
#include "backends/cuda/stages/sort_kernel.h"
#include "backends/cuda/stages/sweep_kernel.h"

namespace crumple::cuda {

template void sort_members(const Geometry&, cudaStream_t, const PreparedScene&, const Points&, int, const Segments&,
                           const Members&, const Frames&, const Ownership&, const Sorted&, const StaticTriangle&,
                           const RecordRows&, const List<SweepUnit>&, Counters*);

template void sweep(const Geometry&, cudaStream_t, const PreparedScene&, const Sorted&, const List<SweepUnit>&,
                    const Ownership&, const PairSelection&, const PlaneTest&, const List<Candidate>&, const Slice&,
                    Counters*);

}  // namespace crumple::cuda
