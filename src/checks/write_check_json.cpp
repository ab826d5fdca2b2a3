#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "checks/check_writers.h"
#include "checks/item_texts.h"

namespace crumple::checks {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const std::optional<double>& number) { return number ? Json(*number) : Json(); }
Json json_of(const std::optional<Point>& point) { return point ? Json(*point) : Json(); }
Json json_of(const std::optional<BoundingBox>& box) {
    return box ? Json{{"low", box->low}, {"high", box->high}} : Json();
}

Json json_of(const CheckedShell& shell) {
    return {{"triangles", shell.mesh->triangle_count()},
            {"closed", shell.volume.has_value()},
            {"volume", json_of(shell.volume)},
            {"overlap_with_itself", json_of(shell.overlap_with_itself)},
            {"inside", shell.inside},
            {"cavity", shell.is_cavity}};
}

Json json_of(const CheckReport& report, std::size_t b) {
    const CheckedBody& body = report.bodies[b];
    Json json = checks::json_of(report.names[b], body.mesh, body.report);
    Json loops = Json::array(), shells = Json::array();
    for (const BoundaryLoop& loop : body.loops)
        loops.push_back({{"edges", loop.edges.size()},
                         {"length", loop.length},
                         {"centre", loop.centre},
                         {"box", json_of(std::optional(loop.box))}});
    for (std::int32_t s = 0; s < body.shells; ++s) shells.push_back(json_of(report.shell_of(body, s)));
    json["boundary_loops"] = std::move(loops);
    json["shells"] = std::move(shells);
    json["overlap_with_itself"] = json_of(body.overlap_with_itself);
    return json;
}

Json json_of(const ItemPlace& place) {
    Json json{{"centre", place.centre}, {"box", json_of(std::optional(place.box))}};
    if (place.triangles > 0) {
        json["triangles"] = place.triangles;
        return json;
    }
    json["volume"] = place.volume;
    json["mean_depth"] = place.mean_depth;
    json["thickness"] = place.thickness;
    json["pieces"] = place.pieces;
    return json;
}

Json json_of(const CheckReport& report, const CheckItem& item) {
    const auto name = [&](const BodyPart& part) {
        return part.body < 0 ? Json() : Json(report.names[static_cast<std::size_t>(part.body)]);
    };
    const auto shell = [](const BodyPart& part) { return part.shell < 0 ? Json() : Json(part.shell); };
    Json json{{"kind", name_of(item.kind)},         {"finding", item.is_finding},
              {"ignored", item.is_ignored},         {"first", name(item.first)},
              {"first_shell", shell(item.first)},   {"second", name(item.second)},
              {"second_shell", shell(item.second)}, {"centre", json_of(item.centre)},
              {"box", json_of(item.box)},           {"count", item.count}};
    const auto add = [&](const char* key, double number) {
        if (!std::isnan(number)) json[key] = number;
    };
    add("volume", item.volume);
    add("mean_depth", item.mean_depth);
    add("depth_reached", item.depth_reached);
    add("depth_bound", item.depth_bound);
    add("contact_area", item.contact_area);
    add("length", item.length);
    add("clearance", item.clearance);
    if (!std::isnan(item.clearance)) json["closest_points"] = item.closest;
    if (!item.triangles.empty()) json["triangles"] = item.triangles;
    if (item.second.body >= 0) {
        Json places = Json::array();
        for (const ItemPlace& place : item.places) places.push_back(json_of(place));
        json["places"] = std::move(places);
    }
    json["text"] = text_of(report, item);
    return json;
}

}  // namespace

void write_check_json(std::ostream& out, const CheckReport& report) {
    const Json unit = report.unit == io::Unit::unknown ? Json() : Json(io::name_of(report.unit));
    Json all{{"files", report.files}, {"unit", unit}, {"findings", report.count_findings()}};
    Json bodies = Json::array(), items = Json::array();
    for (std::size_t b = 0; b < report.bodies.size(); ++b) bodies.push_back(json_of(report, b));
    for (const CheckItem& item : report.items) items.push_back(json_of(report, item));
    all["bodies"] = std::move(bodies);
    all["items"] = std::move(items);
    out << all.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
}

}  // namespace crumple::checks
