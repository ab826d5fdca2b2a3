#include "io/lists/overlap_lists.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <unordered_map>
#include <utility>

#include "crumple/error.h"
#include "io/bytes/json.h"
#include "io/formats.h"
#include "io/lists/list_files.h"

namespace crumple::io {
namespace {

constexpr std::array<std::string_view, 6> relation_names{"touching",      "overlapping", "first_inside",
                                                         "second_inside", "equal",       "undefined"};

/// Calls use(quantity, index of its first number among the numbers of a row) for each quantity.
template <class Use>
void for_each_quantity(std::span<const OverlapQuantity> quantities, Use use) {
    std::size_t place = 0;
    for (const OverlapQuantity& quantity : quantities) {
        use(quantity, place);
        place += quantity.width;
    }
}

RowTable overlap_rows(bool has_configurations, bool has_numbers) {
    RowTable table{{}, {{"", {}}}};
    const auto add = [&](std::string column, FieldType type, std::string_view noun, bool may_be_nan = false) {
        table.sections[0].fields.push_back({type, table.columns.size(), noun, true, may_be_nan});
        table.columns.push_back(std::move(column));
    };
    if (has_configurations) add("configuration", FieldType::id, "configuration");
    add("first", FieldType::word, "body");
    add("second", FieldType::word, "body");
    add("relation", FieldType::word, "relation");
    if (!has_numbers) return table;
    for_each_quantity(overlap_quantities, [&](const OverlapQuantity& quantity, std::size_t) {
        for (std::size_t k = 0; k < quantity.width; ++k) {
            const std::string axis = quantity.width > 1 ? std::string("_") + "xyz"[k] : "";
            add(std::string(quantity.name) + axis, FieldType::number, "number", quantity.may_be_nan);
        }
    });
    return table;
}

const ListArray configuration_array{"configuration", NumberType::int32, 1, {"configuration"}};
const ListArray bodies_array{"bodies", NumberType::int32, 2, {"body", "body"}};
const ListArray relation_array{"relation", NumberType::uint8};
const ListArray region_rows_array{"region_rows", NumberType::int32, 1, {"row"}};

/// Describes an array of numbers that may be NaN.
ListArray numbers_array(const char* name, std::size_t width = 1) {
    ListArray array{name, NumberType::float64, width};
    array.may_be_nan = true;
    return array;
}
const ListArray depth_tolerance_array = numbers_array("depth_tolerance"),
                depth_reached_array = numbers_array("depth_reached"), depth_bound_array = numbers_array("depth_bound"),
                directions_array = numbers_array("directions", 3), withdrawals_array = numbers_array("withdrawals"),
                first_free_array = numbers_array("first_free");

ListArray array_of(const OverlapQuantity& quantity) {
    ListArray array{std::string(quantity.name), NumberType::float64, quantity.width};
    array.may_be_nan = quantity.may_be_nan;
    return array;
}

/// Returns an array filled with what numbers_of(row) returns for each row: `array.width` numbers.
template <class Row, class NumbersOf>
ListMember member_of(ListArray array, const std::vector<Row>& rows, NumbersOf numbers_of) {
    using Number = std::remove_cvref_t<decltype(numbers_of(rows[0])[0])>;
    const auto own = std::make_shared<std::vector<Number>>();
    own->reserve(rows.size() * array.width);
    for (const Row& row : rows) {
        const auto& numbers = numbers_of(row);
        own->insert(own->end(), numbers.begin(), numbers.end());
    }
    ListMember member{std::move(array), own->data(), rows.size()};
    member.owner = own;
    return member;
}

/// Adds regions, depths and withdrawals, if the list has them.
void add_parts(const OverlapList& list, std::vector<ListMember>& members) {
    const auto add = [&](bool requested, const ListArray& array, const std::vector<double>& numbers) {
        if (requested) members.push_back(ListMember{array, numbers.data(), numbers.size() / array.width});
    };
    const auto one = std::make_shared<double>(list.depth_tolerance);
    if (list.depth_tolerance > 0) {
        members.push_back(ListMember{depth_tolerance_array, one.get(), 1});
        members.back().owner = one;
    }
    add(list.depth_tolerance > 0, depth_reached_array, list.depth_reached);
    add(list.depth_tolerance > 0, depth_bound_array, list.depth_bound);
    add(!list.directions.empty(), directions_array, list.directions);
    add(!list.directions.empty(), withdrawals_array, list.withdrawals);
    add(list.has_first_free, first_free_array, list.first_free);
    if (!list.has_regions) return;
    members.push_back(member_of(region_rows_array, list.regions,
                                [](const OverlapListRegion& region) { return std::array{region.row}; }));
    for_each_quantity(region_quantities, [&](const OverlapQuantity& quantity, std::size_t place) {
        members.push_back(member_of(array_of(quantity), list.regions, [&](const OverlapListRegion& region) {
            return std::span(region.numbers).subspan(place, quantity.width);
        }));
    });
}

std::vector<ListMember> members_of(const OverlapList& list, const OverlapBodies& bodies, const Statistics& statistics) {
    const auto json_of_names = [&](Sink& sink) {
        nlohmann::json names = nlohmann::json::array();
        for (const std::string& name : bodies.names) names.push_back(valid_utf8(name));
        sink << names.dump();
    };
    const auto json_of_unit = [&](Sink& sink) {
        bodies.unit == Unit::unknown ? sink << "null" : sink << '"' << name_of(bodies.unit) << '"';
    };
    std::vector<ListMember> members{json_member("names", json_of_names), json_member("unit", json_of_unit)};
    if (list.has_configurations)
        members.push_back(member_of(configuration_array, list.rows,
                                    [](const OverlapListRow& row) { return std::array{row.configuration}; }));
    members.push_back(member_of(bodies_array, list.rows, [](const OverlapListRow& row) {
        return std::array{row.bodies.first, row.bodies.second};
    }));
    members.push_back(member_of(relation_array, list.rows, [](const OverlapListRow& row) {
        return std::array{static_cast<std::uint8_t>(row.relation)};
    }));
    for_each_quantity(overlap_quantities, [&](const OverlapQuantity& quantity, std::size_t place) {
        if (!list.has_numbers) return;
        members.push_back(member_of(array_of(quantity), list.rows, [&](const OverlapListRow& row) {
            return std::span(row.numbers).subspan(place, quantity.width);
        }));
    });
    add_parts(list, members);
    members.push_back(json_member("statistics", [&](Sink& sink) { sink << json_of(statistics); }));
    return members;
}

ListTable table_of(const OverlapList& list, const OverlapBodies& bodies, const Statistics& statistics) {
    const auto add_rows = [&](RowWriter& writer) {
        std::vector<ListValue> values;
        for (const OverlapListRow& row : list.rows) {
            values.clear();
            if (list.has_configurations) values.emplace_back(ListId{row.configuration});
            for (const std::int32_t body : {row.bodies.first, row.bodies.second})
                values.emplace_back(std::string_view(bodies.names[static_cast<std::size_t>(body)]));
            values.emplace_back(name_of(row.relation));
            if (list.has_numbers) values.insert(values.end(), row.numbers.begin(), row.numbers.end());
            writer.add(0, values);
        }
    };
    return {"overlaps", overlap_rows(list.has_configurations, list.has_numbers), add_rows,
            [&] { return members_of(list, bodies, statistics); }};
}

/// Reader of one list.
class OverlapReader {
   public:
    OverlapReader(const Source& source, std::span<const std::string> names, bool has_configurations)
        : source_(source), count_(names.size()) {
        list_.has_configurations = has_configurations;
        for (std::size_t b = 0; b < names.size(); ++b) bodies_.emplace(names[b], static_cast<std::int32_t>(b));
    }

    OverlapList read() {
        const std::string extension = extension_of(source_.name());
        if (extension != ".csv" && extension != ".json" && extension != ".npz")
            fail("lists of overlaps are read as .csv, .json or .npz");
        std::vector<ListArray> arrays{bodies_array, relation_array};
        if (list_.has_configurations) arrays.push_back(configuration_array);
        for (const OverlapQuantity& quantity : overlap_quantities) arrays.push_back(array_of(quantity));
        for (const OverlapQuantity& quantity : region_quantities) arrays.push_back(array_of(quantity));
        arrays.insert(arrays.end(), {region_rows_array, depth_tolerance_array, depth_reached_array, depth_bound_array,
                                     directions_array, withdrawals_array, first_free_array});
        RowTable rows = overlap_rows(list_.has_configurations, true);
        rows.may_lack = overlap_number_count;
        read_list(source_, {rows, [&](std::size_t, std::span<const ListValue> values) { return add(values); }, arrays,
                            [&](const NumbersByName& numbers) { add(numbers); }});
        return std::move(list_);
    }

   private:
    /// Adds the row that consists of these values of a .csv. If it is not valid, returns what is wrong with it.
    std::string add(std::span<const ListValue> values) {
        OverlapListRow row;
        if (list_.has_configurations) {
            row.configuration = std::get<ListId>(values[0]).index;
            values = values.subspan(1);
        }
        for (std::int32_t* const body : {&row.bodies.first, &row.bodies.second}) {
            const auto name = std::get<std::string_view>(values[body == &row.bodies.first ? 0 : 1]);
            const auto found = bodies_.find(std::string(name));
            if (found == bodies_.end()) return "there is no body " + in_quotes(name);
            *body = found->second;
        }
        const auto relation = std::get<std::string_view>(values[2]);
        const auto found = std::find(relation_names.begin(), relation_names.end(), relation);
        if (found == relation_names.end()) return in_quotes(relation) + " is not a relation of two bodies";
        row.relation = static_cast<OverlapRelation>(found - relation_names.begin());
        const std::span<const ListValue> numbers = values.subspan(3);
        if (!numbers.empty() && numbers.size() < overlap_number_count)
            return "after its relation a row must have all " + std::to_string(overlap_number_count) +
                   " numbers, or none";
        if (list_.rows.empty()) list_.has_numbers = !numbers.empty();
        if (list_.has_numbers == numbers.empty()) return "some rows have numbers and some do not";
        for (std::size_t i = 0; i < numbers.size(); ++i) row.numbers[i] = std::get<double>(numbers[i]);
        row.place = static_cast<std::int32_t>(list_.rows.size());
        list_.rows.push_back(row);
        return {};
    }

    void add(const NumbersByName& numbers) {
        const std::vector<std::int32_t>& bodies = need(numbers, bodies_array).ids;
        list_.rows.resize(bodies.size() / 2);
        const auto body = [&](std::size_t i) {
            if (static_cast<std::size_t>(bodies[i]) >= count_) fail_at(bodies_array, i / 2, "there is no such body");
            return bodies[i];
        };
        const std::vector<double>& relations = need(numbers, relation_array).numbers;
        for (std::size_t i = 0; i < list_.rows.size(); ++i) {
            list_.rows[i].place = static_cast<std::int32_t>(i);
            list_.rows[i].bodies = {body(2 * i), body(2 * i + 1)};
            const auto relation = std::find(all_relations.begin(), all_relations.end(), relations[i]);
            if (relation == all_relations.end()) fail_at(relation_array, i, "this is not a relation of two bodies");
            list_.rows[i].relation = static_cast<OverlapRelation>(relation - all_relations.begin());
        }
        if (list_.has_configurations) {
            const std::vector<std::int32_t>& configurations = need(numbers, configuration_array).ids;
            for (std::size_t i = 0; i < list_.rows.size(); ++i) list_.rows[i].configuration = configurations[i];
        }
        list_.has_numbers = std::any_of(overlap_quantities.begin(), overlap_quantities.end(),
                                        [&](const auto& quantity) { return numbers.contains(quantity.name); });
        for_each_quantity(overlap_quantities, [&](const OverlapQuantity& quantity, std::size_t place) {
            if (!list_.has_numbers) return;
            const std::vector<double>& values = need(numbers, array_of(quantity)).numbers;
            for (std::size_t i = 0; i < values.size(); ++i)
                list_.rows[i / quantity.width].numbers[place + i % quantity.width] = values[i];
        });
        if (numbers.contains(depth_tolerance_array.name)) add_depths(numbers);
        if (numbers.contains(directions_array.name)) add_withdrawals(numbers);
        if (numbers.contains(region_rows_array.name)) add_regions(numbers);
    }

    void add_depths(const NumbersByName& numbers) {
        list_.depth_tolerance = need(numbers, depth_tolerance_array, 1).numbers[0];
        if (!(list_.depth_tolerance > 0 && std::isfinite(list_.depth_tolerance)))
            fail_at(depth_tolerance_array, 0, "this is not a tolerance above 0");
        list_.depth_reached = need(numbers, depth_reached_array).numbers;
        list_.depth_bound = need(numbers, depth_bound_array).numbers;
    }

    void add_withdrawals(const NumbersByName& numbers) {
        list_.directions = numbers.find(directions_array.name)->second.numbers;
        const std::size_t count = list_.directions.size() / 3;
        for (std::size_t j = 0; j < count; ++j) {
            const auto d = std::span(list_.directions).subspan(3 * j, 3);
            const bool valid = std::isfinite(d[0]) && std::isfinite(d[1]) && std::isfinite(d[2]);
            if (!valid || (d[0] == 0 && d[1] == 0 && d[2] == 0))
                fail_at(directions_array, j, "this is not a direction");
        }
        list_.withdrawals = need(numbers, withdrawals_array, count * list_.rows.size()).numbers;
        list_.has_first_free = numbers.contains(first_free_array.name);
        if (list_.has_first_free) list_.first_free = need(numbers, first_free_array, count * list_.rows.size()).numbers;
    }

    void add_regions(const NumbersByName& numbers) {
        list_.has_regions = true;
        const std::vector<std::int32_t>& rows = numbers.find(region_rows_array.name)->second.ids;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (static_cast<std::size_t>(rows[i]) >= list_.rows.size())
                fail_at(region_rows_array, i, "there is no such row");
            if (i > 0 && rows[i] < rows[i - 1]) fail_at(region_rows_array, i, "rows must be in ascending order");
            list_.regions.push_back({rows[i]});
        }
        for_each_quantity(region_quantities, [&](const OverlapQuantity& quantity, std::size_t place) {
            const std::vector<double>& values = need(numbers, array_of(quantity), rows.size()).numbers;
            for (std::size_t i = 0; i < values.size(); ++i)
                list_.regions[i / quantity.width].numbers[place + i % quantity.width] = values[i];
        });
    }

    /// Returns the numbers of an array. Throws Error (format) if it is missing or does not have as many rows as the
    /// list.
    const ArrayNumbers& need(const NumbersByName& numbers, const ListArray& array) const {
        const auto found = numbers.find(array.name);
        if (found == numbers.end()) fail("there is no array \"" + array.name + '"');
        const std::size_t count = found->second.ids.size() + found->second.numbers.size();
        if (array.name != bodies_array.name && count != list_.rows.size() * array.width)
            fail('"' + array.name + "\" is not as long as \"" + bodies_array.name + '"');
        return found->second;
    }
    /// Returns the numbers of an array of another length. Throws Error (format) if it is missing or has another length.
    const ArrayNumbers& need(const NumbersByName& numbers, const ListArray& array, std::size_t rows) const {
        const auto found = numbers.find(array.name);
        if (found == numbers.end()) fail("there is no array \"" + array.name + '"');
        if (found->second.ids.size() + found->second.numbers.size() != rows * array.width)
            fail('"' + array.name + "\" must have " + std::to_string(rows) + " rows");
        return found->second;
    }
    [[noreturn]] void fail(const std::string& message) const {
        throw Error(ErrorCode::format, source_.name() + ": " + message);
    }
    [[noreturn]] void fail_at(const ListArray& array, std::size_t row, const std::string& message) const {
        fail(row_name(array, row) + ": " + message);
    }

    static constexpr std::array<double, relation_names.size()> all_relations{0, 1, 2, 3, 4, 5};
    const Source& source_;
    std::size_t count_;  ///< number of bodies
    std::unordered_map<std::string, std::int32_t> bodies_;
    OverlapList list_;
};

}  // namespace

std::string_view name_of(OverlapRelation relation) { return relation_names[static_cast<std::size_t>(relation)]; }

void OverlapList::add_region(const Overlaps& overlaps, std::int64_t r, std::int32_t row) {
    auto number = regions.emplace_back(OverlapListRegion{row}).numbers.begin();
    const auto put = [&](const auto& quantity) {
        if constexpr (requires { quantity[r].size(); })
            number = std::copy(quantity[r].begin(), quantity[r].end(), number);
        else
            *number++ = quantity[r];
    };
    put(overlaps.region_volume);
    put(overlaps.region_centroid);
    put(overlaps.region_area_vector);
    put(overlaps.region_normal);
    put(overlaps.region_mean_depth);
    put(overlaps.region_thickness);
    put(overlaps.region_box);
}

std::span<const OverlapListRegion> OverlapList::regions_of(const OverlapListRow& row) const {
    const auto before = [](const OverlapListRegion& region, std::int32_t place) { return region.row < place; };
    const auto begin = std::lower_bound(regions.begin(), regions.end(), row.place, before),
               end = std::lower_bound(begin, regions.end(), row.place + 1, before);
    return {begin, end};
}

void OverlapList::add(const Overlaps& overlaps, std::int32_t bodies, std::int32_t first_configuration) {
    const std::size_t first = rows.size(), count = overlaps.bodies.size();
    rows.resize(first + count);
    for (std::size_t i = 0; i < count; ++i) {
        const BodyPair& pair = overlaps.bodies[i];
        const std::int32_t world = pair.first / bodies;
        rows[first + i].place = static_cast<std::int32_t>(first + i);
        rows[first + i].configuration = first_configuration + world;
        rows[first + i].bodies = {pair.first - world * bodies, pair.second - world * bodies};
        rows[first + i].relation = overlaps.relation[i];
        auto number = rows[first + i].numbers.begin();
        const auto put = [&](const auto& quantity) {
            if (!has_numbers) return;
            if constexpr (requires { quantity[i].size(); })
                number = std::copy(quantity[i].begin(), quantity[i].end(), number);
            else
                *number++ = quantity[i];
        };
        put(overlaps.volume);
        put(overlaps.centroid);
        put(overlaps.area_vector);
        put(overlaps.normal);
        put(overlaps.mean_depth);
        put(overlaps.torque);
        put(overlaps.torque_point);
        put(overlaps.contact_area);
        for (std::int64_t r = overlaps.region_offsets.empty() ? 0 : overlaps.region_offsets[i];
             !overlaps.region_offsets.empty() && r < overlaps.region_offsets[i + 1]; ++r)
            add_region(overlaps, r, static_cast<std::int32_t>(first + i));
    }
    for (const auto& [from, to] :
         {std::pair(&overlaps.depth_reached, &depth_reached), std::pair(&overlaps.depth_bound, &depth_bound),
          std::pair(&overlaps.withdrawals, &withdrawals), std::pair(&overlaps.first_free, &first_free)})
        to->insert(to->end(), from->begin(), from->end());
}

void write_overlaps(const std::filesystem::path& path, const OverlapList& list, const OverlapBodies& bodies,
                    const Statistics& statistics) {
    write_list(path, table_of(list, bodies, statistics), PairFormat::automatic);
}
void write_overlaps(std::ostream& out, const OverlapList& list, const OverlapBodies& bodies,
                    const Statistics& statistics, PairFormat format) {
    write_list(out, table_of(list, bodies, statistics), format);
}

OverlapList read_overlaps(const std::filesystem::path& path, std::span<const std::string> names,
                          bool has_configurations) {
    return OverlapReader(Source(path), names, has_configurations).read();
}
OverlapList read_overlaps(std::istream& in, const std::string& name, std::span<const std::string> names,
                          bool has_configurations) {
    return OverlapReader(Source(in, name), names, has_configurations).read();
}

}  // namespace crumple::io
