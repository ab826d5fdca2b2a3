#include "io/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <random>
#include <system_error>

#include "crumple/error.h"

namespace crumple::io {

namespace fs = std::filesystem;

namespace {

fs::path temporary_name(const fs::path& target) {
    std::random_device random;
    fs::path name = ".";
    name += target.filename();
    for (int i = 0; i < 2; ++i) name.concat(".").concat(std::to_string(random()));
    name += ".tmp";
    return target.parent_path() / name;
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& target) : target_(target) {
    std::error_code error;
    if (fs::is_symlink(target, error)) target_ = fs::weakly_canonical(target, error);  // keeps the link
    const fs::file_status status = fs::status(target_, error);
    if (fs::is_directory(status)) fail("it is a directory", EISDIR);
    if (!target_.has_filename()) fail("it names no file");
    // To rename over a file takes no permission to write it, so that has to be asked.
    if (fs::exists(status) && faccessat(AT_FDCWD, target_.c_str(), W_OK, AT_EACCESS) != 0) fail(errno);
    direct_ = fs::exists(status) && !fs::is_regular_file(status);
    written_ = direct_ ? target_ : temporary_name(target_);
    errno = 0;
    stream_.open(written_, std::ios::binary | std::ios::trunc);
    if (!stream_) fail(errno);
    if (fs::is_regular_file(status)) fs::permissions(written_, status.permissions(), error);  // as it was, if possible
}

AtomicFile::~AtomicFile() {
    std::error_code ignored;
    if (stream_.is_open()) stream_.close();
    if (!written_.empty() && !direct_) fs::remove(written_, ignored);
}

void AtomicFile::commit() {
    errno = 0;
    const bool wrote = static_cast<bool>(stream_.flush());
    const int reason = errno;
    stream_.close();
    if (reason && (!wrote || !stream_)) fail(reason);
    if (!wrote || !stream_) fail("the write failed");
    std::error_code error;
    if (!direct_) fs::rename(written_, target_, error);
    if (error) fail(error.value());
    written_.clear();
}

void AtomicFile::fail(const std::string& reason, int system_error) const {
    throw Error(ErrorCode::file, "cannot write " + target_.string() + ": " + reason, Element::none, -1, 0,
                system_error);
}

void AtomicFile::fail(int system_error) const { fail(std::generic_category().message(system_error), system_error); }

}  // namespace crumple::io
