#include "io/bytes/zip.h"

#include <minizip/zip.h>

#include <algorithm>
#include <utility>

namespace crumple::io {

namespace {

/// Largest number of bytes passed to minizip in one call: minizip counts bytes in 32 bits.
constexpr std::size_t max_bytes_per_write = std::size_t{1} << 30;

}  // namespace

/// Archive in memory, with the file functions that minizip calls.
struct ZipWriter::Memory {
    std::string bytes;
    std::size_t at = 0;

    static void* open(void* memory, const void*, int) { return memory; }
    static uLong write(void*, void* stream, const void* from, uLong size) {
        auto& [bytes, at] = *static_cast<Memory*>(stream);
        try {
            bytes.replace(at, std::min<std::size_t>(size, bytes.size() - at), static_cast<const char*>(from), size);
            at += size;
            return size;
        } catch (const std::bad_alloc&) {
            return 0;
        }
    }
    static ZPOS64_T tell(void*, void* stream) { return static_cast<const Memory*>(stream)->at; }
    static long seek(void*, void* stream, ZPOS64_T offset, int origin) {
        auto& [bytes, at] = *static_cast<Memory*>(stream);
        const std::uint64_t base = origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                                   : origin == ZLIB_FILEFUNC_SEEK_END ? bytes.size()
                                                                      : at;
        if (base + offset > bytes.size()) return -1;
        at = base + offset;
        return 0;
    }
    static int nothing(void*, void*) { return 0; }
};

ZipWriter::ZipWriter(std::string kind) : kind_(std::move(kind)), memory_(std::make_unique<Memory>()) {
    zlib_filefunc64_def functions{Memory::open, nullptr,         Memory::write,   Memory::tell,
                                  Memory::seek, Memory::nothing, Memory::nothing, memory_.get()};
    archive_ = zipOpen2_64(nullptr, APPEND_STATUS_CREATE, nullptr, &functions);
    check(archive_ ? ZIP_OK : ZIP_INTERNALERROR);
}

ZipWriter::~ZipWriter() {
    if (archive_) zipClose(archive_, nullptr);
}

void ZipWriter::check(int status) const {
    if (status == ZIP_OK) return;
    throw Error(ErrorCode::file, "cannot make the " + kind_ + " archive: it does not fit in memory");
}

void ZipWriter::begin(const std::string& name, Method method, std::uint64_t size) {
    zip_fileinfo info{};
    info.dosDate = uLong{33} << 16;                     // 1980-01-01
    const bool large = size >= UINT32_MAX - (1 << 20);  // deflate may add bytes
    check(zipOpenNewFileInZip64(archive_, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr,
                                method == Method::store ? 0 : Z_DEFLATED, Z_DEFAULT_COMPRESSION, large));
}

void ZipWriter::add(std::string_view bytes) {
    while (!bytes.empty()) {
        const std::string_view some = bytes.substr(0, max_bytes_per_write);
        check(zipWriteInFileInZip(archive_, some.data(), static_cast<unsigned>(some.size())));
        bytes.remove_prefix(some.size());
    }
}

void ZipWriter::end() { check(zipCloseFileInZip(archive_)); }

void ZipWriter::write(std::ostream& out) {
    check(zipClose(std::exchange(archive_, nullptr), nullptr));
    out.write(memory_->bytes.data(), static_cast<std::streamsize>(memory_->bytes.size()));
}

}  // namespace crumple::io
