#pragma once

// Bytes of a file, read once, and errors and warnings that name a place in it. Lines are counted only for such
// messages.

#include <filesystem>
#include <iosfwd>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "crumple/array.h"
#include "crumple/error.h"

namespace crumple::io {

class Source {
   public:
    /// Reads the whole file, and expands gzip. Throws Error (format) if the gzip data is damaged; (file) if the file is
    /// missing, a directory, a device, not readable, or too large for memory.
    explicit Source(const std::filesystem::path& path);
    /// Reads a stream to its end, and expands gzip. `name` is for messages. Throws Error (file, format).
    Source(std::istream& in, const std::string& name);
    /// Takes bytes that are already in memory, such as an archive entry, and expands gzip. Throws Error (file, format).
    Source(Array<char> bytes, std::string name);

    const char* begin() const { return bytes_.begin(); }
    /// Returns the start of the text, after the byte order mark that some editors put before UTF-8.
    const char* text_begin() const { return begin() + (text().starts_with("\xef\xbb\xbf") ? 3 : 0); }
    const char* end() const { return bytes_.end(); }
    std::string_view text() const { return {bytes_.data(), bytes_.size()}; }
    const std::string& name() const { return name_; }

    /// Throws Error (format): "NAME, line 17: WHAT" or "NAME, byte 4711: WHAT".
    [[noreturn]] void fail_at_line(const char* place, const std::string& what) const;
    [[noreturn]] void fail_at_byte(const char* place, const std::string& what) const;

   private:
    friend class Warnings;
    void read(std::istream& in, std::size_t hint);
    void expand_if_compressed();
    Error error_at_line(const char* place, const std::string& what) const;
    Error error_at_byte(const char* place, const std::string& what) const;

    std::string name_;
    Array<char> bytes_;
};

/// Collector of warnings, one sentence each, about oddities of a file that can be read nevertheless. In strict mode
/// each is thrown as an Error instead.
class Warnings {
   public:
    Warnings(const Source& source, bool strict) : source_(source), strict_(strict) {}

    void at_line(const char* place, const std::string& what) { add(source_.error_at_line(place, what)); }
    void at_byte(const char* place, const std::string& what) { add(source_.error_at_byte(place, what)); }
    void of_file(const std::string& what) {
        add(Error(ErrorCode::format, source_.name() + ": " + what, Element::none));
    }
    std::vector<std::string> take() { return std::move(sentences_); }

   private:
    void add(const Error& error) {
        if (strict_) throw error;
        sentences_.emplace_back(error.what());
    }

    const Source& source_;
    bool strict_;
    std::vector<std::string> sentences_;
};

/// Oddities of one kind, which share one warning: the place of the first of them in the file, and their number.
struct WarningTally {
    const char* first = nullptr;
    std::int64_t count = 0;

    void add(const char* place) {
        if (count++ == 0) first = place;
    }
    /// Returns ", and 1 more like it", ", and 3 more like that", or an empty text.
    std::string others() const {
        return count < 2 ? "" : ", and " + std::to_string(count - 1) + " more like " + (count == 2 ? "it" : "that");
    }
};

/// Quotes a word of a file for a message. Cuts it to `longest` characters, and replaces unprintable ones by '?'.
std::string in_quotes(std::string_view word, std::size_t longest = 40);

}  // namespace crumple::io
