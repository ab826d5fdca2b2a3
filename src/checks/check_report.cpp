#include "checks/check_report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "checks/crossing_places.h"
#include "checks/pair_items.h"
#include "checks/self_overlaps.h"
#include "checks/surface_items.h"

namespace crumple::checks {
namespace {

/// World of meshes without poses, with the part of a body that each of them is.
struct PartWorld {
    std::vector<BodyPart> parts;
    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    io::BodyOrigins origins;

    void add(const io::TriangleMesh& mesh, const BodyPart& part, Body body) {
        body.shape = static_cast<std::int32_t>(shapes.size());
        parts.push_back(part);
        shapes.emplace_back(mesh.view());
        bodies.push_back(body);
    }
    World world() const { return {shapes, bodies, {}}; }
};

/// Returns the volume that a closed surface covers more than once. `overlap`: ½ ∫ (w² − w) dx for its winding numbers
/// w, which also counts the inside of a surface that is inside out; `volume`: ∫ w dx.
double covered_twice(double overlap, double volume) { return overlap + std::min(volume, 0.0); }

/// Returns the diagonal of the box of all vertices; 0 if there are none.
double diagonal_of(const io::TriangleMesh& mesh) {
    const std::optional<BoundingBox> box = checks::box_of(mesh);
    if (!box) return 0;
    return std::hypot(box->high[0] - box->low[0], box->high[1] - box->low[1], box->high[2] - box->low[2]);
}

class BodyCheck {
   public:
    BodyCheck(Detector& detector, const CheckInput& input, const CheckOptions& options, std::stop_token stop)
        : detector_(detector), input_(input), options_(options), stop_(std::move(stop)), pairs_(options) {}

    CheckReport run() {
        report_.names = input_.origins.names;
        report_.files = input_.origins.files;
        report_.unit = input_.world.unit;
        for (const BodyPair& pair : input_.excluded)
            if (pair.first != pair.second) excluded_.push_back(pair);
        read_surfaces();
        list_shells();
        find_crossings();
        measure_bodies();
        measure_shells();
        mark_cavities();
        measure_overlaps_with_themselves();
        add_places();
        add_duplicates();
        measure_distances();
        collect_items();
        return std::move(report_);
    }

   private:
    void read_surfaces();
    void list_shells();
    void find_crossings();
    void measure_bodies();
    void measure_shells();
    void mark_cavities();
    void measure_overlaps_with_themselves();
    void add_places();
    void add_places_of(const CheckedShell& of, const std::vector<const CrossingPlace*>& places);
    void add_duplicates();
    void measure_distances();
    void collect_items();

    template <class Query>
    const typename Query::Result& find(const PartWorld& parts, const Query& query) {
        try {
            return detector_.find(parts.world(), query, stop_);
        } catch (const Error& error) {
            throw io::with_body_name(error, parts.origins, -1);
        }
    }
    PartWorld world_of_bodies() const;
    double depth_tolerance(double diagonal) const;
    OverlapQuery overlap_query() const;

    CheckedBody& body(std::int32_t b) { return report_.bodies[static_cast<std::size_t>(b)]; }
    CheckedShell& shell(std::int32_t s) { return report_.shells[static_cast<std::size_t>(s)]; }
    CheckedShell& shell(const BodyPart& part) { return shell(body(part.body).first_shell + part.shell); }
    const std::string& file_of(std::int32_t body) const {
        return input_.origins.file_of_body[static_cast<std::size_t>(body)];
    }

    Detector& detector_;
    const CheckInput& input_;
    const CheckOptions& options_;
    std::stop_token stop_;
    CheckReport report_;
    std::vector<BodyPair> excluded_;  ///< excluded pairs of different bodies
    std::vector<CrossingPlace> places_;
    PairItems pairs_;
};

void BodyCheck::read_surfaces() {
    for (std::size_t b = 0; b < report_.names.size(); ++b) {
        io::TriangleMesh mesh = posed_body(input_.world, b);
        BodyReport report(mesh, false);
        std::vector<BoundaryLoop> loops = find_boundary_loops(mesh, report.edges.open);
        const auto none = report.has_inside() ? std::optional(0.0) : std::nullopt;
        report_.bodies.push_back({std::move(mesh), std::move(report), std::move(loops), 0, 0, none});
    }
}

void BodyCheck::list_shells() {
    std::vector<std::size_t> first_mesh;
    for (CheckedBody& checked : report_.bodies) {
        first_mesh.push_back(report_.shell_meshes.size());
        if (checked.report.components < 2) continue;
        for (ShellMesh& shell : split_into_shells(checked.mesh, checked.report.labels, checked.report.components))
            report_.shell_meshes.push_back(std::move(shell));
    }
    for (std::int32_t b = 0; b < std::ssize(report_.bodies); ++b) {
        CheckedBody& checked = body(b);
        checked.first_shell = static_cast<std::int32_t>(report_.shells.size());
        checked.shells = checked.report.components;
        for (std::int32_t s = 0; s < checked.shells; ++s) {
            CheckedShell& added = report_.shells.emplace_back(CheckedShell{{b, s}, &checked.mesh});
            if (checked.shells == 1) {
                added.volume = checked.report.volume;
            } else {
                ShellMesh& part =
                    report_.shell_meshes[first_mesh[static_cast<std::size_t>(b)] + static_cast<std::size_t>(s)];
                added.mesh = &part.mesh;
                added.triangles = std::move(part.triangles);
                const EdgeReport edges = report_edges(part.mesh);
                if (edges.closed && !edges.flipped) added.volume = signed_volume(part.mesh);
            }
            if (added.volume) added.overlap_with_itself = 0;
        }
    }
}

/// Finds all pairs of triangles that intersect, and their places.
void BodyCheck::find_crossings() {
    PartWorld shells;
    shells.origins = {input_.origins.files, {}, {}};
    std::vector<const io::TriangleMesh*> meshes;
    for (const CheckedShell& shell : report_.shells) {
        shells.add(*shell.mesh, shell.part, {.group = shell.part.body, .self = true});
        shells.origins.names.push_back(report_.names[static_cast<std::size_t>(shell.part.body)]);
        shells.origins.file_of_body.push_back(file_of(shell.part.body));
        meshes.push_back(shell.mesh);
    }
    IntersectionQuery query{.output = Output::contacts};
    for (const BodyPair& pair : input_.excluded) query.filter.excluded_groups.push_back({pair.first, pair.second});
    report_.crossings = find(shells, query);
    places_ = find_places(report_.crossings, meshes);
}

PartWorld BodyCheck::world_of_bodies() const {
    PartWorld world;
    world.origins = input_.origins;
    for (std::int32_t b = 0; b < std::ssize(report_.bodies); ++b)
        world.add(report_.bodies[static_cast<std::size_t>(b)].mesh, {b}, {});
    return world;
}

/// Returns the largest difference of the bounds on a depth. `diagonal`: of the box of the smallest body.
double BodyCheck::depth_tolerance(double diagonal) const {
    const double tolerance = diagonal / 1024;
    return options_.ignore_below > 0 ? std::min(tolerance, options_.ignore_below / 4) : tolerance;
}

OverlapQuery BodyCheck::overlap_query() const {
    double diagonal = std::numeric_limits<double>::infinity();
    for (const CheckedBody& checked : report_.bodies)
        if (const double length = diagonal_of(checked.mesh); length > 0) diagonal = std::min(diagonal, length);
    OverlapQuery query{.open = OpenSurfaces::skip, .regions = true};
    query.depth_tolerance = depth_tolerance(std::isfinite(diagonal) ? diagonal : 1024);
    return query;
}

/// Measures how much bodies overlap each other.
void BodyCheck::measure_bodies() {
    if (report_.bodies.size() < 2) return;
    const PartWorld world = world_of_bodies();
    OverlapQuery query = overlap_query();
    query.filter.excluded_bodies = excluded_;
    pairs_.add(find(world, query), world.parts);
}

/// Measures the shells of bodies that have several, and how much these overlap.
void BodyCheck::measure_shells() {
    PartWorld world;
    std::vector<std::int32_t> shell_of;
    for (std::int32_t s = 0; s < std::ssize(report_.shells); ++s) {
        const BodyPart part = shell(s).part;
        if (body(part.body).shells < 2) continue;
        shell_of.push_back(s);
        world.add(*shell(s).mesh, part, {.world = part.body});  // shells of different bodies are not paired
        world.origins.names.push_back(report_.names[static_cast<std::size_t>(part.body)]);
        world.origins.file_of_body.push_back(file_of(part.body));
    }
    world.origins.files = input_.origins.files;
    if (shell_of.empty()) return;
    const Overlaps& found = find(world, overlap_query());
    pairs_.add(found, world.parts);
    for (std::size_t i = 0; i < found.bodies.size(); ++i) {
        const auto [first, second] = found.bodies[i];
        const auto number = [&](std::int32_t j) { return world.parts[static_cast<std::size_t>(j)].shell; };
        const auto of = [&](std::int32_t j) -> CheckedShell& { return shell(shell_of[static_cast<std::size_t>(j)]); };
        if (found.relation[i] == OverlapRelation::first_inside) of(first).inside.push_back(number(second));
        if (found.relation[i] == OverlapRelation::second_inside) of(second).inside.push_back(number(first));
    }
}

/// Measures the volume that bodies and shells cover twice. Surfaces that do not meet themselves, of bodies whose shells
/// do not lie inside each other, are left out: they cover nothing twice.
void BodyCheck::measure_overlaps_with_themselves() {
    std::set<BodyPart> parts;
    for (const CrossingPlace& place : places_) {
        const BodyPart first = shell(place.shells.first).part, second = shell(place.shells.second).part;
        if (first.body != second.body) continue;
        parts.insert({first.body});
        if (first == second) parts.insert(first);
    }
    for (const CheckedShell& checked : report_.shells)
        if (checked.covers_twice()) parts.insert({checked.part.body});
    PartWorld world;
    world.origins.files = input_.origins.files;
    for (const BodyPart& part : parts) {
        const bool is_whole = part.shell < 0;
        const auto& volume = is_whole ? body(part.body).report.volume : shell(part).volume;
        if (!volume || (!is_whole && body(part.body).shells == 1)) continue;
        world.add(is_whole ? body(part.body).mesh : *shell(part).mesh, part,
                  {.world = static_cast<std::int32_t>(world.parts.size())});  // no pairs
        world.origins.names.push_back(report_.names[static_cast<std::size_t>(part.body)]);
        world.origins.file_of_body.push_back(file_of(part.body));
    }
    if (world.parts.empty()) return;
    const Overlaps& found = find(world, OverlapQuery{.self_overlaps = true});
    for (std::size_t i = 0; i < found.bodies.size(); ++i) {
        const BodyPart part = world.parts[static_cast<std::size_t>(found.bodies[i].first)];
        const double volume = covered_twice(found.volume[i], found.body_volume[found.bodies[i].first]);
        if (part.shell >= 0) {
            shell(part).overlap_with_itself = volume;
            continue;
        }
        body(part.body).overlap_with_itself = volume;
        if (body(part.body).shells == 1) shell(body(part.body).first_shell).overlap_with_itself = volume;
    }
}

/// Adds the places where surfaces meet, to the pair of bodies or of shells, or as items of one shell.
void BodyCheck::add_places() {
    std::map<std::int32_t, std::vector<const CrossingPlace*>> alone;  // places where a shell meets itself
    for (const CrossingPlace& place : places_) {
        const CheckedShell &first = shell(place.shells.first), &second = shell(place.shells.second);
        if (place.shells.first == place.shells.second) {
            alone[place.shells.first].push_back(&place);
            continue;
        }
        const bool same_body = first.part.body == second.part.body;
        pairs_.add(place,
                   same_body ? PartPair(first.part, second.part) : PartPair({first.part.body}, {second.part.body}));
    }
    for (const auto& [number, places] : alone) add_places_of(shell(number), places);
}

/// Adds the places where a shell meets itself, the largest first. Places that bound one overlap are joined.
void BodyCheck::add_places_of(const CheckedShell& of, const std::vector<const CrossingPlace*>& places) {
    const auto& volume = of.overlap_with_itself;
    std::vector<SelfOverlap> overlaps;
    if (volume && *volume != 0)
        overlaps = find_self_overlaps(*of.mesh, report_.crossings, places, *volume, *of.volume > 0,
                                      depth_tolerance(diagonal_of(*of.mesh)));
    const bool is_resolved = !overlaps.empty();
    for (std::int32_t i = 0; !is_resolved && i < std::ssize(places); ++i)
        overlaps.push_back({{i}, volume && *volume == 0});
    std::vector<CheckItem> items;
    for (const SelfOverlap& overlap : overlaps) {
        std::vector<const CrossingPlace*> joins;
        for (const std::int32_t i : overlap.places) joins.push_back(places[static_cast<std::size_t>(i)]);
        CrossingPlace place = joined(joins, report_.crossings);
        CheckItem& item = items.emplace_back(
            CheckItem{overlap.is_contact ? ItemKind::self_contact : ItemKind::self_intersection, of.part});
        item.centre = place.centre;
        item.box = place.box;
        item.count = place.triangles;
        item.rows = std::move(place.rows);
        if (overlap.is_contact) continue;
        if (is_resolved) item.volume = overlap.volume;
        if (overlap.depth[1] > 0) item.depth_reached = overlap.depth[0], item.depth_bound = overlap.depth[1];
    }
    const auto overlaps_itself = [](const CheckItem& item) { return item.kind == ItemKind::self_intersection; };
    if (volume && std::count_if(items.begin(), items.end(), overlaps_itself) == 1)
        std::find_if(items.begin(), items.end(), overlaps_itself)->volume = *volume;
    std::stable_sort(items.begin(), items.end(),
                     [](const CheckItem& x, const CheckItem& y) { return x.count > y.count; });
    report_.items.insert(report_.items.end(), items.begin(), items.end());
}

/// Decides for each closed shell whether it is a cavity, or faces the wrong side: outside of it, as far as other shells
/// are concerned, a winding number of 0 must become 1 inside, or 1 must become 0.
void BodyCheck::mark_cavities() {
    for (CheckedShell& checked : report_.shells) {
        if (!checked.volume || *checked.volume == 0) continue;
        const CheckedBody& of = body(checked.part.body);
        for (const std::int32_t other : checked.inside) {
            const auto& volume = shell(of.first_shell + other).volume;
            checked.winding_around += volume && *volume < 0 ? -1 : 1;
        }
        checked.is_cavity = *checked.volume < 0 && checked.winding_around == 1;
        if (*checked.volume < 0 && !checked.is_cavity) {
            const bool is_whole = of.shells == 1;
            CheckItem& item = report_.items.emplace_back(
                CheckItem{ItemKind::inside_out, {checked.part.body, is_whole ? -1 : checked.part.shell}});
            item.volume = *checked.volume;
            item.count = checked.mesh->triangle_count();
            item.box = checks::box_of(*checked.mesh);
            item.centre = middle_of(*item.box);
        }
    }
}

/// Marks pairs of bodies with the same triangles: equal corners, in any order.
void BodyCheck::add_duplicates() {
    using Corners = std::array<Point, 3>;
    const auto is_excluded = [&](std::int32_t a, std::int32_t b) {
        return std::any_of(excluded_.begin(), excluded_.end(), [&](const BodyPair& pair) {
            return pair == BodyPair{a, b} || pair == BodyPair{b, a};
        });
    };
    std::map<std::tuple<std::int64_t, Point, Point>, std::vector<std::int32_t>> alike;
    for (std::int32_t b = 0; b < std::ssize(report_.bodies); ++b)
        if (const BodyReport& report = body(b).report; report.triangles > 0)
            alike[{report.triangles, report.box->low, report.box->high}].push_back(b);
    for (const auto& [properties, bodies] : alike) {
        if (bodies.size() < 2) continue;
        std::vector<std::vector<Corners>> triangles;
        for (const std::int32_t b : bodies) {
            const io::TriangleMesh& mesh = body(b).mesh;
            auto& list = triangles.emplace_back(static_cast<std::size_t>(mesh.triangle_count()));
            for (std::size_t t = 0; t < list.size(); ++t) {
                for (std::size_t k = 0; k < 3; ++k) list[t][k] = point_of(mesh, mesh.triangles[3 * t + k]);
                std::sort(list[t].begin(), list[t].end());
            }
            std::sort(list.begin(), list.end());
        }
        for (std::size_t i = 0; i < bodies.size(); ++i)
            for (std::size_t j = i + 1; j < bodies.size(); ++j)
                if (triangles[i] == triangles[j] && !is_excluded(bodies[i], bodies[j]))
                    pairs_.add_duplicate({{bodies[i]}, {bodies[j]}});
    }
}

void BodyCheck::measure_distances() {
    if (!options_.clearance || report_.bodies.size() < 2) return;
    DistanceQuery query{.radius = *options_.clearance};
    query.filter.excluded_bodies = excluded_;
    pairs_.add(find(world_of_bodies(), query));
}

/// Puts the items in order: for each body those about its surface, then those about its shells; then pairs of bodies.
void BodyCheck::collect_items() {
    std::vector<CheckItem> items;
    for (std::int32_t b = 0; b < std::ssize(report_.bodies); ++b) add_surface_items(b, body(b), items);
    for (CheckItem& item : report_.items) items.push_back(std::move(item));
    std::vector<CheckItem> pairs = std::move(pairs_).items();
    for (CheckItem& item : pairs) {
        if (item.first.body != item.second.body) continue;
        if (item.kind == ItemKind::first_inside || item.kind == ItemKind::second_inside) {
            const CheckedShell& inner = shell(item.kind == ItemKind::first_inside ? item.first : item.second);
            if (!inner.covers_twice()) continue;
        }
        items.push_back(std::move(item));
    }
    std::stable_sort(items.begin(), items.end(),
                     [](const CheckItem& x, const CheckItem& y) { return x.first.body < y.first.body; });
    for (CheckItem& item : pairs)
        if (item.first.body != item.second.body) items.push_back(std::move(item));
    report_.items = std::move(items);
}

}  // namespace

std::int64_t CheckReport::count_findings() const {
    return std::count_if(items.begin(), items.end(), [](const CheckItem& item) { return item.is_finding; });
}

CheckReport check_bodies(Detector& detector, const CheckInput& input, const CheckOptions& options,
                         std::stop_token stop) {
    return BodyCheck(detector, input, options, std::move(stop)).run();
}

}  // namespace crumple::checks
