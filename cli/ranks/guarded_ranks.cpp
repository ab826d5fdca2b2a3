#include "cli/ranks/guarded_ranks.h"

#include <cstdlib>
#include <exception>
#include <new>
#include <string>

#include "cli/commands.h"
#include "cli/terminal.h"
#include "crumple/mpi.h"

namespace crumple::cli {
namespace {

// Prints the message and aborts all ranks.
[[noreturn]] void abort_all_ranks(const char* message, int status) {
    be_silent(false);
    print_error(message);
    MPI_Abort(MPI_COMM_WORLD, status);
    std::exit(status);
}

}  // namespace

Error without_rank_name(const Error& error) {
    const std::string who = "rank " + std::to_string(error.rank) + ": ", message = error.what();
    if (!message.starts_with(who)) return error;
    Error plain(error.code, message.substr(who.size()), error.element, error.index, error.bytes_needed,
                error.system_error);
    plain.rank = error.rank;
    return plain;
}

Error without_rank(const Error& error) {
    return error.rank > 0 && error.code != ErrorCode::format ? error : without_rank_name(error);
}

int guarded_on_ranks(const std::function<int()>& work) {
    try {
        return work();
    } catch (const Error& error) {
        if (error.rank >= 0) throw without_rank(error);  // thrown on all ranks
        abort_all_ranks(error.what(), failed);
    } catch (const std::bad_alloc&) {
        abort_all_ranks("the machine does not have enough memory", out_of_memory);
    } catch (const std::exception& error) {
        abort_all_ranks(error.what(), failed);
    }
}

}  // namespace crumple::cli
