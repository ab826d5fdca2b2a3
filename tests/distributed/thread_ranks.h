#pragma once

// Ranks that are threads of the test's process.

#include <exception>
#include <memory>
#include <thread>
#include <vector>

#include "distributed/transport/in_process.h"

namespace crumple::test {

/// Runs body(transport) on `ranks` ranks at once, and rethrows the exception of the lowest rank that failed.
template <class Body>
void run_ranks(int ranks, Body body) {
    const auto hub = std::make_shared<distribute::Hub>(ranks);
    std::vector<std::exception_ptr> failed(static_cast<std::size_t>(ranks));
    std::vector<std::thread> threads;
    for (int r = 0; r < ranks; ++r)
        threads.emplace_back([&, r] {
            distribute::InProcess transport(hub, r);
            try {
                body(transport);
            } catch (...) {
                failed[static_cast<std::size_t>(r)] = std::current_exception();
                hub->leave();
            }
        });
    for (std::thread& thread : threads) thread.join();
    for (const std::exception_ptr& error : failed)
        if (error) std::rethrow_exception(error);
}

}  // namespace crumple::test
