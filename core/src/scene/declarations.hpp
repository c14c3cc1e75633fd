// The sections of a scene, each as a table of declared keys.
#pragma once
#include "scene/keys.hpp"

namespace pileus::scene {

const Table& identity_table();  // scene
const Table& constants_table();
const Table& formulas_table();
const Table& domain_table();
const Table& time_table();
const Table& step_table();
const Table& background_table();
const Table& initial_table();
const Table& boundaries_table();
const Table& flow_table();
const Table& parcels_table();
const Table& operator_table();  // one entry of operators
const Table& coupling_table();
const Table& effects_table();
const Table& energy_table();
const Table& numerics_table();
const Table& water_path_table();
const Table& diagnostics_table();
const Table& output_table();
const Table& expectation_table();  // one entry of expect

const Table& field_table();  // the mapping form of a field
const Table& noise_table();

Key effects_key();

}  // namespace pileus::scene
