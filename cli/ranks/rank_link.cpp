#include "cli/ranks/rank_link.h"

#include <span>

namespace crumple::cli {
namespace {

constexpr std::int64_t bytes_at_a_time = std::int64_t{1} << 26;

/// Returns a duplicate of MPI_COMM_WORLD, which is not freed before MPI_Finalize: freeing is collective, and after an
/// error no rank may wait for the others.
MPI_Comm duplicate_of_world() {
    MPI_Comm own = MPI_COMM_NULL;
    distribute::check_mpi(MPI_Comm_dup(MPI_COMM_WORLD, &own), "MPI_Comm_dup");
    distribute::check_mpi(MPI_Comm_set_errhandler(own, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
    return own;
}

}  // namespace

RankLink::RankLink() : transport_(duplicate_of_world()), rounds_(transport_, bytes_at_a_time), agreement_(transport_) {
    rounds_.reserve();  // allocates now, so that no exchange fails on one rank only
}

std::string RankLink::text_of_first(std::string text) {
    text.resize(static_cast<std::size_t>(largest(is_first() ? static_cast<std::int64_t>(text.size()) : 0)));
    transport_.broadcast(std::as_writable_bytes(std::span(text)), 0);
    return text;
}

}  // namespace crumple::cli
