#pragma once

// The API of the target crumple::crumple. Reading and writing of files has headers of its own (crumple/io.h,
// crumple/io_features.h), and so has MPI (crumple/mpi.h).

#include "crumple/array.h"
#include "crumple/candidates.h"
#include "crumple/clustering.h"
#include "crumple/detector.h"
#include "crumple/device.h"
#include "crumple/distances.h"
#include "crumple/error.h"
#include "crumple/executor.h"
#include "crumple/feature_pairs.h"
#include "crumple/impacts.h"
#include "crumple/intersections.h"
#include "crumple/mesh.h"
#include "crumple/open_edges.h"
#include "crumple/options.h"
#include "crumple/overlaps.h"
#include "crumple/proximities.h"
#include "crumple/query.h"
#include "crumple/rigid_motion.h"
#include "crumple/scene.h"
#include "crumple/stencils.h"
#include "crumple/version.h"
#include "crumple/world.h"
