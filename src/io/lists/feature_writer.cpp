// Impacts, near pairs and candidates as text and CSV, block by block.

#include <optional>

#include "base/float_environment.h"
#include "io/bytes/atomic_file.h"
#include "io/bytes/sink.h"
#include "io/formats.h"
#include "io/lists/feature_list_view.h"

namespace crumple::io {
namespace {

const FeatureWords& words_of(ListKind of) {
    return of == ListKind::impacts ? impact_words : of == ListKind::near ? near_words : candidate_words;
}

}  // namespace

struct FeatureWriter::Implementation {
    std::optional<AtomicFile> file;
    std::ostream* out = nullptr;
    ListKind of;
    bool csv;

    Implementation(ListKind blocks, PairFormat format) : of(blocks), csv(format == PairFormat::csv) {
        if (format != PairFormat::csv && format != PairFormat::txt)
            fail(ErrorCode::invalid_argument, " are written block by block as .txt or .csv");
    }
    [[noreturn]] void fail(ErrorCode code, const char* what, const char* before = "") const {
        throw Error(code, before + std::string(words_of(of).what) + what);
    }
    void begin() const {
        const FloatEnvironment environment;
        Sink sink(*out);
        if (csv) begin_csv(sink, words_of(of));
    }
    template <class Block>
    void add(const Block& block, ListKind blocks) {
        const FloatEnvironment environment;
        if (blocks != of) fail(ErrorCode::invalid_argument, " were announced, but a block is of another answer");
        const FeatureAnswer answer = view(block);
        {
            Sink sink(*out);
            csv ? add_csv(sink, answer) : add_txt(sink, answer);
        }
        if (*out) return;
        if (file) file->complete();  // says why not
        fail(ErrorCode::file, " to the stream", "cannot write ");
    }
};

FeatureWriter::FeatureWriter(const std::filesystem::path& path, ListKind of, PairFormat format)
    : implementation_(std::make_unique<Implementation>(
          of, format == PairFormat::automatic ? pair_format_of(extension_of(path)) : format)) {
    implementation_->out = &implementation_->file.emplace(path).stream();
    implementation_->begin();
}

FeatureWriter::FeatureWriter(std::ostream& out, ListKind of, PairFormat format)
    : implementation_(
          std::make_unique<Implementation>(of, format == PairFormat::automatic ? PairFormat::txt : format)) {
    implementation_->out = &out;
    implementation_->begin();
}

FeatureWriter::~FeatureWriter() = default;
FeatureWriter::FeatureWriter(FeatureWriter&&) noexcept = default;
FeatureWriter& FeatureWriter::operator=(FeatureWriter&&) noexcept = default;

void FeatureWriter::add(const Impacts& block) { implementation_->add(block, ListKind::impacts); }
void FeatureWriter::add(const Proximities& block) { implementation_->add(block, ListKind::near); }
void FeatureWriter::add(const Candidates& block) { implementation_->add(block, ListKind::candidates); }

void FeatureWriter::commit() {
    Implementation& to = *implementation_;
    if (to.file) return to.file->commit();
    if (!to.out->flush()) to.fail(ErrorCode::file, " to the stream", "cannot write ");
}

}  // namespace crumple::io
