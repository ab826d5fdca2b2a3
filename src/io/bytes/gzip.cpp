#include "io/bytes/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <new>

#include "crumple/error.h"
#include "io/bytes/expanded_size.h"

namespace crumple::io {

namespace {

constexpr int gzip_only = 16 + MAX_WBITS;
/// Largest number of bytes passed to zlib in one call: zlib counts bytes in 32 bits.
constexpr std::size_t max_bytes_per_call = std::size_t{1} << 30;

class Expander {
   public:
    Expander(std::string_view bytes, const std::string& name)
        : bytes_(bytes), name_(name), most_(expansion_limit(bytes.size())) {
        if (inflateInit2(&stream_, gzip_only) != Z_OK) throw std::bad_alloc();
    }
    Expander(const Expander&) = delete;
    Expander& operator=(const Expander&) = delete;
    ~Expander() { inflateEnd(&stream_); }

    Array<char> expand() {
        constexpr std::size_t first_guess = 4;
        out_.resize(std::min<std::size_t>(first_guess * bytes_.size() + 1, most_ + 1));
        for (int status = Z_OK; !(status == Z_STREAM_END && at_ == bytes_.size());) {
            if (status == Z_STREAM_END) begin_next_member();
            if (size_ == out_.size()) grow();
            status = step();
        }
        if (size_ > most_) fail_too_large();
        out_.resize(size_);
        return std::move(out_);
    }

   private:
    int step() {
        const std::size_t given = std::min(bytes_.size() - at_, max_bytes_per_call);
        const std::size_t room = std::min(out_.size() - size_, max_bytes_per_call);
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes_.data() + at_));  // zlib only reads it
        stream_.avail_in = static_cast<uInt>(given);
        stream_.next_out = reinterpret_cast<Bytef*>(out_.data() + size_);
        stream_.avail_out = static_cast<uInt>(room);
        const int status = inflate(&stream_, Z_NO_FLUSH);
        at_ += given - stream_.avail_in;
        size_ += room - stream_.avail_out;
        if (status == Z_MEM_ERROR) throw std::bad_alloc();
        if (status == Z_BUF_ERROR || (status == Z_OK && at_ == bytes_.size() && stream_.avail_out > 0))
            fail("the gzip data is truncated");
        if (status != Z_OK && status != Z_STREAM_END) fail("the gzip data is damaged");
        return status;
    }

    void begin_next_member() {
        if (!is_gzip(bytes_.substr(at_))) fail("other data follows the gzip data");
        inflateReset(&stream_);
    }

    void grow() {
        if (size_ > most_) fail_too_large();
        out_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(2 * std::uint64_t{size_}, most_ + 1)));
    }

    [[noreturn]] void fail_too_large() const { fail("the file expands too far: " + std::string(expansion_rule)); }
    /// Throws Error (format) that names the current byte of the compressed data.
    [[noreturn]] void fail(const std::string& what) const {
        const auto byte = static_cast<std::int64_t>(at_);
        throw Error(ErrorCode::format, name_ + ", byte " + std::to_string(byte) + ": " + what, Element::byte, byte);
    }

    std::string_view bytes_;
    const std::string& name_;
    std::uint64_t most_;
    z_stream stream_{};
    Array<char> out_;
    std::size_t at_ = 0, size_ = 0;
};

}  // namespace

Array<char> expand_gzip(std::string_view bytes, const std::string& name) { return Expander(bytes, name).expand(); }

bool has_gzip_name(const std::filesystem::path& path) {
    const std::string extension = path.extension().string();
    return extension.size() == 3 && extension[0] == '.' && std::tolower(extension[1]) == 'g' &&
           std::tolower(extension[2]) == 'z';
}

std::filesystem::path without_gzip_name(const std::filesystem::path& path) {
    return has_gzip_name(path) ? path.parent_path() / path.stem() : path;
}

struct GzipBuffer::Deflate {
    z_stream stream{};
    std::array<char, 1 << 16> out;

    Deflate() {
        constexpr int memory_level = 8;  // zlib's default
        if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, gzip_only, memory_level, Z_DEFAULT_STRATEGY) !=
            Z_OK)
            throw std::bad_alloc();
    }
    Deflate(const Deflate&) = delete;
    Deflate& operator=(const Deflate&) = delete;
    ~Deflate() { deflateEnd(&stream); }
};

GzipBuffer::GzipBuffer(std::streambuf& to) : to_(to), deflate_(std::make_unique<Deflate>()) {
    setp(uncompressed_.data(), uncompressed_.data() + uncompressed_.size());
}

GzipBuffer::~GzipBuffer() = default;

bool GzipBuffer::compress(bool last) {
    auto& [stream, out] = *deflate_;
    stream.next_in = reinterpret_cast<Bytef*>(pbase());
    stream.avail_in = static_cast<uInt>(pptr() - pbase());
    setp(uncompressed_.data(), uncompressed_.data() + uncompressed_.size());
    do {
        stream.next_out = reinterpret_cast<Bytef*>(out.data());
        stream.avail_out = static_cast<uInt>(out.size());
        deflate(&stream, last ? Z_FINISH : Z_NO_FLUSH);
        const auto made = static_cast<std::streamsize>(out.size() - stream.avail_out);
        if (to_.sputn(out.data(), made) != made) return false;
    } while (stream.avail_out == 0);
    return true;
}

bool GzipBuffer::finish() { return compress(true) && to_.pubsync() == 0; }

/// Writes the output that zlib has produced so far. zlib is not flushed: it keeps the rest of the input in its own
/// buffers, so flushing the stream does not worsen the compression.
int GzipBuffer::sync() { return compress(false) ? to_.pubsync() : -1; }

GzipBuffer::int_type GzipBuffer::overflow(int_type c) {
    if (!compress(false)) return traits_type::eof();
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
}

}  // namespace crumple::io
