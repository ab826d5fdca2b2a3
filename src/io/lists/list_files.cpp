#include "io/lists/list_files.h"

#include "base/float_environment.h"
#include "io/formats.h"

namespace crumple::io {
namespace {

void write_as(std::ostream& out, const ListTable& list, PairFormat format) {
    if (format == PairFormat::json) return write_list_json(out, list.members());
    if (format == PairFormat::npz) return write_list_npz(out, list.members());
    RowWriter writer(out, list.rows, format == PairFormat::csv);
    writer.write_heading();
    list.add_rows(writer);
}

PairFormat block_format(std::string_view what, PairFormat format, PairFormat automatic) {
    if (format == PairFormat::automatic) format = automatic;
    if (format == PairFormat::csv || format == PairFormat::txt) return format;
    throw Error(ErrorCode::invalid_argument, std::string(what) + " are written block by block as .txt or .csv");
}

[[noreturn]] void fail_to_write(std::string_view what) {
    throw Error(ErrorCode::file, "cannot write " + std::string(what) + " to the stream");
}

}  // namespace

PairFormat pair_format_of(std::string_view extension) {
    if (extension == ".txt") return PairFormat::txt;
    if (extension == ".csv") return PairFormat::csv;
    if (extension == ".json") return PairFormat::json;
    if (extension == ".npz") return PairFormat::npz;
    return PairFormat::automatic;
}

void write_list(const std::filesystem::path& path, const ListTable& list, PairFormat format) {
    const FloatEnvironment environment;
    if (format == PairFormat::automatic) format = pair_format_of(extension_of(path));
    if (format == PairFormat::automatic)
        throw Error(ErrorCode::invalid_argument, "cannot write " + path.string() + ": " + std::string(list.what) +
                                                     " are written as .txt, .csv, .json or .npz");
    AtomicFile file(path);
    write_as(file.stream(), list, format);
    file.commit();
}

void write_list(std::ostream& out, const ListTable& list, PairFormat format) {
    const FloatEnvironment environment;
    write_as(out, list, format);
    if (!out.flush()) fail_to_write(list.what);
}

ListWriter::ListWriter(std::string_view what, const RowTable& rows, const std::filesystem::path& path,
                       PairFormat format)
    : what_(what),
      format_(block_format(what, format, pair_format_of(extension_of(path)))),
      file_(path),
      out_(&file_->stream()) {
    RowWriter(*out_, rows, format_ == PairFormat::csv).write_heading();
}

ListWriter::ListWriter(std::string_view what, const RowTable& rows, std::ostream& out, PairFormat format)
    : what_(what), format_(block_format(what, format, PairFormat::txt)), out_(&out) {
    RowWriter(*out_, rows, format_ == PairFormat::csv).write_heading();
}

void ListWriter::add(const ListTable& block) {
    {
        const FloatEnvironment environment;
        RowWriter writer(*out_, block.rows, format_ == PairFormat::csv);
        block.add_rows(writer);
    }
    if (*out_) return;
    if (file_) file_->complete();  // throws an Error that states the reason
    fail_to_write(what_);
}

void ListWriter::commit() {
    if (file_) return file_->commit();
    if (!out_->flush()) fail_to_write(what_);
}

void read_list(const Source& source, const ListReader& reader) {
    const FloatEnvironment environment;
    const std::string extension = extension_of(source.name());
    try {
        if (extension == ".csv") return read_csv_rows(source, reader.rows, reader.consume_row);
        if (extension == ".json") return reader.consume_arrays(read_list_json(source, reader.arrays));
        if (extension == ".npz") return reader.consume_arrays(read_list_npz(source, reader.arrays));
        if (extension == ".npy" && reader.reads_npy)
            return reader.consume_arrays(read_list_npy(source, reader.arrays[0]));
        read_txt_rows(source, reader.rows, reader.consume_row);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::file, "cannot read " + source.name() + ": its rows do not fit in memory");
    }
}

}  // namespace crumple::io
