#include "distributed/transport/collective_check.h"

#include <array>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "crumple/array.h"

namespace crumple::distribute {
namespace {

constexpr std::int64_t nobody = std::numeric_limits<std::int64_t>::max();

// Converts an exception to the Error that other ranks receive.
Error error_of(const std::exception_ptr& failed) {
    try {
        std::rethrow_exception(failed);
    } catch (const Error& error) {
        return error;
    } catch (const std::bad_alloc&) {
        return Error(ErrorCode::memory_limit, "memory is exhausted");
    } catch (const MemoryMeter::Exceeded& exceeded) {
        return Error(ErrorCode::memory_limit,
                     "the memory limit is too small; at least " + std::to_string(exceeded.bytes) + " bytes are needed",
                     Element::option, -1, exceeded.bytes);
    } catch (const std::exception& error) {
        return Error(ErrorCode::cancelled, std::string("the call was interrupted: ") + error.what());
    } catch (...) {
        return Error(ErrorCode::cancelled, "the call was interrupted");
    }
}

bool is_error(const std::exception_ptr& failed) {
    try {
        std::rethrow_exception(failed);
    } catch (const Error&) {
        return true;
    } catch (const std::bad_alloc&) {
        return true;
    } catch (const MemoryMeter::Exceeded&) {
        return true;
    } catch (...) {
        return false;
    }
}

}  // namespace

void CollectiveCheck::throw_if_any_failed(const std::exception_ptr& failed) {
    std::optional<Error> mine;
    if (failed) mine = error_of(failed);
    // Finds the least key (index, -bytes needed, rank), number by number; a rank with a larger number drops out.
    std::array<std::int64_t, 3> key{nobody, nobody, nobody};
    if (mine) key = {mine->index, -mine->bytes_needed, transport_.rank()};
    bool in = mine.has_value();
    std::int64_t least = 0;
    for (std::size_t k = 0; k < key.size(); ++k) {
        least = in ? key[k] : nobody;
        transport_.reduce({&least, 1}, Reduction::min);
        if (k == 0 && least == nobody) return;
        in = in && key[k] == least;
    }
    const int root = static_cast<int>(least);
    Error error = broadcast(mine, root);
    if (failed && !is_error(failed)) std::rethrow_exception(failed);
    throw error;
}

// Broadcasts the error of the rank `root`.
Error CollectiveCheck::broadcast(const std::optional<Error>& mine, int root) {
    const bool here = transport_.rank() == root;
    std::array<std::int64_t, 6> head{};
    std::string message;
    if (here) {
        message = "rank " + std::to_string(root) + ": " + mine->what();
        head = {static_cast<std::int64_t>(mine->code),
                static_cast<std::int64_t>(mine->element),
                mine->index,
                mine->bytes_needed,
                mine->system_error,
                static_cast<std::int64_t>(message.size())};
    }
    transport_.broadcast(std::as_writable_bytes(std::span(head)), root);
    message.resize(static_cast<std::size_t>(head[5]));
    transport_.broadcast(std::as_writable_bytes(std::span(message)), root);
    Error error(static_cast<ErrorCode>(head[0]), message, static_cast<Element>(head[1]), head[2], head[3],
                static_cast<int>(head[4]));
    error.rank = root;
    return error;
}

}  // namespace crumple::distribute
