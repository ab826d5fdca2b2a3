#include "cli/ranks/rank_link.h"

#include <cstdlib>

#include "cli/terminal.h"

namespace crumple::cli {
namespace {

constexpr std::int64_t bytes_at_a_time = std::int64_t{1} << 26;

}  // namespace

void abort_all_ranks(const char* message, int status) {
    be_silent(false);
    print_error(message);
    MPI_Abort(MPI_COMM_WORLD, status);
    std::exit(status);
}

// Left to MPI_Finalize: after an error nobody may wait for the others to free it.
RankLink::Communicator::Communicator() {
    distribute::check_mpi(MPI_Comm_dup(MPI_COMM_WORLD, &own), "MPI_Comm_dup");
    distribute::check_mpi(MPI_Comm_set_errhandler(own, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
}

RankLink::RankLink() : transport_(communicator_.get()), rounds_(transport_, bytes_at_a_time), agreement_(transport_) {}

std::string RankLink::text_of_first(std::string text) {
    text.resize(static_cast<std::size_t>(largest(is_first() ? static_cast<std::int64_t>(text.size()) : 0)));
    transport_.broadcast(std::as_writable_bytes(std::span(text)), 0);
    return text;
}

/// A file is bad whoever reads it, and what rank 0 does is what one process would do; of others it matters who they
/// are.
Error RankLink::as_of_one_process(const Error& error) {
    const std::string who = "rank " + std::to_string(error.rank) + ": ", message = error.what();
    if (!message.starts_with(who) || (error.rank > 0 && error.code != ErrorCode::format)) return error;
    Error plain(error.code, message.substr(who.size()), error.element, error.index, error.bytes_needed,
                error.system_error);
    plain.rank = error.rank;
    return plain;
}

}  // namespace crumple::cli
