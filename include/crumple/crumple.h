#pragma once

#include "crumple/array.h"
#include "crumple/collisions.h"
#include "crumple/detector.h"
#include "crumple/device.h"
#include "crumple/error.h"
#include "crumple/executor.h"
#include "crumple/feature_pairs.h"
#include "crumple/mesh.h"
#include "crumple/motion.h"
#include "crumple/near.h"
#include "crumple/options.h"
#include "crumple/version.h"
