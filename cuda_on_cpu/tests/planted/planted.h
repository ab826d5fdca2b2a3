#pragma once

#include "cuda_on_cpu/tests/fixture.h"

namespace planted {

/// Fixture of the tests of planted bugs, in several files.
class Planted : public cuda_on_cpu::FreshSettings {};

}  // namespace planted
