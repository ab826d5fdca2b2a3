#pragma once

#include "cli/terminal.h"
#include "io/meshes/common_unit.h"

namespace crumple::cli {

/// Returns a converter of input files to a common unit that prints its messages. `strict`: warnings are errors.
inline io::CommonUnit common_unit(bool strict) {
    return {strict, "--unit states a unit for the former", print_note, print_warning};
}

}  // namespace crumple::cli
