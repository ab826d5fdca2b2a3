#pragma once

// What is written to a file descriptor, and why that failed: std::filebuf and std::cout leave the reason to errno,
// which others overwrite.

#include <array>
#include <streambuf>

namespace crumple::io {

class FileBuffer : public std::streambuf {
   public:
    /// -1: no file. Does not own the descriptor.
    explicit FileBuffer(int descriptor = -1);

    void open(int descriptor) { descriptor_ = descriptor; }
    int descriptor() const { return descriptor_; }
    /// errno of the first write that failed, or 0. Nothing is written after that.
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
