#include <map>
#include <tuple>

#include <fmt/format.h>

#include "checks/check_writers.h"
#include "checks/item_texts.h"
#include "io/bytes/grouped.h"

namespace crumple::checks {

using io::grouped;

namespace {

constexpr std::size_t most_alike = 10;  // items of one kind about the same parts that are listed

/// Lists items; those that are like ten or more listed ones are only counted.
class ItemLister {
   public:
    ItemLister(std::ostream& out, const CheckReport& report, const char* indent)
        : out_(out), report_(report), indent_(indent) {}

    void add(const CheckItem& item) {
        if (++alike_[{item.kind, item.first, item.second}] <= most_alike)
            out_ << indent_ << text_of(report_, item) << '\n';
    }
    void finish() const {
        for (const auto& [key, count] : alike_)
            if (count > most_alike)
                out_ << indent_
                     << fmt::format("{}: {} more items of the kind {}; .csv and .json files list them all (-o)\n",
                                    checks::name_of(report_, std::get<1>(key)),
                                    grouped(static_cast<std::int64_t>(count - most_alike)), name_of(std::get<0>(key)));
    }

   private:
    std::ostream& out_;
    const CheckReport& report_;
    const char* indent_;
    std::map<std::tuple<ItemKind, BodyPart, BodyPart>, std::size_t> alike_;
};

/// Writes the volume that a shell covers twice in several places.
void write_volumes(std::ostream& out, const CheckReport& report, const CheckedBody& body) {
    for (std::int32_t s = 0; s < body.shells; ++s) {
        const CheckedShell& shell = report.shell_of(body, s);
        std::int64_t places = 0;
        for (const CheckItem& item : report.items)
            places += item.kind == ItemKind::self_intersection && item.first == shell.part;
        if (places > 1 && shell.overlap_with_itself)
            out << fmt::format("  {} overlaps itself in {} places: volume {}\n", name_of(report, shell.part),
                               grouped(places), text_of_volume(report, *shell.overlap_with_itself));
    }
}

}  // namespace

void write_check_text(std::ostream& out, const CheckReport& report) {
    auto item = report.items.begin();
    for (std::int32_t b = 0; b < std::ssize(report.bodies); ++b) {
        const CheckedBody& body = report.bodies[static_cast<std::size_t>(b)];
        out << name_of(report, {b}) << ": " << text_of(report, body) << '\n';
        ItemLister lister(out, report, "  ");
        for (; item != report.items.end() && item->first.body == b && item->second.body <= b; ++item) {
            if (item->second.body >= 0 && item->second.body != b) break;
            lister.add(*item);
        }
        lister.finish();
        write_volumes(out, report, body);
    }
    ItemLister lister(out, report, "");
    for (; item != report.items.end(); ++item) lister.add(*item);
    lister.finish();
    out << summary_of(report) << '\n';
}

}  // namespace crumple::checks
