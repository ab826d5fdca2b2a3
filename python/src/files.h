#pragma once

// Mesh files, lists of pairs and procedural scenes for Python.

#include <filesystem>
#include <string>

#include <nanobind/nanobind.h>

#include "crumple/io.h"
#include "gil.h"

namespace crumple::python {

/// Returns (vertices, faces, groups or None, polygons or None): NumPy arrays that share the mesh's own memory.
nanobind::tuple give(io::TriangleMesh&& mesh);

/// Copies a mesh for the writers of files.
io::TriangleMesh copy_of(const MeshView& view);

/// Converts a unit from its name or None, and back.
io::Unit unit_of(nanobind::handle unit);
nanobind::object name_of_unit(io::Unit unit);

/// Converts text to str. File names need not be UTF-8: invalid bytes are escaped.
nanobind::object shown(const std::string& text);

/// Returns what to do at exit about a file that is being written. A regular file is completed, so that no part of it is
/// left. Other targets, such as pipes, may never complete, and have no temporary file.
WithoutGil::AtExit at_exit(const std::filesystem::path& written);

void bind_files(nanobind::module_& module);

}  // namespace crumple::python
