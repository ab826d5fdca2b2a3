#pragma once

// Queries on their way in: the dataclasses of crumple/_queries.py as those of the library.

#include <nanobind/nanobind.h>

#include "crumple/detector.h"

namespace crumple::python {

/// Fills a query with the attributes of the same names. Throws where one is of another type or has another name.
void read(nanobind::handle given, IntersectionQuery& query);
void read(nanobind::handle given, ImpactQuery& query);
void read(nanobind::handle given, FirstImpactQuery& query);
void read(nanobind::handle given, FreeStepQuery& query);
void read(nanobind::handle given, ProximityQuery& query);
void read(nanobind::handle given, CandidateQuery& query);
void read(nanobind::handle given, DistanceQuery& query);

}  // namespace crumple::python
