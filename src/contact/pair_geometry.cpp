#include "contact/pair_geometry.h"

#include <algorithm>

namespace haptic_cloth {

Vec3 fromTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double uu = ab.squaredNorm(), uv = ab.dot(ac), vv = ac.squaredNorm(), up = ap.dot(ab),
               vp = ap.dot(ac);
  const double determinant = uu * vv - uv * uv;
  if (determinant > 0.0) {
    const double v = (vv * up - uv * vp) / determinant, u = (uu * vp - uv * up) / determinant;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0) return ap - v * ab - u * ac;
  }
  const auto fromSide = [&p](const Vec3& from, const Vec3& to) {
    const Vec3 side = to - from;
    const double square = side.squaredNorm();
    return Vec3(p - from - (square > 0.0 ? std::clamp((p - from).dot(side) / square, 0.0, 1.0) : 0.0) * side);
  };
  Vec3 best = fromSide(a, b);
  for (const Vec3& other : {fromSide(b, c), fromSide(c, a)}) {
    if (other.squaredNorm() < best.squaredNorm()) best = other;
  }
  return best;
}

Vec3 betweenLines(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = d - c, r = a - c;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), ur = u.dot(r), vr = v.dot(r);
  if (!(uu > 0.0) || !(vv > 0.0)) return Vec3::Zero();
  const double determinant = uu * vv - uv * uv;
  double s = determinant > 1e-14 * uu * vv ? std::clamp((uv * vr - ur * vv) / determinant, 0.0, 1.0) : 0.0;
  const double t = std::clamp((uv * s + vr) / vv, 0.0, 1.0);
  s = std::clamp((uv * t - ur) / uu, 0.0, 1.0);
  return r + s * u - t * v;
}

/// The way is walked from distance to distance: the direction between the nearest points separates both parts
/// until one of their nodes has passed the other part along it. Rounding can tilt that of a small distance so
/// far that it separates nothing.
bool staysApartOnWay(const std::array<int, 4>& nodes, bool lines, const Field& from, const Field& to) {
  constexpr double kShare = 0.9;   // of the distance that a step may use up
  constexpr double kLeast = 1e-6;  // distance over that at the start from which on they count as meeting
  constexpr int kSteps = 200;      // a way straight into the other part takes seven
  std::array<Vec3, 4> x, way;
  for (int c = 0; c < 4; ++c) {
    x[c] = from[nodes[c]];
    way[c] = to[nodes[c]] - x[c];
  }
  const int firsts = lines ? 2 : 1;
  double left = 1.0, least = 0.0;  // share of the way; [m]
  for (int k = 0; k < kSteps; ++k) {
    const Vec3 between = lines ? betweenLines(x[0], x[1], x[2], x[3]) : fromTriangle(x[0], x[1], x[2], x[3]);
    const double distance = between.norm();
    if (k == 0) least = kLeast * distance;
    if (!(distance > least)) return false;
    double step = left;
    for (int a = 0; a < firsts; ++a) {
      for (int b = firsts; b < 4; ++b) {
        const double apart = between.dot(x[a] - x[b]) / distance,
                     closing = between.dot(way[b] - way[a]) / distance;
        if (!(apart > 0.5 * distance)) return false;
        if (closing > 0.0) step = std::min(step, (apart - (1.0 - kShare) * distance) / closing);
      }
    }
    for (int c = 0; c < 4; ++c) x[c] += step * way[c];
    left -= step;
    if (!(left > 0.0)) return true;
  }
  return false;
}

}  // namespace haptic_cloth
