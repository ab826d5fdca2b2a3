#pragma once

// Names of bodies, each once.

#include <cstdint>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "crumple/io.h"

namespace crumple::io {

/// The second body of a name becomes NAME_2, the third NAME_3; numbers that other names have are passed over.
inline void make_names_unique(std::vector<NamedBody>& bodies) {
    std::unordered_set<std::string> given, taken;
    for (const NamedBody& body : bodies) given.insert(body.name);
    std::unordered_map<std::string, std::int64_t> last;
    for (NamedBody& body : bodies) {
        if (taken.insert(body.name).second) continue;
        std::int64_t& number = last.try_emplace(body.name, 1).first->second;
        std::string name;
        do name = body.name + '_' + std::to_string(++number);
        while (given.count(name) || taken.count(name));
        taken.insert(name);
        body.name = std::move(name);
    }
}

}  // namespace crumple::io
