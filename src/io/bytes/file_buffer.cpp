#include "io/bytes/file_buffer.h"

#include <unistd.h>

#include <cerrno>

namespace crumple::io {

FileBuffer::FileBuffer(int descriptor) : descriptor_(descriptor) {
    setp(buffer_.data(), buffer_.data() + buffer_.size());
}

void FileBuffer::write(const char* data, std::size_t size) {
    while (size > 0 && !reason_) {
        const ssize_t written = ::write(descriptor_, data, size);
        if (written >= 0) {
            data += written;
            size -= static_cast<std::size_t>(written);
        } else if (errno != EINTR) {
            reason_ = errno;
        }
    }
}

int FileBuffer::sync() {
    write(pbase(), static_cast<std::size_t>(pptr() - pbase()));
    setp(buffer_.data(), buffer_.data() + buffer_.size());
    return reason_ ? -1 : 0;
}

FileBuffer::int_type FileBuffer::overflow(int_type c) {
    if (sync() != 0) return traits_type::eof();
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
}

/// Writes data that does not fit in the buffer straight to the file.
std::streamsize FileBuffer::xsputn(const char* data, std::streamsize size) {
    if (size <= epptr() - pptr()) return std::streambuf::xsputn(data, size);
    if (sync() == 0) write(data, static_cast<std::size_t>(size));
    return reason_ ? 0 : size;
}

}  // namespace crumple::io
