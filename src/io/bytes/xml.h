#pragma once

// XML by expat, element by element, in bounded pieces. Names are NAMESPACE|LOCAL, of attributes without a prefix LOCAL
// alone. Documents with a DOCTYPE, and thus with entities of their own, are refused, as are elements nested deeper, and
// tags longer, than any writer makes them.

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "crumple/error.h"

struct XML_ParserStruct;

namespace crumple::io {

/// "PLACE, line 17: WHAT"; `place` names the file and what of it.
Error xml_error(const std::string& place, std::int64_t line, const std::string& what);

/// Of the element that begins, and only as long.
class XmlAttributes {
   public:
    explicit XmlAttributes(const char** all) : all_(all) {}
    std::optional<std::string_view> find(std::string_view name) const;

   private:
    const char** all_;  ///< names and values in turn, and a null
};

class XmlReader {
   public:
    explicit XmlReader(std::string place) : place_(std::move(place)) {}
    XmlReader(const XmlReader&) = delete;
    XmlReader& operator=(const XmlReader&) = delete;
    virtual ~XmlReader() = default;

    /// Reads a document to its end. more(to, size) gives the next bytes, none at the end. Throws Error (format), and
    /// what begin() and end() throw.
    void read(const std::function<std::size_t(char*, std::size_t)>& more);

    const std::string& place() const { return place_; }

   protected:
    virtual void begin(std::string_view element, const XmlAttributes& attributes) = 0;
    /// Of the element that began last and has not ended.
    virtual void end() = 0;
    /// Before the element begins on which it stands. Null for no namespace.
    virtual void declare_namespace(const char* /*prefix*/, const char* /*name*/) {}

    /// Of the element that begins or ends.
    std::int64_t line() const;
    [[noreturn]] void fail(const std::string& what) const { throw xml_error(place_, line(), what); }

   private:
    struct Callbacks;
    void parse_all(const std::function<std::size_t(char*, std::size_t)>& more);

    std::string place_;
    XML_ParserStruct* parser_ = nullptr;
    std::exception_ptr thrown_;  ///< by a callback: expat, which is C, must not see it
    int depth_ = 0;
};

}  // namespace crumple::io
