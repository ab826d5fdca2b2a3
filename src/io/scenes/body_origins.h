#pragma once

// Files and names of bodies, for messages.

#include <cstdint>
#include <string>
#include <vector>

#include "crumple/error.h"

namespace crumple::io {

/// Files and names of the bodies of a world.
struct BodyOrigins {
    std::string files;  ///< names of all files, for errors that concern no single body
    std::vector<std::string> names, file_of_body;
};

/// Returns an error about a world with the name of the body that it concerns, with its file and configuration, or else
/// with the names of all files. `first_configuration`: number of the first configuration in the world, which has all
/// bodies once for each configuration; -1 if there is only one, which messages then do not name.
Error with_body_name(const Error& error, const BodyOrigins& origins, std::int64_t first_configuration);

}  // namespace crumple::io
