#include "cuda_on_cpu/machine/graph.h"

#include <algorithm>
#include <iterator>

#include "cuda_on_cpu/machine/settings.h"

namespace cuda_on_cpu {

GraphCount& graph_count() {
    static GraphCount instance;
    return instance;
}

std::size_t longest_chain(const Nodes& nodes) {
    std::vector<std::size_t> length(nodes.size(), 1);  // nodes depend on earlier ones only
    for (std::size_t i = 0; i < nodes.size(); ++i)
        for (const std::size_t before : nodes[i].after) length[i] = std::max(length[i], length[before] + 1);
    return nodes.empty() ? 0 : *std::max_element(length.begin(), length.end());
}

void run_nodes(const Nodes& nodes) {
    std::vector<std::size_t> missing(nodes.size());
    std::vector<std::vector<std::size_t>> followers(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        missing[i] = nodes[i].after.size();
        for (const std::size_t before : nodes[i].after) followers[before].push_back(i);
    }
    std::set<std::size_t> next;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (!missing[i]) next.insert(i);
    while (!next.empty()) {
        auto chosen = next.begin();
        if (settings().order == Order::reverse) chosen = std::prev(next.end());
        if (settings().order == Order::random) std::advance(chosen, host_random().below(next.size()));
        const std::size_t i = *chosen;
        next.erase(chosen);
        nodes[i].work.run();
        for (const std::size_t follower : followers[i])
            if (--missing[follower] == 0) next.insert(follower);
    }
}

}  // namespace cuda_on_cpu
