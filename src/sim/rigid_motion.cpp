#include "sim/rigid_motion.h"

#include <Eigen/Eigenvalues>

namespace haptic_cloth {

RigidMotion rigidMotion(const ActiveMesh& mesh, const Field& positions, const Field& vectors) {
  // Cloth in a line has no inertia about it; rounding would make any turn of its vectors.
  constexpr double kLeastInertia = 1e-9;  // of the largest
  RigidMotion whole;
  double mass = 0.0;
  for (int n = 0; n < mesh.active(); ++n) {
    mass += mesh.mass[n];
    whole.centre += mesh.mass[n] * positions[n];
    whole.mean += mesh.mass[n] * vectors[n];
  }
  whole.centre /= mass;
  whole.mean /= mass;
  Mat3 inertia = Mat3::Zero();
  Vec3 momentum = Vec3::Zero();
  for (int n = 0; n < mesh.active(); ++n) {
    const Vec3 arm = positions[n] - whole.centre;
    inertia += mesh.mass[n] * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
    momentum += mesh.mass[n] * arm.cross(vectors[n] - whole.mean);
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(inertia);
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = axes.eigenvectors().col(k);
    const double about = axes.eigenvalues()[k];
    if (about > kLeastInertia * axes.eigenvalues()[2]) whole.turn += axis.dot(momentum) / about * axis;
  }
  return whole;
}

}  // namespace haptic_cloth
