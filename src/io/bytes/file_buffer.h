#pragma once

// Stream buffer that writes to a file descriptor and records why a write failed. std::filebuf and std::cout leave the
// reason in errno, where later calls overwrite it.

#include <array>
#include <streambuf>

namespace crumple::io {

class FileBuffer : public std::streambuf {
   public:
    /// Does not own the descriptor; -1 means no file.
    explicit FileBuffer(int descriptor = -1);

    void open(int descriptor) { descriptor_ = descriptor; }
    int descriptor() const { return descriptor_; }
    /// Returns errno of the first failed write, or 0. Nothing is written after a failure.
    int reason() const { return reason_; }
    void fail(int reason) { reason_ = reason; }

   private:
    int sync() override;
    int_type overflow(int_type c) override;
    std::streamsize xsputn(const char* data, std::streamsize size) override;
    void write(const char* data, std::size_t size);

    int descriptor_, reason_ = 0;
    std::array<char, 1 << 16> buffer_;
};

}  // namespace crumple::io
