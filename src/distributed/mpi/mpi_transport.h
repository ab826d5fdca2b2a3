#pragma once

// Ranks that are processes of MPI.

#include <vector>

#include "crumple/mpi.h"
#include "distributed/transport/transport.h"

namespace crumple::distribute {

/// Throws Error (communication) with MPI's own words.
void check_mpi(int code, const char* call);

class MpiTransport final : public Transport {
   public:
    /// Of a communicator that nobody else uses, and that returns its errors.
    explicit MpiTransport(MPI_Comm communicator);
    int rank() const override { return rank_; }
    int size() const override { return size_; }
    void reduce(std::span<std::int64_t> numbers, Reduction how) override;
    void broadcast(std::span<std::byte> bytes, int root) override;
    void all_to_all(std::span<const std::int64_t> to, std::span<std::int64_t> from) override;
    void exchange(std::span<const Outgoing> out, std::span<const Incoming> in) override;

   private:
    MPI_Comm communicator_;
    int rank_ = 0, size_ = 1;
    std::vector<MPI_Request> requests_;
};

}  // namespace crumple::distribute
