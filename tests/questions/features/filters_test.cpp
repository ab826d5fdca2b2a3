// The filters of pairs of features, by every table of kernels: what they reject is apart, and they reject most of that.

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "base/float_environment.h"
#include "questions/features/cpu/kernels.h"
#include "questions/features/feature_cases.h"

namespace crumple {
namespace {

const std::vector<const cpu::FeatureTables*>& tables() {
    static const auto all = cpu::all_feature_kernels();
    return all;
}

/// Cases with one kind, one number of moments and one distance, as kernels read them.
class Rows {
   public:
    Rows(std::span<const FeatureCase> cases, bool float32) : ends_(4 * static_cast<std::int64_t>(cases.size())) {
        const auto moments = static_cast<std::size_t>(cases.front().moments), points = 4 * cases.size();
        auto& rows = rows_;
        rows.resize(4 * moments * points);
        for (std::size_t i = 0; i < points; ++i)
            for (std::size_t m = 0; m < moments; ++m) {
                const MovingPoint& p = cases[i / 4].point[i % 4];
                for (int axis = 0; axis < 3; ++axis)
                    rows[4 * (m * points + i) + static_cast<std::size_t>(axis)] = (m ? p.end : p.start)[axis];
            }
        if (float32) rows32_.assign(rows.begin(), rows.end());
    }

    PointRows points() const {
        return rows32_.empty() ? PointRows{nullptr, rows_.data()} : PointRows{rows32_.data(), nullptr};
    }
    std::int64_t ends() const { return ends_; }

    /// Of each case whether the table keeps it.
    std::vector<bool> kept(const cpu::FeatureTables& table, std::span<const FeatureCase> cases) const {
        const auto kind = static_cast<std::size_t>(cases.front().kind);
        const float distance = cases.front().distance;
        std::vector<FeatureTest> test;
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(cases.size()); ++i)
            test.push_back({{i, i}, {4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3}});
        const FlushToZero mode;
        const std::size_t left = cases.front().moments == 1
                                     ? table.at_rest.filter[kind](points(), ends_, distance, test.data(), test.size())
                                     : table.moving.filter[kind](points(), ends_, distance, test.data(), test.size());
        std::vector<bool> kept(cases.size(), false);
        for (std::size_t i = 0; i < left; ++i) kept[static_cast<std::size_t>(test[i].pair.a)] = true;
        return kept;
    }

   private:
    std::int64_t ends_;
    std::vector<double> rows_;
    std::vector<float> rows32_;
};

bool keeps(const cpu::FeatureTables& table, const FeatureCase& c, bool float32) {
    return Rows({&c, 1}, float32).kept(table, {&c, 1}).front();
}

constexpr FeatureKind kinds[] = {FeatureKind::vertex_face, FeatureKind::edge_edge};

class FeatureFilters : public testing::TestWithParam<Shape> {};
std::string name_of(const testing::TestParamInfo<Shape>& info) { return std::string(shape_name(info.param)); }
INSTANTIATE_TEST_SUITE_P(, FeatureFilters, testing::ValuesIn(all_shapes), name_of);

// Tables differ by fused operations only, so they may answer differently only next to a filter's edge.
TEST_P(FeatureFilters, RejectOnlyWhatIsApart) {
    int cases = 0, differ = 0;
    for (const bool float32 : {true, false})
        for (const FeatureKind kind : kinds)
            for (const int moments : {1, 2}) {
                RandomCases random(GetParam(), float32, 83);
                for (int i = 0; i < 400; ++i) {
                    const FeatureCase c = random(kind, moments);
                    std::size_t rejecting = 0;
                    for (const auto* table : tables()) rejecting += !keeps(*table, c, float32);
                    ASSERT_FALSE(rejecting > 0 && c.near()) << c << (float32 ? ", float32" : ", float64");
                    ++cases;
                    differ += rejecting > 0 && rejecting < tables().size();
                }
            }
    EXPECT_LE(differ, cases / 100);
}

}  // namespace
}  // namespace crumple
