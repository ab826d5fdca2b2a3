#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include "crumple/candidates.h"
#include "crumple/export.h"
#include "crumple/features.h"
#include "crumple/impacts.h"
#include "crumple/io.h"
#include "crumple/proximities.h"

namespace crumple::io {

/// Row of a list of candidates. Edges are identified by their vertices, and points are vertices, so lists can be
/// compared whatever the numbering of edges and points.
struct CandidateRow {
    CandidateKind kind = CandidateKind::vertex_face;
    BodyPair bodies{0, 0};  ///< bodies of the first and of the second feature
    /// Ids of both features, in the order of the kind's name. A vertex or a face has one id, an edge its two vertices,
    /// the lower one first. Of two features of the same type, the lesser one is first (by body, then by ids). Unused
    /// ids are 0.
    std::array<std::int32_t, 4> ids{};
    friend bool operator==(const CandidateRow&, const CandidateRow&) = default;
};

/// Row of a list of impacts or of near pairs; for impacts also pairs of triangles, with kind face_face.
struct FeatureRow : CandidateRow {
    double value = 0;   ///< impacts: time of contact; near pairs: squared distance
    bool flag = false;  ///< impacts: they touch at the start; near pairs: they touch
    friend bool operator==(const FeatureRow&, const FeatureRow&) = default;
};

/// List of impacts or of near pairs.
struct FeatureList {
    std::vector<FeatureRow> rows;
    bool has_bodies = false;  ///< rows have bodies; else there is a single mesh
};

/// List of candidates.
struct CandidateRows {
    std::vector<CandidateRow> rows;
    bool has_bodies = false;  ///< as in FeatureList
};

/// Converts a result to a list, in the same order. Throws Error (invalid_argument) if the sizes of the result's arrays
/// are inconsistent.
/// @{
CRUMPLE_API FeatureList list_of(const Impacts& impacts);
CRUMPLE_API FeatureList list_of(const Proximities& nearby);
CRUMPLE_API CandidateRows list_of(const Candidates& candidates);
/// @}

/// Writes impacts in the order of the result, as txt, csv, json or npz.
///
///     txt   vf V F TOI START, ee A B C D TOI START, ve V A B TOI START, vv V A TOI START: a line each, points and
///           edges by their vertices, START 0 or 1
///     csv   the same in the columns kind,vertex,face,a,b,c,d,toi,start, of which those of the other kinds stay empty
///     json  vertex_faces, vertex_face_toi, vertex_face_start; edges, edge_edges (by index into edges), edge_edge_toi,
///           edge_edge_start; the same of vertex_edges and vertex_vertices; earliest, an object or null; statistics
///     npz   the same arrays, without earliest and statistics
///
/// If pairs of triangles are listed, they are lines ff F G TOI START, and arrays face_faces, face_face_toi and
/// face_face_start. A result of several bodies has ids `body:id` in txt and csv; json and npz have also
/// vertex_face_bodies and so on, and first_edge. Numbers are the shortest decimals that are read back as the same
/// float64. Throws crumple::Error (file, invalid_argument), and then leaves an existing file unchanged.
CRUMPLE_API void write_impacts(const std::filesystem::path& path, const Impacts& impacts,
                               PairFormat format = PairFormat::automatic);

/// Writes to a stream; `automatic` is txt.
CRUMPLE_API void write_impacts(std::ostream& out, const Impacts& impacts, PairFormat format = PairFormat::automatic);

/// Writes only the pairs of triangles, in the same format.
CRUMPLE_API void write_triangle_pairs(const std::filesystem::path& path, const Impacts& impacts,
                                      PairFormat format = PairFormat::automatic);

/// Writes to a stream; `automatic` is txt.
CRUMPLE_API void write_triangle_pairs(std::ostream& out, const Impacts& impacts,
                                      PairFormat format = PairFormat::automatic);

/// Writes near pairs, in the format of write_impacts, with a squared distance instead of the time, and `touching`
/// instead of `start`; txt omits `touching`. A squared distance that overflows float64 is `inf`, in json null.
CRUMPLE_API void write_near(const std::filesystem::path& path, const Proximities& nearby,
                            PairFormat format = PairFormat::automatic);

/// Writes to a stream; `automatic` is txt.
CRUMPLE_API void write_near(std::ostream& out, const Proximities& nearby, PairFormat format = PairFormat::automatic);

/// Writes candidates of the requested kinds, in the format of write_impacts without numbers and flags.
///
///     txt   vf V F, ee A B C D, ef A B F, ff F G, ve V A B, vv V W: a line each
///     csv   kind,vertex,face,a,b,c,d
///     json  vertex_faces, edge_edges, edge_faces, face_faces, vertex_edges, vertex_vertices; edges; statistics
///     npz   the same arrays, without statistics
CRUMPLE_API void write_candidates(const std::filesystem::path& path, const Candidates& candidates,
                                  PairFormat format = PairFormat::automatic);

/// Writes to a stream; `automatic` is txt.
CRUMPLE_API void write_candidates(std::ostream& out, const Candidates& candidates,
                                  PairFormat format = PairFormat::automatic);

/// Kind of results that a FeatureWriter writes.
enum class ListKind : std::uint8_t { impacts, near, candidates };

/// Writes results block by block (Detector::stream, of a single mesh or of one world), as .txt or .csv. The file is the
/// same as write_impacts, write_near or write_candidates writes for all blocks.
class CRUMPLE_API FeatureWriter {
   public:
    /// Throws crumple::Error (file; invalid_argument for other formats).
    explicit FeatureWriter(const std::filesystem::path& path, ListKind of, PairFormat format = PairFormat::automatic);
    /// Writes to a stream; `automatic` is txt.
    explicit FeatureWriter(std::ostream& out, ListKind of, PairFormat format = PairFormat::automatic);
    ~FeatureWriter();
    FeatureWriter(FeatureWriter&&) noexcept;
    FeatureWriter& operator=(FeatureWriter&&) noexcept;

    /// Writes a block. Throws crumple::Error: file, as commit() does; invalid_argument for a block of another kind.
    /// @{
    void add(const Impacts& block);
    void add(const Proximities& block);
    void add(const Candidates& block);
    /// @}
    /// Completes the file after the last block. Without this call an existing file stays unchanged.
    void commit();

   private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// Reads a list of impacts, in the file's order. By extension: .csv, .json and .npz as write_impacts writes them; any
/// other file is text, where blank lines and comments (#) are skipped. If START is missing, it is set for a time of 0.
/// The order of two edges, and of an edge's vertices, does not matter. Throws crumple::Error (file, format) that names
/// the place: invalid ids, an edge that names a vertex twice, times outside of [0, 1].
CRUMPLE_API FeatureList read_impacts(const std::filesystem::path& path);

/// Reads impacts from a stream, to its end. Uses `name` for the file in messages, and its extension to detect the
/// format.
CRUMPLE_API FeatureList read_impacts(std::istream& in, const std::string& name);

/// Reads near pairs, as read_impacts does; squared distances are 0 or more.
CRUMPLE_API FeatureList read_near(const std::filesystem::path& path);

/// Reads near pairs from a stream, to its end.
CRUMPLE_API FeatureList read_near(std::istream& in, const std::string& name);

/// Reads candidates of all kinds, as read_impacts does.
CRUMPLE_API CandidateRows read_candidates(const std::filesystem::path& path);

/// Reads candidates from a stream, to its end.
CRUMPLE_API CandidateRows read_candidates(std::istream& in, const std::string& name);

/// Writes the mesh at the start as .glb. Triangles in an impact, by their face, edge or vertex, are coloured by their
/// first time of contact, from dark red at the start to pale yellow at the end; the others are grey. Throws as
/// write_coloured does for collisions.
CRUMPLE_API void write_coloured(const std::filesystem::path& path, const TriangleMesh& start, const Impacts& impacts);

/// Writes to a stream.
CRUMPLE_API void write_coloured(std::ostream& out, const TriangleMesh& start, const Impacts& impacts);

/// Writes a mesh, and `second` (body 1) unless it is null. Each triangle in a near pair, by its face, edge or vertex,
/// is coloured by its least distance, on a scale from 0 to the largest distance listed; the others are grey.
CRUMPLE_API void write_coloured(const std::filesystem::path& path, const TriangleMesh& mesh, const TriangleMesh* second,
                                const Proximities& nearby);

/// Writes to a stream.
CRUMPLE_API void write_coloured(std::ostream& out, const TriangleMesh& mesh, const TriangleMesh* second,
                                const Proximities& nearby);

}  // namespace crumple::io
