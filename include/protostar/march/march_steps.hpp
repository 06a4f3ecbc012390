// Traces, which a march tells of its steps: of each evaluation of the field, and of each part of the ray that
// is proven empty.
#pragma once

#include <cstdint>

#include "../numeric/double_double.hpp"
#include "../platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Kind of an evaluation of a field by a march.
enum class Evaluation : std::uint8_t {
  value,          ///< a plain value in double, at one t
  slope,          ///< an enclosure of value and slope in double, over a segment
  precise_value,  ///< an enclosure of the value in double-double, at one t
  precise_slope   ///< an enclosure of value and slope in double-double, over a segment
};

/// Proof that a part of a ray is empty, or that it has one crossing.
enum class MarchProof : std::uint8_t {
  ball,         ///< a value: the field cannot reach 0 nearer to it than (v − E) / (L |d|)
  two_balls,    ///< two values whose balls cover what is between them, after an over-relaxed step
  bend,         ///< the line through two values, and a bound of the second derivative behind them
  segment,      ///< an enclosure of value and slope over the segment
  fall,         ///< a bound of the second derivative and two values behind: the field falls over the segment
  deflation,    ///< the slope has one sign from the surface that is left on: nothing but the departure
  sign_change,  ///< the field falls and has another sign at the end: the segment has one crossing
  touch         ///< not proven in double-double: the field comes nearer to 0 than its digits tell
};

/// Trace of a march that ignores everything. A trace of your own has the same two functions: evaluated() is
/// called for each evaluation over a ≤ t ≤ b, and proven() for each part a ≤ t ≤ b of the ray about which
/// something is proven. For a sign change or a touch [a, b] is the enclosure of the crossing's t.
struct NoTrace {
  void evaluated(Evaluation, double /*a*/, double /*b*/) {}
  void proven(MarchProof, double /*a*/, double /*b*/) {}
};

/// Trace that is called through virtual functions, so that one can be given to a march of any field. It takes
/// parameters t with all of their digits; other traces take the nearest doubles. Its evaluated() takes the
/// result of the evaluation as well: an enclosure of the value, or for a plain value in double that value as
/// both ends, with the error that the surface's set-up bounds; and an enclosure of the slope by t, or 0 where
/// no slope was evaluated. Results have the sign that makes F > 0 where the march comes from.
class MarchListener {
 public:
  /// Enclosures by their ends, which are rounded to double if they are in double-double.
  struct Result {
    double lower = 0, upper = 0, slope_lower = 0, slope_upper = 0;
  };

  virtual void evaluated(Evaluation kind, const DoubleDouble& a, const DoubleDouble& b,
                         const Result& result) = 0;
  virtual void proven(MarchProof proof, const DoubleDouble& a, const DoubleDouble& b) = 0;

 protected:
  ~MarchListener() = default;
};

/// Trace that counts the evaluations of a march.
struct MarchCounts {
  std::uint64_t values = 0, slopes = 0, precise_values = 0, precise_slopes = 0;

  void evaluated(Evaluation kind, double, double) {
    ++(kind == Evaluation::value           ? values
       : kind == Evaluation::slope         ? slopes
       : kind == Evaluation::precise_value ? precise_values
                                           : precise_slopes);
  }
  void proven(MarchProof, double, double) {}

  /// Returns the number of all evaluations.
  [[nodiscard]] std::uint64_t evaluations() const {
    return values + slopes + precise_values + precise_slopes;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI
