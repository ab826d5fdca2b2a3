#pragma once

// Writer and reader of NumPy's .npz, a zip archive of .npy files. The writer stores entries uncompressed; the reader
// also accepts compressed ones.

#include <cstring>
#include <ostream>
#include <string>

#include "crumple/error.h"
#include "io/bytes/bytes.h"
#include "io/bytes/source.h"
#include "io/bytes/zip.h"

namespace crumple::io {

/// Returns `descr` of a NumPy type: byte order, kind, size.
template <class T>
std::string npy_descriptor() {
    const char order = sizeof(T) == 1 ? '|' : std::endian::native == std::endian::little ? '<' : '>';
    const char kind = std::is_floating_point_v<T> ? 'f' : std::is_signed_v<T> ? 'i' : 'u';
    return std::string{order, kind} + std::to_string(sizeof(T));
}

inline std::string npy_header(const std::string& type, const std::string& shape) {
    constexpr std::size_t alignment = 64, prologue = 10;  // magic, version, length
    std::string text = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
    text.resize((prologue + text.size() + alignment) / alignment * alignment - prologue - 1, ' ');
    text += '\n';
    const auto length = little_endian(static_cast<std::uint16_t>(text.size()));
    return std::string("\x93NUMPY\x01\x00", 8) + std::string(length.data(), length.size()) + text;
}

/// Writer of an archive, which is held in memory until write().
class NpzWriter {
   public:
    /// Adds an array. `data` holds scalars of type T in rows of `columns`; 0 columns make a one-dimensional array.
    template <class T>
    void add(const char* name, const void* data, std::size_t rows, std::size_t columns = 0) {
        const std::string shape = std::to_string(rows) + "," + (columns ? std::to_string(columns) : "");
        const std::string header = npy_header(npy_descriptor<T>(), shape);
        const std::size_t size = rows * (columns ? columns : 1) * sizeof(T);
        archive_.begin(std::string(name) + ".npy", ZipWriter::Method::store, header.size() + size);
        archive_.add(header);
        archive_.add({static_cast<const char*>(data), size});
        archive_.end();
    }

    void write(std::ostream& out) { archive_.write(out); }

   private:
    ZipWriter archive_{".npz"};
};

/// Reader of an archive, one array at a time.
class NpzReader {
   public:
    explicit NpzReader(const Source& source) : source_(source), archive_(source, ".npz") {}

    /// Sequential reader of one array of the archive.
    class Entry {
       public:
        Entry(NpzReader& from, const std::string& array)
            : source_(from.source_), archive_(from.archive_), array_(array), found_(archive_.open(array + ".npy")) {}

        /// True if the archive has the array.
        explicit operator bool() const { return found_; }

        /// Reads the next `size` bytes. The result grows with the data, because the size that the file states may be
        /// wrong.
        std::string read(std::size_t size) {
            constexpr std::size_t block = 1 << 20;
            std::string bytes;
            while (bytes.size() < size) {
                const std::size_t before = bytes.size();
                bytes.resize(before + std::min(block, size - before));
                const std::size_t got = read(bytes.data() + before, bytes.size() - before);
                if (got == 0) fail("is truncated or damaged");
                bytes.resize(before + got);
            }
            return bytes;
        }
        bool at_end() {
            char byte;
            return read(&byte, 1) == 0;
        }
        [[noreturn]] void fail(const std::string& what) const {
            throw Error(ErrorCode::format, source_.name() + ": the array '" + array_ + "' " + what);
        }

       private:
        std::size_t read(char* to, std::size_t size) {
            std::size_t got = 0;
            if (!archive_.read(to, size, got)) fail("is truncated or damaged");
            return got;
        }

        const Source& source_;
        ZipReader& archive_;
        std::string array_;
        bool found_;
    };

   private:
    const Source& source_;
    ZipReader archive_;
};

}  // namespace crumple::io
