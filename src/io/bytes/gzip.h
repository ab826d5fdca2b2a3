#pragma once

// gzip by zlib, in pieces: what files with `.gz` at the end of their name hold, or begin with 1f 8b.

#include <array>
#include <filesystem>
#include <memory>
#include <streambuf>
#include <string>
#include <string_view>

#include "crumple/array.h"

namespace crumple::io {

inline bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

/// Of all members, one after the other. `name` is for messages. Throws Error (format): truncated, damaged, followed by
/// something else, expands beyond measure (io/bytes/expanded_size.h).
Array<char> expand_gzip(std::string_view bytes, const std::string& name);

/// Whether a file of this name is compressed.
bool has_gzip_name(const std::filesystem::path& path);
/// mesh.obj for mesh.obj.gz; other names stay.
std::filesystem::path without_gzip_name(const std::filesystem::path& path);

/// Compresses what is written to it into another buffer. Equal bytes give equal files.
class GzipBuffer : public std::streambuf {
   public:
    explicit GzipBuffer(std::streambuf& to);
    GzipBuffer(const GzipBuffer&) = delete;
    GzipBuffer& operator=(const GzipBuffer&) = delete;
    ~GzipBuffer() override;

    /// Ends the file; whether all of it could be written.
    bool finish();

   private:
    struct Deflate;
    int sync() override;
    int_type overflow(int_type c) override;
    bool compress(bool last);

    std::streambuf& to_;
    std::unique_ptr<Deflate> deflate_;
    std::array<char, 1 << 16> buffer_;
};

}  // namespace crumple::io
