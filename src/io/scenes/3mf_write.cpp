// Writer of 3MF: bodies are objects, and the build places them. A mesh that several bodies share is written once, and
// each of these bodies is an object with this mesh as its only component, because only objects have names. Colours are
// base materials of the core specification: an object has the material of free triangles, and each coloured triangle
// names its own material.

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <streambuf>
#include <string>

#include "io/bytes/json.h"
#include "io/bytes/sink.h"
#include "io/bytes/zip.h"
#include "io/formats.h"
#include "io/meshes/unit.h"
#include "io/scenes/world_mesh.h"

namespace crumple::io {

namespace {

constexpr std::string_view xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
constexpr std::string_view content_types =
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n"
    " <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n"
    " <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n"
    "</Types>\n";
constexpr std::string_view relations =
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n"
    " <Relationship Target=\"/3D/3dmodel.model\" Id=\"model\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n"
    "</Relationships>\n";
constexpr std::string_view model_begin =
    "\" xml:lang=\"en-US\" "
    "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
    " <metadata name=\"Application\">Crumple</metadata>\n"
    " <resources>\n";

/// Stream buffer that writes to the open entry of an archive.
class EntryBuffer : public std::streambuf {
   public:
    explicit EntryBuffer(ZipWriter& archive) : archive_(archive) {}

   private:
    std::streamsize xsputn(const char* data, std::streamsize size) override {
        archive_.add({data, static_cast<std::size_t>(size)});
        return size;
    }
    int_type overflow(int_type c) override {
        const char byte = traits_type::to_char_type(c);
        archive_.add({&byte, 1});
        return c;
    }

    ZipWriter& archive_;
};

/// Escapes a name for an attribute. Replaces invalid UTF-8 and characters that XML cannot represent.
std::string attribute(const std::string& name) {
    std::string result;
    const std::string text = valid_utf8(name);
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        const bool none = text.compare(i, 3, "\xef\xbf\xbe") == 0 || text.compare(i, 3, "\xef\xbf\xbf") == 0;
        if (none) i += 2;
        if (c == '&' || c == '<' || c == '"' || c == '\t' || c == '\n' || c == '\r')
            result += "&#" + std::to_string(int{c}) + ';';
        else if (none || (c >= 0 && c < ' '))
            result += "\xef\xbf\xbd";
        else
            result += c;
    }
    return result;
}

/// Returns #RRGGBB, or #RRGGBBAA for a translucent material.
std::string hexadecimal(const Material& material) {
    const auto& [red, green, blue] = material.colour;
    const int alpha = static_cast<int>(std::lround(255 * material.opacity));
    std::string text = "#";
    for (const int value : {int{red}, int{green}, int{blue}, alpha})
        for (const int digit : {value >> 4, value & 15}) text += "0123456789ABCDEF"[digit];
    return alpha < 255 ? text : text.substr(0, 7);
}

/// Mesh to write: a shape with the colours of its triangles. `hit`: index of the material of each triangle; empty if
/// all have material 0. `bodies`: number of bodies with this mesh. `object`: id of its object; 0 until it is written.
struct WrittenMesh {
    const TriangleMesh* shape;
    std::span<const std::uint8_t> hit;
    std::int64_t bodies = 0;
    std::int64_t object = 0;
};

class ModelText {
   public:
    ModelText(std::ostream& out, Unit unit, std::span<const Material> materials)
        : out_(out), materials_(materials.size()) {
        out_ << xml << "<model unit=\"" << name_in_3mf(unit) << model_begin;
        if (materials.empty()) return;
        out_ << "  <basematerials id=\"1\">\n";
        for (const Material& material : materials)
            out_ << "   <base name=\"" << material.name << "\" displaycolor=\"" << hexadecimal(material) << "\"/>\n";
        out_ << "  </basematerials>\n";
        last_id_ = 1;
    }

    std::int64_t add_mesh(const WrittenMesh& mesh, const std::string& name) {
        begin_object(name);
        if (materials_) out_ << " pid=\"1\" pindex=\"0\"";
        out_ << ">\n   <mesh>\n    <vertices>\n";
        std::visit([&](const auto& xyz) { add_vertices(xyz); }, mesh.shape->vertices);
        out_ << "    </vertices>\n    <triangles>\n";
        const std::vector<std::int32_t>& corners = mesh.shape->triangles;
        for (std::size_t t = 0; t < corners.size() / 3; ++t) {
            out_ << "     <triangle v1=\"" << corners[3 * t] << "\" v2=\"" << corners[3 * t + 1] << "\" v3=\""
                 << corners[3 * t + 2];
            if (t < mesh.hit.size() && mesh.hit[t])
                out_ << "\" pid=\"1\" p1=\"" << std::min<std::size_t>(mesh.hit[t], materials_ - 1);
            out_ << "\"/>\n";
        }
        out_ << "    </triangles>\n   </mesh>\n  </object>\n";
        return last_id_;
    }

    /// Adds an object with this name whose only component is `object`, and returns its id.
    std::int64_t add_named(std::int64_t object, const std::string& name) {
        begin_object(name);
        out_ << ">\n   <components>\n    <component objectid=\"" << object << "\"/>\n   </components>\n  </object>\n";
        return last_id_;
    }

    void begin_build() { out_ << " </resources>\n <build>\n"; }
    void add_item(std::int64_t object, const Pose& pose) {
        out_ << "  <item objectid=\"" << object;
        if (pose != Pose{}) out_ << "\" transform=\"";
        for (std::size_t k = 0; pose != Pose{} && k < 4; ++k)
            for (std::size_t i = 0; i < 3; ++i) (k || i ? out_ << ' ' : out_) << pose.rows[4 * i + k];
        out_ << "\"/>\n";
    }
    void end() { out_ << " </build>\n</model>\n"; }

   private:
    void begin_object(const std::string& name) {
        out_ << "  <object id=\"" << ++last_id_ << "\" type=\"model\"";
        if (!name.empty()) out_ << " name=\"" << attribute(name) << '"';
    }

    template <class Scalar>
    void add_vertices(const std::vector<Scalar>& xyz) {
        for (std::size_t i = 0; i < xyz.size(); i += 3)
            out_ << "     <vertex x=\"" << double{xyz[i]} << "\" y=\"" << double{xyz[i + 1]} << "\" z=\""
                 << double{xyz[i + 2]} << "\"/>\n";
    }

    Sink out_;
    std::size_t materials_;
    std::int64_t last_id_ = 0;
};

/// Returns the meshes to write, and appends to `of_body` the index of each body's mesh. Bodies without colliding
/// triangles share the mesh of their shape; any other body has its own mesh.
std::vector<WrittenMesh> meshes_of(const WorldMesh& world, std::span<const std::uint8_t> hit,
                                   std::vector<std::size_t>& of_body) {
    std::vector<WrittenMesh> meshes;
    for (const TriangleMesh& shape : world.shapes) meshes.push_back({&shape, {}});
    for (const NamedBody& body : world.bodies) {
        const auto shape = static_cast<std::size_t>(body.shape);
        const std::span<const std::uint8_t> own =
            hit.empty() ? hit : hit.first(static_cast<std::size_t>(world.shapes[shape].triangle_count()));
        hit = hit.subspan(own.size());
        const bool free = std::all_of(own.begin(), own.end(), [](std::uint8_t h) { return h == 0; });
        of_body.push_back(free ? shape : meshes.size());
        if (!free) meshes.push_back({&world.shapes[shape], own});
        ++meshes[of_body.back()].bodies;
    }
    return meshes;
}

void add_model(std::ostream& out, const WorldMesh& world, std::span<const std::uint8_t> hit,
               std::span<const Material> materials) {
    std::vector<std::size_t> of_body;
    std::vector<WrittenMesh> meshes = meshes_of(world, hit, of_body);
    ModelText text(out, world.unit, materials);
    std::vector<std::int64_t> objects;
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
        WrittenMesh& mesh = meshes[of_body[b]];
        const std::string& name = world.bodies[b].name;
        if (mesh.object == 0) mesh.object = text.add_mesh(mesh, mesh.bodies > 1 ? "" : name);
        objects.push_back(mesh.bodies > 1 ? text.add_named(mesh.object, name) : mesh.object);
    }
    text.begin_build();
    for (std::size_t b = 0; b < world.bodies.size(); ++b) text.add_item(objects[b], world.bodies[b].pose);
    text.end();
}

/// Returns an upper bound on the bytes that the text of the model takes.
std::uint64_t most_bytes(const WorldMesh& world) {
    std::uint64_t bytes = 4096;
    for (const NamedBody& body : world.bodies) {
        const TriangleMesh& shape = world.shapes[static_cast<std::size_t>(body.shape)];
        bytes += 128 * static_cast<std::uint64_t>(shape.vertex_count() + shape.triangle_count());
        bytes += 1024 + 8 * body.name.size();
    }
    return bytes;
}

}  // namespace

void write_coloured_3mf(std::ostream& out, const WorldMesh& world, std::span<const std::uint8_t> hit,
                        std::span<const Material> materials) {
    ZipWriter archive("3MF");
    const auto add = [&](const char* name, std::string_view text) {
        archive.begin(name, ZipWriter::Method::deflate, xml.size() + text.size());
        archive.add(xml);
        archive.add(text);
        archive.end();
    };
    add("[Content_Types].xml", content_types);
    add("_rels/.rels", relations);
    archive.begin("3D/3dmodel.model", ZipWriter::Method::deflate, most_bytes(world));
    EntryBuffer buffer(archive);
    std::ostream model(&buffer);
    add_model(model, world, hit, materials);
    if (!model) throw Error(ErrorCode::file, "cannot make the 3MF archive: it does not fit in memory");
    archive.end();
    archive.write(out);
}

void write_3mf(std::ostream& out, const WorldMesh& world) { write_coloured_3mf(out, world, {}, {}); }

void write_3mf(std::ostream& out, const TriangleMesh& mesh, bool) { write_3mf(out, world_of(mesh)); }

void write_coloured_3mf(std::ostream& out, const ColouredMesh& coloured) {
    write_coloured_3mf(out, world_of(coloured.mesh), coloured.hit, coloured.materials);
}

}  // namespace crumple::io
