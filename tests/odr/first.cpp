// Two translation units that include everything link into one program, and share every function: one that is not
// inline would be defined twice, one in an unnamed namespace or static would have two addresses.

#include <cdem/cdem.hpp>

#include "units.hpp"

Addresses addresses_in_first() {
  return addresses();
}

int main() {
  return addresses_in_first() == addresses_in_second() ? 0 : 1;
}
