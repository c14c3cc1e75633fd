#include <array>

#include "conform/check.hpp"

namespace pileus::conform {
namespace {

constexpr std::array<Check, 27> checks = {{
    {"C01", "the note agrees with the tables", nullptr},
    {"C02", "one exported symbol, known libraries", nullptr},
    {"C03", "the tables are well-formed", nullptr},
    {"C04", "names, units and ranges", check_names_and_units},
    {"C05", "natures, weights and budgets", check_natures_and_budgets},
    {"C06", "licence, references, summary", check_metadata},
    {"C07", "declares the same in every process", nullptr},
    {"C08", "parameter bounds are accepted", check_parameter_bounds},
    {"C09", "life cycle without leak", check_life_cycle},
    {"C10", "two instances do not meet", check_instances},
    {"C11", "writes only what it may", check_writes},
    {"C12", "remembers no call", check_repeated_calls},
    {"C13", "same bits for any blocks and threads", check_blocks_and_threads},
    {"C14", "parcels do not see each other", check_permutation},
    {"C15", "inactive parcels stay as they are", check_inactive_parcels},
    {"C16", "same bits with and without skipping", check_skipping},
    {"C17", "small steps change little", check_small_steps},
    {"C18", "random states stay admissible", check_random_states},
    {"C19", "large steps stay admissible", check_large_steps},
    {"C20", "budgets close", check_budgets},
    {"C21", "split parcels sum to the whole", check_split_parcels},
    {"C22", "a restart changes nothing", check_restart},
    {"C23", "a projection settles, a closure is pure", check_projection_and_closure},
    {"C24", "no threads, files, arithmetic modes left", check_environment},
    {"C25", "errors are sentences", check_errors},
    {"C26", "cost per parcel (reported)", measure_cost},
    {"C27", "the plugin's own tests", check_own_tests},
}};

}  // namespace

std::span<const Check> all_checks() {
  return checks;
}

}  // namespace pileus::conform
