#pragma once

// Streaming reader of XML over expat: element by element, in bounded pieces. Names are NAMESPACE|LOCAL; attributes
// without a prefix are LOCAL alone. Rejects documents with a DOCTYPE, which could define entities, and elements nested
// deeper or tags longer than any writer produces (limits in xml.cpp).

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "crumple/error.h"

struct XML_ParserStruct;

namespace crumple::io {

/// Returns Error (format) "PLACE, line 17: WHAT"; `place` names the file and the part of it.
Error xml_error(const std::string& place, std::int64_t line, const std::string& what);

/// Attributes of the element that begins; valid only during XmlReader::begin().
class XmlAttributes {
   public:
    explicit XmlAttributes(const char** all) : all_(all) {}
    std::optional<std::string_view> find(std::string_view name) const;

   private:
    const char** all_;  ///< alternating names and values, then a null
};

class XmlReader {
   public:
    explicit XmlReader(std::string place) : place_(std::move(place)) {}
    XmlReader(const XmlReader&) = delete;
    XmlReader& operator=(const XmlReader&) = delete;
    virtual ~XmlReader() = default;

    /// Reads a document to its end. more(to, size) copies up to `size` next bytes and returns their number, 0 at the
    /// end. Throws Error (format), and whatever `more` and the callbacks throw.
    void read(const std::function<std::size_t(char*, std::size_t)>& more);

    const std::string& place() const { return place_; }

   protected:
    virtual void begin(std::string_view element, const XmlAttributes& attributes) = 0;
    /// Ends the element that began last and has not ended.
    virtual void end() = 0;
    /// Called before begin() of the element with the declaration. `prefix` is null for the default namespace, `name`
    /// for no namespace.
    virtual void declare_namespace(const char* /*prefix*/, const char* /*name*/) {}

    /// Returns the line of the element that begins or ends.
    std::int64_t line() const;
    [[noreturn]] void fail(const std::string& what) const { throw xml_error(place_, line(), what); }

   private:
    struct Callbacks;
    void parse_all(const std::function<std::size_t(char*, std::size_t)>& more);

    std::string place_;
    XML_ParserStruct* parser_ = nullptr;
    std::exception_ptr thrown_;  ///< exception of a callback; must not propagate through expat, which is C
    int depth_ = 0;
};

}  // namespace crumple::io
