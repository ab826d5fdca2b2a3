#pragma once

// One scene searched for pairs of features whose grown boxes overlap.

#include <optional>

#include "backends/cuda/candidates/candidate_pass.h"
#include "backends/cuda/features/feature_input.h"
#include "backends/cuda/features/finder.h"
#include "queries/candidate_request.h"
#include "queries/device_answer.h"

namespace crumple::cuda {

struct CandidateSlot : FinderSlot {
    CandidateSlot(const Device& device, cudaStream_t stream, MemoryMeter& meter, Input& input)
        : FinderSlot(device, stream, meter, input), values(meter), host(&meter) {}

    Block values;
    Inflation* widening = nullptr;
    Normaliser* normaliser = nullptr;
    AskedOfCandidates asked;
    FirstOfCandidates firsts;
    CandidateOutput output{};
    // What accepting has found:
    std::array<unsigned long long, candidate_kinds + 1> ends{};  ///< of the lists, among all rows
    CandidateAnswer host;                                        ///< the lists, if they were found in chunks
};

using CandidateKeyOfGraph = FinderKey<AskedOfCandidates, FirstOfCandidates>;

/// Its calls are those of FeatureFinder.
class CandidateFinder : public Finder<CandidateFinder, CandidatePass, CandidateSlot, CandidateKeyOfGraph> {
    friend Finder;

   public:
    CandidateFinder(const Device& device, const Geometry& geometry, cudaStream_t stream, const Options& options,
                    MemoryMeter& meter, Cancellation& cancellation, Flights& flights,
                    const std::array<Input*, Flights::slots>& inputs, FeaturesOnDevice& features)
        : Finder(device, geometry, stream, options, meter, cancellation, flights, inputs), features_(features) {}

    void bring(std::size_t slot, const PreparedScene& scene, const CandidateRequest& query);
    void view(std::size_t slot, const Shape& shape, const CandidateRequest& query, Room room = Room::grows);

    void copy_to(CandidateAnswer& answer);
    DeviceAnswer show();

    void release();

   private:
    const FirstOfCandidates& firsts() const { return slot().firsts; }
    static VertexReader rest() { return {}; }
    static Extent extent() { return Extent::all; }
    static bool all_kinds() { return false; }
    void adopt(const CandidateRequest& query, Room room);
    void look();
    void plan();
    void cut_answer(Cutter& cutter);
    void find_in_chunks(Lists lists);
    void make_ready();
    void enqueue(StageEvents* watch);
    bool accept();
    CandidateHits hits() const;
    void take_hits(Array<RankedCandidate>& found);
    void write_sorted(Array<RankedCandidate>& found);
    void upload();

    FeaturesOnDevice& features_;
    std::int64_t planned_for_ = -1;  ///< triangles
};

}  // namespace crumple::cuda
