#pragma once

// Names of bodies: unique ones, and names in texts.

#include <cstdint>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "crumple/io.h"

namespace crumple::io {

/// Renames the second body with a name to NAME_2, the third to NAME_3, and so on; skips names that are in use.
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

/// Returns a name as text lists contain it: as a JSON string if it is empty, has a control character or a quote, begins
/// with `#`, or begins or ends with a blank; otherwise unchanged.
std::string quoted_name(const std::string& name);

}  // namespace crumple::io
