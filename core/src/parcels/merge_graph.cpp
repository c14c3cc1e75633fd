#include "parcels/merge_graph.hpp"

namespace pileus::parcels {

const std::vector<Link>& MergeGraph::resolve(const std::vector<Link>& links, std::size_t parcels) {
  kept_.clear();
  if (links.empty()) return kept_;
  merged_.assign(parcels, 0);
  leaf_.assign(parcels, 0);
  available_.assign(parcels, 0);
  while (accept_leaves(links)) {
  }
  settle_remaining(links);
  return kept_;
}

/// One pass: a leaf (nobody's nearest) merges into a neighbour that only leaves point to. A
/// receiver loses its own link, which cuts the chain there. Returns whether anything merged.
bool MergeGraph::accept_leaves(const std::vector<Link>& links) {
  for (const Link& link : links)
    if (!merged_[link.from]) {
      leaf_[link.from] = 1;
      available_[link.to] = 1;
    }
  for (const Link& link : links)
    if (!merged_[link.from]) leaf_[link.to] = 0;
  for (const Link& link : links)
    if (!merged_[link.from] && !leaf_[link.from]) available_[link.to] = 0;
  // All leaves of one receiver merge together: flags change only after every link was looked at.
  const std::size_t before = kept_.size();
  for (const Link& link : links)
    if (!merged_[link.from] && leaf_[link.from] && available_[link.to]) kept_.push_back(link);
  for (std::size_t k = before; k < kept_.size(); ++k)
    merged_[kept_[k].from] = merged_[kept_[k].to] = 1;
  return kept_.size() > before;
}

/// What is left are cycles of two, alone or with leaves, and large roots behind a cut chain.
void MergeGraph::settle_remaining(const std::vector<Link>& links) {
  for (const Link& link : links)
    if (!merged_[link.from] && leaf_[link.from]) available_[link.to] = 1;
  for (const Link& link : links) {
    const std::uint32_t i = link.from;
    if (merged_[i]) continue;
    if (leaf_[i]) {
      kept_.push_back(link);
    } else if (!available_[i]) {
      if (available_[link.to])
        kept_.push_back(link);
      else
        available_[i] = 1;  // an isolated pair: this one receives, its partner's link is kept
    }
  }
}

}  // namespace pileus::parcels
