#include <cmath>

#include "checks/check_writers.h"
#include "io/bytes/sink.h"
#include "io/lists/list_rows.h"

namespace crumple::checks {
namespace {

constexpr const char* heading =
    "kind,finding,first,first_shell,second,second_shell,x,y,z,low_x,low_y,low_z,high_x,high_y,high_z,count,places,"
    "volume,mean_depth,depth_reached,depth_bound,contact_area,length,clearance\n";

}  // namespace

void write_check_csv(std::ostream& out, const CheckReport& report) {
    io::Sink sink(out);
    sink << heading;
    const auto number = [&](double x) {
        sink << ',';
        if (!std::isnan(x)) sink << x;
    };
    const auto numbers = [&](const Point* point) {
        for (std::size_t k = 0; k < 3; ++k) number(point ? (*point)[k] : not_computed);
    };
    for (const CheckItem& item : report.items) {
        sink << name_of(item.kind) << ',' << (item.is_finding ? '1' : '0');
        for (const BodyPart& part : {item.first, item.second}) {
            sink << ',';
            if (part.body >= 0) sink << io::csv_cell(report.names[static_cast<std::size_t>(part.body)]);
            sink << ',';
            if (part.shell >= 0) sink << part.shell;
        }
        numbers(item.centre ? &*item.centre : nullptr);
        numbers(item.box ? &item.box->low : nullptr);
        numbers(item.box ? &item.box->high : nullptr);
        sink << ',' << item.count << ',' << item.places.size();
        for (const double x : {item.volume, item.mean_depth, item.depth_reached, item.depth_bound, item.contact_area,
                               item.length, item.clearance})
            number(x);
        sink << '\n';
    }
}

}  // namespace crumple::checks
