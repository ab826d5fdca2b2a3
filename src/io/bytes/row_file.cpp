#include "io/bytes/row_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "crumple/error.h"

namespace crumple::io {

RowFile::RowFile(const std::filesystem::path& path) : name_(path.string()) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return;
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    if (descriptor_ >= 0 && ::fstat(descriptor_, &status) == 0) size_ = status.st_size;
}

RowFile::~RowFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

std::vector<char> RowFile::read(std::int64_t offset, std::int64_t bytes) const {
    const auto fail = [&](int reason) {
        throw Error(ErrorCode::file, "cannot read " + name_ + ": " + std::generic_category().message(reason),
                    Element::none, -1, 0, reason);
    };
    std::vector<char> piece(static_cast<std::size_t>(std::max<std::int64_t>(0, std::min(bytes, size_ - offset))));
    for (std::size_t done = 0; done < piece.size();) {
        const ssize_t got = ::pread(descriptor_, piece.data() + done, piece.size() - done,
                                    static_cast<off_t>(offset + static_cast<std::int64_t>(done)));
        if (got == 0) fail(EIO);  // it has become shorter meanwhile
        if (got < 0 && errno != EINTR) fail(errno);
        if (got > 0) done += static_cast<std::size_t>(got);
    }
    return piece;
}

void RowFile::fail_at(std::int64_t byte, const std::string& what) const {
    throw Error(ErrorCode::format, name_ + ", byte " + std::to_string(byte) + ": " + what, Element::byte, byte);
}

}  // namespace crumple::io
