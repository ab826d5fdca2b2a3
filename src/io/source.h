#pragma once

// A file's bytes, read once, and the errors that name a place in it. Lines are counted only when an error needs them.

#include <filesystem>
#include <string>
#include <string_view>

#include "crumple/array.h"
#include "crumple/error.h"

namespace crumple::io {

class Source {
   public:
    /// Reads the whole file. Throws Error (file): missing, a directory, a device, not permitted, too large for memory.
    explicit Source(const std::filesystem::path& path);

    const char* begin() const { return bytes_.begin(); }
    /// Where text begins: after the byte order mark that some editors put before UTF-8.
    const char* text_begin() const { return begin() + (text().starts_with("\xef\xbb\xbf") ? 3 : 0); }
    const char* end() const { return bytes_.end(); }
    std::string_view text() const { return {bytes_.data(), bytes_.size()}; }
    const std::string& name() const { return name_; }

    /// Throws Error (format): "NAME, line 17: WHAT" or "NAME, byte 4711: WHAT".
    [[noreturn]] void fail_at_line(const char* place, const std::string& what) const;
    [[noreturn]] void fail_at_byte(const char* place, const std::string& what) const;

   private:
    std::string name_;
    Array<char> bytes_;
};

/// A word of a file for a message: short and printable, whatever the file holds.
std::string in_quotes(std::string_view word);

}  // namespace crumple::io
