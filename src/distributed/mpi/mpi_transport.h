#pragma once

// Transport between MPI processes.

#include <vector>

#include "crumple/mpi.h"
#include "distributed/transport/transport.h"

namespace crumple::distribute {

/// Throws Error (communication) with MPI's message unless `code` is MPI_SUCCESS.
void check_mpi(int code, const char* call);

class MpiTransport final : public Transport {
   public:
    /// The communicator must be used by this transport alone, and return errors (MPI_ERRORS_RETURN).
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
