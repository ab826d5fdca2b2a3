#pragma once

// Mesh files, lists of pairs and procedural scenes for Python.

#include <filesystem>
#include <string>

#include <nanobind/nanobind.h>

#include "crumple/io.h"
#include "gil.h"

namespace crumple::python {

/// (vertices, faces, groups or None, polygons or None): NumPy arrays over the mesh's own memory, which they share.
nanobind::tuple give(io::TriangleMesh&& mesh);

/// What the writers take: a copy, once a file.
io::TriangleMesh copy_of(const MeshView& view);

/// The unit of a word or of None, and back.
io::Unit unit_of(nanobind::handle unit);
nanobind::object name_of_unit(io::Unit unit);

/// Text for people: the name of a file need not be UTF-8.
nanobind::object shown(const std::string& text);

/// A file is written to its end, so that no part of it is left behind. What is no regular file, such as a pipe, may
/// never end, and has no temporary file beside it.
WithoutGil::AtExit at_exit(const std::filesystem::path& written);

void bind_files(nanobind::module_& module);

}  // namespace crumple::python
