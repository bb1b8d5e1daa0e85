#include "core/contact/bvh.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>

namespace bb {

namespace {
constexpr int leaf_size = 4;  // primitives a leaf: fewer nodes to refit, few box tests more
constexpr double rebuild_growth = 1.5;
}  // namespace

void Bvh::update(std::span<const Aabb> boxes, std::span<const std::uint8_t> free) {
  const bool first = boxes.size() != boxes_.size() || nodes_.empty();
  boxes_.assign(boxes.begin(), boxes.end());
  free_.assign(free.begin(), free.end());
  if (boxes_.empty()) {
    nodes_.clear();
    return;
  }
  if (!first) {
    refit();
    if (!(looseness() > rebuild_growth * built_looseness_)) return;
  }
  build();
}

void Bvh::build() {
  const int n = static_cast<int>(boxes_.size());
  order_.resize(boxes_.size());
  for (int i = 0; i < n; ++i) order_[static_cast<std::size_t>(i)] = i;
  nodes_.clear();
  split(0, n);
  refit();
  built_looseness_ = looseness();
  ++builds_;
}

int Bvh::split(int begin, int end) {
  const int id = static_cast<int>(nodes_.size());
  nodes_.push_back({Aabb{}, begin, end, -1, false});
  if (end - begin <= leaf_size) return id;

  Aabb centres;
  for (int i = begin; i < end; ++i) {
    const Aabb& b = boxes_[static_cast<std::size_t>(order_[static_cast<std::size_t>(i)])];
    centres.add(Vec3d(b.lo + b.hi));
  }
  int axis = 0;
  (centres.hi - centres.lo).maxCoeff(&axis);
  const int middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](int p, int q) {
    const Aabb &a = boxes_[static_cast<std::size_t>(p)], &b = boxes_[static_cast<std::size_t>(q)];
    const double ca = a.lo[axis] + a.hi[axis], cb = b.lo[axis] + b.hi[axis];
    return ca < cb || (ca == cb && p < q);
  });
  split(begin, middle);
  const int right = split(middle, end);
  nodes_[static_cast<std::size_t>(id)].right = right;
  return id;
}

void Bvh::refit() {
  ordered_boxes_.resize(boxes_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) ordered_boxes_[i] = box(order_[i]);
  for (std::size_t k = nodes_.size(); k-- > 0;) {  // children come after their parent
    Node& node = nodes_[k];
    node.box = Aabb{};
    node.any_free = false;
    if (node.right < 0) {
      for (int i = node.begin; i < node.end; ++i) {
        node.box.add(box_in_order(i));
        node.any_free = node.any_free || is_free(order_[static_cast<std::size_t>(i)]);
      }
    } else {
      const Node &left = nodes_[k + 1], &right = nodes_[static_cast<std::size_t>(node.right)];
      node.box.add(left.box);
      node.box.add(right.box);
      node.any_free = left.any_free || right.any_free;
    }
  }
}

double Bvh::looseness() const {
  double inner = 0, leaves = 0;
  for (const Node& node : nodes_) (node.right < 0 ? leaves : inner) += node.box.half_area();
  double primitives = 0;
  for (const Aabb& b : boxes_) primitives += b.half_area();
  return primitives > 0 ? (inner + leaves) / primitives : 0;
}

void Bvh::cut(int size, std::vector<int>& out) const {
  out.clear();
  for (std::size_t k = 0; k < nodes_.size();) {
    const Node& node = nodes_[k];
    if (node.end - node.begin > size && node.right >= 0) {
      ++k;
      continue;
    }
    out.push_back(static_cast<int>(k));
    while (k < nodes_.size() && nodes_[k].begin < node.end) ++k;  // skip its descendants
  }
}

namespace detail {

void PairCollector::run(std::size_t n, Task task, const void* self, std::vector<IndexPair>& pairs) {
  if (parts_.size() < n) parts_.resize(n);
  if (stacks_.size() < n) stacks_.resize(n);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t k) {
    parts_[k].clear();
    task(self, k, stacks_[k], parts_[k]);
  });
  std::size_t total = 0;
  for (std::size_t k = 0; k < n; ++k) total += parts_[k].size();
  pairs.reserve(total);
  for (std::size_t k = 0; k < n; ++k) pairs.insert(pairs.end(), parts_[k].begin(), parts_[k].end());
  tbb::parallel_sort(pairs.begin(), pairs.end());  // no two are equal: the order is unique
}

}  // namespace detail
}  // namespace bb
