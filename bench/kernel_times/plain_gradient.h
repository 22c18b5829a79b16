/// Reference for bench/kernels: the cost of value and gradient of stretch, bending and shear in
/// plain loops. It shares no code with the library.
#pragma once

#include <vector>

namespace haptic_cloth {

/// A square sheet of n x n particles with linear laws, near its rest shape.
class PlainSheet {
 public:
  explicit PlainSheet(int n);

  int particles() const { return n_ * n_; }

  /// Writes the gradient [N]. @return energy of stretch, bending and shear [J]
  double gradient();

 private:
  struct Vector {
    double x, y, z;
  };
  static Vector minus(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  static double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  void add(int particle, double factor, const Vector& v) {
    gradient_[particle].x += factor * v.x;
    gradient_[particle].y += factor * v.y;
    gradient_[particle].z += factor * v.z;
  }
  double stretch(int a, int b);
  double bend(int left, int centre, int right);
  double shear(int a, int b, int c, int d);

  int n_;
  std::vector<Vector> position_, normal_, gradient_;
};

}  // namespace haptic_cloth
