#pragma once

// NumPy's .npz: a zip archive of .npy files. What is written is stored, not compressed; what is read may be either.

#include <zip.h>

#include <cstring>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "crumple/error.h"
#include "io/bytes.h"
#include "io/source.h"

namespace crumple::io {

/// `descr` of a NumPy type: byte order, kind, size.
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

/// Refers to the arrays until it is written.
class NpzWriter {
   public:
    NpzWriter() {
        zip_error_t error;
        zip_error_init(&error);
        content_ = zip_source_buffer_create(nullptr, 0, 0, &error);
        if (content_) archive_ = zip_open_from_source(content_, ZIP_TRUNCATE, &error);
        const std::string reason = zip_error_strerror(&error);
        zip_error_fini(&error);
        if (!archive_) {
            if (content_) zip_source_free(content_);
            fail(reason);
        }
        zip_source_keep(content_);  // the archive frees it, too
    }
    NpzWriter(const NpzWriter&) = delete;
    NpzWriter& operator=(const NpzWriter&) = delete;
    ~NpzWriter() {
        if (archive_) zip_discard(archive_);
        zip_source_free(content_);
    }

    /// `data` holds scalars of type T in rows of `columns`; 0: a plain vector.
    template <class T>
    void add(const char* name, const void* data, std::size_t rows, int columns = 0) {
        const std::string shape = std::to_string(rows) + "," + (columns ? std::to_string(columns) : "");
        headers_.push_back(std::make_unique<std::string>(npy_header(npy_descriptor<T>(), shape)));
        const std::size_t size = rows * static_cast<std::size_t>(columns ? columns : 1) * sizeof(T);
        const zip_buffer_fragment_t fragments[] = {
            {reinterpret_cast<zip_uint8_t*>(headers_.back()->data()), headers_.back()->size()},
            {static_cast<zip_uint8_t*>(const_cast<void*>(data)), size},
        };
        zip_source_t* const source = zip_source_buffer_fragment(archive_, fragments, size ? 2 : 1, 0);
        const zip_int64_t index =
            source ? zip_file_add(archive_, (std::string(name) + ".npy").c_str(), source, ZIP_FL_ENC_UTF_8) : -1;
        if (index < 0) {
            zip_source_free(source);
            fail(zip_strerror(archive_));
        }
        const auto entry = static_cast<zip_uint64_t>(index);
        constexpr zip_uint16_t first_date = 33;  // 1980-01-01: equal results give equal files
        if (zip_set_file_compression(archive_, entry, ZIP_CM_STORE, 0) != 0 ||
            zip_file_set_dostime(archive_, entry, 0, first_date, 0) != 0) {
            fail(zip_strerror(archive_));
        }
    }

    void write(std::ostream& out) {
        if (zip_close(archive_) != 0) fail(zip_strerror(archive_));
        archive_ = nullptr;
        if (zip_source_open(content_) != 0) fail("the archive cannot be read back");
        std::vector<char> block(1 << 16);
        zip_int64_t got;
        while ((got = zip_source_read(content_, block.data(), block.size())) > 0) out.write(block.data(), got);
        zip_source_close(content_);
        if (got < 0) fail("the archive cannot be read back");
    }

   private:
    [[noreturn]] static void fail(const std::string& reason) {
        throw Error(ErrorCode::file, "cannot make the .npz archive: " + reason);
    }

    zip_source_t* content_ = nullptr;
    zip_t* archive_ = nullptr;
    std::vector<std::unique_ptr<std::string>> headers_;
};

/// An archive that is read.
class NpzReader {
   public:
    explicit NpzReader(const Source& source) : source_(source) {
        zip_source_t* const content =
            zip_source_buffer_create(source.begin(), static_cast<zip_uint64_t>(source.text().size()), 0, nullptr);
        if (content) archive_.reset(zip_open_from_source(content, ZIP_RDONLY, nullptr));
        if (archive_) return;
        zip_source_free(content);
        throw Error(ErrorCode::format, source.name() + ": this is not a .npz archive");
    }

    /// One of its arrays, from the left.
    class Entry {
       public:
        Entry(const NpzReader& from, const std::string& array)
            : source_(from.source_),
              array_(array),
              file_(zip_fopen(from.archive_.get(), (array + ".npy").c_str(), 0)) {}

        /// Whether the archive has it.
        explicit operator bool() const { return file_ != nullptr; }

        /// The next `size` bytes. Grows as they come: what the file says of its size may be a lie.
        std::string read(std::size_t size) {
            constexpr std::size_t block = 1 << 20;
            std::string bytes;
            while (bytes.size() < size) {
                const std::size_t before = bytes.size();
                bytes.resize(before + std::min(block, size - before));
                const zip_int64_t got = zip_fread(file_.get(), bytes.data() + before, bytes.size() - before);
                if (got <= 0) fail("is truncated or damaged");
                bytes.resize(before + static_cast<std::size_t>(got));
            }
            return bytes;
        }
        bool at_end() {
            char byte;
            return zip_fread(file_.get(), &byte, 1) == 0;
        }
        [[noreturn]] void fail(const std::string& what) const {
            throw Error(ErrorCode::format, source_.name() + ": the array '" + array_ + "' " + what);
        }

       private:
        struct Close {
            void operator()(zip_file_t* file) const { zip_fclose(file); }
        };
        const Source& source_;
        std::string array_;
        std::unique_ptr<zip_file_t, Close> file_;
    };

   private:
    struct Close {
        void operator()(zip_t* archive) const { zip_discard(archive); }
    };
    const Source& source_;
    std::unique_ptr<zip_t, Close> archive_;
};

}  // namespace crumple::io
