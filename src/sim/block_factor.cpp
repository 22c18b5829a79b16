#include "sim/block_factor.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "mesh/list_by_node.h"

namespace haptic_cloth {

void BlockFactor::reserve(int rows) {
  constexpr int kSprings = 2, kEnds = 5, kEntries = 8;
  for (auto* list : {&pulls_of_, &order_, &rank_, &parent_, &seen_, &path_, &entries_of_, &first_, &last_})
    list->reserve(rows + 2);
  own_.reserve(rows);
  for (auto* list : {&places_, &work_}) list->reserve(rows);
  for (auto* list : {&sums_, &inverse_}) list->reserve(rows);
  springs_.reserve(kSprings * rows);
  ends_.reserve(kSprings * kEnds * rows);
  pulls_.reserve(kSprings * kEnds * rows);
  entries_.reserve(kEntries * rows);
}

void BlockFactor::clear() {
  own_.clear();
  places_.clear();
  springs_.clear();
  ends_.clear();
}

int BlockFactor::addRow(const Block& own, const Vec3& place) {
  own_.push_back(own);
  places_.push_back(place);
  return rows() - 1;
}

void BlockFactor::addSpring(const Block& stiffness, const std::vector<End>& ends) {
  const int begin = static_cast<int>(ends_.size());
  ends_.insert(ends_.end(), ends.begin(), ends.end());
  springs_.push_back({stiffness, begin, static_cast<int>(ends_.size())});
}

/// Calls visit(row) for all rows that share a spring with a row, with repetitions.
template <class Visit>
void BlockFactor::forNeighbours(int row, const Visit& visit) const {
  for (int p = pulls_of_[row]; p < pulls_of_[row + 1]; ++p) {
    const Spring& spring = springs_[pulls_[p].spring];
    for (int e = spring.ends; e < spring.ends_end; ++e) visit(ends_[e].row);
  }
}

/// Moves rows begin..end of the order that separate one half of the others from the other half to the end.
/// @return the first of these; those before `begin + (end - begin) / 2` are one half
int BlockFactor::separate(int begin, int end) {
  Vec3 low = places_[order_[begin]], high = low;
  for (int k = begin; k < end; ++k) {
    low = low.cwiseMin(places_[order_[k]]);
    high = high.cwiseMax(places_[order_[k]]);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const auto middle = order_.begin() + begin + (end - begin) / 2, last = order_.begin() + end;
  std::nth_element(order_.begin() + begin, middle, last, [&](int a, int b) {
    return places_[a][axis] != places_[b][axis] ? places_[a][axis] < places_[b][axis] : a < b;
  });
  for (auto row = order_.begin() + begin; row != last; ++row) seen_[*row] = row < middle ? begin : -1;
  const auto separators = std::partition(middle, last, [&](int row) {
    bool apart = true;
    forNeighbours(row, [&](int other) { apart = apart && seen_[other] != begin; });
    return apart;
  });
  return static_cast<int>(separators - order_.begin());
}

void BlockFactor::dissect(int begin, int end) {
  constexpr int kFew = 4;
  if (end - begin <= kFew) return;
  const int middle = begin + (end - begin) / 2, separators = separate(begin, end);
  dissect(begin, middle);
  dissect(middle, separators);
}

bool BlockFactor::factor() {
  const auto visit = [this](const auto& put) {
    for (int s = 0; s < static_cast<int>(springs_.size()); ++s) {
      for (int e = springs_[s].ends; e < springs_[s].ends_end; ++e)
        put(ends_[e].row, Pull{s, ends_[e].weight});
    }
  };
  listByNode(rows(), visit, pulls_of_, pulls_);
  order_.resize(rows());
  for (int k = 0; k < rows(); ++k) order_[k] = k;
  seen_.assign(rows(), -1);
  dissect(0, rows());
  rank_.resize(rows());
  for (int k = 0; k < rows(); ++k) rank_[order_[k]] = k;

  for (auto* list : {&parent_, &seen_, &first_, &last_}) list->assign(rows(), -1);
  path_.resize(rows());
  sums_.assign(rows(), Mat3::Zero());
  inverse_.resize(rows());
  entries_.clear();
  entries_of_.assign(1, 0);
  for (int k = 0; k < rows(); ++k) {
    if (!addToFactor(k)) return false;
  }
  return true;
}

/// Adds row k of L and of D⁻¹. The sums solve the rows before it: sums of column i become (L_ki D_i)ᵀ.
bool BlockFactor::addToFactor(int k) {
  Mat3 own = matrix(own_[order_[k]]);
  for (int p = pulls_of_[order_[k]]; p < pulls_of_[order_[k] + 1]; ++p) {
    const Spring& spring = springs_[pulls_[p].spring];
    const Mat3 pull = pulls_[p].weight * matrix(spring.stiffness);
    for (int e = spring.ends; e < spring.ends_end; ++e) {
      const int i = rank_[ends_[e].row];
      if (i < k) sums_[i] += ends_[e].weight * pull;
      if (i == k) own += ends_[e].weight * pull;
    }
  }
  for (int at = listAncestors(k); at < rows(); ++at) {
    const int i = path_[at];
    const Mat3 sum = sums_[i];
    sums_[i].setZero();
    for (int e = first_[i]; e >= 0; e = entries_[e].next)
      sums_[entries_[e].row].noalias() -= entries_[e].value * sum;
    const Mat3 value = (inverse_[i] * sum).transpose();
    own.noalias() -= value * sum;
    const int entry = static_cast<int>(entries_.size());
    entries_.push_back({i, k, -1, value});
    (first_[i] < 0 ? first_[i] : entries_[last_[i]].next) = entry;
    last_[i] = entry;
  }
  entries_of_.push_back(static_cast<int>(entries_.size()));
  const Eigen::LLT<Mat3> factors(own);  // cofactors lose twice the digits of a stiff block
  inverse_[k] = factors.solve(Mat3::Identity());
  return factors.info() == Eigen::Success && inverse_[k].allFinite();
}

/// Lists the columns with entries in row k of L, at the end of path_: the ways from its neighbours to the
/// root of the elimination tree. Each comes after those on which it depends. @return the first place
int BlockFactor::listAncestors(int k) {
  int top = rows();
  seen_[k] = k;
  forNeighbours(order_[k], [&](int row) {
    int length = 0;
    for (int i = rank_[row]; i < k && seen_[i] != k; i = parent_[i]) {
      if (parent_[i] < 0) parent_[i] = k;
      path_[length++] = i;
      seen_[i] = k;
    }
    while (length > 0) path_[--top] = path_[--length];
  });
  return top;
}

void BlockFactor::solve(std::vector<Vec3>& values) const {
  work_.resize(rows());
  for (int k = 0; k < rows(); ++k) {
    Vec3 value = values[order_[k]];
    for (int e = entries_of_[k]; e < entries_of_[k + 1]; ++e)
      value -= entries_[e].value * work_[entries_[e].column];
    work_[k] = value;
  }
  for (int k = 0; k < rows(); ++k) work_[k] = inverse_[k] * work_[k];
  for (int k = rows() - 1; k >= 0; --k) {
    for (int e = entries_of_[k]; e < entries_of_[k + 1]; ++e)
      work_[entries_[e].column] -= entries_[e].value.transpose() * work_[k];
    values[order_[k]] = work_[k];
  }
}

}  // namespace haptic_cloth
