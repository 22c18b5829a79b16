#include "contact/crossings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace haptic_cloth {
namespace {

/// Sum of doubles without rounding, as parts that do not overlap, the largest last [Shewchuk 1997,
/// Adaptive precision floating-point arithmetic and fast robust geometric predicates].
class ExactSum {
 public:
  void add(double value) {
    int kept = 0;
    for (int k = 0; k < size_; ++k) {
      const double part = parts_[k], sum = value + part, taken = sum - value;
      const double lost = (value - (sum - taken)) + (part - taken);
      if (lost != 0.0) parts_[kept++] = lost;
      value = sum;
    }
    if (value != 0.0) parts_[kept++] = value;
    size_ = kept;
  }
  void addProduct(double a, double b, double c) {
    const double product = a * b;
    for (const double factor : {std::fma(a, b, -product), product}) {
      const double part = factor * c;
      add(std::fma(factor, c, -part));
      add(part);
    }
  }
  /// Adds sign · a · (b × c).
  void addTriple(double sign, const Vec3& a, const Vec3& b, const Vec3& c) {
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      addProduct(sign * a[k], b[l], c[m]);
      addProduct(-sign * a[k], b[m], c[l]);
    }
  }
  int sign() const { return size_ == 0 ? 0 : parts_[size_ - 1] > 0.0 ? 1 : -1; }

 private:
  std::array<double, 96> parts_;  // 24 products of three, each of four doubles
  int size_ = 0;
};

// Rounding error of a determinant or a dot product of differences, over the sum of its terms' sizes.
constexpr double kRounding = 1e-15;

/// Sign of the determinant of a - d, b - d, c - d: on which side of the plane through a, b, c is d?
int side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = a - d, v = b - d, w = c - d, sizes = v.cwiseAbs();
  const double value = u.dot(v.cross(w));
  const Vec3 terms(sizes[1] * std::abs(w[2]) + sizes[2] * std::abs(w[1]),
                   sizes[2] * std::abs(w[0]) + sizes[0] * std::abs(w[2]),
                   sizes[0] * std::abs(w[1]) + sizes[1] * std::abs(w[0]));
  if (std::abs(value) > kRounding * u.cwiseAbs().dot(terms)) return value > 0.0 ? 1 : -1;
  ExactSum sum;
  sum.addTriple(1.0, a, b, c);
  sum.addTriple(-1.0, d, b, c);
  sum.addTriple(-1.0, a, d, c);
  sum.addTriple(-1.0, a, b, d);
  return sum.sign();
}

using Vec2 = Eigen::Vector2d;
using GridPoint = Eigen::Vector2i;

/// Sign of the area of a, b, c: do they turn to the left?
int turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  ExactSum sum;
  for (const auto& [u, v] : {std::pair(a, b), {b, c}, {c, a}}) {
    sum.addProduct(u[0], v[1], 1.0);
    sum.addProduct(-u[1], v[0], 1.0);
  }
  return sum.sign();
}

int turn(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  const long area =
      static_cast<long>(b[0] - a[0]) * (c[1] - a[1]) - static_cast<long>(b[1] - a[1]) * (c[0] - a[0]);
  return area == 0 ? 0 : area > 0 ? 1 : -1;
}

/// Tells whether the segment p q and the triangle a b c of one plane have a point in common. If not,
/// a side of the triangle or the line through p and q separates them.
template <class Point>
bool meetInPlane(const Point& p, const Point& q, const Point& a, const Point& b, const Point& c) {
  const int way = turn(a, b, c);
  const auto outside = [&](const Point& u, const Point& v) {
    return way * turn(u, v, p) < 0 && way * turn(u, v, q) < 0;
  };
  if (way == 0 || outside(a, b) || outside(b, c) || outside(c, a)) return false;
  const int left = turn(p, q, a);
  return left == 0 || turn(p, q, b) != left || turn(p, q, c) != left;
}

/// The same in space, for points of one plane.
bool meetInPlane(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int k = 0; k < 3; ++k) {
    const auto project = [k](const Vec3& x) { return Vec2(x[(k + 1) % 3], x[(k + 2) % 3]); };
    if (turn(project(a), project(b), project(c)) == 0) continue;
    return meetInPlane(project(p), project(q), project(a), project(b), project(c));
  }
  return false;  // the triangle has collapsed
}

/// Tells whether the closed segment p q and the closed triangle a b c have a point in common.
bool meet(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int start = side(a, b, c, p), end = side(a, b, c, q);
  if (start * end > 0) return false;
  if (start == 0 && end == 0) return meetInPlane(p, q, a, b, c);
  const std::array<int, 3> ways{side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)};
  const auto [least, most] = std::minmax_element(ways.begin(), ways.end());
  return *least * *most >= 0;
}

/// Tells quickly that segment and triangle are apart: along the normal of the triangle, of one of
/// its sides in its plane, or of the segment there. Where this does not, meet() decides.
bool apart(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, start = p - a, end = q - a, normal = u.cross(v);
  for (const Vec3& axis : {normal, Vec3(normal.cross(u)), Vec3(normal.cross(v)), Vec3(normal.cross(v - u)),
                           Vec3(normal.cross(end - start))}) {
    const auto [least, most] = std::minmax({0.0, axis.dot(u), axis.dot(v)});
    const auto [near, far] = std::minmax({axis.dot(start), axis.dot(end)});
    const double size = std::max({u.lpNorm<1>(), v.lpNorm<1>(), start.lpNorm<1>(), end.lpNorm<1>()});
    const double error = 2.0 * kRounding * size * axis.lpNorm<Eigen::Infinity>();
    if (far < least - error || near > most + error) return true;
  }
  return false;
}

/// Point where p q cuts the plane of a b c, to rounding.
Vec3 cutPoint(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double start = normal.dot(p - a), end = normal.dot(q - a);
  const double part = start == end ? 0.5 : std::clamp(start / (start - end), 0.0, 1.0);
  return p + part * (q - p);
}

struct Box {
  Vec3 low = Vec3::Constant(HUGE_VAL), high = Vec3::Constant(-HUGE_VAL);  ///< [m]

  void include(const Vec3& x) {
    low = x.allFinite() ? Vec3(low.cwiseMin(x)) : x;
    high = x.allFinite() ? Vec3(high.cwiseMax(x)) : x;
  }
  bool meets(const Box& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

struct SurfaceEdge {
  int a, b;  ///< nodes
};

/// A leaf with its triangles and those of its edges that no other leaf has listed.
struct Leaf {
  Cell cell;
  Box box;
  std::array<std::array<int, 3>, 2> triangles;  ///< nodes
  std::array<SurfaceEdge, 7> edges;
  int edge_count = 0;

  void add(int a, int b) { edges[edge_count++] = {a, b}; }
};

/// Surface of the leaves, and the search for crossings in it.
class Surface {
 public:
  Surface(const ActiveMesh& mesh, const Field& nodes) : mesh_(mesh), nodes_(nodes) {
    leaves_.reserve(mesh.patches.size());
    for (const Patch& patch : mesh.patches) {
      const Leaf leaf = makeLeaf(patch);
      if (leaf.box.low.allFinite() && leaf.box.high.allFinite()) leaves_.push_back(leaf);
    }
  }

  /// Sorts the leaves along the longest axis, and compares those whose boxes overlap.
  Crossings findCrossings() {
    Box all;
    for (const Leaf& leaf : leaves_) {
      all.include(leaf.box.low);
      all.include(leaf.box.high);
    }
    int axis = 0;
    (all.high - all.low).maxCoeff(&axis);
    std::sort(leaves_.begin(), leaves_.end(),
              [axis](const Leaf& a, const Leaf& b) { return a.box.low[axis] < b.box.low[axis]; });
    for (auto one = leaves_.begin(); one != leaves_.end(); ++one) {
      compare(*one, *one);  // its halves may fold flat onto each other
      for (auto other = one + 1; other != leaves_.end() && other->box.low[axis] <= one->box.high[axis];
           ++other) {
        if (!one->box.meets(other->box)) continue;
        compare(*one, *other);
        compare(*other, *one);
      }
    }
    return found_;
  }

 private:
  Leaf makeLeaf(const Patch& patch) const {
    const auto& n = patch.nodes;
    Leaf leaf;
    leaf.cell = patch.cell;
    if (patch.cell.diagonalRises()) {
      leaf.triangles = {{{n[0], n[1], n[3]}, {n[0], n[3], n[2]}}};
      leaf.add(n[0], n[3]);
    } else {
      leaf.triangles = {{{n[0], n[1], n[2]}, {n[1], n[3], n[2]}}};
      leaf.add(n[1], n[2]);
    }
    // The leaf above or to the right lists the side between them.
    const Cell& cell = patch.cell;
    addSide(n[0], n[1], leaf);
    addSide(n[0], n[2], leaf);
    if (cell.i + cell.span() == mesh_.grid.columns - 1) addSide(n[1], n[3], leaf);
    if (cell.j + cell.span() == mesh_.grid.rows - 1) addSide(n[2], n[3], leaf);
    for (int k = 0; k < leaf.edge_count; ++k) {
      for (const int node : {leaf.edges[k].a, leaf.edges[k].b}) leaf.box.include(nodes_[node]);
    }
    for (const int node : n) leaf.box.include(nodes_[node]);
    return leaf;
  }

  /// Adds a side, or its halves if a node hangs in its middle.
  void addSide(int a, int b, Leaf& leaf) const {
    const int first = mesh_.particle[a], last = mesh_.particle[b];
    const int steps = std::max(mesh_.grid.column(last) - mesh_.grid.column(first),
                               mesh_.grid.row(last) - mesh_.grid.row(first));
    const int middle = steps > 1 ? mesh_.node[first + (last - first) / 2] : -1;
    leaf.add(a, middle < 0 ? b : middle);
    if (middle >= 0) leaf.add(middle, b);
  }

  /// Compares the edges of one leaf with the triangles of another.
  void compare(const Leaf& one, const Leaf& other) {
    for (int k = 0; k < one.edge_count; ++k) {
      for (const auto& triangle : other.triangles) {
        if (!cut(one.edges[k], triangle)) continue;
        const std::array<int, 2> cell{other.cell.i, other.cell.j}, edge_cell{one.cell.i, one.cell.j};
        if (found_.pairs++ > 0 && std::pair(found_.cell, found_.other) <= std::pair(cell, edge_cell))
          continue;
        found_.cell = cell;
        found_.other = edge_cell;
        found_.position = cutPoint(nodes_[one.edges[k].a], nodes_[one.edges[k].b], nodes_[triangle[0]],
                                   nodes_[triangle[1]], nodes_[triangle[2]]);
      }
    }
  }

  bool cut(const SurfaceEdge& edge, const std::array<int, 3>& triangle) const {
    for (const int node : triangle) {
      if (node == edge.a || node == edge.b) return false;
    }
    const Vec3 p = nodes_[edge.a], q = nodes_[edge.b], a = nodes_[triangle[0]], b = nodes_[triangle[1]],
               c = nodes_[triangle[2]];
    const Vec3 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    if ((p.cwiseMax(q).array() < low.array()).any() || (p.cwiseMin(q).array() > high.array()).any())
      return false;
    return !meetInPlane(atRest(edge.a), atRest(edge.b), atRest(triangle[0]), atRest(triangle[1]),
                        atRest(triangle[2])) &&
           !apart(p, q, a, b, c) && meet(p, q, a, b, c);
  }

  GridPoint atRest(int node) const {
    return {mesh_.grid.column(mesh_.particle[node]), mesh_.grid.row(mesh_.particle[node])};
  }

  const ActiveMesh& mesh_;
  const Field& nodes_;
  std::vector<Leaf> leaves_;
  Crossings found_;
};

}  // namespace

Crossings findCrossings(const ActiveMesh& mesh, const Field& nodes) {
  return Surface(mesh, nodes).findCrossings();
}

}  // namespace haptic_cloth
