#pragma once

#include "scenes/soup.h"

namespace crumple::scenes {

inline constexpr int cloth_frames = 94;

/// The scene `cloth`: adds the sheet as group 0 and the ball as group 1.
void add_cloth(Soup& soup, const Parameters& parameters);

}  // namespace crumple::scenes
