#pragma once

// One scene searched for pairs of features whose grown boxes overlap.

#include <optional>

#include "engine/candidate_query.h"
#include "engine/cuda/finder.h"
#include "questions/candidates/cuda/pass.h"
#include "questions/features/cuda/input.h"

namespace crumple::cuda {

class CandidateFinder : Finder<CandidatePass> {
   public:
    CandidateFinder(const Device& device, const Geometry& geometry, cudaStream_t stream, const Options& options,
                    MemoryMeter& meter, Cancellation& cancellation, Input& input, FeaturesOnDevice& features)
        : Finder(device, geometry, stream, options, meter, cancellation, input), features_(features), values_(meter) {}

    /// Of a scene in host memory.
    void find(const Scene& scene, const CandidateQuery& query, CandidateAnswer& answer);

    /// Gives back all that is kept between calls.
    void release();

   private:
    /// What sizes and places of all arrays follow from.
    struct Layout {
        std::int64_t vertices, triangles;
        bool float32, moving;
        Plan plan;
        FirstOfCandidates firsts;
        friend bool operator==(const Layout&, const Layout&) = default;
    };

    void adopt(const Scene& scene, const CandidateQuery& query);
    void find_at_once(CandidateAnswer& answer);
    void find_in_chunks(CandidateAnswer& answer, Lists lists);
    void lay_out_lists();
    void make_ready();
    void enqueue();
    CandidateHits hits() const;
    void take_hits(Array<RankedCandidate>& found);
    void write_sorted(Array<RankedCandidate>& found, CandidateAnswer& answer) const;
    void copy_to(CandidateAnswer& answer);

    FeaturesOnDevice& features_;
    Block values_;
    Inflation* widening_ = nullptr;
    Normaliser* normaliser_ = nullptr;
    FirstOfCandidates firsts_;
    CandidateOutput output_{};
    std::optional<Layout> laid_out_;
    std::int64_t planned_for_ = -1;  ///< triangles
};

}  // namespace crumple::cuda
