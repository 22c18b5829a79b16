#include "contact/contact_set.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {

ContactSet::ContactSet(const Grid& grid, const std::vector<Obstacle>& obstacles, const Options& options)
    : options_(options), law_(options.range), grid_(grid) {
  for (const Obstacle& obstacle : obstacles) obstacles_.emplace_back(obstacle);
  const std::size_t capacity = grid.particles() * (obstacles.size() + 1) + 4 * grid.cells();
  samples_.reserve(capacity);
  slots_.reserve(capacity);
  entries_.reserve(4 * capacity);
  rows_.reserve(grid.particles() + 1);
}

Vec3 ContactSet::samplePosition(const ContactSample& sample, const Field& values) const {
  return sample.weights[0] * values[sample.nodes[0]] + sample.weights[1] * values[sample.nodes[1]] +
         sample.weights[2] * values[sample.nodes[2]] + sample.weights[3] * values[sample.nodes[3]];
}

Distance ContactSet::distance(int solid, const Vec3& point, const Vec3& proxy) const {
  if (solid != kProbe) return obstacles_[solid].distance(point);
  const Vec3 offset = point - proxy;
  const double d = offset.norm();
  return {d - options_.probe_radius, d > 0.0 ? Vec3(offset / d) : Vec3::UnitZ()};
}

void ContactSet::collect(const ActiveMesh& mesh, const Field& nodes, double reach, const Vec3* proxy,
                         double proxy_reach) {
  samples_.clear();
  sampleObstacles(mesh, nodes, law_.range() + reach);
  if (proxy) sampleProbe(mesh, nodes, law_.range() + reach + proxy_reach, *proxy);
  slots_.resize(samples_.size());
  buildRows(mesh.nodes());
}

namespace {

/// Centre and radius of a sphere around a cell's surface.
std::pair<Vec3, double> boundingSphere(const Patch& patch, const Field& nodes) {
  const auto& n = patch.nodes;
  const Vec3 centre = 0.25 * (nodes[n[0]] + nodes[n[1]] + nodes[n[2]] + nodes[n[3]]);
  double radius = 0.0;
  for (const int corner : n) radius = std::max(radius, (nodes[corner] - centre).squaredNorm());
  return {centre, std::sqrt(radius)};
}

/// The part of a row of samples across a cell that may lie within reach of the probe.
struct Window {
  /// @param length of the cell at rest [m]  @param side its mean side now [m]  @param offset of the probe
  /// from its centre
  Window(double length, double spacing, const Vec3& side, const Vec3& offset, double reach)
      : count(std::max(1, static_cast<int>(std::ceil(length / spacing)))) {
    // Twice the reach makes up for cells that are not flat rectangles.
    const double middle = 0.5 + offset.dot(side) / std::max(side.squaredNorm(), 1e-300),
                 half = 2.0 * reach / std::max(side.norm(), 1e-300);
    first = static_cast<int>(count * std::clamp(middle - half, 0.0, 1.0));
    last = static_cast<int>(std::ceil(count * std::clamp(middle + half, 0.0, 1.0)));
  }
  int count, first, last;
};

}  // namespace

void ContactSet::sampleObstacles(const ActiveMesh& mesh, const Field& nodes, double margin) {
  if (obstacles_.empty()) return;
  for (const Patch& patch : mesh.patches) {
    const auto [centre, radius] = boundingSphere(patch, nodes);
    const Cell& cell = patch.cell;
    const int s = cell.span();
    // Each finest-grid point belongs to one cell: the one it is the lower left of, or the last on a border.
    const int i_end = cell.i + s == grid_.columns - 1 ? s : s - 1,
              j_end = cell.j + s == grid_.rows - 1 ? s : s - 1;
    for (int solid = 0; solid < static_cast<int>(obstacles_.size()); ++solid) {
      if (obstacles_[solid].distance(centre).value > radius + margin) continue;
      for (int j = 0; j <= j_end; ++j) {
        const double height = cell.j + j == 0 || cell.j + j == grid_.rows - 1 ? 0.5 : 1.0;
        for (int i = 0; i <= i_end; ++i) {
          const double width = cell.i + i == 0 || cell.i + i == grid_.columns - 1 ? 0.5 : 1.0;
          addSample(patch, static_cast<double>(i) / s, static_cast<double>(j) / s,
                    width * height * grid_.dx * grid_.dy, solid, nodes, margin, Vec3::Zero());
        }
      }
    }
  }
}

void ContactSet::sampleProbe(const ActiveMesh& mesh, const Field& nodes, double margin, const Vec3& proxy) {
  const double spacing = options_.probe_radius / 3.0, reach = options_.probe_radius + margin;
  for (const Patch& patch : mesh.patches) {
    const auto [centre, radius] = boundingSphere(patch, nodes);
    if ((centre - proxy).norm() > reach + radius) continue;
    const auto& n = patch.nodes;
    const Vec3 u = 0.5 * (nodes[n[3]] + nodes[n[1]] - nodes[n[2]] - nodes[n[0]]),
               v = 0.5 * (nodes[n[3]] + nodes[n[2]] - nodes[n[1]] - nodes[n[0]]);
    const Window columns(patch.cell.span() * grid_.dx, spacing, u, proxy - centre, reach);
    const Window rows(patch.cell.span() * grid_.dy, spacing, v, proxy - centre, reach);
    const double area = patch.area / (static_cast<double>(columns.count) * rows.count);
    for (int j = rows.first; j < rows.last; ++j) {
      for (int i = columns.first; i < columns.last; ++i) {
        addSample(patch, (i + 0.5) / columns.count, (j + 0.5) / rows.count, area, kProbe, nodes, margin,
                  proxy);
      }
    }
  }
}

bool ContactSet::isClear(const ActiveMesh& mesh, const Field& nodes, const Vec3& proxy) {
  samples_.clear();
  sampleProbe(mesh, nodes, law_.range(), proxy);
  const bool clear = samples_.empty();
  samples_.clear();
  return clear;
}

void ContactSet::addSample(const Patch& patch, double u, double v, double area, int solid, const Field& nodes,
                           double margin, const Vec3& proxy) {
  ContactSample sample{};
  sample.nodes = patch.nodes;
  sample.weights = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
  sample.area = area;
  sample.solid = solid;
  const Vec3 position = samplePosition(sample, nodes);
  const Distance d = distance(solid, position, proxy);
  if (d.value > margin) return;
  sample.raised = d.value < 0.0 ? law_.firmGap() - d.value : 0.0;
  const double friction = solid == kProbe ? options_.probe_friction : obstacles_[solid].friction();
  sample.friction_force = friction * area * law_(d.value + sample.raised).pressure;
  sample.start = solid == kProbe ? Vec3(position - proxy) : position;
  sample.start_normal = d.normal;
  samples_.push_back(sample);
}

void ContactSet::buildRows(int nodes) {
  rows_.assign(nodes + 1, 0);
  const auto visit = [&](const auto& put) {
    for (int k = 0; k < size(); ++k) {
      for (int c = 0; c < 4; ++c) {
        if (samples_[k].weights[c] > 0.0) put(samples_[k].nodes[c], Entry{k, samples_[k].weights[c]});
      }
    }
  };
  visit([&](int node, const Entry&) { ++rows_[node + 1]; });
  for (int n = 0; n < nodes; ++n) rows_[n + 1] += rows_[n];
  entries_.resize(rows_[nodes]);
  visit([&](int node, const Entry& entry) { entries_[rows_[node]++] = entry; });
  for (int n = nodes; n > 0; --n) rows_[n] = rows_[n - 1];
  rows_[0] = 0;
}

ContactSet::Energy ContactSet::evaluate(int begin, int end, const Field& nodes, const Vec3& proxy) {
  const double epsilon = options_.slip_speed * options_.time_step;
  Energy energy;
  for (int k = begin; k < end; ++k) {
    const ContactSample& sample = samples_[k];
    const Vec3 position = samplePosition(sample, nodes);
    const Distance d = distance(sample.solid, position, proxy);
    const ContactLaw::Point contact = law_(d.value + sample.raised);
    Slot& slot = slots_[k];
    slot.gap = d.value;
    slot.normal = d.normal;
    slot.normal_stiffness = sample.area * contact.stiffness;
    slot.tangent_stiffness = 0.0;
    slot.pressing = sample.area * contact.pressure;
    slot.gradient = -slot.pressing * d.normal;
    energy.contact += sample.area * contact.energy;
    if (sample.friction_force > 0.0) {
      const Vec3 moved = (sample.solid == kProbe ? Vec3(position - proxy) : position) - sample.start;
      const Vec3 slip = moved - sample.start_normal.dot(moved) * sample.start_normal;
      const SmoothSlip smooth = smoothSlip(slip.norm(), epsilon);
      energy.friction += sample.friction_force * smooth.potential;
      slot.tangent_stiffness = sample.friction_force * smooth.ratio;
      slot.gradient += slot.tangent_stiffness * slip;
    }
  }
  return energy;
}

double ContactSet::curvature(int begin, int end, const Field& d, const Vec3& d_proxy) const {
  double sum = 0.0;
  for (int k = begin; k < end; ++k) {
    const ContactSample& sample = samples_[k];
    const Slot& slot = slots_[k];
    if (slot.normal_stiffness == 0.0 && slot.tangent_stiffness == 0.0) continue;
    Vec3 moved = samplePosition(sample, d);
    if (sample.solid == kProbe) moved -= d_proxy;
    const double normal = slot.normal.dot(moved), start = sample.start_normal.dot(moved);
    sum += slot.normal_stiffness * normal * normal +
           slot.tangent_stiffness * (moved.squaredNorm() - start * start);
  }
  return sum;
}

void ContactSet::addGradient(int begin, int end, Field& gradient) const {
  for (int n = begin; n < end; ++n) {
    for (int e = rows_[n]; e < rows_[n + 1]; ++e) {
      gradient.add(n, entries_[e].weight * slots_[entries_[e].sample].gradient);
    }
  }
}

namespace {

Vec3 diagonalOf(const Vec3& normal, const Vec3& start_normal, double normal_stiffness,
                double tangent_stiffness) {
  return normal_stiffness * normal.cwiseAbs2() +
         tangent_stiffness * (Vec3::Ones() - start_normal.cwiseAbs2());
}

}  // namespace

void ContactSet::addDiagonal(Field& diagonal) const {
  for (int n = 0; n < diagonal.size(); ++n) {
    for (int e = rows_[n]; e < rows_[n + 1]; ++e) {
      const Slot& slot = slots_[entries_[e].sample];
      diagonal.add(n, entries_[e].weight * entries_[e].weight *
                          diagonalOf(slot.normal, samples_[entries_[e].sample].start_normal,
                                     slot.normal_stiffness, slot.tangent_stiffness));
    }
  }
}

Vec3 ContactSet::proxyGradient() const {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < size(); ++k) {
    if (samples_[k].solid == kProbe) sum -= slots_[k].gradient;
  }
  return sum;
}

Vec3 ContactSet::proxyDiagonal() const {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < size(); ++k) {
    if (samples_[k].solid != kProbe) continue;
    sum += diagonalOf(slots_[k].normal, samples_[k].start_normal, slots_[k].normal_stiffness,
                      slots_[k].tangent_stiffness);
  }
  return sum;
}

Vec3 ContactSet::obstacleForce() const {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < size(); ++k) {
    if (samples_[k].solid != kProbe) sum -= slots_[k].gradient;
  }
  return sum;
}

double ContactSet::maxStep(const Field& nodes, const Vec3& proxy, const Field& d, const Vec3& d_proxy) const {
  constexpr double kShareOfGap = 0.9;
  double step = 1e300;
  for (int k = 0; k < size(); ++k) {
    const ContactSample& sample = samples_[k];
    if (sample.solid != kProbe) continue;
    const Distance now = distance(kProbe, samplePosition(sample, nodes), proxy);
    const double closing = -now.normal.dot(samplePosition(sample, d) - d_proxy);
    // The distance is convex along the step: its tangent bounds it from below.
    if (now.value > 0.0 && closing > 0.0) step = std::min(step, kShareOfGap * now.value / closing);
  }
  return step;
}

double ContactSet::deepest() const {
  double deepest = 0.0;
  for (const Slot& slot : slots_) deepest = std::max(deepest, -slot.gap);
  return deepest;
}

void ContactSet::calm(Field& velocities) const {
  for (const ContactSample& sample : samples_) {
    if (sample.raised == 0.0) continue;
    for (const int node : sample.nodes) velocities.set(node, Vec3::Zero());
  }
}

bool ContactSet::probeTouched() const {
  return std::any_of(slots_.begin(), slots_.end(), [this](const Slot& slot) {
    return slot.normal_stiffness > 0.0 && samples_[&slot - slots_.data()].solid == kProbe;
  });
}

}  // namespace haptic_cloth
