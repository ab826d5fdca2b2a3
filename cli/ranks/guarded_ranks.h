#pragma once

// Errors of commands that MPI processes run together.

#include <functional>

#include "crumple/error.h"

namespace crumple::cli {

/// Returns the error without "rank 3: " in its message.
Error without_rank_name(const Error& error);
/// Returns the error without "rank 3: " in its message if the rank does not matter: for errors of rank 0, which does
/// what a single process would do, and for errors in a file's contents, which do not depend on the rank.
Error without_rank(const Error& error);

/// Collective. Returns work(). Rethrows an Error that all ranks have thrown. An exception that was thrown on this rank
/// only is printed and aborts the processes of all ranks, because they would wait for this one forever.
int guarded_on_ranks(const std::function<int()>& work);

}  // namespace crumple::cli
