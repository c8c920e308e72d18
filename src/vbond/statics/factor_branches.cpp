#include "vbond/statics/detail/factor_branches.hpp"

#include <algorithm>
#include <cstddef>
#include <queue>
#include <utility>

namespace vbond {
namespace {

std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

/// A block, and the blocks below it in the tree.
struct Node {
  int parent = -1;
  double own = 0, all = 0;    // entries
  int lowest = 0, count = 1;  // blocks
  bool is_top = false;
};

std::vector<Node> tree_of(const FactorBlocks& blocks) {
  std::vector<int> block_of(at(blocks.columns()));
  for (int b = 0; b < blocks.number(); ++b)
    std::fill_n(block_of.begin() + blocks.block(b).first, blocks.block(b).width, b);
  std::vector<Node> tree(at(blocks.number()));
  for (int b = 0; b < blocks.number(); ++b) tree[at(b)].lowest = b;
  for (int b = 0; b < blocks.number(); ++b) {  // children come first
    Node& node = tree[at(b)];
    const auto [first, width, height] = blocks.block(b);
    node.own = static_cast<double>(width) * height;
    node.all += node.own;
    if (height == width) continue;
    node.parent = block_of[at(blocks.rows[at(blocks.from[at(b)] + width)])];
    Node& parent = tree[at(node.parent)];
    parent.all += node.all;
    parent.count += node.count;
    parent.lowest = std::min(parent.lowest, node.lowest);
  }
  return tree;
}

/// The largest are cut off from what holds them together until all are small, or too much is on top.
void choose_top(std::vector<Node>& tree, double sum, double largest) {
  constexpr double most_on_top = 0.25;  // of all entries
  std::vector<std::vector<int>> children(tree.size());
  std::priority_queue<std::pair<double, int>> waiting;
  for (int b = 0; b < static_cast<int>(tree.size()); ++b) {
    const Node& node = tree[at(b)];
    if (node.parent >= 0)
      children[at(node.parent)].push_back(b);
    else
      waiting.push({node.all, b});
  }
  double on_top = 0.0;
  while (!waiting.empty() && waiting.top().first > largest) {
    const int b = waiting.top().second;
    waiting.pop();
    if (on_top + tree[at(b)].own > most_on_top * sum) continue;
    on_top += tree[at(b)].own;
    tree[at(b)].is_top = true;
    for (const int child : children[at(b)]) waiting.push({tree[at(child)].all, child});
  }
}

}  // namespace

FactorBranches branches_of(const FactorBlocks& blocks) {
  constexpr double worth_it = 0x1p20;  // entries
  std::vector<Node> tree = tree_of(blocks);
  double sum = 0.0;
  for (const Node& node : tree) sum += node.own;
  const double largest = 0.125 * sum;
  FactorBranches found;
  // blocks of a branch must follow each other, as CHOLMOD sorts them
  const bool sorted = std::all_of(tree.begin(), tree.end(), [&tree](const Node& node) {
    return node.count == static_cast<int>(&node - tree.data()) - node.lowest + 1;
  });
  if (sum > worth_it && sorted) {
    choose_top(tree, sum, largest);
    for (const Node& node : tree) {
      const int b = static_cast<int>(&node - tree.data());
      if (node.is_top) found.top.push_back(b);
      if (node.is_top || (node.parent >= 0 && !tree[at(node.parent)].is_top)) continue;
      FactorBranches::Branch* before = found.branches.empty() ? nullptr : &found.branches.back();
      if (before != nullptr && before->last == node.lowest && before->size + node.all <= largest)
        before->last = b + 1, before->size += node.all;
      else
        found.branches.push_back({node.lowest, b + 1, node.all});
    }
    double copied = 0.0;  // columns of the top, for each branch
    for (const int b : found.top) copied += blocks.block(b).width;
    copied *= static_cast<double>(found.branches.size());
    if (found.branches.size() > 1 && copied < 0.1 * sum) return found;  // else twigs of a trunk: no gain
  }
  found = {};
  for (int b = 0; b < blocks.number(); ++b) found.top.push_back(b);
  return found;
}

}  // namespace vbond
