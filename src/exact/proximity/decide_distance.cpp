#include "exact/proximity/decide_distance.h"

namespace crumple {

bool Distance::within(const DistanceLimit& reach) {
    const Proximity proximity = quick_.compare(reach);
    return proximity == Proximity::unknown ? exact().within(reach) : proximity == Proximity::within;
}

bool Distance::touching() {
    if (enclosure().touching()) return true;
    return !enclosure().apart() && exact().touching();
}

double Distance::squared() {
    double rounded;
    return enclosure().squared_rounded(rounded) ? rounded : exact().squared();
}

double Distance::rounded_down() {
    double rounded;
    return enclosure().rounded_down(rounded) ? rounded : exact().rounded_down();
}

ClosestPoints Distance::closest() {
    ClosestPoints points;
    return enclosure().closest(points) ? points : exact().closest();
}

detail::Enclosure& Distance::enclosure() {
    if (!enclosure_) enclosure_ = quick_.enclosure();
    return *enclosure_;
}

const RationalDistance& Distance::exact() {
    if (!exact_) {
        exact_.emplace(features_);
        ++counts_.rational;
    }
    return *exact_;
}

}  // namespace crumple
