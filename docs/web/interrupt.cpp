// Stands for the signals that end native programs: WebAssembly has none, and a page ends its workers.
#include "stages/support/interrupt.hpp"

Interrupt::Interrupt() = default;

Interrupt::~Interrupt() = default;

void Interrupt::set_timeout(double, const std::string&) {}

int Interrupt::status() const { return 1; }
