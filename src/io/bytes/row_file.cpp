#include "io/bytes/row_file.h"

#include <cerrno>
#include <system_error>

#include "crumple/error.h"

namespace crumple::io {

RowFile::RowFile(const std::filesystem::path& path) : name_(path.string()) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return;
    size_ = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
    if (!error) in_.open(path, std::ios::binary);
}

std::vector<char> RowFile::read(std::int64_t offset, std::int64_t bytes) {
    std::vector<char> piece(static_cast<std::size_t>(std::max<std::int64_t>(0, std::min(bytes, size_ - offset))));
    errno = 0;
    if (in_.seekg(offset).read(piece.data(), static_cast<std::streamsize>(piece.size()))) return piece;
    const int reason = errno ? errno : EIO;  // errno is 0 if the file has become shorter since it was opened
    throw Error(ErrorCode::file, "cannot read " + name_ + ": " + std::generic_category().message(reason), Element::none,
                -1, 0, reason);
}

void RowFile::fail_at(std::int64_t byte, const std::string& what) const {
    throw Error(ErrorCode::format, name_ + ", byte " + std::to_string(byte) + ": " + what, Element::byte, byte);
}

}  // namespace crumple::io
