#include "checks/item_texts.h"

#include <cmath>

#include <fmt/format.h>

#include "io/bytes/grouped.h"
#include "io/scenes/body_names.h"

namespace crumple::checks {

using io::grouped, io::quoted_name;

namespace {

std::string unit_of(const CheckReport& report, const char* power = "") {
    return report.unit == io::Unit::unknown ? "" : fmt::format(" {}{}", io::name_of(report.unit), power);
}

/// Returns "1 triangle" or "1,200 triangles".
std::string counted(std::int64_t count, const char* noun) {
    return fmt::format("{} {}{}", grouped(count), noun, count == 1 ? "" : "s");
}

/// Returns at most five triangles: " (5, 17, 40)".
std::string some_of(const std::vector<std::int32_t>& triangles) {
    std::string text;
    for (std::size_t i = 0; i < std::min<std::size_t>(5, triangles.size()); ++i)
        text += fmt::format("{}{}", i ? ", " : "", triangles[i]);
    return fmt::format(" ({}{})", text, triangles.size() > 5 ? ", ..." : "");
}

/// Returns "lid and pot", or "shells 0 and 1 of pot".
std::string both_of(const CheckReport& report, const CheckItem& item) {
    if (item.first.shell < 0 || item.first.body != item.second.body)
        return name_of(report, item.first) + " and " + name_of(report, item.second);
    return fmt::format("shells {} and {} of {}", item.first.shell, item.second.shell,
                       name_of(report, {item.first.body}));
}

/// Returns a clause of the relation of two parts.
std::string relation_of(const CheckReport& report, const CheckItem& item) {
    const std::string first = name_of(report, item.first), second = name_of(report, item.second),
                      both = both_of(report, item);
    switch (item.kind) {
        case ItemKind::touching:
            return both + " touch";
        case ItemKind::overlapping:
            return both + " overlap";
        case ItemKind::first_inside:
            return first + " lies inside " + second;
        case ItemKind::second_inside:
            return second + " lies inside " + first;
        case ItemKind::equal:
            return both + " fill the same space";
        case ItemKind::duplicate:
            return both + " have the same triangles";
        case ItemKind::near:
            return both + " are near each other";
        case ItemKind::piercing:
            if (item.pieces[0] < 2) return first + " passes through " + second;
            if (item.pieces[1] < 2) return second + " passes through " + first;
            return both + " pass through each other";
        default:
            return "the surfaces of " + both + " meet, and at least one is not closed";
    }
}

/// Returns ", greatest depth at most 0.1 mm", or nothing if the depth has not been computed.
std::string depth_of(const CheckReport& report, const CheckItem& item) {
    if (std::isnan(item.depth_bound)) return "";
    return ", greatest depth at most " + text_of_length(report, item.depth_bound);
}

/// Returns the numbers of a relation, each after a comma, except for the first.
std::string numbers_of(const CheckReport& report, const CheckItem& item) {
    std::string text;
    const auto add = [&](const std::string& more) { text += (text.empty() ? "" : ", ") + more; };
    const bool overlaps = !std::isnan(item.volume) && item.kind != ItemKind::touching;
    if (overlaps) add("volume " + text_of_volume(report, item.volume));
    // The contributions of several places to the mean depth cancel each other, and so do those of two sides.
    const bool has_one_side = item.places.size() == 1 && item.kind != ItemKind::piercing;
    if (overlaps && has_one_side && !std::isnan(item.mean_depth))
        add("mean depth " + text_of_length(report, item.mean_depth));
    const bool is_same = item.kind == ItemKind::equal || item.kind == ItemKind::duplicate;
    if (overlaps && !is_same) text += depth_of(report, item);
    if (item.contact_area > 0) add("common area " + text_of_number(item.contact_area) + unit_of(report, "^2"));
    if (!std::isnan(item.clearance)) add("clearance " + text_of_length(report, item.clearance));
    if (item.places.size() > 1) add(fmt::format("in {}", counted(std::ssize(item.places), "place")));
    if (item.centre) add("around " + text_of_place(*item.centre));
    if (item.is_ignored) add("ignored");
    return text;
}

}  // namespace

std::string name_of(const CheckReport& report, const BodyPart& part) {
    const std::string name = quoted_name(report.names[static_cast<std::size_t>(part.body)]);
    const bool is_whole = part.shell < 0 || report.bodies[static_cast<std::size_t>(part.body)].shells == 1;
    return is_whole ? name : fmt::format("shell {} of {}", part.shell, name);
}

std::string text_of_number(double number) { return fmt::format("{:.6g}", number + 0.0); }
std::string text_of_length(const CheckReport& report, double length) {
    return text_of_number(length) + unit_of(report);
}
std::string text_of_volume(const CheckReport& report, double volume) {
    return text_of_number(volume) + unit_of(report, "^3");
}
std::string text_of_place(const Point& p) {
    return fmt::format("({} {} {})", text_of_number(p[0]), text_of_number(p[1]), text_of_number(p[2]));
}

std::string text_of(const CheckReport& report, const CheckItem& item) {
    const std::string name = name_of(report, item.first);
    const auto around = [&] { return item.centre ? " around " + text_of_place(*item.centre) : std::string(); };
    const std::string triangles = counted(item.count, "triangle");
    switch (item.kind) {
        case ItemKind::no_triangles:
            return name + " has no triangles";
        case ItemKind::hole:
            return fmt::format("{} has a hole{}: {}, length {}", name, around(), counted(item.count, "edge"),
                               text_of_length(report, item.length));
        case ItemKind::non_manifold_edges:
            return fmt::format("{} is not closed: it has {}", name, counted(item.count, "non-manifold edge"));
        case ItemKind::inconsistent_orientation:
            return fmt::format(
                "{} is not consistently oriented: triangles {} and {} run along one edge in the same "
                "direction{}",
                name, item.triangles[0], item.triangles[1], around());
        case ItemKind::inside_out:
            return fmt::format("{} is inside out: volume {}", name, text_of_volume(report, item.volume));
        case ItemKind::degenerate_triangles:
            return fmt::format("{} has {}{}", name, counted(item.count, "degenerate triangle"),
                               some_of(item.triangles));
        case ItemKind::duplicated_triangles:
            return fmt::format("{} has {}{}", name, counted(item.count, "duplicated triangle"),
                               some_of(item.triangles));
        case ItemKind::self_contact:
            return fmt::format("{} touches itself{}: {}", name, around(), triangles);
        case ItemKind::self_intersection:
            return fmt::format("{} passes through itself{}: {}{}{}", name, around(), triangles,
                               std::isnan(item.volume) ? "" : ", overlap " + text_of_volume(report, item.volume),
                               depth_of(report, item));
        default:
            break;
    }
    const std::string numbers = numbers_of(report, item);
    return relation_of(report, item) + (numbers.empty() ? "" : ": " + numbers);
}

std::string text_of(const CheckReport& report, const CheckedBody& body) {
    const BodyReport& surface = body.report;
    std::string text = surface.triangles == 0    ? "empty"
                       : !surface.edges.closed   ? "not closed"
                       : surface.edges.flipped   ? "closed, not consistently oriented"
                       : surface.is_inside_out() ? "closed, inside out"
                                                 : "closed";
    if (!body.loops.empty()) text += ", " + counted(std::ssize(body.loops), "hole");
    if (surface.volume) text += ", volume " + text_of_volume(report, *surface.volume);
    text += ", " + counted(surface.triangles, "triangle");
    if (body.shells < 2) return text;
    std::int64_t cavities = 0;
    for (std::int32_t s = 0; s < body.shells; ++s) cavities += report.shell_of(body, s).is_cavity;
    text += fmt::format(", {} shells", grouped(body.shells));
    if (cavities > 0)
        text += fmt::format(" ({} of them {})", grouped(cavities), cavities == 1 ? "a cavity" : "cavities");
    return text;
}

std::string summary_of(const CheckReport& report) {
    const std::int64_t findings = report.count_findings();
    return findings == 0 ? "no findings" : counted(findings, "finding");
}

}  // namespace crumple::checks
