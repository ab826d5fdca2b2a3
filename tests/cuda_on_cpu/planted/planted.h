#pragma once

#include "cuda_on_cpu/fixture.h"

namespace planted {

/// The tests of planted bugs, in several files.
class Planted : public cuda_on_cpu::FreshSettings {};

}  // namespace planted
