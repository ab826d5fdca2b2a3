#pragma once

// A file that appears whole or not at all: written under a temporary name beside its target, then renamed. What is not
// a regular file (a pipe, /dev/stdout) cannot be renamed over and is written directly. A name that ends with .gz has
// what is written compressed.

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
    /// Throws Error (file) that names the target, or the folder that is the cause: no such folder, a directory, a file
    /// that must not be written, not permitted.
    explicit AtomicFile(const std::filesystem::path& target);
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;
    /// Removes what has not been committed.
    ~AtomicFile();

    std::ostream& stream() { return stream_; }
    /// Where the bytes go until commit(), for others that write some of them; not of a compressed file. Empty where
    /// they go to the target itself.
    std::filesystem::path temporary() const { return direct_ ? std::filesystem::path() : written_; }

    /// Throws Error (file) if anything could not be written; the target then is as it was. Of several files that belong
    /// together, complete all before the first is committed.
    void complete();
    /// Completes the file and gives it its name.
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
