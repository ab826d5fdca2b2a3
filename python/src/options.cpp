#include "options.h"

#include <cstdint>
#include <vector>

#include "arguments.h"
#include "names.h"

namespace nb = nanobind;

namespace crumple::python {
namespace {

std::vector<int> devices_of(const nb::dict& given) {
    std::vector<int> devices;
    if (!given.contains("devices")) return devices;
    const nb::object numbers = given["devices"];
    if (!nb::isinstance<nb::sequence>(numbers) || nb::isinstance<nb::str>(numbers))
        refuse_type("devices", "a sequence of integers", numbers);
    for (const nb::handle number : numbers) devices.push_back(integer<int>("devices", number));
    return devices;
}

/// Converts a Python object of class crumple.FuzzyCMeans.
FuzzyCMeans fuzzy_c_means_of(const nb::object& given) {
    return {.fuzziness = real("fuzziness", given.attr("fuzziness")),
            .max_iterations = integer<int>("max_iterations", given.attr("max_iterations")),
            .first_iterations = integer<int>("first_iterations", given.attr("first_iterations")),
            .stop = real("stop", given.attr("stop")),
            .first_stop = real("first_stop", given.attr("first_stop"))};
}

/// Converts a Python object of class crumple.Method.
Method method_of(const nb::object& given) {
    Method method;
    const nb::object sweep = given.attr("sweep"), threshold = given.attr("threshold");
    if (nb::isinstance<nb::str>(sweep)) {
        method.sweep = named(sweep_names, "sweep", sweep);
    } else {
        if (!nb::isinstance<nb::sequence>(sweep) || nb::len(sweep) != method.direction.size())
            refuse_type("sweep", "\"pca\", \"x\", \"y\", \"z\" or a sequence of three numbers", sweep);
        method.sweep = SweepDirection::given;
        for (std::size_t i = 0; i < method.direction.size(); ++i) method.direction[i] = real("sweep", sweep[i]);
    }
    method.membership = named(membership_names, "membership", given.attr("membership"));
    method.threshold = real("threshold", threshold);
    return method;
}

}  // namespace

Options options_of(const nb::dict& given) {
    return {
        .backend = named(backend_names, "backend", given["backend"]),
        .threads = integer<int>("threads", given["threads"]),
        .memory_limit = integer<std::int64_t>("memory_limit", given["memory_limit"]),
        .clusters = integer<int>("clusters", given["clusters"]),
        .leaf_size = integer<int>("leaf_size", given["leaf_size"]),
        .fuzzy_c_means = fuzzy_c_means_of(given["fuzzy_c_means"]),
        .method = method_of(given["method"]),
        .simd = named(simd_names, "simd", given["simd"]),
        .device = integer<int>("device", given["device"]),
        .devices = devices_of(given),
    };
}

}  // namespace crumple::python
