#pragma once

// Sentences about the items of a check.

#include <string>

#include "checks/check_report.h"

namespace crumple::checks {

/// Returns a name for messages: that of a body, or "shell 0 of part".
std::string name_of(const CheckReport& report, const BodyPart& part);

/// Returns a sentence about an item, with its place and numbers: "lid and pot overlap: volume 0.25 mm^3, ...".
std::string text_of(const CheckReport& report, const CheckItem& item);

/// Returns a line about a body's surface: "closed, volume 12.5 mm^3, 1,200 triangles, 2 shells".
std::string text_of(const CheckReport& report, const CheckedBody& body);

/// Returns the last line of a report: "3 findings", or "no findings".
std::string summary_of(const CheckReport& report);

/// Formats of numbers with the report's unit: "0.25", "0.25 mm", "0.25 mm^3", "(0 0 1)".
std::string text_of_number(double number);
std::string text_of_length(const CheckReport& report, double length);
std::string text_of_volume(const CheckReport& report, double volume);
std::string text_of_place(const Point& point);

}  // namespace crumple::checks
