#pragma once

// What rows of impacts, near pairs or candidates that were read must be, and become when they are written and read
// again.

#include <string>
#include <string_view>

#include "crumple/io_features.h"

namespace crumple::fuzz {

/// The three readers.
io::FeatureList read_impacts(std::string_view bytes, const std::string& name);
io::FeatureList read_near(std::string_view bytes, const std::string& name);
io::CandidateRows read_candidates(std::string_view bytes, const std::string& name);

/// Ids in range and in order, numbers as the list has them; and, kind after kind, the same rows when an answer that has
/// them is written in each format.
void require_kept(const io::FeatureList& rows, bool impacts);
void require_kept(const io::CandidateRows& rows);

}  // namespace crumple::fuzz
