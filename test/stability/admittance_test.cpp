/// A hand on an admittance robot: its force moves the tool, and the robot follows the tool with a
/// delay.
/// Criterion 1: the loop is quiet, as in z_width_test.cpp, if b > K_hand t, where t is the total
/// delay. For a mass m with damper b and a spring K that acts t late, -m ω² + i b ω + K exp(-iωt) =
/// 0 needs b ω = K sin ωt <= K ω t, for any m and any additional spring without delay (the cloth).
/// Far below, with a tenth of that damping, it buzzes.
/// Criterion 2: at rest hand and cloth balance, and the tool is F/k, the stretch of the coupling,
/// behind the proxy.
/// Criterion 3: passivity. Whatever the hand does, its work never falls below zero by more than the
/// energy of the coupling at the force kSlack, and hand and robot end with a loss.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "haptics/admittance_loop.h"
#include "stability/cloth_probe.h"
#include "stability/loop_parts.h"
#include "support/record.h"

namespace haptic_cloth::admittance_test {
namespace {

constexpr double kBuzz = 1.5e-4;  ///< half of the peak-to-peak motion [m]
constexpr double kLag = 0.002;    ///< lag of the robot's position controller [s]
constexpr double kSlack = 0.05;   ///< imperceptible force [N]

struct AdmittanceRun {
  HapticOptions options;
  double delay = 0.0;  ///< half on the way to the robot, half from the sensor [s]
  double noise = 0.0;  ///< uniform noise of the sensor to either side [N]
  HandModel hand;
  std::function<Vec3(double)> push;  ///< force over time that replaces the hand [N]
  SolverModel solver;
  double lost_at = 1e9;  ///< time after which no force arrives [s]
  double time = 2.0, measured = 0.5;

  /// Total delay of the loop: transport, lag of the robot, hold of the tick and step of the tool.
  double allDelay() const { return delay + kLag + 1.5 / options.rate; }
};

struct AdmittanceResult {
  /// Half of the robot's peak-to-peak motion in the last part [m].
  double amplitude = 0.0;
  Vec3 hand = Vec3::Zero();      ///< mean force of the hand in the last part [N]
  Vec3 reaction = Vec3::Zero();  ///< mean force of the cloth on the tool [N]
  Vec3 stretch = Vec3::Zero();   ///< mean of proxy - tool [m]
  /// Work of the hand: final value, and minimum over the run [J].
  double work = 0.0, least_work = 0;
  double at_rest_since = 1e9;  ///< time from which the tool stands still [s]
  /// Largest speed of the tool [m/s], and its largest change from tick to tick [m/s].
  double most_speed = 0.0, most_change = 0.0;
  bool finite = true;
};

Vec3 handForce(const AdmittanceRun& run, double time, const Vec3& robot, const Vec3& velocity) {
  if (run.push) return run.push(time);
  const double s = std::clamp((time - run.hand.press_from) / run.hand.press_time, 0.0, 1.0);
  const Vec3 way = run.hand.pressed - run.hand.start;
  const Vec3 target = run.hand.start + s * s * (3.0 - 2.0 * s) * way;
  const Vec3 target_velocity = 6.0 * s * (1.0 - s) / run.hand.press_time * way;
  return run.hand.stiffness * (target - robot) + run.hand.damping * (target_velocity - velocity);
}

/// Means, range and work of a run, updated step by step.
class Record {
 public:
  explicit Record(const AdmittanceRun& run) : run_(run) {}

  void addStep(double time, const Vec3& force, const Vec3& robot, const Vec3& velocity) {
    result_.work += kStep * force.dot(velocity);
    result_.least_work = std::min(result_.least_work, result_.work);
    if (time < run_.time - run_.measured) return;
    low_ = low_.cwiseMin(robot);
    high_ = high_.cwiseMax(robot);
    result_.hand += kStep / run_.measured * force;
  }
  void addTick(double time, const AdmittanceLoop& loop, const ProbeSnapshot& snapshot) {
    const Vec3 velocity = loop.device().velocity;
    result_.finite = result_.finite && velocity.allFinite() && loop.reaction().allFinite();
    result_.most_speed = std::max(result_.most_speed, velocity.norm());
    result_.most_change = std::max(result_.most_change, (velocity - velocity_).norm());
    velocity_ = velocity;
    result_.at_rest_since = loop.atRest() ? std::min(result_.at_rest_since, time) : 1e9;
    if (time < run_.time - run_.measured) return;
    const double share = 1.0 / (run_.options.rate * run_.measured);
    result_.reaction += share * loop.reaction();
    result_.stretch += share * (snapshot.proxy - snapshot.device);
  }
  AdmittanceResult result() {
    result_.amplitude = 0.5 * (high_ - low_).maxCoeff();
    return result_;
  }

 private:
  const AdmittanceRun& run_;
  AdmittanceResult result_;
  Vec3 low_ = Vec3::Constant(1e9), high_ = Vec3::Constant(-1e9), velocity_ = Vec3::Zero();
};

AdmittanceResult runAdmittance(const AdmittanceRun& run, ProbeWorld& world) {
  const int steps_per_tick = static_cast<int>(std::lround(1.0 / (run.options.rate * kStep)));
  AdmittanceLoop loop(run.options);
  loop.place({run.hand.start, Quat::Identity()}, 0.0);
  SolverThread solver(run.solver, world);
  DelayLine to_robot(0.5 * run.delay), from_sensor(0.5 * run.delay);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-run.noise, run.noise);
  Vec3 robot = run.hand.start, velocity = Vec3::Zero();
  ForceSample sample;
  ProbeSnapshot snapshot;
  Record record(run);
  const int steps = static_cast<int>(std::lround(run.time / kStep));
  for (int k = 0; k < steps; ++k) {
    const double time = k * kStep;
    const Vec3 force = handForce(run, time, robot, velocity);
    const Vec3 seen = from_sensor.pass(force);
    if (k % steps_per_tick == 0) {
      if (time < run.lost_at) {
        sample.received = time;
        for (int c = 0; c < 3; ++c) sample.force[c] = seen[c] + noise(random);
      }
      DeviceSample device = loop.device();
      if (k == 0) device.position = run.hand.start;
      solver.run(time, device, snapshot);
      loop.tick(sample, snapshot, false, time);
      record.addTick(time, loop, snapshot);
    }
    const Vec3 command = to_robot.pass(loop.device().position);
    velocity = (command - robot) / kLag;
    robot += kStep * velocity;
    record.addStep(time, force, robot, velocity);
  }
  return record.result();
}

AdmittanceRun handRun() {
  AdmittanceRun run;
  run.options.soft_start = 0.1;
  run.options.admittance.workspace_low = Vec3(-0.1, -0.1, -0.1);
  run.hand.damping = 0.0;  // the bound assumes a hand without damping
  return run;
}

/// Runs the loop and checks its limits, which hold in every run.
AdmittanceResult checked(const AdmittanceRun& run, ProbeWorld& world) {
  const AdmittanceResult result = runAdmittance(run, world);
  const AdmittanceOptions& tool = run.options.admittance;
  EXPECT_TRUE(result.finite);
  EXPECT_LE(result.most_speed, tool.max_speed * (1.0 + 1e-9));
  EXPECT_LE(result.most_change, std::sqrt(3.0) * tool.max_acceleration / run.options.rate * (1.0 + 1e-9));
  return result;
}

AdmittanceResult pushWall(const AdmittanceRun& run, double stiffness = 1e9) {
  WallWorld wall(run.options, stiffness);
  return checked(run, wall);
}

/// Calls visit(run) for hands, delays and masses, each with `share` of the damping of the bound.
void forHands(double share, const std::function<void(const AdmittanceRun&)>& visit) {
  for (const double stiffness : {100.0, 300.0, 1000.0}) {
    for (const double delay : {0.0, 0.002, 0.005, 0.010}) {
      for (const double mass : {0.1, 0.5, 2.0}) {
        AdmittanceRun run = handRun();
        run.hand.stiffness = stiffness;
        run.delay = delay;
        run.options.admittance.mass = mass;
        run.options.admittance.damping = share * stiffness * run.allDelay();
        visit(run);
      }
    }
  }
}

std::string words(const AdmittanceRun& run) {
  return "hand " + std::to_string(run.hand.stiffness) + " N/m, delay " + std::to_string(run.delay) +
         " s, tool " + std::to_string(run.options.admittance.mass) + " kg " +
         std::to_string(run.options.admittance.damping) + " N·s/m";
}

/// Time in which some millimetres decay below kBuzz: five times 2 m/b, where the delay takes half
/// of b, or b/K for a tool that creeps.
double settling(const AdmittanceRun& run) {
  const AdmittanceOptions& tool = run.options.admittance;
  return 1.0 + 5.0 * (4.0 * tool.mass / tool.damping + tool.damping / run.hand.stiffness);
}

TEST(Admittance, IsQuietWhereTheBoundSays) {
  for (const double height : {0.02, 0.0}) {  // in free space, and against a rigid wall
    forHands(2.0, [&](AdmittanceRun run) {
      run.hand.start.z() += height;
      run.hand.pressed.z() += height;
      run.time = settling(run);
      EXPECT_LT(pushWall(run).amplitude, kBuzz) << words(run) << ", height " << height;
    });
  }
}

TEST(Admittance, BuzzesFarOutsideTheBound) {
  forHands(0.1, [](AdmittanceRun run) {
    run.hand.start.z() += 0.02;
    run.hand.pressed.z() += 0.02;
    const AdmittanceResult result = pushWall(run);
    EXPECT_GT(result.amplitude, kBuzz) << words(run);
  });
}

TEST(Admittance, IsQuietWhileTheSolverIsSlowOrStalls) {
  for (const bool stall : {false, true}) {
    for (const double wall : {1e9, 200.0}) {
      forHands(2.0, [&](AdmittanceRun run) {
        if (stall) {
          run.solver.stall_from = 0.4;
          run.solver.stall_time = 0.5;
        } else {
          run.solver.slowness = 10.0;
        }
        run.time = 1.0 + settling(run);
        EXPECT_LT(pushWall(run, wall).amplitude, kBuzz)
            << words(run) << ", wall " << wall << (stall ? ", stalled" : ", slow");
      });
    }
  }
}

/// Default tool in a hand of 300 N/m, with a delay of 4 ms and noise, on the cloth.
AdmittanceRun clothRun() {
  AdmittanceRun run = handRun();
  run.delay = 0.004;
  run.noise = 0.02;
  run.hand.damping = 2.0;
  return run;
}

TEST(Admittance, BalancesTheHandOnTheCloth) {
  const AdmittanceRun run = clothRun();
  ClothWorldProbe world(smallDrape(run.options.coupling_stiffness, run.options.coupling_damping));
  const AdmittanceResult result = checked(run, world);
  EXPECT_EQ(world.failed(), 0);
  EXPECT_LT(result.amplitude, kBuzz);
  // Hand and coupling are two springs in series, 6 mm apart; cloth and contact take up some of
  // that.
  const double a = run.hand.stiffness, b = run.options.coupling_stiffness;
  const double springs = a * b / (a + b) * -run.hand.pressed.z();
  EXPECT_GT(-result.hand.z(), 0.8 * springs);
  EXPECT_LT(-result.hand.z(), 1.05 * springs);
  record({"admittance tool on the cloth", "cloth's force, expected: the hand's [N]", "amrc", 0.0,
          result.reaction.z(), -result.hand.z(), springs});
  record({"admittance tool on the cloth", "coupling's length, expected: F/k [m]", "amrc", 0.0,
          result.stretch.z(), -result.hand.z() / b, springs / b});
  EXPECT_NEAR(result.reaction.z(), -result.hand.z(), 0.01 * springs);
  EXPECT_NEAR(result.stretch.z(), -result.hand.z() / b, 0.02 * springs / b);
}

TEST(Admittance, IsQuietOnTheClothWhileTheSolverIsSlow) {
  AdmittanceRun run = clothRun();
  run.solver.slowness = 10.0;
  run.time = 2.5;
  ClothWorldProbe world(smallDrape(run.options.coupling_stiffness, run.options.coupling_damping));
  EXPECT_LT(checked(run, world).amplitude, kBuzz);
}

/// Pushes of up to 2 N: three times into the surface below and out again, and along it.
AdmittanceRun pushedRun() {
  AdmittanceRun run = handRun();
  run.hand.start.z() = 0.003;
  run.push = [](double time) {
    const double turn = 2.0 * M_PI * time;
    return Vec3(0.3 * std::sin(3.0 * turn), 0.0, -std::sin(1.5 * turn) - std::sin(2.5 * turn));
  };
  run.options.admittance.damping = 1.0;  // low, so that it does not dissipate everything
  run.options.admittance.mass = 0.2;
  return run;
}

void expectPassive(const AdmittanceRun& run, const AdmittanceResult& result) {
  const double slack = 0.5 * kSlack * kSlack / run.options.coupling_stiffness;
  EXPECT_GE(result.least_work, -slack);
  EXPECT_GT(result.work, 0.0);
}

TEST(Admittance, MakesNoEnergy) {
  for (const double wall : {1e9, 1000.0, 200.0}) {
    for (const double slowness : {1.0, 5.0}) {
      AdmittanceRun run = pushedRun();
      run.solver.slowness = slowness;
      expectPassive(run, pushWall(run, wall));
    }
  }
  const AdmittanceRun run = pushedRun();
  ClothWorldProbe world(smallDrape(run.options.coupling_stiffness, run.options.coupling_damping));
  expectPassive(run, checked(run, world));
}

TEST(Admittance, ALostForceBringsItToRest) {
  for (const double lost_at : {0.12, 0.2, 1.0}) {  // moving, at the wall, pressed
    AdmittanceRun run = clothRun();
    run.lost_at = lost_at;
    run.time = lost_at + 0.5;
    const AdmittanceResult result = pushWall(run);
    const AdmittanceOptions& tool = run.options.admittance;
    EXPECT_LE(result.at_rest_since,
              lost_at + tool.force_timeout + tool.max_speed / tool.max_acceleration + 3.0 / run.options.rate);
  }
}

}  // namespace
}  // namespace haptic_cloth::admittance_test
