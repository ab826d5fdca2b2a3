#include "checks/check_writers.h"

namespace crumple::checks {

CheckWriter check_writer_of(std::string_view extension) {
    if (extension == ".txt") return write_check_text;
    if (extension == ".json") return write_check_json;
    if (extension == ".csv") return write_check_csv;
    if (extension == ".html") return write_check_page;
    return nullptr;
}

}  // namespace crumple::checks
