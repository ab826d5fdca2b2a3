#pragma once

// Mesh files, lists of pairs and procedural scenes for Python.

#include <filesystem>
#include <string>

#include <nanobind/nanobind.h>

#include "crumple/io.h"
#include "gil.h"

namespace crumple::python {

/// Returns (vertices, faces, groups or None, polygons or None): NumPy arrays, which take over the memory of the mesh.
nanobind::tuple to_numpy(io::TriangleMesh&& mesh);

/// Copies a mesh for the writers of files. Throws Error if its arrays are in CUDA memory.
io::TriangleMesh copy_of(const MeshView& view);

/// Convert a unit of length from its name ("mm") or None, and to its name or None.
io::Unit unit_of(nanobind::handle unit);
nanobind::object name_of_unit(io::Unit unit);

/// Converts the options of reading that all files have. Throws Error if one is invalid.
io::ReadOptions read_options(nanobind::handle precision, nanobind::handle weld, nanobind::handle triangulation,
                             nanobind::handle strict, nanobind::handle unit);

/// Converts text to a Python str. Bytes that are not valid UTF-8, as file names may have, become escapes such as \x80.
nanobind::object to_str(const std::string& text);

/// Returns whether the process waits at exit until the file at this path is written. It waits for a regular file, so
/// that no temporary file is left. Other targets, such as pipes, have no temporary file, and writing them may never
/// end.
WithoutGil::AtExit at_exit(const std::filesystem::path& written);

void bind_files(nanobind::module_& module);

}  // namespace crumple::python
