#include "contact/sample_finder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/friction_law.h"
#include "shape/solid_lanes.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace {

constexpr double kFlat = 0.1;    // rise of the arc of an obstacle over a cell that counts as flat [ranges]
constexpr double kPile = 10.0;   // height of layers that bend like the obstacle below them [ranges]
constexpr double kStart = 3e-8;  // time that the start of a sample takes, about [s]

/// Largest distance of the samples of a probe: a third of half its width, and of the radius on which a ball
/// of that size that touches flat cloth is nearer to it than the range [m].
double probeSpacing(const Solid& probe, double range) {
  const double width = probe.halfWidth();
  return std::min(width, std::sqrt(2.0 * width * range)) / 3.0;
}

/// Share of a way that another way makes [-]; 1 of none.
double shareAlong(const Vec3& way, const Vec3& whole) {
  const double squared = whole.squaredNorm();
  return squared > 0.0 ? way.dot(whole) / squared : 1.0;
}

}  // namespace

SampleFinder::SampleFinder(const Grid& grid, const SolidSet& solids, const ContactLaw& law,
                           const FrictionMemory& memory, Team& team)
    : grid_(grid),
      solids_(solids),
      law_(law),
      memory_(memory),
      team_(team),
      gaps_(grid),
      edges_(grid, law.range(), gaps_) {
  const int samples = capacity();
  probes_.reserve(solids.size());
  is_let_out_.reserve(grid.particles());
  started_.reserve(samples);
  near_.reserve(samples);
  near_probe_.reserve(grid.particles());
  dented_.reserve(grid.cells());
  for (auto* list : {&node_area_, &still_}) list->reserve(grid.particles());
  double shortest = EdgeDivision::kCut * law_.range();
  for (int k = solids_.obstacles(); k < solids_.size(); ++k)
    shortest = std::min(shortest, probeSpacing(solids_[k], law_.range()));
  const int span = 1 << grid_.levels, rest = 2 * span + 4;  // rest: parts beside an edge, and rounding
  const int most = static_cast<int>(span * grid_.longestSpacing() / shortest) + rest;
  lines_.reserve(most);
  candidates_.reserve(samples);
  for (Distances* distances : {&now_, &then_}) distances->reserve(samples);
}

int SampleFinder::capacity() const {
  const int particles = grid_.particles(), solids = solids_.size();
  const double spacing = grid_.longestSpacing();
  bool fine = chord(2.0) <= EdgeDivision::kCut * law_.range();
  for (int k = solids_.obstacles(); k < solids; ++k) {
    fine = fine && spacing <= probeSpacing(solids_[k], law_.range());
  }
  const int places = fine ? (particles + particles / 2) * solids : 4 * particles * (solids + 1);
  return places + 2 * kPack * solids;
}

void SampleFinder::findProbes(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                              const Field& motion, const std::vector<Reach>& touching, SampleList& samples) {
  samples.clear();
  probes_.clear();
  for (const Reach& probe : touching) {
    const int solid = solids_.indexOf(probe.probe);
    addProbePoints(mesh, nodes, reach, probe);
    if (addGroup(solid, motion, samples)) probes_.push_back(solid);
  }
  near_probe_.assign(mesh.nodes(), 0);
  dented_.assign(mesh.patches.size(), 0);
  if (probes_.empty()) return;
  for (int n = 0; n < mesh.nodes(); ++n) near_probe_[n] = isNearProbe(nodes[n]) ? 1 : 0;
  for (std::size_t k = 0; k < mesh.patches.size(); ++k)
    dented_[k] = layersMayBeDented(mesh.patches[k], nodes) ? 1 : 0;
}

/// Tells whether a probe may dent layers that press on each other in a finest cell, see dented(). They press
/// before the probe comes. So they have to lie flat there: over a curve even layers do not press evenly on
/// nodes and middles.
bool SampleFinder::layersMayBeDented(const Patch& patch, const Field& nodes) const {
  const auto isOverCurve = [&](int n) {
    const double near = kPile * law_.range() + grid_.longestSpacing();
    for (int k = 0; k < solids_.obstacles(); ++k) {
      const Solid& solid = solids_[k];
      if (solid.edgeDistance(nodes[n]) < near) return true;
      if (!isFlat(solid) && solid.distance(nodes[n]).value < near) return true;
    }
    return false;
  };
  return isFinestNearProbe(patch) && std::none_of(patch.nodes.begin(), patch.nodes.end(), isOverCurve);
}

bool SampleFinder::isFinestNearProbe(const Patch& patch) const {
  return patch.cell.span() == 1 &&
         std::any_of(patch.nodes.begin(), patch.nodes.end(), [&](int n) { return near_probe_[n] != 0; });
}

/// Tells whether an obstacle counts as flat over the diagonal of a finest cell.
bool SampleFinder::isFlat(const Solid& solid) const {
  const double bulge = (grid_.dx * grid_.dx + grid_.dy * grid_.dy) / 8.0 * solid.curvature();
  return bulge <= kFlat * law_.range();
}

void SampleFinder::findObstacles(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                                 const Field& motion, SampleList& samples) {
  is_let_out_.assign(mesh.nodes(), 0);
  for (const int particle : let_out_) {
    if (mesh.node[particle] >= 0) is_let_out_[mesh.node[particle]] = 1;
  }
  const Ball ball = ballAround(nodes, reach);
  for (int solid = 0; solid < solids_.obstacles(); ++solid) {
    if (solids_[solid].distance(ball.centre).value > ball.radius + law_.range()) continue;
    const Solid sharp = solids_[solid].sharp();
    gaps_.measure(sharp, law_.range(), mesh, nodes, reach, team_);
    edges_.find(sharp, mesh, nodes);
    addCells(solids_[solid], mesh, nodes);
    addGroup(solid, motion, samples);
    addNodes(mesh, nodes, reach);
    addGroup(solid, motion, samples);
  }
  listLetOut(mesh, samples);
}

std::optional<Vec3> SampleFinder::wayOut(const ActiveMesh& mesh, const Field& nodes, int probe) {
  still_.assign(mesh.nodes(), 0.0);
  addProbePoints(mesh, nodes, still_, {probe, 0.0});
  selectNear(solids_.indexOf(probe));
  Vec3 out = Vec3::Zero();
  for (const int k : near_) out -= candidates_.point(k).area * (law_.range() - now_.gaps[k]) * now_[k].normal;
  candidates_.clear();
  if (near_.empty()) return std::nullopt;
  return out.stableNormalized();
}

/// The ball around the box around the nodes.
SampleFinder::Ball SampleFinder::ballAround(const Field& nodes, const std::vector<double>& reach) {
  Vec3 low, high;
  for (int c = 0; c < 3; ++c) {
    const Eigen::Map<const Eigen::ArrayXd> values(nodes.coordinate(c).data(), nodes.size());
    low[c] = values.minCoeff();
    high[c] = values.maxCoeff();
  }
  const Eigen::Map<const Eigen::ArrayXd> reaches(reach.data(), nodes.size());
  return {0.5 * (low + high), 0.5 * (high - low).norm() + reaches.maxCoeff()};
}

/// Adds points of the cells on which an obstacle does not press evenly. The other cells leave their
/// area to their nodes.
void SampleFinder::addCells(const Solid& solid, const ActiveMesh& mesh, const Field& nodes) {
  node_area_.assign(mesh.nodes(), 0.0);
  for (int k = 0; k < static_cast<int>(mesh.patches.size()); ++k) {
    const double near = gaps_.margin(k);
    if (near < 0.0) continue;
    const Patch& patch = mesh.patches[k];
    const bool may_be_dented = mayBeDented(solid, patch, nodes);
    if ((may_be_dented && edges_.divideEvenly(solid, patch, nodes, lines_)) ||
        edges_.divide(solid, patch, nodes, lines_)) {
      candidates_.addCrossings(lines_, patch, solid, nodes, near);
      continue;
    }
    const int parts = partsOf(patch);
    const bool dented = parts == 1 && may_be_dented;
    const double corner_area = patch.area / (dented ? 36 : 4 * parts * parts);
    for (const int corner : patch.nodes) node_area_[corner] += corner_area;
    if (parts > 1) candidates_.addCorners(patch, parts, nodes, near);
    // Corners alone would carry up to four times the pressure in a dent, which grows fast with depth.
    if (dented) candidates_.addMiddles(patch, nodes, near);
  }
}

/// Tells whether a probe may dent a finest cell. It must not depend on the pressure: if the weights changed
/// with it, a hand could gain energy on a closed path. They may change away from the dent, where the pressure
/// is even. It is not on a round obstacle, which is nearer to the middle of a wide cell than to its corners.
/// Cloth that is ejected needs its nodes as samples.
bool SampleFinder::mayBeDented(const Solid& solid, const Patch& patch, const Field& nodes) const {
  const auto was_put_inside = [&](int n) {
    if (!(gaps_.nodes().gaps[n] < 0.0)) return false;
    const double gap = solid.distance(nodes[n]).value;
    return gap < 0.0 && (is_let_out_[n] || !isPressedIn(nodes[n], gap));
  };
  return isFlat(solid) && isFinestNearProbe(patch) &&
         std::none_of(patch.nodes.begin(), patch.nodes.end(), was_put_inside);
}

/// Tells whether a probe that touches is so near that it may press cloth here into an obstacle.
bool SampleFinder::isNearProbe(const Vec3& place) const {
  const double near = law_.range() + grid_.longestSpacing();
  return std::any_of(probes_.begin(), probes_.end(), [&](int index) {
    const Solid& probe = solids_[index];
    return (place - probe.position()).norm() < probe.extent() + near && probe.distance(place).value < near;
  });
}

/// Tells whether a load may keep cloth at a gap below zero, up to the range deep: it was not put there.
bool SampleFinder::isPressedIn(const Vec3& place, double gap) const {
  return gap > -law_.range() && isNearProbe(place);
}

/// Lists what obstacles let out in this step. It stays so until it has left them: pressed in, it would be
/// thrown out.
void SampleFinder::listLetOut(const ActiveMesh& mesh, const SampleList& samples) {
  let_out_.clear();
  is_let_out_.assign(mesh.nodes(), 0);
  for (const ContactSample& sample : samples) {
    if (!sample.isLetOut()) continue;
    for (int c = 0; c < 4; ++c) {
      const int node = sample.nodes[c];
      if (sample.weights[c] == 0.0 || is_let_out_[node]) continue;
      is_let_out_[node] = 1;
      let_out_.push_back(mesh.particle[node]);
    }
  }
}

void SampleFinder::serialize(Archive& archive) {
  archive.length("let_out", let_out_, grid_.particles());
  archive.within("let_out_particle", let_out_, 0, grid_.particles() - 1);
}

/// Adds the nodes with the area that addCells() left to them.
void SampleFinder::addNodes(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach) {
  for (int n = 0; n < mesh.nodes(); ++n) {
    const double near = law_.range() + reach[n];
    if (node_area_[n] == 0.0 || gaps_.nodes().gaps[n] > near) continue;
    const int particle = mesh.particle[n];
    const FlatPoint flat{double(grid_.column(particle)), double(grid_.row(particle))};
    candidates_.add(SurfacePoint::atNode(n, node_area_[n], flat), nodes[n], near);
  }
}

/// Number of parts of a cell's side to be sampled. It is 1 if the obstacle presses evenly: one
/// normal at the corners, and gaps whose difference hardly changes the pressure. Otherwise it is
/// the number of finest cells, but no part is smaller than a share of the range. It is larger if a
/// round solid would cut deeper into these parts than that share.
int SampleFinder::partsOf(const Patch& patch) const {
  constexpr double kSameNormal = 1e-3, kShareOfRange = 0.1;
  // Largest differences over all pairs; with one corner as reference, mirrored cells would differ.
  const std::vector<double>& gap = gaps_.nodes().gaps;
  double gaps = 0.0, turn = 0.0;
  for (int c = 1; c < 4; ++c) {
    for (int d = 0; d < c; ++d) {
      gaps = std::max(gaps, std::abs(gap[patch.nodes[c]] - gap[patch.nodes[d]]));
      turn = std::max(turn, gaps_.normalTurn(patch, c, d));
    }
  }
  const bool uneven = gaps > kShareOfRange * law_.range() || turn > kSameNormal;
  const int span = patch.cell.span();
  const double smallest = EdgeDivision::kCut * law_.range(), side = span * grid_.longestSpacing();
  const int finest = uneven ? std::min<int>(span, std::ceil(side / smallest)) : 1;
  return finest *
         static_cast<int>(std::clamp(std::ceil(chord(turn) / smallest), 1.0, EdgeDivision::kMostParts));
}

/// Adds points of the cells near a probe, in rows and columns that are dense enough for it.
void SampleFinder::addProbePoints(const ActiveMesh& mesh, const Field& nodes,
                                  const std::vector<double>& reach, const Reach& touching) {
  const Solid& solid = solids_[solids_.indexOf(touching.probe)];
  gaps_.measure(solid, law_.range() + touching.distance, mesh, nodes, reach, team_);
  for (int k = 0; k < static_cast<int>(mesh.patches.size()); ++k) {
    const double near = gaps_.margin(k);
    if (near < 0.0) continue;
    const Patch& patch = mesh.patches[k];
    for (const int direction : {kWarp, kWeft}) {
      const double parts =
          std::ceil(patch.cell.span() * grid_.spacing(direction) / probeSpacing(solid, law_.range()));
      lines_.clear(direction);
      lines_.addMiddles(direction, std::max(1, static_cast<int>(parts)));
    }
    candidates_.addCrossings(lines_, patch, solid, nodes, near);
  }
}

/// Selects the candidates that are near a solid at the start of the step.
void SampleFinder::selectNear(int solid) {
  const bool still = solids_.isStill(solid);
  const int count = candidates_.size();
  now_.measure(solids_[solid], count, candidates_.places(), team_);
  if (!still) then_.measure(solids_.before(solid), count, candidates_.places(), team_);
  near_.clear();
  for (int k = 0; k < count; ++k) {
    if (!(now_.gaps[k] > candidates_.margin(k))) near_.push_back(k);
  }
}

/// Adds the candidates that are near a solid. Touching samples come first, so that packs of the
/// others can be skipped. @return whether any touches
bool SampleFinder::addGroup(int solid, const Field& motion, SampleList& samples) {
  selectNear(solid);
  const int count = static_cast<int>(near_.size());
  if (static_cast<int>(started_.size()) < count) started_.resize(count);
  const Eigen::AngleAxisd turn = solids_.turnInStep(solid);
  const SolidStep step{solids_.isStill(solid), turn, turn.toRotationMatrix()};
  const auto start = [&](int begin, int end) {
    for (int s = begin; s < end; ++s) started_[s] = startSample(near_[s], solid, step, motion);
  };
  team_.forRange(count, start, kStart);
  candidates_.clear();
  samples.beginGroup(solid);
  const int first = samples.size();
  for (const bool apart : {false, true}) {
    for (std::size_t s = 0; s < near_.size(); ++s) {
      if ((started_[s].clearance > 0.0) == apart) samples.add(started_[s]);
    }
  }
  const bool touches = samples.size() > first && !(samples[first].clearance > 0.0);
  samples.endGroup();
  return touches;
}

/// Tells whether a point moves with a node that is let out.
bool SampleFinder::touchesLetOut(const SurfacePoint& point) const {
  for (int c = 0; c < 4; ++c) {
    if (point.weights[c] > 0.0 && is_let_out_[point.nodes[c]]) return true;
  }
  return false;
}

/// Slip over the smoothing length for the friction that is remembered, before the solid turns.
Vec3 SampleFinder::elasticSlip(const ContactSample& sample) const {
  return slipUnder(sample.area / sample.friction_force * memory_.find(sample.solid, sample.flat));
}

/// Starts a sample. If a moving solid touches it only at the end of the step, it has no friction
/// yet.
ContactSample SampleFinder::startSample(int point, int index, const SolidStep& step,
                                        const Field& motion) const {
  const Solid &solid = solids_[index], &before = solids_.before(index);
  const Vec3 place = candidates_.places()[point];
  const Distance then = step.still ? now_[point] : then_[point];
  ContactSample sample{candidates_.point(point), index};
  // A probe came from outside, so what is inside it is under load.
  sample.pressed_in = solids_.isProbe(index) ||
                      (then.value < 0.0 && !touchesLetOut(sample) && isPressedIn(place, then.value));
  sample.count = law_.count(then.value, sample.pressed_in);
  // Ejected cloth has no friction, which would hold it inside.
  const double friction = sample.isLetOut() ? 0.0 : solid.friction();
  sample.friction_force = friction * sample.area * law_(then.value + sample.count.offset).pressure;
  Vec3 carried = place;
  sample.start_normal = then.normal;
  if (sample.friction_force > 0.0) sample.elastic_slip = elasticSlip(sample);
  if (!step.still) {
    const Vec3 arm = place - before.position(), turned = step.rotation * arm;
    carried = solid.position() + turned;
    sample.turn_share = shareAlong(sample.of(motion) - solids_.way(index), turned - arm);
    // Where cloth slips in place on a roller the normal stays, or friction would press the cloth on.
    sample.start_normal = partOf(step.turn, std::clamp(sample.turn_share, 0.0, 1.0)) * then.normal;
    sample.elastic_slip = step.rotation * sample.elastic_slip;
  }
  sample.elastic_slip -= sample.elastic_slip.dot(sample.start_normal) * sample.start_normal;
  sample.start = carried - solids_.origin(index);
  sample.carry = carried - place;
  sample.clearance = now_.gaps[point] - law_.range() - sample.carry.norm();
  return sample;
}

}  // namespace haptic_cloth
