#pragma once

// gzip compression and decompression with zlib, for files that begin with 1f 8b or whose name ends with .gz.

#include <array>
#include <filesystem>
#include <memory>
#include <streambuf>
#include <string>
#include <string_view>

#include "crumple/array.h"

namespace crumple::io {

inline bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

/// Decompresses a gzip file, which may be several gzip files put one after the other. `name` is for messages. Throws
/// Error (format) if the data is truncated, damaged, followed by other data, or expands beyond the limit of
/// io/bytes/expanded_size.h.
Array<char> expand_gzip(std::string_view bytes, const std::string& name);

/// True if the name ends with .gz, in any case: such a file is compressed.
bool has_gzip_name(const std::filesystem::path& path);
/// Returns mesh.obj for mesh.obj.gz, and other names unchanged.
std::filesystem::path without_gzip_name(const std::filesystem::path& path);

/// Stream buffer that compresses into another buffer. Equal input gives equal output.
class GzipBuffer : public std::streambuf {
   public:
    explicit GzipBuffer(std::streambuf& to);
    GzipBuffer(const GzipBuffer&) = delete;
    GzipBuffer& operator=(const GzipBuffer&) = delete;
    ~GzipBuffer() override;

    /// Ends the gzip data: compresses what is buffered and writes the trailer. Returns false if not all could be
    /// written.
    bool finish();

   private:
    struct Deflate;
    int sync() override;
    int_type overflow(int_type c) override;
    bool compress(bool last);

    std::streambuf& to_;
    std::unique_ptr<Deflate> deflate_;
    std::array<char, 1 << 16> uncompressed_;  ///< bytes that wait to be compressed
};

}  // namespace crumple::io
