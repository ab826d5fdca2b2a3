#include "distributed/mpi/mpi_transport.h"

#include <algorithm>
#include <array>
#include <string>

#include "crumple/error.h"

namespace crumple::distribute {

void check_mpi(int code, const char* call) {
    if (code == MPI_SUCCESS) return;
    std::array<char, MPI_MAX_ERROR_STRING> text{};
    int length = 0;
    MPI_Error_string(code, text.data(), &length);
    throw Error(ErrorCode::communication,
                std::string(call) + ": " + std::string(text.data(), static_cast<std::size_t>(length)));
}

MpiTransport::MpiTransport(MPI_Comm communicator) : communicator_(communicator) {
    check_mpi(MPI_Comm_rank(communicator, &rank_), "MPI_Comm_rank");
    check_mpi(MPI_Comm_size(communicator, &size_), "MPI_Comm_size");
}

void MpiTransport::reduce(std::span<std::int64_t> numbers, Reduction how) {
    const MPI_Op op = how == Reduction::min ? MPI_MIN : how == Reduction::max ? MPI_MAX : MPI_SUM;
    check_mpi(
        MPI_Allreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(numbers.size()), MPI_INT64_T, op, communicator_),
        "MPI_Allreduce");
}

// Broadcasts in pieces, since MPI counts with int.
void MpiTransport::broadcast(std::span<std::byte> bytes, int root) {
    constexpr std::size_t most = std::size_t{1} << 30;
    for (; !bytes.empty(); bytes = bytes.subspan(std::min(most, bytes.size())))
        check_mpi(
            MPI_Bcast(bytes.data(), static_cast<int>(std::min(most, bytes.size())), MPI_BYTE, root, communicator_),
            "MPI_Bcast");
}

void MpiTransport::all_to_all(std::span<const std::int64_t> to, std::span<std::int64_t> from) {
    check_mpi(MPI_Alltoall(to.data(), 1, MPI_INT64_T, from.data(), 1, MPI_INT64_T, communicator_), "MPI_Alltoall");
}

// Messages between the same two ranks keep their order, so all calls can use the same tag.
void MpiTransport::exchange(std::span<const Outgoing> out, std::span<const Incoming> in) {
    requests_.clear();
    for (const Incoming& message : in)
        if (!message.bytes.empty()) {
            requests_.emplace_back();
            check_mpi(MPI_Irecv(message.bytes.data(), static_cast<int>(message.bytes.size()), MPI_BYTE, message.rank, 0,
                                communicator_, &requests_.back()),
                      "MPI_Irecv");
        }
    for (const Outgoing& message : out)
        if (!message.bytes.empty()) {
            requests_.emplace_back();
            check_mpi(MPI_Isend(message.bytes.data(), static_cast<int>(message.bytes.size()), MPI_BYTE, message.rank, 0,
                                communicator_, &requests_.back()),
                      "MPI_Isend");
        }
    check_mpi(MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE), "MPI_Waitall");
}

}  // namespace crumple::distribute
