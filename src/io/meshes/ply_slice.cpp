// Binary PLY of which every row has its place: no lists but the corners of faces, three each. Each reader checks that
// in the faces that it reads; where one has another number, all rows behind it lie elsewhere, and nothing is read.

#include "io/meshes/ply_slice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "io/bytes/bytes.h"
#include "io/formats.h"
#include "io/meshes/ply_header.h"

namespace crumple::io {
namespace {

std::int64_t size_of(PlyType type) {
    return with_type(type, [](auto zero) { return static_cast<std::int64_t>(sizeof zero); });
}

std::int64_t integer_at(const char* p, PlyType type, std::endian order) {
    return with_type(type, [&](auto zero) { return static_cast<std::int64_t>(load<decltype(zero)>(p, order)); });
}

template <class Scalar>
Scalar real_at(const char* p, PlyType type, std::endian order) {
    return with_type(type, [&](auto zero) { return static_cast<Scalar>(load<decltype(zero)>(p, order)); });
}

/// Where an element's rows are, and where a property is in its row.
struct Rows {
    const PlyElement* element = nullptr;
    std::int64_t begin = 0, row_bytes = 0;

    std::int64_t place_of(const PlyProperty* wanted) const {
        std::int64_t place = 0;
        for (const PlyProperty& property : element->properties) {
            if (&property == wanted) break;
            place += bytes_of(property);
        }
        return place;
    }
    static std::int64_t bytes_of(const PlyProperty& property) {
        const std::int64_t one = size_of(property.type);
        return property.count_type ? size_of(*property.count_type) + 3 * one : one;
    }
};

class PlySliceReader {
   public:
    PlySliceReader(const RowFile& file, const ReadOptions& options, int reader, int readers)
        : file_(file), options_(options), reader_(reader), readers_(readers) {}

    /// Whether the header is one of a file that is read by slices. Throws Error where it makes no sense.
    bool understand(const Source& beginning) {
        header_ = read_ply_header(beginning);
        if (header_.encoding == PlyEncoding::ascii) return false;
        order_ = header_.encoding == PlyEncoding::big_endian ? std::endian::big : std::endian::little;
        const PlyElement* const vertex = header_.find(beginning, "vertex");
        const PlyElement* const face = header_.find(beginning, "face");
        if (!vertex || !face) return false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            xyz_[axis] = vertex->find(beginning, {std::array{"x", "y", "z"}[axis]});
            if (!xyz_[axis]) return false;
        }
        corners_ = face->find(beginning, {"vertex_indices", "vertex_index"});
        if (!corners_ || !corners_->count_type || !is_integer(corners_->type)) return false;
        if (!options_.group_property.empty()) {
            group_ = face->find(beginning, {options_.group_property});
            if (!group_ || group_->count_type || !is_integer(group_->type)) return false;
        }
        return find_rows(header_.body - beginning.begin(), *vertex, *face) && face->count > 0;
    }

    std::optional<MeshSlice> read() {
        MeshSlice slice;
        slice.triangles = {faces_.element->count, readers_};
        slice.vertices = {vertices_.element->count, readers_};
        if (std::max(slice.triangles.rows, slice.vertices.rows) > INT32_MAX)
            throw Error(ErrorCode::format, file_.name() + ": more vertices or triangles than 32-bit ids can name");
        slice.weld = options_.weld == Weld::yes;
        const bool single =
            std::all_of(xyz_.begin(), xyz_.end(), [](const PlyProperty* p) { return p->type == PlyType::float32; });
        slice.mesh =
            in_precision(options_.precision, single ? ScalarType::float32 : ScalarType::float64, [&](auto zero) {
                return TriangleMesh{read_vertices<decltype(zero)>(slice.vertices), {}};
            });
        if (!read_faces(slice.triangles, slice.vertices.rows, slice.mesh)) return std::nullopt;
        return slice;
    }

   private:
    /// Whether all rows have a length, and the file is as long as all together.
    bool find_rows(std::int64_t begin, const PlyElement& vertex, const PlyElement& face) {
        for (const PlyElement& element : header_.elements) {
            Rows rows{&element, begin, 0};
            for (const PlyProperty& property : element.properties) {
                if (property.count_type && &property != corners_) return false;
                rows.row_bytes += Rows::bytes_of(property);
            }
            if (element.name == "tristrips" && element.count > 0) return false;
            if (rows.row_bytes > 0 && element.count > (file_.size() - begin) / rows.row_bytes) return false;
            begin += element.count * rows.row_bytes;
            if (&element == &vertex) vertices_ = rows;
            if (&element == &face) faces_ = rows;
        }
        return begin == file_.size();
    }

    template <class Scalar>
    std::vector<Scalar> read_vertices(const Blocks& blocks) const {
        struct Coordinate {
            std::int64_t place;
            std::size_t axis;
        };
        std::array<Coordinate, 3> coordinates{};  // in the order of the row, so that the first bad one is told
        for (std::size_t axis = 0; axis < 3; ++axis) coordinates[axis] = {vertices_.place_of(xyz_[axis]), axis};
        std::sort(coordinates.begin(), coordinates.end(),
                  [](const Coordinate& a, const Coordinate& b) { return a.place < b.place; });
        std::vector<Scalar> xyz(3 * static_cast<std::size_t>(blocks.size(reader_)));
        Scalar* vertex = xyz.data();
        const auto read_row = [&](const char* row, std::int64_t byte) {
            for (const auto [place, axis] : coordinates) {
                vertex[axis] = real_at<Scalar>(row + place, xyz_[axis]->type, order_);
                if (!std::isfinite(vertex[axis]))
                    file_.fail_at(byte + place, std::is_same_v<Scalar, float> ? "a coordinate is not a finite float32"
                                                                              : "a coordinate is not finite");
            }
            vertex += 3;
            return true;
        };
        file_.for_each(vertices_.begin + blocks.begin(reader_) * vertices_.row_bytes, vertices_.row_bytes,
                       blocks.size(reader_), read_row);
        return xyz;
    }

    /// False at a face that has not three corners, unless no reader would take it.
    bool read_faces(const Blocks& blocks, std::int64_t vertex_count, TriangleMesh& mesh) const {
        const auto count = static_cast<std::size_t>(blocks.size(reader_));
        const std::int64_t place = faces_.place_of(corners_), first = place + size_of(*corners_->count_type);
        const std::int64_t group_place = group_ ? faces_.place_of(group_) : 0, step = size_of(corners_->type);
        mesh.triangles.reserve(3 * count);
        if (group_) mesh.groups.reserve(count);
        const auto read_group = [&](const char* row, std::int64_t byte) {
            const std::int64_t group = integer_at(row + group_place, group_->type, order_);
            if (group != static_cast<std::int32_t>(group))
                file_.fail_at(byte + group_place, "a group does not fit in 32 bits");
            mesh.groups.push_back(static_cast<std::int32_t>(group));
        };
        return file_.for_each(faces_.begin + blocks.begin(reader_) * faces_.row_bytes, faces_.row_bytes,
                              blocks.size(reader_), [&](const char* row, std::int64_t byte) {
                                  if (group_ && group_place < place) read_group(row, byte);
                                  const std::int64_t corners = integer_at(row + place, *corners_->count_type, order_);
                                  if (corners != 3) return false;
                                  for (std::int64_t at = first; at < first + 3 * step; at += step) {
                                      const std::int64_t index = integer_at(row + at, corners_->type, order_);
                                      if (index < 0 || index >= vertex_count)
                                          file_.fail_at(byte + at, "a face names vertex " + std::to_string(index) +
                                                                       " of " + std::to_string(vertex_count));
                                      mesh.triangles.push_back(static_cast<std::int32_t>(index));
                                  }
                                  if (group_ && group_place > place) read_group(row, byte);
                                  return true;
                              });
    }

    const RowFile& file_;
    const ReadOptions& options_;
    int reader_, readers_;
    PlyHeader header_;
    std::endian order_ = std::endian::little;
    std::array<const PlyProperty*, 3> xyz_{};
    const PlyProperty *corners_ = nullptr, *group_ = nullptr;
    Rows vertices_, faces_;
};

}  // namespace

std::optional<MeshSlice> read_ply_slice(const RowFile& file, const Source& beginning, const ReadOptions& options,
                                        int reader, int readers) {
    PlySliceReader slice(file, options, reader, readers);
    try {
        if (!slice.understand(beginning)) return std::nullopt;
    } catch (const Error&) {
        return std::nullopt;  // who reads the whole file tells
    }
    return slice.read();
}

}  // namespace crumple::io
