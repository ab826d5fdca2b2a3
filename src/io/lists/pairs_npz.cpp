// Colliding pairs as NumPy arrays.

#include "io/bytes/npz.h"
#include "io/formats.h"
#include "io/lists/pairs.h"

namespace crumple::io {

void write_pairs_npz(std::ostream& out, const Intersections& collisions) {
    NpzWriter archive;
    archive.add<std::int32_t>("pairs", collisions.pairs.data(), collisions.pairs.size(), 2);
    archive.add<std::int64_t>("offsets", collisions.offsets.data(), collisions.offsets.size());
    archive.add<std::uint8_t>("hit", collisions.hit.data(), collisions.hit.size());
    if (!collisions.hit_second.empty()) {
        archive.add<std::uint8_t>("hit_second", collisions.hit_second.data(), collisions.hit_second.size());
    }
    if (has_contacts(collisions)) {
        const Contacts& contacts = collisions.contacts;
        archive.add<std::uint8_t>("contact_kinds", contacts.kinds.data(), contacts.kinds.size());
        archive.add<std::int64_t>("contact_offsets", contacts.offsets.data(), contacts.offsets.size());
        archive.add<double>("contact_points", contacts.points.data(), contacts.points.size(), 3);
    }
    archive.write(out);
}

}  // namespace crumple::io
