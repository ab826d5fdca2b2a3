#include "io/zip.h"

#include <minizip/unzip.h>
#include <minizip/zip.h>

#include <algorithm>
#include <cstring>
#include <unordered_map>
#include <utility>

namespace crumple::io {

/// Where a file of minizip is, in memory.
struct ZipPosition {
    std::uint64_t at = 0;

    long seek(std::uint64_t size, ZPOS64_T offset, int origin) {
        const std::uint64_t base = origin == ZLIB_FILEFUNC_SEEK_SET ? 0 : origin == ZLIB_FILEFUNC_SEEK_END ? size : at;
        if (base + offset > size) return -1;
        at = base + offset;
        return 0;
    }
};

namespace {

template <class Memory>
void* open_memory(void* memory, const void*, int) {
    return memory;
}

template <class Memory>
ZPOS64_T tell(void*, void* stream) {
    return static_cast<const Memory*>(stream)->position.at;
}

template <class Memory>
long seek(void*, void* stream, ZPOS64_T offset, int origin) {
    auto& memory = *static_cast<Memory*>(stream);
    return memory.position.seek(memory.size(), offset, origin);
}

int nothing(void*, void*) { return 0; }

/// What both directions have in common.
template <class Memory>
zlib_filefunc64_def functions_of(Memory& memory) {
    zlib_filefunc64_def functions{};
    functions.zopen64_file = open_memory<Memory>;
    functions.ztell64_file = tell<Memory>;
    functions.zseek64_file = seek<Memory>;
    functions.zclose_file = nothing;
    functions.zerror_file = nothing;
    functions.opaque = &memory;
    return functions;
}

/// Bytes of one call, which minizip counts in 32 bits.
constexpr std::size_t most_at_once = std::size_t{1} << 30;

}  // namespace

struct ZipWriter::Memory {
    std::string bytes;
    ZipPosition position;

    std::uint64_t size() const { return bytes.size(); }
    static uLong write(void*, void* stream, const void* from, uLong size) {
        auto& [bytes, position] = *static_cast<Memory*>(stream);
        try {
            const std::size_t at = position.at, replaced = std::min<std::size_t>(size, bytes.size() - at);
            bytes.replace(at, replaced, static_cast<const char*>(from), size);
            position.at += size;
            return size;
        } catch (const std::bad_alloc&) {
            return 0;
        }
    }
};

ZipWriter::ZipWriter(std::string kind) : kind_(std::move(kind)), memory_(std::make_unique<Memory>()) {
    zlib_filefunc64_def functions = functions_of(*memory_);
    functions.zwrite_file = Memory::write;
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
    const bool large = size >= UINT32_MAX - (1 << 20);  // deflate may add a few bytes
    check(zipOpenNewFileInZip64(archive_, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr,
                                method == Method::store ? 0 : Z_DEFLATED, Z_DEFAULT_COMPRESSION, large));
}

void ZipWriter::add(std::string_view bytes) {
    while (!bytes.empty()) {
        const std::string_view some = bytes.substr(0, most_at_once);
        check(zipWriteInFileInZip(archive_, some.data(), static_cast<unsigned>(some.size())));
        bytes.remove_prefix(some.size());
    }
}

void ZipWriter::end() { check(zipCloseFileInZip(archive_)); }

void ZipWriter::write(std::ostream& out) {
    check(zipClose(std::exchange(archive_, nullptr), nullptr));
    out.write(memory_->bytes.data(), static_cast<std::streamsize>(memory_->bytes.size()));
}

struct ZipReader::Memory {
    std::string_view bytes;
    ZipPosition position;
    bool read_past_end = false;

    std::uint64_t size() const { return bytes.size(); }
    static uLong read(void*, void* stream, void* to, uLong size) {
        auto& [bytes, position, read_past_end] = *static_cast<Memory*>(stream);
        const std::string_view some = bytes.substr(position.at, size);
        read_past_end = some.size() < size;
        std::copy(some.begin(), some.end(), static_cast<char*>(to));
        position.at += some.size();
        return some.size();
    }
    /// Without it minizip takes what is missing for zeros.
    static int error(void*, void* stream) { return static_cast<const Memory*>(stream)->read_past_end; }
};

/// Where entries are, by their names and by these in lower case; of several with one name the first. minizip itself
/// looks through all of them for each.
struct ZipReader::Index {
    std::unordered_map<std::string, unz64_file_pos> exact, any_case;
};

ZipReader::ZipReader(const Source& source, const std::string& kind)
    : memory_(std::make_unique<Memory>(Memory{source.text(), {}})) {
    zlib_filefunc64_def functions = functions_of(*memory_);
    functions.zread_file = Memory::read;
    functions.zerror_file = Memory::error;
    archive_ = unzOpen2_64(nullptr, &functions);
    if (!archive_) throw Error(ErrorCode::format, source.name() + ": this is not a " + kind + " archive");
}

ZipReader::~ZipReader() {
    close();
    unzClose(archive_);
}

void ZipReader::close() {
    if (std::exchange(is_open_, false)) unzCloseCurrentFile(archive_);
}

void ZipReader::list_entries() {
    index_ = std::make_unique<Index>();
    unz_file_info64 info{};
    std::string name(UINT16_MAX, '\0');  // the longest there is
    for (int code = unzGoToFirstFile(archive_); code == UNZ_OK; code = unzGoToNextFile(archive_)) {
        unz64_file_pos at{};
        if (unzGetCurrentFileInfo64(archive_, &info, name.data(), name.size(), nullptr, 0, nullptr, 0) != UNZ_OK)
            return;
        if (unzGetFilePos64(archive_, &at) != UNZ_OK) return;
        const std::string this_name = name.substr(0, info.size_filename);
        index_->exact.try_emplace(this_name, at);
        index_->any_case.try_emplace(in_lower_case(this_name), at);
    }
}

bool ZipReader::open(const std::string& name, bool any_case) {
    close();
    if (!index_) list_entries();
    auto& index = any_case ? index_->any_case : index_->exact;
    const auto found = index.find(any_case ? in_lower_case(name) : name);
    if (found == index.end() || unzGoToFilePos64(archive_, &found->second) != UNZ_OK) return false;
    unz_file_info64 info{};
    if (unzGetCurrentFileInfo64(archive_, &info, nullptr, 0, nullptr, 0, nullptr, 0) != UNZ_OK) return false;
    const bool locked = info.flag & 1;
    if (locked || (info.compression_method != 0 && info.compression_method != Z_DEFLATED)) return false;
    return is_open_ = unzOpenCurrentFile(archive_) == UNZ_OK;
}

bool ZipReader::read(char* to, std::size_t size, std::size_t& got) {
    got = 0;
    if (!is_open_) return true;  // its end has been seen
    const int count = unzReadCurrentFile(archive_, to, static_cast<unsigned>(std::min(size, most_at_once)));
    if (count < 0) return false;
    got = static_cast<std::size_t>(count);
    if (count > 0 || size == 0) return true;
    const bool whole = unzeof(archive_) == 1;
    is_open_ = false;
    return unzCloseCurrentFile(archive_) == UNZ_OK && whole;
}

}  // namespace crumple::io
