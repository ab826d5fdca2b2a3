#pragma once

// A file that appears whole or not at all: written under a temporary name beside its target, then renamed. What is not
// a regular file (a pipe, /dev/stdout) cannot be renamed over and is written directly.

#include <filesystem>
#include <fstream>

namespace crumple::io {

class AtomicFile {
   public:
    /// Throws Error (file) that names the target: no such folder, a directory, a file that
    /// must not be written, not permitted.
    explicit AtomicFile(const std::filesystem::path& target);
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;
    /// Removes what has not been committed.
    ~AtomicFile();

    std::ostream& stream() { return stream_; }

    /// Throws Error (file) if anything could not be written; the target then is as it was.
    void commit();

   private:
    [[noreturn]] void fail(const std::string& reason, int system_error = 0) const;
    [[noreturn]] void fail(int system_error) const;

    std::filesystem::path target_, written_;
    std::ofstream stream_;
    bool direct_;
};

}  // namespace crumple::io
