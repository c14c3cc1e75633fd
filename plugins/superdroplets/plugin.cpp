// Superdroplets on parcels: the droplets and their growth, their collisions, their fall.
#include <pileus/plugin.hpp>

#include "coalescence_operator.hpp"
#include "droplets_operator.hpp"
#include "sedimentation_operator.hpp"

PILEUS_MODULE("org.pileus.superdroplets", "1.0.0", pileus::superdroplets::DropletsOperator::table(),
              pileus::superdroplets::CoalescenceOperator::table(),
              pileus::superdroplets::SedimentationOperator::table());
