// Pearson's χ² test of counts, whose false alarms are rarer than one in a million.
#pragma once

#include <cmath>

/// Returns the bound that χ² with so many degrees of freedom exceeds with a probability below 1e-6, by Wilson
/// and Hilferty's cube root. Its normal quantile is 4.753; 4.9 is more than the error of the approximation
/// from 3 degrees on.
inline double chi_squared_bound(int degrees) {
  const double k = degrees, share = 2 / (9 * k), root = 1 - share + 4.9 * std::sqrt(share);
  return k * root * root * root;
}

/// Returns χ² of counts and their expected values, to which `counts` and `expected` give access by an index.
double chi_squared(int cells, const auto& counts, const auto& expected) {
  double sum = 0;
  for (int i = 0; i < cells; ++i) {
    const double difference = counts(i) - expected(i);
    sum += difference * difference / expected(i);
  }
  return sum;
}
