// Page that shows the bodies of a check, with a list of the items and with the places where surfaces meet coloured.

#include <algorithm>
#include <array>
#include <map>

#include "checks/check_writers.h"
#include "checks/item_texts.h"
#include "io/bytes/grouped.h"
#include "io/coloured/html_page.h"
#include "io/lists/pairs.h"

namespace crumple::checks {

using io::grouped;

namespace {

/// Colours of bodies, in turn; faint, so that coloured places stand out.
constexpr std::array<io::Colour, 4> body_colours{{{178, 178, 178}, {150, 168, 188}, {190, 176, 150}, {156, 182, 160}}};

class CheckPage {
   public:
    explicit CheckPage(const CheckReport& report) : report_(report) {}

    io::Page make() {
        io::Page page;
        for (std::size_t b = 0; b < report_.bodies.size(); ++b)
            page.sides.push_back({&report_.bodies[b].mesh, {}, {"free", body_colours[b % body_colours.size()]}, {}});
        page_.title = report_.files;
        page_.summary = summary_of(report_);
        add_bodies();
        for (const CheckItem& item : report_.items) add(item);
        for (auto& [bodies, drawing] : drawings_) page_.drawings.push_back(std::move(drawing));
        page.report = std::move(page_);
        return page;
    }

   private:
    using Bodies = std::array<std::int32_t, 2>;

    void add_bodies() {
        for (std::int32_t b = 0; b < std::ssize(report_.bodies); ++b)
            page_.bodies.push_back(
                {name_of(report_, {b}), text_of(report_, report_.bodies[static_cast<std::size_t>(b)]), false});
    }

    io::PageReport::Drawing& drawing(const Bodies& bodies) {
        return drawings_.try_emplace(bodies, io::PageReport::Drawing{bodies}).first->second;
    }

    void add(const CheckItem& item) {
        const Bodies bodies{item.first.body, item.second.body < 0 ? item.first.body : item.second.body};
        const auto add_entry = [&](const std::string& text, const std::optional<BoundingBox>& box) {
            io::PageReport::Item& entry = page_.items.emplace_back(io::PageReport::Item{text, bodies});
            if (box) entry.box = {box->low, box->high};
            entry.is_finding = item.is_finding;
        };
        add_entry(text_of(report_, item), item.box);
        for (std::size_t i = 0; i < item.places.size() && item.places.size() > 1; ++i)
            add_entry(text_of_place(item.places[i], i), item.places[i].box);
        if (item.is_finding)
            for (const std::int32_t b : bodies) page_.bodies[static_cast<std::size_t>(b)].has_findings = true;
        draw(item, bodies);
    }

    std::string text_of_place(const ItemPlace& place, std::size_t number) const {
        std::string text = "place " + std::to_string(number) + " around " + checks::text_of_place(place.centre);
        if (place.triangles > 0) return text + ": " + grouped(place.triangles) + " triangles";
        return text + ": volume " + text_of_volume(report_, place.volume);
    }

    void draw(const CheckItem& item, const Bodies& bodies) {
        for (const std::int32_t row : item.rows) draw_row(static_cast<std::size_t>(row), bodies);
        const io::TriangleMesh& mesh = report_.bodies[static_cast<std::size_t>(item.first.body)].mesh;
        const auto add_line = [&](const Point& a, const Point& b) { drawing(bodies).lines.push_back({a, b}); };
        for (const Edge& edge : item.edges) add_line(point_of(mesh, edge.a), point_of(mesh, edge.b));
        for (const std::int32_t t : item.triangles)
            for (std::size_t k = 0; k < 3; ++k) {
                const auto corner = [&](std::size_t j) {
                    return point_of(mesh, mesh.triangles[3 * static_cast<std::size_t>(t) + j % 3]);
                };
                add_line(corner(k), corner(k + 1));
            }
        if (item.kind == ItemKind::near) add_line(item.closest[0], item.closest[1]);
    }

    /// Draws the contact of two triangles, and colours both near it.
    void draw_row(std::size_t row, const Bodies& bodies) {
        const BodyPair shells = report_.crossings.bodies[row];
        const Pair pair = report_.crossings.pairs[row];
        const auto points = io::points_of_pair(report_.crossings.contacts, row);
        const std::size_t lines = points.size() < 3 ? std::max<std::size_t>(points.size(), 2) - 1 : points.size();
        for (std::size_t k = 0; k < lines; ++k) {
            const io::PageSegment segment{points[k], points[(k + 1) % points.size()]};
            const auto in_body = [&](std::int32_t s, std::int32_t triangle) {
                return report_.shells[static_cast<std::size_t>(s)].triangle_in_body(triangle);
            };
            drawing(bodies).contacts.push_back(
                {{in_body(shells.first, pair.a), in_body(shells.second, pair.b)}, segment});
        }
        for (std::size_t k = 2; k < points.size(); ++k)
            drawing(bodies).areas.push_back({points[0], points[k - 1], points[k]});
    }

    const CheckReport& report_;
    io::PageReport page_;
    std::map<Bodies, io::PageReport::Drawing> drawings_;
};

}  // namespace

void write_check_page(std::ostream& out, const CheckReport& report) {
    io::write_page(out, CheckPage(report).make(), 0);
}

}  // namespace crumple::checks
