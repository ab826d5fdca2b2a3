// Reader and writer of PLY: a header that announces elements, then the rows of each. The reader reads the rows of
// `vertex`, `face` and `tristrips` and skips the rest; the vertices of a file without triangles are points, if these
// are requested. Before rows are allocated or read, their announced count is compared with the bytes left.

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

#include "io/bytes/sink.h"
#include "io/formats.h"
#include "io/meshes/faces.h"
#include "io/meshes/ply_body.h"
#include "io/meshes/ply_header.h"

namespace crumple::io {

namespace {

template <class Body>
class BodyReader {
   public:
    BodyReader(const Source& source, const PlyHeader& header, const std::string& group_property)
        : source_(source),
          header_(header),
          body_(source, header),
          vertex_(vertices()),
          xyz_{scalar(vertex_, "x"), scalar(vertex_, "y"), scalar(vertex_, "z")},
          face_(header.find(source, "face")),
          corners_(indices(face_)),
          strips_(header.find(source, "tristrips")),
          strip_corners_(indices(strips_)) {
        if (group_property.empty()) return;
        if (!face_ || !face_->find(source, {group_property}) || (strips_ && strips_->count > 0)) {
            throw Error(ErrorCode::invalid_argument,
                        source.name() + ": its faces have no property " + in_quotes(group_property), Element::option);
        }
        group_ = scalar(*face_, group_property);
        if (!is_integer(group_->type))
            source.fail_at_line(face_->place, "face property " + in_quotes(group_property) + " is not an integer");
    }

    ScalarType precision() const {
        for (const PlyProperty* property : xyz_) {
            if (property->type != PlyType::float32) return ScalarType::float64;
        }
        return ScalarType::float32;
    }

    template <class Scalar>
    TriangleMesh read(const ReadOptions& options, Warnings& warnings) {
        std::vector<Scalar> xyz;
        for (const PlyElement& element : header_.elements) {
            check_count(element);
            if (&element == &vertex_)
                xyz = read_vertices<Scalar>();
            else if (&element == face_)
                read_faces();
            else if (&element == strips_)
                read_strips();
            else
                skip_rows(element);
        }
        // Without this check, a count that is too small would go unnoticed, and the rest of the mesh would be missing.
        const char* const rest = body_.position();
        const std::string_view left(rest, static_cast<std::size_t>(source_.end() - rest));
        if (left.find_first_not_of(" \t\r\n") != left.npos) {
            body_.fail(rest, "data follows the last row that the header announces");
        }
        const bool lines = header_.encoding == PlyEncoding::ascii;
        TriangleMesh mesh = faces_.mesh(std::move(xyz), options.triangulation, warnings, lines);
        mesh.groups = std::move(groups_);
        if (options.lines_and_points && mesh.triangles.empty()) {
            mesh.points.resize(static_cast<std::size_t>(mesh.vertex_count()));
            std::iota(mesh.points.begin(), mesh.points.end(), 0);
        }
        return mesh;
    }

   private:
    const PlyElement& vertices() const {
        const PlyElement* const vertex = header_.find(source_, "vertex");
        if (!vertex) source_.fail_at_line(header_.body - 1, "the header has no element 'vertex'");
        return *vertex;
    }
    /// Returns the list property that holds the corners of faces or strips.
    const PlyProperty* indices(const PlyElement* element) const {
        if (!element) return nullptr;
        const PlyProperty* const found = element->find(source_, {"vertex_indices", "vertex_index"});
        if (!found || !found->count_type || !is_integer(found->type))
            source_.fail_at_line(element->place,
                                 "element " + in_quotes(element->name) + " has no list of integers 'vertex_indices'");
        return found;
    }
    const PlyProperty* scalar(const PlyElement& element, const std::string& name) const {
        const PlyProperty* property = element.find(source_, {name});
        if (!property || property->count_type) {
            source_.fail_at_line(element.place,
                                 "element " + in_quotes(element.name) + " has no scalar " + in_quotes(name));
        }
        return property;
    }

    void check_count(const PlyElement& element) {
        std::int64_t row = 0;
        for (const PlyProperty& property : element.properties) {
            row += body_.least_size(property.count_type.value_or(property.type));
        }
        if (row > 0 && element.count > body_.remaining() / row) {
            source_.fail_at_line(element.place, std::to_string(element.count) + " rows of element " +
                                                    in_quotes(element.name) + " do not fit in the rest of the file");
        }
    }

    std::int64_t list_count(const PlyProperty& property) {
        const char* const place = body_.position();
        const std::int64_t count = body_.integer(*property.count_type);
        if (count < 0 || count > body_.remaining() / body_.least_size(property.type)) {
            body_.fail(place, "a list of " + std::to_string(count) + " values does not fit in the rest of the file");
        }
        return count;
    }

    void skip_value(const PlyProperty& property) {
        body_.skip(property.type, property.count_type ? list_count(property) : 1);
    }

    void skip_rows(const PlyElement& element) {
        if (element.properties.empty()) return;
        for (std::int64_t row = 0; row < element.count; ++row) {
            for (const PlyProperty& property : element.properties) skip_value(property);
        }
    }

    template <class Scalar>
    std::vector<Scalar> read_vertices() {
        std::vector<Scalar> xyz(3 * static_cast<std::size_t>(vertex_.count));
        std::vector<int> axes;  // per property; -1: skip
        for (const PlyProperty& property : vertex_.properties) {
            const auto axis = std::find(xyz_.begin(), xyz_.end(), &property);
            axes.push_back(axis == xyz_.end() ? -1 : static_cast<int>(axis - xyz_.begin()));
        }
        Scalar* vertex = xyz.data();
        for (std::int64_t row = 0; row < vertex_.count; ++row, vertex += 3) {
            for (std::size_t i = 0; i < axes.size(); ++i) {
                const PlyProperty& property = vertex_.properties[i];
                if (axes[i] >= 0)
                    vertex[axes[i]] = body_.template real<Scalar>(property.type);
                else
                    skip_value(property);
            }
        }
        return xyz;
    }

    void read_faces() {
        faces_.reserve(std::min(face_->count, body_.remaining() / (3 * body_.least_size(corners_->type))));
        for (std::int64_t row = 0; row < face_->count; ++row) {
            std::int32_t group = 0;
            for (const PlyProperty& property : face_->properties) {
                if (&property == corners_)
                    read_polygon();
                else if (&property == group_)
                    group = read_group();
                else
                    skip_value(property);
            }
            if (group_) groups_.resize(faces_.triangle_count(), group);
        }
    }

    void read_polygon() {
        const char* const place = body_.position();
        const std::int64_t count = list_count(*corners_);
        faces_.begin(place);
        for (std::int64_t i = 0; i < count; ++i) faces_.add(read_corner(*corners_, "face"));
        faces_.end();
    }

    std::int32_t read_corner(const PlyProperty& list, const char* what, std::int64_t least = 0) {
        const char* const place = body_.position();
        const std::int64_t index = body_.integer(list.type);
        if (index < least || index >= vertex_.count) {
            body_.fail(place, std::string("a ") + what + " names vertex " + std::to_string(index) + " of " +
                                  std::to_string(vertex_.count));
        }
        return static_cast<std::int32_t>(index);
    }

    void read_strips() {
        for (std::int64_t row = 0; row < strips_->count; ++row) {
            for (const PlyProperty& property : strips_->properties) {
                if (&property == strip_corners_)
                    read_strip();
                else
                    skip_value(property);
            }
        }
    }

    /// Reads triangle strips: each corner makes a triangle with the two before it, and every other triangle is
    /// reversed; -1 starts a new strip. A strip that changes direction or jumps contains triangles that name a vertex
    /// twice; these are left out.
    void read_strip() {
        std::int32_t before = -1, last = -1;
        bool turned = false;
        for (std::int64_t left = list_count(*strip_corners_); left > 0; --left) {
            const char* const place = body_.position();
            const std::int32_t corner = read_corner(*strip_corners_, "strip", -1);
            if (before >= 0 && corner >= 0 && before != last && last != corner && corner != before) {
                faces_.begin(place);
                for (const std::int32_t c : {turned ? last : before, turned ? before : last, corner}) faces_.add(c);
                faces_.end();
            }
            turned = corner >= 0 && before >= 0 && !turned;
            before = corner < 0 ? -1 : last;
            last = corner;
        }
    }

    std::int32_t read_group() {
        const char* const place = body_.position();
        const std::int64_t group = body_.integer(group_->type);
        if (group != static_cast<std::int32_t>(group)) body_.fail(place, "a group does not fit in 32 bits");
        return static_cast<std::int32_t>(group);
    }

    const Source& source_;
    const PlyHeader& header_;
    Body body_;
    const PlyElement& vertex_;
    std::array<const PlyProperty*, 3> xyz_;
    const PlyElement* face_;  ///< null if there is no element `face`; `strips_` likewise
    const PlyProperty* corners_;
    const PlyElement* strips_;
    const PlyProperty* strip_corners_;
    const PlyProperty* group_ = nullptr;
    Faces faces_;
    std::vector<std::int32_t> groups_;
};

template <class Body>
TriangleMesh read(const Source& source, const PlyHeader& header, const ReadOptions& options, Warnings& warnings) {
    BodyReader<Body> reader(source, header, options.group_property);
    return in_precision(options.precision, reader.precision(),
                        [&](auto zero) { return reader.template read<decltype(zero)>(options, warnings); });
}

constexpr std::string_view colour_properties = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

void write_header(Sink& sink, const TriangleMesh& mesh, std::int64_t faces, bool colours, bool long_lists) {
    const char* const scalar = mesh.precision() == ScalarType::float32 ? "float" : "double";
    sink << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.vertex_count() << '\n';
    for (const char* const axis : {"x", "y", "z"}) sink << "property " << scalar << ' ' << axis << '\n';
    if (colours) sink << colour_properties;
    sink << "element face " << faces << "\nproperty list " << (long_lists ? "int" : "uchar") << " int vertex_indices\n";
    if (!mesh.groups.empty()) sink << "property int group\n";
    if (colours) sink << colour_properties;
    sink << "end_header\n";
}

/// Writes a mesh, with colours unless `hit`, the material of each triangle, is null. A vertex has the last one of its
/// triangles' materials.
void write(std::ostream& out, const TriangleMesh& mesh, bool polygons, const std::vector<std::uint8_t>* hit,
           std::span<const Material> materials = {}) {
    using Corners = std::span<const std::int32_t>;
    std::vector<std::uint8_t> hit_vertices(hit ? static_cast<std::size_t>(mesh.vertex_count()) : 0);
    bool long_lists = false;
    for_each_face(mesh, polygons, [&](Corners corners, std::size_t triangle) {
        long_lists = long_lists || corners.size() > UINT8_MAX;
        if (!hit || !(*hit)[triangle]) return;
        for (const std::int32_t corner : corners) {
            std::uint8_t& of_vertex = hit_vertices[static_cast<std::size_t>(corner)];
            of_vertex = std::max(of_vertex, (*hit)[triangle]);
        }
    });
    Sink sink(out);
    const auto colour = [&](std::uint8_t material) {
        const Colour& c = materials[material].colour;
        sink.little(c.red, c.green, c.blue);
    };
    write_header(sink, mesh, polygons ? mesh.polygons.count() : mesh.triangle_count(), hit != nullptr, long_lists);
    std::visit(
        [&](const auto& xyz) {
            for (std::size_t v = 0; v < xyz.size() / 3; ++v) {
                sink.little(xyz[3 * v], xyz[3 * v + 1], xyz[3 * v + 2]);
                if (hit) colour(hit_vertices[v]);
            }
        },
        mesh.vertices);
    for_each_face(mesh, polygons, [&](Corners corners, std::size_t triangle) {
        if (long_lists)
            sink.little(static_cast<std::int32_t>(corners.size()));
        else
            sink.little(static_cast<std::uint8_t>(corners.size()));
        for (const std::int32_t corner : corners) sink.little(corner);
        if (!mesh.groups.empty()) sink.little(mesh.groups[triangle]);
        if (hit) colour((*hit)[triangle]);
    });
}

}  // namespace

TriangleMesh read_ply(const Source& source, const ReadOptions& options, Warnings& warnings) {
    const PlyHeader header = read_ply_header(source);
    return header.encoding == PlyEncoding::ascii ? read<AsciiBody>(source, header, options, warnings)
                                                 : read<BinaryBody>(source, header, options, warnings);
}

void write_ply(std::ostream& out, const TriangleMesh& mesh, bool polygons) { write(out, mesh, polygons, nullptr); }

void write_coloured_ply(std::ostream& out, const ColouredMesh& coloured) {
    write(out, coloured.mesh, coloured.has_polygons(), &coloured.hit, coloured.materials);
}

}  // namespace crumple::io
