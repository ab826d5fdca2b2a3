#include "io/scenes/3mf_model.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

#include "io/bytes/text.h"
#include "io/formats.h"
#include "io/meshes/unit.h"

namespace crumple::io {

namespace {

constexpr std::string_view core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
constexpr std::string_view production = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
constexpr std::string_view beams = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02|beamlattice";
constexpr const char* path_attribute = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06|path";
/// Extensions that a file may list as required: those that this reader implements, and those that do not change the
/// positions of triangles.
constexpr std::string_view supported_extensions[] = {
    core, production, "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07"};

constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// Removes the next word from the text and returns it; empty if none is left.
std::string_view next_word(std::string_view& text) {
    const auto begin = std::find_if_not(text.begin(), text.end(), is_blank);
    const auto end = std::find_if(begin, text.end(), is_blank);
    const std::string_view word(begin, static_cast<std::size_t>(end - begin));
    text.remove_prefix(static_cast<std::size_t>(end - text.begin()));
    return word;
}

/// Returns the text without blanks at either end.
std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

template <class Scalar>
class ModelReader : public XmlReader {
   public:
    explicit ModelReader(const std::string& place) : XmlReader(place), model_{place} {}

    Model take() { return std::move(model_); }

   private:
    /// Innermost open element of the document; `other`: an element that is skipped.
    enum class Within : std::uint8_t {
        document,
        model,
        resources,
        object,
        mesh,
        vertices,
        triangles,
        components,
        build,
        other
    };

    void declare_namespace(const char* prefix, const char* name) override {
        if (within_.empty() && prefix && name) namespaces_[prefix] = name;
    }

    void begin(std::string_view element, const XmlAttributes& attributes) override {
        const Within outer = within_.empty() ? Within::document : within_.back();
        within_.push_back(enter(outer, element, attributes));
    }

    void end() override {
        const Within ended = within_.back();
        within_.pop_back();
        if (ended == Within::mesh) end_mesh();
    }

    Within enter(Within outer, std::string_view element, const XmlAttributes& attributes) {
        if (outer == Within::mesh && element == beams) ++model_.beams;
        const bool of_core = element.starts_with(core) && element.size() > core.size() && element[core.size()] == '|';
        const std::string_view name = of_core ? element.substr(core.size() + 1) : "";
        switch (outer) {
            case Within::document:
                if (name != "model") fail("the document is not a 3MF model, but " + in_quotes(element));
                begin_model(attributes);
                return Within::model;
            case Within::model:
                return name == "resources" ? Within::resources : name == "build" ? Within::build : Within::other;
            case Within::resources:
                if (name != "object") break;
                begin_object(attributes);
                return Within::object;
            case Within::object:
                return enter_object(name);
            case Within::mesh:
                return name == "vertices" ? Within::vertices : name == "triangles" ? Within::triangles : Within::other;
            case Within::vertices:
                if (name == "vertex") add_vertex(attributes);
                break;
            case Within::triangles:
                if (name == "triangle") add_triangle(attributes);
                break;
            case Within::components:
                if (name == "component") object_->components.push_back(reference("a component", attributes));
                break;
            case Within::build:
                if (name == "item") model_.build.push_back(reference("an item", attributes));
                break;
            case Within::other:
                break;
        }
        return Within::other;
    }

    void begin_model(const XmlAttributes& attributes) {
        std::string_view required = attributes.find("requiredextensions").value_or("");
        for (std::string_view prefix = next_word(required); !prefix.empty(); prefix = next_word(required)) {
            const auto found = namespaces_.find(std::string(prefix));
            if (found == namespaces_.end()) fail("a required extension, " + in_quotes(prefix) + ", has no namespace");
            if (std::find(std::begin(supported_extensions), std::end(supported_extensions), found->second) ==
                std::end(supported_extensions))
                fail("the required extension " + in_quotes(found->second, longest_namespace) + " is not supported");
        }
        const std::string_view unit = trimmed(attributes.find("unit").value_or(name_in_3mf(Unit::millimetre)));
        const auto found = unit_in_3mf(unit);
        if (!found) fail(in_quotes(unit) + " is not a unit of 3MF");
        model_.unit = *found;
    }

    void begin_object(const XmlAttributes& attributes) {
        const std::int64_t id = number("an object", attributes, "id");
        constexpr std::string_view types[] = {"model", "solidsupport", "support", "surface", "other"};
        const std::string_view type = trimmed(attributes.find("type").value_or("model"));
        if (std::find(std::begin(types), std::end(types), type) == std::end(types))
            fail("an object has the type " + in_quotes(type) + ", which 3MF does not define");
        const auto [at, is_new] = model_.objects.try_emplace(id, ModelObject{line()});
        if (!is_new)
            fail("there is an object " + std::to_string(id) + " already, in line " + std::to_string(at->second.line));
        object_ = &at->second;
        object_->name = attributes.find("name").value_or("");
    }

    Within enter_object(std::string_view name) {
        if (name != "mesh" && name != "components") return Within::other;
        if (object_->mesh || !object_->components.empty()) fail("an object must hold either one mesh or components");
        if (name == "components") return Within::components;
        object_->mesh = model_.meshes.size();
        xyz_.clear();
        triangles_.clear();
        return Within::mesh;
    }

    void end_mesh() {
        xyz_.shrink_to_fit();
        triangles_.shrink_to_fit();
        model_.meshes.push_back({std::move(xyz_), std::move(triangles_)});
        xyz_ = {};
        triangles_ = {};
    }

    void add_vertex(const XmlAttributes& attributes) {
        if (xyz_.size() / 3 >= INT32_MAX) fail("a mesh has more vertices than 32-bit ids can number");
        for (const char* const axis : {"x", "y", "z"})
            xyz_.push_back(real<Scalar>(required("a vertex", attributes, axis)));
    }

    void add_triangle(const XmlAttributes& attributes) {
        for (const char* const corner : {"v1", "v2", "v3"}) {
            const std::int64_t vertex = number("a triangle", attributes, corner);
            const std::size_t vertices = xyz_.size() / 3;
            if (static_cast<std::size_t>(vertex) >= vertices)
                fail("a triangle names vertex " + std::to_string(vertex) + " of " + std::to_string(vertices));
            triangles_.push_back(static_cast<std::int32_t>(vertex));
        }
    }

    ModelReference reference(const char* element, const XmlAttributes& attributes) {
        ModelReference result{line(), number(element, attributes, "objectid")};
        if (const auto path = attributes.find(path_attribute)) result.part = part_name(*path);
        if (const auto transform = attributes.find("transform")) result.pose = pose(*transform);
        return result;
    }

    /// Parses a transform. 3MF uses row vectors, so its 12 numbers list the matrix Pose::rows column by column.
    Pose pose(std::string_view text) const {
        std::array<double, 12> m{};
        for (double& value : m) {
            const std::string_view word = next_word(text);
            if (word.empty()) fail("a transform has fewer than 12 numbers");
            value = real<double>(word);
        }
        if (!next_word(text).empty()) fail("a transform has more than 12 numbers");
        Pose pose;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 4; ++k) pose.rows[4 * i + k] = m[3 * k + i];
        return pose;
    }

    std::string_view required(const char* element, const XmlAttributes& attributes, const char* name) const {
        const auto text = attributes.find(name);
        if (!text) fail(std::string(element) + " lacks " + name);
        return *text;
    }

    /// Returns an attribute that must be an integer of 0 or more.
    std::int64_t number(const char* element, const XmlAttributes& attributes, const char* name) const {
        const std::string_view word = trimmed(required(element, attributes, name));
        std::uint32_t value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size())
            fail(std::string(name) + " of " + element + " is " + in_quotes(word) + ", which is not an index");
        return value;
    }

    template <class Number>
    Number real(std::string_view text) const {
        const std::string_view word = trimmed(text);
        const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
        const char* const end = word.data() + word.size();
        const LeadingNumber<Number> number = leading_number<Number>(word.data() + plus, end);
        if (number.end != end || word.empty()) fail(in_quotes(word) + " is not a finite number");
        if (!std::isfinite(number.value))
            fail(in_quotes(word) + (sizeof(Number) == 4 ? " overflows float32" : " overflows float64"));
        return number.value;
    }

    static constexpr std::size_t longest_namespace = 120;

    Model model_;
    ModelObject* object_ = nullptr;  ///< current object
    std::vector<Scalar> xyz_;        ///< coordinates of the current mesh
    std::vector<std::int32_t> triangles_;
    std::vector<Within> within_;
    std::unordered_map<std::string, std::string> namespaces_;  ///< namespaces declared at the root, by prefix
};

template <class Scalar>
Model read_model(Package& package, const std::string& part) {
    ModelReader<Scalar> reader(package.place(part));
    package.read(part, reader);
    return reader.take();
}

}  // namespace

Model read_3mf_model(Package& package, const std::string& part, const ReadOptions& options) {
    return options.precision == Precision::float32 ? read_model<float>(package, part)
                                                   : read_model<double>(package, part);
}

}  // namespace crumple::io
