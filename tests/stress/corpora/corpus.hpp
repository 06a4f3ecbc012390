// Case of one ray and one surface, and a corpus: a random source of cases of one kind.
#pragma once

#include <protostar/ray.hpp>

#include "support/random.hpp"

template <class S>
struct Case {
  protostar::Ray ray;
  S surface;
};

template <class S>
struct Corpus {
  const char* name;
  Case<S> (*next)(Random&);
};
