#pragma once

// Items about one body's surface, without those that need a search.

#include <vector>

#include "checks/check_report.h"

namespace crumple::checks {

/// Appends an item for each irregularity of the surface of body `number`.
void add_surface_items(std::int32_t number, const CheckedBody& body, std::vector<CheckItem>& items);

}  // namespace crumple::checks
