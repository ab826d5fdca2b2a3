// Writes impacts, near pairs and candidates to files, at once or block by block.

#include "crumple/error.h"
#include "io/lists/feature_tables.h"

namespace crumple::io {

void write_impacts(std::ostream& out, const Impacts& impacts, PairFormat format) {
    write_list(out, table_of(impacts), format);
}
void write_impacts(const std::filesystem::path& path, const Impacts& impacts, PairFormat format) {
    write_list(path, table_of(impacts), format);
}

void write_triangle_pairs(std::ostream& out, const Impacts& impacts, PairFormat format) {
    write_list(out, table_of_triangle_pairs(impacts), format);
}
void write_triangle_pairs(const std::filesystem::path& path, const Impacts& impacts, PairFormat format) {
    write_list(path, table_of_triangle_pairs(impacts), format);
}

void write_near(std::ostream& out, const Proximities& nearby, PairFormat format) {
    write_list(out, table_of(nearby), format);
}
void write_near(const std::filesystem::path& path, const Proximities& nearby, PairFormat format) {
    write_list(path, table_of(nearby), format);
}

void write_candidates(std::ostream& out, const Candidates& candidates, PairFormat format) {
    write_list(out, table_of(candidates), format);
}
void write_candidates(const std::filesystem::path& path, const Candidates& candidates, PairFormat format) {
    write_list(path, table_of(candidates), format);
}

struct FeatureWriter::Implementation {
    ListKind kind;
    ListWriter writer;

    template <class To>
    Implementation(ListKind of, To& to, PairFormat format)
        : kind(of), writer(words_of(of).what, words_of(of).rows(), to, format) {}

    template <class Block>
    void add(const Block& block, ListKind of) {
        if (of != kind)
            throw Error(ErrorCode::invalid_argument,
                        std::string(words_of(kind).what) + " were announced, but a block has rows of another kind");
        writer.add(table_of(block));
    }
};

FeatureWriter::FeatureWriter(const std::filesystem::path& path, ListKind of, PairFormat format)
    : implementation_(std::make_unique<Implementation>(of, path, format)) {}
FeatureWriter::FeatureWriter(std::ostream& out, ListKind of, PairFormat format)
    : implementation_(std::make_unique<Implementation>(of, out, format)) {}
FeatureWriter::~FeatureWriter() = default;
FeatureWriter::FeatureWriter(FeatureWriter&&) noexcept = default;
FeatureWriter& FeatureWriter::operator=(FeatureWriter&&) noexcept = default;

void FeatureWriter::add(const Impacts& block) { implementation_->add(block, ListKind::impacts); }
void FeatureWriter::add(const Proximities& block) { implementation_->add(block, ListKind::near); }
void FeatureWriter::add(const Candidates& block) { implementation_->add(block, ListKind::candidates); }
void FeatureWriter::commit() { implementation_->writer.commit(); }

}  // namespace crumple::io
