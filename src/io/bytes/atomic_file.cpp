#include "io/bytes/atomic_file.h"

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
    constexpr int most_links = 40;
    // If the target is a symbolic link, writes the file that the link points to. That file need not exist yet.
    for (int i = 0; i < most_links && fs::is_symlink(target_, error); ++i)
        target_ = target_.parent_path() / fs::read_symlink(target_, error);
    if (fs::is_symlink(target_, error)) {
        target_ = target;
        fail(ELOOP);
    }
    const fs::file_status status = fs::status(target_, error);
    if (fs::is_directory(status)) fail("it is a directory", EISDIR);
    if (!target_.has_filename()) fail("it names no file");
    // Renaming over a file needs no permission to write that file, so check the permission explicitly.
    if (fs::exists(status) && faccessat(AT_FDCWD, target_.c_str(), W_OK, AT_EACCESS) != 0) fail(errno);
    direct_ = fs::exists(status) && !fs::is_regular_file(status);
    written_ = direct_ ? target_ : temporary_name(target_);
    if (!direct_) unfinished_.begin(written_);
    constexpr mode_t readable = 0666;  // before the system applies the umask
    buffer_.open(::open(written_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | (direct_ ? O_TRUNC : O_EXCL), readable));
    if (buffer_.descriptor() < 0) direct_ ? fail(errno) : fail_to_create(errno);
    if (fs::is_regular_file(status)) fs::permissions(written_, status.permissions(), error);  // those of the old file
    if (has_gzip_name(target)) stream_.rdbuf(&gzip_.emplace(buffer_));
}

AtomicFile::~AtomicFile() { close(); }

/// Closes the file. An error of close() counts as a failed write: network file systems may report failed writes only
/// then.
void AtomicFile::close() {
    if (buffer_.descriptor() >= 0 && ::close(buffer_.descriptor()) != 0 && !buffer_.reason()) buffer_.fail(errno);
    buffer_.open(-1);
}

void AtomicFile::complete() {
    stream_.flush();
    if (gzip_ && stream_ && !gzip_->finish()) stream_.setstate(std::ios::failbit);
    close();
    if (buffer_.reason()) fail(buffer_.reason());
    if (!stream_) fail("the write failed");
}

void AtomicFile::commit() {
    complete();
    std::error_code error;
    if (!direct_) fs::rename(written_, target_, error);
    if (error) fail(error.value());
    unfinished_.finish();
}

/// Throws Error (file) that says why no temporary file could be created in the folder of the target.
void AtomicFile::fail_to_create(int system_error) const {
    const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    std::error_code error;
    const fs::file_status status = fs::status(folder, error);
    if (!fs::exists(status)) fail("there is no folder " + folder.string(), ENOENT);
    if (!fs::is_directory(status)) fail(folder.string() + " is not a folder", ENOTDIR);
    fail("in the folder " + folder.string() + ": " + std::generic_category().message(system_error), system_error);
}

void AtomicFile::fail(const std::string& reason, int system_error) const {
    throw Error(ErrorCode::file, "cannot write " + target_.string() + ": " + reason, Element::none, -1, 0,
                system_error);
}

void AtomicFile::fail(int system_error) const { fail(std::generic_category().message(system_error), system_error); }

}  // namespace crumple::io
