#include "io/scenes/package.h"

#include <vector>

#include "io/bytes/expanded_size.h"

namespace crumple::io {

namespace {

class Relationships : public XmlReader {
   public:
    Relationships(std::string place, std::string_view wanted) : XmlReader(std::move(place)), wanted_(wanted) {}

    std::vector<std::string> targets;

   private:
    void begin(std::string_view element, const XmlAttributes& attributes) override {
        if (element != "http://schemas.openxmlformats.org/package/2006/relationships|Relationship") return;
        if (attributes.find("Type") != wanted_) return;
        const auto target = attributes.find("Target");
        if (!target) fail("a relationship lacks its Target");
        targets.push_back(part_name(*target));
    }
    void end() override {}

    std::string_view wanted_;
};

}  // namespace

std::string part_name(std::string_view reference) {
    if (reference.starts_with('/')) reference.remove_prefix(1);
    return std::string(reference);
}

Package::Package(const Source& source, const std::string& kind)
    : source_(source), archive_(source, kind), most_expanded_(expansion_limit(source.text().size())) {}

void Package::read(const std::string& part, XmlReader& reader) {
    const auto fail = [&](const std::string& what) {
        throw Error(ErrorCode::format, source_.name() + ": the part " + in_quotes(part) + ' ' + what);
    };
    if (!archive_.open(part, true)) fail("is missing, encrypted, or compressed in a way that is not supported");
    reader.read([&](char* to, std::size_t size) {
        std::size_t got = 0;
        if (!archive_.read(to, size, got)) fail("is truncated or damaged");
        expanded_ += got;
        if (expanded_ > most_expanded_) fail("expands too far: " + std::string(expansion_rule));
        return got;
    });
}

std::string Package::target_of(std::string_view relationship) {
    const std::string part = "_rels/.rels";
    Relationships relationships(place(part), relationship);
    read(part, relationships);
    const std::size_t count = relationships.targets.size();
    if (count != 1)
        throw Error(ErrorCode::format,
                    place(part) + ": it refers to " + (count ? std::to_string(count) + " models" : "no model"));
    return relationships.targets[0];
}

}  // namespace crumple::io
