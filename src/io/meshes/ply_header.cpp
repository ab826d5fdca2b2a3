#include "io/meshes/ply_header.h"

#include <algorithm>
#include <charconv>

namespace crumple::io {

namespace {

using Words = std::vector<std::string_view>;

Words split(std::string_view line) {
    constexpr std::string_view blanks = " \t\r\v\f";
    Words words;
    for (std::size_t begin; (begin = line.find_first_not_of(blanks)) != line.npos;) {
        line.remove_prefix(begin);
        const std::size_t length = std::min(line.find_first_of(blanks), line.size());
        words.push_back(line.substr(0, length));
        line.remove_prefix(length);
    }
    return words;
}

std::optional<PlyType> type_named(std::string_view name) {
    struct Entry {
        std::string_view old_name, name;
        PlyType type;
    };
    constexpr Entry entries[] = {
        {"char", "int8", PlyType::int8},        {"uchar", "uint8", PlyType::uint8},
        {"short", "int16", PlyType::int16},     {"ushort", "uint16", PlyType::uint16},
        {"int", "int32", PlyType::int32},       {"uint", "uint32", PlyType::uint32},
        {"", "int64", PlyType::int64},          {"", "uint64", PlyType::uint64},
        {"float", "float32", PlyType::float32}, {"double", "float64", PlyType::float64},
    };
    for (const Entry& entry : entries) {
        if (name == entry.name || (name == entry.old_name && !name.empty())) return entry.type;
    }
    return std::nullopt;
}

/// Reader of the header, line by line.
class HeaderReader {
   public:
    explicit HeaderReader(const Source& source) : source_(source), next_(source.text_begin()) {}

    PlyHeader read() {
        if (Words words = next_line(); words.size() != 1 || words[0] != "ply") fail("this is not a PLY file");
        bool has_format = false;
        while (true) {
            const Words words = next_line();
            if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
            if (words[0] == "end_header") break;
            if (words[0] == "format" && !has_format) {
                read_format(words);
                has_format = true;
            } else if (words[0] == "element") {
                read_element(words);
            } else if (words[0] == "property") {
                read_property(words);
            } else {
                fail(in_quotes(words[0]) + " is not expected in a header");
            }
        }
        if (!has_format) fail("the header names no format");
        header_.body = next_;
        return std::move(header_);
    }

   private:
    Words next_line() {
        line_ = next_;
        const char* end = std::find(line_, source_.end(), line_end_);
        if (line_end_ == 0) {  // the first line determines how lines end: a binary body may begin with CR or LF
            end = std::find_if(line_, source_.end(), [](char c) { return c == '\n' || c == '\r'; });
            if (end != source_.end())
                line_end_ = *end == '\r' && end + 1 != source_.end() && end[1] == '\n' ? '\n' : *end;
            if (end != source_.end() && *end != line_end_) ++end;
        }
        if (end == source_.end()) fail("the header has no line end_header");
        next_ = end + 1;
        return split({line_, static_cast<std::size_t>(end - line_)});
    }

    void read_format(const Words& words) {
        if (words.size() != 3 || words[2] != "1.0") fail("a format of version 1.0 is expected");
        if (words[1] == "ascii")
            header_.encoding = PlyEncoding::ascii;
        else if (words[1] == "binary_little_endian")
            header_.encoding = PlyEncoding::little_endian;
        else if (words[1] == "binary_big_endian")
            header_.encoding = PlyEncoding::big_endian;
        else
            fail("unknown format " + in_quotes(words[1]));
    }

    void read_element(const Words& words) {
        if (words.size() != 3) fail("an element must have a name and a count");
        PlyElement element{std::string(words[1]), 0, {}, line_};
        const char* const end = words[2].data() + words[2].size();
        const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
        if (error != std::errc() || stop != end || element.count < 0) fail(in_quotes(words[2]) + " is not a count");
        header_.elements.push_back(std::move(element));
    }

    void read_property(const Words& words) {
        if (header_.elements.empty()) fail("a property precedes the first element");
        const bool list = words.size() == 5 && words[1] == "list";
        if (!list && words.size() != 3) fail("a property must have a type and a name");
        PlyProperty property{std::string(words.back()), type(words[words.size() - 2]), {}};
        if (list) property.count_type = type(words[2]);
        if (list && !is_integer(*property.count_type)) fail("a list's count must be an integer");
        header_.elements.back().properties.push_back(std::move(property));
    }

    PlyType type(std::string_view name) const {
        const std::optional<PlyType> found = type_named(name);
        if (!found) fail("unknown type " + in_quotes(name));
        return *found;
    }

    [[noreturn]] void fail(const std::string& what) const { source_.fail_at_line(line_, what); }

    const Source& source_;
    const char* line_ = nullptr;
    const char* next_;
    char line_end_ = 0;  ///< LF (also for CR LF), or CR; 0 until the first line is read
    PlyHeader header_;
};

}  // namespace

const PlyProperty* PlyElement::find(const Source& source, std::initializer_list<std::string_view> names) const {
    const PlyProperty* found = nullptr;
    for (const PlyProperty& property : properties) {
        if (std::find(names.begin(), names.end(), property.name) == names.end()) continue;
        if (found)
            source.fail_at_line(place,
                                "element " + in_quotes(name) + " has two properties " + in_quotes(*names.begin()));
        found = &property;
    }
    return found;
}

const PlyElement* PlyHeader::find(const Source& source, std::string_view name) const {
    const PlyElement* found = nullptr;
    for (const PlyElement& candidate : elements) {
        if (candidate.name != name) continue;
        if (found) source.fail_at_line(candidate.place, "there is a second element " + in_quotes(name));
        found = &candidate;
    }
    return found;
}

PlyHeader read_ply_header(const Source& source) { return HeaderReader(source).read(); }

}  // namespace crumple::io
