// SPDX-License-Identifier: MIT
// Block whose top is a wave along its length. It is object I of Sun and Min 2021. For vertical lines, intersections
// have a closed form. For other lines, bisection and Newton's method find them between the critical points.
#include <palpate/math.hpp>

#include "solid.hpp"

namespace palpate::shapes {

struct WaveOptions : Options {
  double length = 0.16;
  double width = 0.06;
  double height = 0.09;
  double amplitude = 0.02;
  double period = 0.08;

  void list(Fields& fields) override {
    fields.real(length, Field("length", "size along x, the direction of the wave")
                            .in(Unit::metre)
                            .above(0)
                            .from("Sun and Min 2021: 16 cm"));
    fields.real(
        width,
        Field("width", "size along y, parallel to the crests").in(Unit::metre).above(0).from("Sun and Min 2021: 6 cm"));
    fields.real(height, Field("height", "mean height of the top above the desk").in(Unit::metre).above(0));
    fields.real(
        amplitude,
        Field("amplitude", "amplitude of the wave. The centre of the block is on a crest").in(Unit::metre).at_least(0));
    fields.real(period, Field("period", "distance from one crest to the next").in(Unit::metre).above(0));
    fields.require(amplitude <= height, "amplitude",
                   "is larger than the mean height, so the top would be below the desk");
  }
};

constexpr double kPi = 3.14159265358979323846;

class Wave final : public Shape {
 public:
  using Options = WaveOptions;
  Wave(const Options& o, const Context&) : o_(o) {}

  double top(double s, double t) const override {
    if (std::abs(s) > half_length_ || std::abs(t) > half_width_) return -kInfinity;
    return height_at(s);
  }

  double first_intersection(const Line& line) const override {
    const Interval box = box_interval(line);
    if (box.empty() || clearance(line, box.begin) <= 0.0) return box.first();
    for (double from = box.begin; from < box.end;) {
      const double to = std::min(box.end, next_turn(line, from));
      if (clearance(line, to) <= 0.0) return crossing(line, from, to);
      from = to;
    }
    return kInfinity;
  }

  std::vector<LineInterval> intervals(const Line& line) const override {
    const Interval box = box_interval(line);
    std::vector<LineInterval> all;
    for (double from = box.begin; from < box.end;) {
      const double to = std::min(box.end, next_turn(line, from));
      const bool within = clearance(line, from) <= 0.0;
      const bool stays = clearance(line, to) <= 0.0;
      const double between = within == stays ? to : within ? crossing(line, to, from) : crossing(line, from, to);
      if (within) all.push_back({from, between});
      if (stays && !within) all.push_back({between, to});
      from = to;
    }
    return joined(std::move(all));
  }

  double support(const Eigen::Vector3d& direction) const override {
    return std::abs(direction.y()) * half_width_ + profile_support(direction.x(), direction.z());
  }

 private:
  /// Returns the interval of the line within the bounding box of the block.
  Interval box_interval(const Line& line) const {
    Interval out;
    out.clip(line.origin.x(), line.direction.x(), -half_length_, half_length_);
    out.clip(line.origin.y(), line.direction.y(), -half_width_, half_width_);
    out.clip(line.origin.z(), line.direction.z(), 0.0, o_.height + o_.amplitude);
    return out;
  }

  double height_at(double s) const { return o_.height + o_.amplitude * math::cos(2.0 * kPi * s / o_.period); }

  /// Returns the height of the point at distance x along the line, relative to the top surface; metres.
  double clearance(const Line& line, double x) const {
    return line.origin.z() + x * line.direction.z() - height_at(line.origin.x() + x * line.direction.x());
  }

  /// Returns the first x after `from` where the slope of the clearance may change its sign. The slope along the line is
  /// u_z + A * k * u_s * sin(k * s). u is the direction of the line, A the amplitude and k the wave number. The slope
  /// is 0 where sin(k * s) = -u_z / (A * k * u_s), at two positions per period.
  double next_turn(const Line& line, double from) const {
    const double along = line.direction.x();
    const double steepest = o_.amplitude * k_ * along;
    if (!(std::abs(line.direction.z()) < std::abs(steepest))) return kInfinity;
    // The phase grows along the line, also if the line points towards -x.
    const double turn = std::copysign(1.0, along) * math::asin(-line.direction.z() / steepest);
    const double rate = k_ * std::abs(along);
    const double phase = std::copysign(1.0, along) * k_ * line.origin.x() + rate * from;
    const double least = phase + 1e-9;
    const auto after = [least](double angle) { return angle + 2.0 * kPi * std::ceil((least - angle) / (2.0 * kPi)); };
    return from + (std::min(after(turn), after(kPi - turn)) - phase) / rate;
  }

  /// Returns the zero of the clearance between two positions with different signs, found by bisection and Newton's
  /// method. Between them, the clearance must be monotonic.
  double crossing(const Line& line, double above, double below) const {
    double x = 0.5 * (above + below);
    for (int i = 0; i < 100 && std::abs(below - above) > 1e-16; ++i) {
      const double clear = clearance(line, x);
      (clear > 0.0 ? above : below) = x;
      const double s = line.origin.x() + x * line.direction.x();
      const double slope = line.direction.z() + o_.amplitude * k_ * line.direction.x() * math::sin(k_ * s);
      const double next = x - clear / slope;
      if (std::abs(next - x) < 1e-15) return next;
      x = next > std::min(above, below) && next < std::max(above, below) ? next : 0.5 * (above + below);
    }
    return x;
  }

  /// Returns the largest value of along * s + up * z over the block's section in the plane of length and height.
  double profile_support(double along, double up) const {
    const double bottom = std::abs(along) * half_length_;
    if (up <= 0.0) return bottom;
    double best = bottom + up * height_at(half_length_);
    // On the top, the maximum is at an end of the wave, or near the farthest crest in this direction. There, along = up
    // * A * k * sin(k * s).
    if (std::abs(along) > up * o_.amplitude * k_) return best;
    const double phase = o_.amplitude > 0.0 ? math::asin(along / (up * o_.amplitude * k_)) : 0.0;
    double s = std::abs(phase) / k_;
    if (s > half_length_) return best;
    if (along != 0.0) s += o_.period * std::floor((half_length_ - s) / o_.period);
    return std::max(best, std::abs(along) * s + up * height_at(s));
  }

  Options o_;
  double half_length_ = o_.length / 2;
  double half_width_ = o_.width / 2;
  double k_ = 2.0 * kPi / o_.period;  ///< wave number: phase in radians per metre
};

PALPATE_PLUGIN(Shape, Wave, "wave", "block with a wavy top (object I of the paper)")

}  // namespace palpate::shapes
