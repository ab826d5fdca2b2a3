#pragma once

// File that appears whole or not at all: it is written under a temporary name beside its target, then renamed. A target
// that is not a regular file (a pipe, /dev/stdout) cannot be replaced by renaming and is written directly. Output to a
// name that ends with .gz is compressed.

#include <filesystem>
#include <optional>
#include <ostream>
#include <string>

#include "io/bytes/file_buffer.h"
#include "io/bytes/gzip.h"
#include "io/bytes/unfinished_files.h"

namespace crumple::io {

class AtomicFile {
   public:
    /// Throws Error (file) if the folder is missing, if the target is a directory, or if either is not writable. The
    /// message names the one that is the cause.
    explicit AtomicFile(const std::filesystem::path& target);
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;
    /// Removes the temporary file unless it was committed.
    ~AtomicFile();

    std::ostream& stream() { return stream_; }
    /// Returns the path of the temporary file, for other processes that write parts of it; not for compressed files.
    /// Empty if the target is written directly.
    std::filesystem::path temporary() const { return direct_ ? std::filesystem::path() : written_; }

    /// Writes all buffered data and closes the file, without renaming it. Throws Error (file) if anything could not be
    /// written; a regular target is unchanged then. If several files belong together, complete all before committing
    /// the first.
    void complete();
    /// Completes the file and renames it to its target. Throws Error (file).
    void commit();

   private:
    [[noreturn]] void fail(const std::string& reason, int system_error = 0) const;
    [[noreturn]] void fail(int system_error) const;
    [[noreturn]] void fail_to_create(int system_error) const;

    void close();

    std::filesystem::path target_, written_;
    UnfinishedFile unfinished_;
    FileBuffer buffer_;
    std::optional<GzipBuffer> gzip_;
    std::ostream stream_{&buffer_};
    bool direct_;
};

}  // namespace crumple::io
