#include "support/exact_geometry.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

namespace haptic_cloth {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 point(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

Kernel::Triangle_3 exact(const Triangle& t) { return {point(t[0]), point(t[1]), point(t[2])}; }

}  // namespace

bool isCollapsed(const Triangle& triangle) {
  return CGAL::collinear(point(triangle[0]), point(triangle[1]), point(triangle[2]));
}

bool doIntersect(const Segment& segment, const Triangle& triangle) {
  if (segment[0] == segment[1]) return exact(triangle).has_on(point(segment[0]));
  return CGAL::do_intersect(Kernel::Segment_3(point(segment[0]), point(segment[1])), exact(triangle));
}

bool doIntersect(const Triangle& a, const Triangle& b) { return CGAL::do_intersect(exact(a), exact(b)); }

}  // namespace haptic_cloth
