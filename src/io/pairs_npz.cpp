// Colliding pairs as NumPy arrays: .npz is a zip archive of .npy files, here stored and not compressed. A .npy file is
// a header, padded to 64 bytes, that tells type and shape, and then the array's bytes.

#include <zip.h>

#include <cstring>
#include <memory>
#include <string>

#include "io/bytes.h"
#include "io/formats.h"
#include "io/pairs.h"

namespace crumple::io {

namespace {

// `descr` of a NumPy type: byte order, kind, size.
template <class T>
std::string descriptor() {
    const char order = sizeof(T) == 1 ? '|' : std::endian::native == std::endian::little ? '<' : '>';
    const char kind = std::is_floating_point_v<T> ? 'f' : std::is_signed_v<T> ? 'i' : 'u';
    return std::string{order, kind} + std::to_string(sizeof(T));
}

std::string npy_header(const std::string& type, const std::string& shape) {
    constexpr std::size_t alignment = 64, prologue = 10;  // magic, version, length
    std::string text = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
    text.resize((prologue + text.size() + alignment) / alignment * alignment - prologue - 1, ' ');
    text += '\n';
    const auto length = little_endian(static_cast<std::uint16_t>(text.size()));
    return std::string("\x93NUMPY\x01\x00", 8) + std::string(length.data(), length.size()) + text;
}

/// A zip archive in memory. Refers to the arrays until it is finished.
class Archive {
   public:
    Archive() {
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
    Archive(const Archive&) = delete;
    Archive& operator=(const Archive&) = delete;
    ~Archive() {
        if (archive_) zip_discard(archive_);
        zip_source_free(content_);
    }

    /// `data` holds scalars of type T in rows of `columns`; 0: a plain vector.
    template <class T>
    void add(const char* name, const void* data, std::size_t rows, int columns = 0) {
        const std::string shape = std::to_string(rows) + "," + (columns ? std::to_string(columns) : "");
        headers_.push_back(std::make_unique<std::string>(npy_header(descriptor<T>(), shape)));
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

}  // namespace

void write_pairs_npz(std::ostream& out, const Collisions& collisions) {
    Archive archive;
    archive.add<std::int32_t>("pairs", collisions.pairs.data(), collisions.pairs.size(), 2);
    archive.add<std::int64_t>("offsets", collisions.offsets.data(), collisions.offsets.size());
    archive.add<std::uint8_t>("hit", collisions.hit.data(), collisions.hit.size());
    if (!collisions.hit_second.empty()) {
        archive.add<std::uint8_t>("hit_second", collisions.hit_second.data(), collisions.hit_second.size());
    }
    if (has_contacts(collisions)) {
        const Contacts& contacts = collisions.contacts;
        archive.add<std::uint8_t>("contact_kinds", contacts.kinds.data(), contacts.kinds.size());
        archive.add<std::int64_t>("contact_offsets", contacts.offsets.data(), contacts.offsets.size());
        archive.add<double>("contact_points", contacts.points.data(), contacts.points.size(), 3);
    }
    archive.write(out);
}

}  // namespace crumple::io
