#include "io/bytes/source.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>

#include "io/bytes/gzip.h"
#include "io/bytes/large_pages.h"

namespace crumple::io {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail_to_read(const fs::path& path, const std::string& reason, int system_error = 0) {
    throw Error(ErrorCode::file, "cannot read " + (path.empty() ? "''" : path.string()) + ": " + reason, Element::none,
                -1, 0, system_error);
}

[[noreturn]] void fail_to_read(const fs::path& path, int system_error) {
    fail_to_read(path, std::generic_category().message(system_error), system_error);
}

}  // namespace

Source::Source(const fs::path& path) : name_(path.string()) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (error) fail_to_read(path, error.value());
    if (fs::is_directory(status)) fail_to_read(path, "it is a directory", EISDIR);
    // A pipe comes to an end; a device such as /dev/zero need not.
    if (!fs::is_regular_file(status) && !fs::is_fifo(status)) fail_to_read(path, "it is not a file");

    errno = 0;
    std::ifstream in(path, std::ios::binary);
    if (!in) fail_to_read(path, errno);
    const std::uintmax_t size = fs::is_regular_file(status) ? fs::file_size(path, error) : 0;
    read(in, error ? 0 : size);
}

Source::Source(std::istream& in, const std::string& name) : name_(name) { read(in, 0); }

Source::Source(Array<char> bytes, std::string name) : name_(std::move(name)), bytes_(std::move(bytes)) {
    expand_if_compressed();
}

void Source::read(std::istream& in, std::size_t hint) {
    errno = 0;
    try {
        bytes_.resize(std::max<std::size_t>(hint, 4095) + 1);  // one byte more, so that one read meets the end
        advise_large_pages(bytes_.data(), bytes_.size());
        std::size_t size = 0;
        while (true) {
            in.read(bytes_.data() + size, static_cast<std::streamsize>(bytes_.size() - size));
            size += static_cast<std::size_t>(in.gcount());
            if (!in) break;
            bytes_.resize(2 * bytes_.size());
        }
        bytes_.resize(size);
    } catch (const std::bad_alloc&) {
        fail_to_read(name_, "it does not fit in memory", ENOMEM);
    }
    if (in.bad()) fail_to_read(name_, errno);
    expand_if_compressed();
}

void Source::expand_if_compressed() {
    if (!is_gzip(text())) return;
    try {
        bytes_ = expand_gzip(text(), name_);
    } catch (const std::bad_alloc&) {
        fail_to_read(name_, "its expanded content does not fit in memory", ENOMEM);
    }
}

Error Source::error_at_line(const char* place, const std::string& what) const {
    std::int64_t line = 1;
    for (const char* p = begin(); p != place; ++p)
        line += *p == '\n' || (*p == '\r' && (p + 1 == end() || p[1] != '\n'));
    return Error(ErrorCode::format, name_ + ", line " + std::to_string(line) + ": " + what, Element::line, line);
}

Error Source::error_at_byte(const char* place, const std::string& what) const {
    const std::int64_t byte = place - begin();
    return Error(ErrorCode::format, name_ + ", byte " + std::to_string(byte) + ": " + what, Element::byte, byte);
}

void Source::fail_at_line(const char* place, const std::string& what) const { throw error_at_line(place, what); }

void Source::fail_at_byte(const char* place, const std::string& what) const { throw error_at_byte(place, what); }

std::string in_quotes(std::string_view word, std::size_t longest) {
    std::string result = "'";
    for (const char c : word.substr(0, longest)) result += c >= ' ' && c <= '~' ? c : '?';
    return result + (word.size() > longest ? "...'" : "'");
}

}  // namespace crumple::io
