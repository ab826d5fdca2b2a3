#pragma once

// Writers of the report of a check.

#include <ostream>
#include <string_view>

#include "checks/check_report.h"

namespace crumple::checks {

/// Writes a line for each body, then its items, then pairs of bodies, and the number of findings. Of the items about
/// one shell that have the same kind, the first ten are listed, and the others counted.
void write_check_text(std::ostream& out, const CheckReport& report);

/// Writes an object with `files`, `unit`, `bodies` (the properties of `info --json`, and loops and shells), `items` and
/// `findings`, the number of findings.
void write_check_json(std::ostream& out, const CheckReport& report);

/// Writes a row for each item. Empty cells: numbers that do not apply.
void write_check_csv(std::ostream& out, const CheckReport& report);

/// Writes an HTML page that shows the bodies and lists the items; about 25 bytes per triangle, and 45 per pair of
/// triangles that intersect.
void write_check_page(std::ostream& out, const CheckReport& report);

using CheckWriter = void (*)(std::ostream&, const CheckReport&);
/// Returns the writer for an extension: .txt, .json, .csv or .html; null for others.
CheckWriter check_writer_of(std::string_view extension);

}  // namespace crumple::checks
