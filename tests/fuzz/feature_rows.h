#pragma once

// Checks of rows of impacts, near pairs and candidates that were read: they are valid, and survive writing and reading
// again.

#include <string>
#include <string_view>

#include "crumple/io_features.h"

namespace crumple::fuzz {

/// Readers of the three kinds of list, from bytes as if they were a file called `name`.
io::FeatureList read_impacts(std::string_view bytes, const std::string& name);
io::FeatureList read_near(std::string_view bytes, const std::string& name);
io::CandidateRows read_candidates(std::string_view bytes, const std::string& name);

/// Requires valid ids, edges whose vertices are in ascending order, and possible values. Then makes a result with these
/// rows, writes it in each format and reads it. Requires the same rows, sorted by kind.
void require_kept(const io::FeatureList& rows, bool impacts);
void require_kept(const io::CandidateRows& rows);

}  // namespace crumple::fuzz
