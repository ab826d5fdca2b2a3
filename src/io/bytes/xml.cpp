#include "io/bytes/xml.h"

#include <expat.h>

#include <memory>
#include <new>
#include <type_traits>

namespace crumple::io {

namespace {

constexpr int piece = 1 << 16;
constexpr int deepest_elements = 256;
/// Largest number of bytes of a tag or comment: expat buffers all of it until its end.
constexpr std::int64_t longest_tag = 1 << 20;

}  // namespace

Error xml_error(const std::string& place, std::int64_t line, const std::string& what) {
    return Error(ErrorCode::format, place + ", line " + std::to_string(line) + ": " + what, Element::line, line);
}

std::optional<std::string_view> XmlAttributes::find(std::string_view name) const {
    for (const char** attribute = all_; *attribute; attribute += 2)
        if (*attribute == name) return attribute[1];
    return std::nullopt;
}

struct XmlReader::Callbacks {
    /// Calls f(reader), and stores its exception. Does nothing after the first exception.
    template <class F>
    static void guard(void* self, F f) {
        auto& reader = *static_cast<XmlReader*>(self);
        if (reader.thrown_) return;
        try {
            f(reader);
        } catch (...) {
            reader.thrown_ = std::current_exception();
            XML_StopParser(reader.parser_, XML_FALSE);
        }
    }
    static void begin(void* self, const char* name, const char** attributes) {
        guard(self, [&](XmlReader& reader) {
            if (++reader.depth_ > deepest_elements)
                reader.fail("elements are nested more than " + std::to_string(deepest_elements) + " deep");
            reader.begin(name, XmlAttributes(attributes));
        });
    }
    static void end(void* self, const char*) {
        guard(self, [](XmlReader& reader) {
            --reader.depth_;
            reader.end();
        });
    }
    static void declare(void* self, const char* prefix, const char* name) {
        guard(self, [&](XmlReader& reader) { reader.declare_namespace(prefix, name); });
    }
    static void refuse_doctype(void* self, const char*, const char*, const char*, int) {
        guard(self, [](const XmlReader& reader) { reader.fail("a DOCTYPE is not supported"); });
    }
};

std::int64_t XmlReader::line() const { return static_cast<std::int64_t>(XML_GetCurrentLineNumber(parser_)); }

void XmlReader::read(const std::function<std::size_t(char*, std::size_t)>& more) {
    const std::unique_ptr<std::remove_pointer_t<XML_Parser>, void (*)(XML_Parser)> parser(
        XML_ParserCreateNS(nullptr, '|'), XML_ParserFree);
    if (!parser) throw std::bad_alloc();
    parser_ = parser.get();
    XML_SetUserData(parser_, this);
    XML_SetElementHandler(parser_, Callbacks::begin, Callbacks::end);
    XML_SetStartNamespaceDeclHandler(parser_, Callbacks::declare);
    XML_SetStartDoctypeDeclHandler(parser_, Callbacks::refuse_doctype);
    parse_all(more);
}

void XmlReader::parse_all(const std::function<std::size_t(char*, std::size_t)>& more) {
    std::int64_t fed = 0;
    for (bool last = false; !last;) {
        auto* const buffer = static_cast<char*>(XML_GetBuffer(parser_, piece));
        if (!buffer) throw std::bad_alloc();
        const std::size_t got = more(buffer, piece);
        fed += static_cast<std::int64_t>(got);
        last = got == 0;
        const XML_Status status = XML_ParseBuffer(parser_, static_cast<int>(got), last);
        if (thrown_) std::rethrow_exception(thrown_);
        if (status != XML_STATUS_OK) {
            const XML_Error error = XML_GetErrorCode(parser_);
            if (error == XML_ERROR_NO_MEMORY) throw std::bad_alloc();
            fail(std::string("this is not valid XML: ") + XML_ErrorString(error));
        }
        if (fed - XML_GetCurrentByteIndex(parser_) > longest_tag) fail("a tag or comment is longer than 1 MiB");
    }
}

}  // namespace crumple::io
