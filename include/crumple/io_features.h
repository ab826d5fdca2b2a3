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

/// A row of a list of candidates. Edges are named by their vertices, and points are vertices, so that lists can be
/// compared whoever has numbered edges and points.
struct CandidateRow {
    CandidateKind kind = CandidateKind::vertex_face;
    BodyPair bodies{0, 0};  ///< of the first and of the second feature
    /// Vertex, face; both edges, the lesser first; an edge's vertices, face; both faces, the lesser first; vertex,
    /// edge; both vertices, the lesser first. Of an edge the lower vertex is first. The rest is 0.
    std::array<std::int32_t, 4> ids{};
    friend bool operator==(const CandidateRow&, const CandidateRow&) = default;
};

/// A row of a list of impacts, or of near pairs; of impacts also pairs of triangles, of the kind face_face.
struct FeatureRow : CandidateRow {
    double value = 0;   ///< time of contact; squared distance
    bool flag = false;  ///< they touch at the start; they touch
    friend bool operator==(const FeatureRow&, const FeatureRow&) = default;
};

struct FeatureList {
    std::vector<FeatureRow> rows;
    bool has_bodies = false;  ///< features have numbers of bodies, too; else there is one mesh
};

struct CandidateRows {
    std::vector<CandidateRow> rows;
    bool has_bodies = false;  ///< as in FeatureList
};

/// The answer as a list, in its order. Throws Error (invalid_argument) unless its arrays fit together.
CRUMPLE_API FeatureList list_of(const Impacts& impacts);
CRUMPLE_API FeatureList list_of(const Proximities& nearby);
CRUMPLE_API CandidateRows list_of(const Candidates& candidates);

/// Writes impacts in the order of the answer, as txt, csv, json or npz.
///
///     txt   vf V F TOI START, ee A B C D TOI START, ve V A B TOI START, vv V A TOI START: a line each, points and
///           edges by their vertices, START 0 or 1
///     csv   the same in the columns kind,vertex,face,a,b,c,d,toi,start, of which those of the other kinds stay empty
///     json  vertex_faces, vertex_face_toi, vertex_face_start; edges, edge_edges (by index into edges), edge_edge_toi,
///           edge_edge_start; the same of vertex_edges and vertex_vertices; earliest, an object or null; statistics
///     npz   the same arrays, without earliest and statistics
///
/// Where pairs of triangles are listed, they are lines ff F G TOI START, and arrays face_faces, face_face_toi and
/// face_face_start. An answer of several bodies has ids `body:id` in txt and csv; json and npz have also
/// vertex_face_bodies and so on, and first_edge. Numbers are the shortest decimals that give the same float64 back.
/// Throws crumple::Error (file, invalid_argument); the file then stays as it was.
CRUMPLE_API void write_impacts(const std::filesystem::path& path, const Impacts& impacts,
                               PairFormat format = PairFormat::automatic);

/// The same to a stream; `automatic` is txt.
CRUMPLE_API void write_impacts(std::ostream& out, const Impacts& impacts, PairFormat format = PairFormat::automatic);

/// Writes pairs of triangles alone, in the same way.
CRUMPLE_API void write_triangle_pairs(const std::filesystem::path& path, const Impacts& impacts,
                                      PairFormat format = PairFormat::automatic);

/// The same to a stream; `automatic` is txt.
CRUMPLE_API void write_triangle_pairs(std::ostream& out, const Impacts& impacts,
                                      PairFormat format = PairFormat::automatic);

/// The same of near pairs: a squared distance in place of the time, and `touching` in place of `start`, which txt does
/// without. A squared distance beyond float64 is `inf`, in json null.
CRUMPLE_API void write_near(const std::filesystem::path& path, const Proximities& nearby,
                            PairFormat format = PairFormat::automatic);

/// The same to a stream; `automatic` is txt.
CRUMPLE_API void write_near(std::ostream& out, const Proximities& nearby, PairFormat format = PairFormat::automatic);

/// The same of candidates, which have neither a number nor a flag; of those kinds that are listed.
///
///     txt   vf V F, ee A B C D, ef A B F, ff F G, ve V A B, vv V W: a line each
///     csv   kind,vertex,face,a,b,c,d
///     json  vertex_faces, edge_edges, edge_faces, face_faces, vertex_edges, vertex_vertices; edges; statistics
///     npz   the same arrays, without statistics
CRUMPLE_API void write_candidates(const std::filesystem::path& path, const Candidates& candidates,
                                  PairFormat format = PairFormat::automatic);

/// The same to a stream; `automatic` is txt.
CRUMPLE_API void write_candidates(std::ostream& out, const Candidates& candidates,
                                  PairFormat format = PairFormat::automatic);

/// Which answers a FeatureWriter writes.
enum class ListKind : std::uint8_t { impacts, near, candidates };

/// Results written block by block (Detector::stream, in order, of a single mesh or of one world),
/// as .txt or .csv; together they are what write_impacts, write_near or write_candidates writes.
class CRUMPLE_API FeatureWriter {
   public:
    /// Throws crumple::Error (file; invalid_argument for other formats).
    explicit FeatureWriter(const std::filesystem::path& path, ListKind of, PairFormat format = PairFormat::automatic);
    /// To a stream; `automatic` is txt.
    explicit FeatureWriter(std::ostream& out, ListKind of, PairFormat format = PairFormat::automatic);
    ~FeatureWriter();
    FeatureWriter(FeatureWriter&&) noexcept;
    FeatureWriter& operator=(FeatureWriter&&) noexcept;

    /// Throws crumple::Error (file, also at commit(); invalid_argument for a block of another answer).
    void add(const Impacts& block);
    void add(const Proximities& block);
    void add(const Candidates& block);
    /// After the last block: the file is there. Without it, what was at the path stays as it was.
    void commit();

   private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// Reads a list of impacts, in the file's order: .csv, .json and .npz as write_impacts has them, by extension; any
/// other is text, where blank lines and comments (#) are skipped. START may be missing: then a time of 0 is one. Which
/// of two edges, and which of an edge's vertices, comes first does not matter. Throws crumple::Error (file, format)
/// that names the place: ids that are none, an edge that names a vertex twice, times that do not lie in [0, 1].
CRUMPLE_API FeatureList read_impacts(const std::filesystem::path& path);

/// The same of a stream, to its end. `name` stands in messages, and its extension for the file's.
CRUMPLE_API FeatureList read_impacts(std::istream& in, const std::string& name);

/// The same of near pairs; squared distances are 0 or more.
CRUMPLE_API FeatureList read_near(const std::filesystem::path& path);

/// The same of a stream, to its end.
CRUMPLE_API FeatureList read_near(std::istream& in, const std::string& name);

/// The same of candidates, of whatever kinds are there.
CRUMPLE_API CandidateRows read_candidates(const std::filesystem::path& path);

/// The same of a stream, to its end.
CRUMPLE_API CandidateRows read_candidates(std::istream& in, const std::string& name);

/// Writes the mesh at the start as .glb. Triangles that are hit, or whose vertex or edge is, are coloured by their
/// first time of contact, from dark red at the start to pale yellow at the end; the others are grey. Throws as
/// write_coloured does for collisions.
CRUMPLE_API void write_coloured(const std::filesystem::path& path, const TriangleMesh& start, const Impacts& impacts);

/// The same to a stream.
CRUMPLE_API void write_coloured(std::ostream& out, const TriangleMesh& start, const Impacts& impacts);

/// The same by the least distance, from 0 to the largest one listed. `second`, which may be null, is body 1.
CRUMPLE_API void write_coloured(const std::filesystem::path& path, const TriangleMesh& mesh, const TriangleMesh* second,
                                const Proximities& nearby);

/// The same to a stream.
CRUMPLE_API void write_coloured(std::ostream& out, const TriangleMesh& mesh, const TriangleMesh* second,
                                const Proximities& nearby);

}  // namespace crumple::io
