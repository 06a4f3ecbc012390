// Pearson's χ² test of counts, whose false alarms are rarer than one in a million.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

/// Returns the bound that χ² with so many degrees of freedom exceeds with a probability below 1e-6, by Wilson
/// and Hilferty's cube root. The normal quantile is 4.753; 4.9 in its place makes up for the error of the
/// approximation from 3 degrees on.
inline double chi_squared_bound(int degrees) {
  const double k = degrees, share = 2 / (9 * k), root = 1 - share + 4.9 * std::sqrt(share);
  return k * root * root * root;
}

/// Returns χ² of counts over its bound: less than 1 if the counts may be of the expected numbers. Numbers
/// below 10 are counted as one cell, as χ² is for numbers that are nearly normal; if even that is below 10, a
/// count above 60, of a probability below 1e-20, is wrong. `counts` and `expected` give access by an index.
double chi_squared_over_bound(int cells, const auto& counts, const auto& expected) {
  double sum = 0, rest_count = 0, rest = 0;
  int used = 0;
  const auto add = [&](double count, double number) {
    sum += (count - number) * (count - number) / number, ++used;
  };
  for (int i = 0; i < cells; ++i)
    if (const double number = expected(i); number >= 10)
      add(counts(i), number);
    else
      rest_count += counts(i), rest += number;
  if (rest >= 10)
    add(rest_count, rest);
  else if (rest_count > 60)
    return std::numeric_limits<double>::infinity();
  return used < 2 ? 0 : sum / chi_squared_bound(std::max(used - 1, 3));
}
